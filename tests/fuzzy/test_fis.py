"""FIS files: what MATLAB's users have, what has no counterpart, and what is broken."""

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.formats.fis_reader import loads_fis
from fuzzytrack.fuzzy.formats.fis_writer import dumps_fis
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.saving import dumps_rulebase

HEATER = """\
% Heating of a room.
[System]
Name='heater'
Type='mamdani'
Version=2.0
NumInputs=2
NumOutputs=1
NumRules=4
AndMethod='min'
OrMethod='max'
ImpMethod='min'
AggMethod='max'
DefuzzMethod='centroid'

[Input1]
Name='room temperature'
Range=[0.000 30.000]
NumMFs=2
MF1='cold':'gaussmf',[4.000 5.000]
MF2='warm':'sigmf',[0.8 20]

[Input2]
Name='change'
Range=[-2 2]
NumMFs=2
MF1='falls':'zmf',[-1 1]
MF2='much, up':'gauss2mf',[0.5 1 0.3 1.5]

[Output1]
Name='power'
Range=[0 100]
NumMFs=3
MF1='off':'trimf',[0 0 40]
MF2='half':'trapmf',[20 40 60 80]
MF3='full':'trimf',[60 100 100]

[Rules]
1 1, 3 (1) : 1
1 -1, 2 (0.5) : 1
2 0, 1 (1) : 1
2 2, 1 (1) : 2
"""


def changed(*pairs, text=HEATER):
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return text


def by_hand(x, d):
    """The heater evaluated as the toolbox describes it: 101 points, min, max, centroid."""
    cold = np.exp(-((x - 5) ** 2) / (2 * 4**2))
    warm = 1 / (1 + np.exp(-0.8 * (x - 20)))
    part = (d + 1) / 2
    falls = (
        1 if d <= -1 else 0 if d >= 1 else 1 - 2 * part**2 if part < 0.5 else 2 * (1 - part) ** 2
    )
    up = np.exp(-((d - 1) ** 2) / (2 * 0.5**2)) if d < 1 else 1.0
    up = up if d <= 1.5 else np.exp(-((d - 1.5) ** 2) / (2 * 0.3**2))
    y = np.linspace(0, 100, 101)
    off = np.clip((40 - y) / 40, 0, 1)
    half = np.clip(np.minimum((y - 20) / 20, (80 - y) / 20), 0, 1)
    full = np.clip((y - 60) / 40, 0, 1)
    fuzzy = np.max(
        [
            np.minimum(min(cold, falls), full),
            np.minimum(0.5 * min(cold, 1 - falls), half),
            np.minimum(warm, off),
            np.minimum(max(warm, up), off),
        ],
        axis=0,
    )
    return fuzzy @ y / fuzzy.sum()


@pytest.mark.parametrize(("x", "d"), [(3, -1.5), (12, -0.3), (12, 0.4), (22, 1.2), (7, 1.9)])
def test_a_file_is_evaluated_as_the_toolbox_describes(x, d):
    rules = loads_fis(HEATER, "heater.fis")
    value = ft.FuzzySystem(rules)(room_temperature=x, change=d)["power"]
    assert value == pytest.approx(by_hand(x, d), abs=1e-12)


def test_what_is_read():
    rules = loads_fis(HEATER, "heater.fis")
    assert rules.name == "heater"
    assert rules.input_names == ("room_temperature", "change")
    assert rules.inputs[0].label == "room temperature"
    assert rules.inputs[1].set_names == ("falls", "much__up", "not_falls")
    assert rules.inputs[1].sets[2].shape == "not zmf"
    assert rules.operators == Operators("min", "max", "centroid", weighting="product")
    assert rules.outputs[0].default == 50
    assert rules.outputs[0].universe.points == 101
    assert loads_rulebase(dumps_rulebase(rules)) == rules


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff" + HEATER,
        HEATER.replace("\n", "\r\n"),
        HEATER.replace("\n", "\r"),
        HEATER.replace("=", " = ").replace("[System]", "  [system]  "),
        HEATER.replace(" ", "\t").replace("room\ttemperature", "room temperature"),
        HEATER.replace("\n1 1, 3 (1) : 1", "\n# a rule\n1 1,3 (1):1 % when cold"),
        HEATER.replace("much, up", "much,\tup"),
        HEATER.replace("=2\n", "=2.000\n").replace(" (1) : 1", ".000 (1.000) : 1.000"),
        HEATER.replace("'", '"'),
        HEATER[HEATER.index("[Input2]") : HEATER.index("[Output1]")]
        + HEATER.replace(HEATER[HEATER.index("[Input2]") : HEATER.index("[Output1]")], ""),
        HEATER.replace("[4.000 5.000]", "[4, 5]").replace("[0 0 40]", "[ 0  0  40 ]"),
    ],
)
def test_the_same_file_in_other_clothes(text):
    assert loads_fis(text, "x") == loads_fis(HEATER, "heater.fis")
    assert loads_fis(text.encode("utf-8"), "x") == loads_fis(HEATER, "heater.fis")


def test_thousands_of_namesakes_have_names_of_their_own():
    sets = "".join(f"MF{k}='s':'trimf',[0 0 40]\n" for k in range(1, 8001))
    old = HEATER[HEATER.index("NumMFs=3") : HEATER.index("\n[Rules]")]
    names = loads_fis(HEATER.replace(old, f"NumMFs=8000\n{sets}"), "x").outputs[0].set_names
    assert names == ("s", *(f"s_{k}" for k in range(2, 8001)))


def test_other_encodings():
    text = changed(("'heater'", "'Öfen'"))
    assert loads_fis(text.encode("latin-1"), "x").name == "Öfen"
    with pytest.raises(RuleBaseError, match="x:1:1: the file is UTF-16"):
        loads_fis(text.encode("utf-16"), "x")


def test_allowed_words_are_listed_once():
    for old in ("'gaussmf'", "AndMethod='min'"):
        with pytest.raises(RuleBaseError) as found:
            loads_fis(changed((old, old.replace("m", "q"))), "x")
        assert str(found.value).count("allowed: ") == 1


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("Type='mamdani'", "Type='mamdanitype2'", "4:6: 'mamdanitype2': sets of type 2 have no"),
        ("Type='mamdani'", "Type='tsukamoto'", "4:6: unknown Type 'tsukamoto'; allowed: mamdani,"),
        ("AndMethod='min'", "AndMethod='myand'", "9:11: AndMethod 'myand' has no counterpart"),
        ("AggMethod='max'", "AggMethod='mymax'", "12:11: AggMethod 'mymax' has no counterpart"),
        ("'centroid'", "'mysum'", "13:14: DefuzzMethod of mamdani 'mysum' has no counterpart"),
        ("Version=2.0\n", "", "is 2, but there are"),
        ("NumInputs=2", "NumInputs=3", "6:11: NumInputs is 3, but there are 2 inputs"),
        ("NumRules=4", "NumRules=9", "8:10: NumRules is 9, but there are 4 rules"),
        ("NumMFs=3", "NumMFs=4", "29:1: the sets must be MF1 to MF4, got 3 sets, the last MF3"),
        ("MF2='half'", "MF5='half'", "29:1: the sets must be MF1 to MF3, got 3 sets, the last MF5"),
        ("'gaussmf'", "'bellcurve'", "19:12: the shape 'bellcurve' has no counterpart"),
        ("'zmf',[-1 1]", "'zmf',[-1 1 2]", r"26:13: zmf takes \[a b\], not 3 numbers"),
        ("'zmf',[-1 1]", "'zmf',[-1 nan]", "26:23: parameters of zmf: 'nan' must be a finite"),
        ("[0 0 40]", "[9 0 40]", "33:11: set 'off': trimf requires a <= b <= c"),
        ("[-2 2]", "[2 -2]", "24:7: Range must be .low high. with low < high"),
        ("Range=[-2 2]\n", "", "22:1: Range is missing in this section"),
        ("\n1 1, 3", "\n1 1 1, 3", "38:1: a rule has 2 indices of input sets, got 3"),
        ("\n1 1, 3", "\n1 7, 3", "38:3: '7': input change has 2 sets"),
        ("\n1 1, 3", "\n1 1, 4", "38:6: '4': output power has 3 sets"),
        ("\n1 1, 3", "\n1 1.07, 3", "38:3: '1.07': unknown hedge .07"),
        ("\n1 1, 3", "\n1 x, 3", "38:3: 'x' is no index of a set"),
        ("\n1 1, 3", "\n0 0, 3", "38:1: a rule without a condition has no counterpart"),
        ("\n1 1, 3", "\n1 1, 0", "38:1: a rule without a conclusion has no counterpart"),
        ("3 (1) : 1\n", "3 (1) : 3\n", r"38:14: the connection must be 1 \(and\) or 2 \(or\)"),
        ("3 (1) : 1\n", "3 1 1\n", "38:1: a rule is written as"),
        ("(0.5)", "(1.5)", r"39:1: weight must be within \[0, 1\], got 1.5"),
        ("[Rules]", "[Regeln]", r"37:1: unknown section '\[Regeln\]'"),
        ("[System]", "[Input1]", "15:1: a second section"),
        ("Name='change'", "Name=change", "23:6: Name must be a text in quotation marks"),
        ("Name='change'", "Name", "23:1: 'Name' is not written as Key=value"),
        ("Range=[-2 2]", "Range=[-2 2]\nRange=[-2 2]", "25:1: Range is given twice"),
        ("Name='heater'", "Name='hea\x07ter'", "3:10: the character U.0007 may not be in a text"),
        ("OrMethod='max'\n", "", "2:1: OrMethod is missing .* add a line OrMethod="),
        ("3 (1) : 1\n", "3 (1) : 1.5\n", "38:14: the connection must be"),
        ("NumRules=4", "NumRules=4.5", "8:10: NumRules must be a whole number"),
    ],
)
def test_what_has_no_counterpart_or_is_broken_is_named_with_its_place(old, new, said):
    text = changed((old, new))
    if "Version" in old:
        text = text.replace("[Input2]", "[Input4]")
        said = r"the section \[Input2\] is missing"
    with pytest.raises(RuleBaseError, match=said) as error:
        loads_fis(text, "heater.fis")
    assert error.value.location.file == "heater.fis"
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "text", ["", "rulebase: 1", "[Rules]\n", "x" * 2_000_000, "\x00", "[System"]
)
def test_what_is_no_such_file(text):
    with pytest.raises(RuleBaseError, match=r"^x:1:1: "):
        loads_fis(text, "x")


def test_shoulders_at_infinity():
    rules = loads_fis(changed(("'gaussmf',[4.000 5.000]", "'trapmf',[-Inf -Inf 5 8]")), "x")
    assert rules.inputs[0].sets[0].shape == "linzmf"
    grades = rules.inputs[0].sets[0].membership([0, 5, 6.5, 8, 30])
    np.testing.assert_array_equal(grades, [1, 1, 0.5, 0, 0])
    rules = loads_fis(changed(("'trimf',[60 100 100]", "'trapmf',[60 100 inf inf]")), "x")
    assert rules.outputs[0].sets[2].parameters == (60, 100)
    with pytest.raises(RuleBaseError, match="19:12: parameters of trapmf must be finite, but for"):
        loads_fis(changed(("'gaussmf',[4.000 5.000]", "'trapmf',[-Inf 2 5 8]")), "heater.fis")


def test_hedges_of_indices():
    text = changed(("\n1 1, 3", "\n1.20 -1.05, 3"))
    rules = loads_fis(text, "x")
    assert dict(rules.rules[0].conditions) == {
        "room_temperature": "very_cold",
        "change": "not_somewhat_falls",
    }


SUGENO = """\
[System]
Name='ramp'
Type='sugeno'
AndMethod='prod'
OrMethod='probor'
ImpMethod='prod'
AggMethod='sum'
DefuzzMethod='wtaver'
[Input1]
Name='a'
Range=[0 1]
MF1='lo':'linzmf',[0 1]
MF2='hi':'linsmf',[0 1]
[Input2]
Name='b'
Range=[0 1]
MF1='lo':'linzmf',[0 1]
MF2='hi':'linsmf',[0 1]
[Output1]
Name='y'
Range=[0 1]
MF1='plane':'linear',[2 -1 3]
MF2='five':'constant',[5]
[Rules]
1 1, 1 (1) : 1
2 2, 2 (0.5) : 2
1 1, 1 (0.25) : 1
"""


@pytest.mark.parametrize(("a", "b"), [(0, 0), (0.25, 0.5), (1, 0.75), (0.3, 1)])
def test_sugeno_rules_are_averaged_by_their_weights(a, b):
    low = (1 - a) * (1 - b)
    high = 0.5 * (a + b - a * b)
    expected = (1.25 * low * (2 * a - b + 3) + high * 5) / (1.25 * low + high)
    rules = loads_fis(SUGENO, "ramp.fis")
    assert ft.FuzzySystem(rules)(a=a, b=b)["y"] == pytest.approx(expected, abs=1e-12)
    again = loads_fis(dumps_fis(rules).text, "again.fis")
    assert ft.FuzzySystem(again)(a=a, b=b)["y"] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("'wtaver'", "'wtsum'", "DefuzzMethod of sugeno 'wtsum' has no counterpart"),
        ("[2 -1 3]", "[2 3]", "22:13: linear takes a coefficient for each of the 2 inputs"),
        ("'constant',[5]", "'constant',[5 6]", "23:12: constant takes one number, not 2"),
        ("'constant'", "'trimf'", "outputs of Sugeno systems are constant or linear"),
    ],
)
def test_what_sugeno_systems_may_not_have(old, new, said):
    with pytest.raises(RuleBaseError, match=said):
        loads_fis(changed((old, new), text=SUGENO), "ramp.fis")


def test_where_no_rule_fires_is_the_middle_of_the_range():
    text = changed(
        ("'gaussmf',[4.000 5.000]", "'trimf',[0 5 8]"), ("'sigmf',[0.8 20]", "'smf',[20 25]")
    )
    text = text.replace("2 2, 1 (1) : 2", "2 2, 1 (1) : 1")
    rules = loads_fis(text, "x")
    assert ft.FuzzySystem(rules)(room_temperature=12, change=0)["power"] == 50
    default = dumps_rulebase(rules).replace("default: 50", "default: 20")
    (note,) = dumps_fis(loads_rulebase(default)).notes
    assert note.startswith(
        "power is 20 where no rule fires; MATLAB gives the middle of the range, 50"
    )


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("{trimf: [5, 5, 9]}", "{spike: [5, 4]}", "the shape spike of 'b'"),
        ("{trimf: [5, 5, 9]}", "{very trimf: [5, 5, 9]}", "the hedge of 'x is b', very,"),
        ("{trimf: [5, 5, 9]}", "{gauss2mf: [7, 1, 6, 1]}", "gauss2mf with mean1 > mean2"),
        ("and: min", "and: einstein-product", "and einstein-product"),
        ("or: max", "or: bounded-sum", "or bounded-sum"),
        ("centroid", "weighted-centers", "or max with weighted-centers, where rules share a set,"),
        ("{y: p}}", "{y: p@0.5}}", "a confidence that is joined by min"),
        ("{x: b}, t", "{x: b}, or: [{x: a, z: a}], t", "alternatives of several conditions"),
    ],
)
def test_what_the_format_lacks_is_named(old, new, said):
    text = """\
rulebase: 1
name: lacks
inputs:
  x: {universe: [0, 9, 10], sets: {a: {trimf: [0, 0, 9]}, b: {trimf: [5, 5, 9]}}}
  z: {universe: [0, 9, 10], sets: {a: {trapmf: [0, 0, 9, 9]}}}
outputs:
  y: {universe: [0, 4, 101], default: 2, sets: {p: {trimf: [0, 1, 2]}, q: {trimf: [2, 3, 4]}}}
operators: {and: min, or: max, defuzzification: centroid}
rules:
  - {if: {x: a}, then: {y: p}}
  - {if: {x: b}, then: {y: q}}
  - {if: {z: a}, then: {y: q}}
"""
    if "or:" in new and "[" in new:
        text = text.replace("or: max", "or: sum")
    assert dumps_fis(loads_rulebase(text)).notes == ()
    assert old in text
    with pytest.raises(RuleBaseError, match=f"lacks: .*{said}.* no counterpart in FIS"):
        dumps_fis(loads_rulebase(text.replace(old, new)))
