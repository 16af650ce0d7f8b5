"""FLL files of both versions, what has no counterpart, and what is broken."""

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.formats.fll_reader import loads_fll
from fuzzytrack.fuzzy.formats.fll_writer import dumps_fll
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.saving import dumps_rulebase

PUMP = """\
#Code of a pump.
Engine: pump
description: Empties a tank.
InputVariable: level
  description: level in the tank
  enabled: true
  range: 0.000 2.000
  lock-range: false
  term: low Ramp 1.000 0.500
  term: good Bell 1.000 0.400 3.000
  term: high SigmoidDifference 1.500 9.000 -8.000 3.000
InputVariable: inflow
  enabled: true
  range: 0.000 10.000
  lock-range: false
  term: weak Discrete 0.000 1.000 4.000 0.500 6.000 0.000
  term: strong Concave 5.000 9.000
OutputVariable: opening
  enabled: true
  range: 0.000 100.000
  lock-range: false
  aggregation: AlgebraicSum
  defuzzifier: Centroid 200
  default: 3.000
  lock-previous: false
  term: shut Cosine 10.000 40.000
  term: full Rectangle 60.000 90.000
RuleBlock: rules
  enabled: true
  conjunction: AlgebraicProduct
  disjunction: Maximum
  implication: Minimum
  activation: General
  rule: if level is low and inflow is weak then opening is shut
  rule: if level is very good and (inflow is strong or inflow is not weak) then opening is full with 0.5
  rule: if level is high or inflow is extremely strong then opening is full
"""  # noqa: E501


def changed(*pairs, text=PUMP):
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return text


def by_hand(level, inflow):
    """The pump by the formulas of the language, over the middles of 200 cells."""
    low = min(1, max(0, (1 - level) / 0.5))
    good = 1 / (1 + abs((level - 1) / 0.4) ** 6)
    high = abs(1 / (1 + np.exp(-9 * (level - 1.5))) - 1 / (1 + np.exp(8 * (level - 3))))
    weak = np.interp(inflow, [0, 4, 6], [1, 0.5, 0])
    strong = 4 / (13 - inflow) if inflow < 9 else 1
    contrast = 2 * strong**2 if strong <= 0.5 else 1 - 2 * (1 - strong) ** 2
    y = (np.arange(200) + 0.5) * 0.5
    shut = np.where(abs(y - 10) <= 20, 0.5 * (1 + np.cos(2 * np.pi / 40 * (y - 10))), 0)
    full = ((y >= 60) & (y <= 90)).astype(float)
    parts = [
        np.minimum(low * weak, shut),
        np.minimum(0.5 * max(good**2 * strong, good**2 * (1 - weak)), full),
        np.minimum(max(high, contrast), full),
    ]
    fuzzy = parts[0]
    for part in parts[1:]:
        fuzzy = fuzzy + part - fuzzy * part
    return fuzzy @ y / fuzzy.sum()


@pytest.mark.parametrize(
    ("level", "inflow"), [(0.2, 1), (0.7, 3.5), (0.9, 8), (1.1, 5), (1.7, 9.5), (0.95, 2)]
)
def test_a_file_is_evaluated_as_the_language_says(level, inflow):
    rules = loads_fll(PUMP, "pump.fll")
    value = ft.FuzzySystem(rules)(level=level, inflow=inflow)["opening"]
    assert value == pytest.approx(by_hand(level, inflow), abs=1e-11)
    again = loads_fll(dumps_fll(rules).text, "again.fll")
    assert ft.FuzzySystem(again)(level=level, inflow=inflow)["opening"] == value


def test_what_is_read():
    rules = loads_fll(PUMP, "pump.fll")
    assert rules.description == "Empties a tank."
    assert rules.inputs[0].label == "level in the tank"
    assert rules.operators.words() == {
        "and": "product", "or": "algebraic-sum", "defuzzification": "centroid",
        "implication": "min",
    }  # fmt: skip
    assert rules.outputs[0].universe.grid == "midpoints"
    assert rules.outputs[0].default == 3
    assert loads_rulebase(dumps_rulebase(rules)) == rules


def test_version_5_of_the_language_is_the_same():
    old = changed(
        ("aggregation: Alg", "accumulation: Alg"), ("  implication: Minimum\n", ""),
        ("activation: General", "activation: Minimum"), ("lock-previous", "lock-valid"),
        ("  lock-range: false\n  term: low", "  term: low"),
    )  # fmt: skip
    assert loads_fll(old, "x") == loads_fll(PUMP, "x")


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff" + PUMP,
        PUMP.replace("\n", "\r\n"),
        PUMP.replace("\n  ", "\n"),
        PUMP.replace("  term:", "\t term :").replace("General", "General # all of them"),
        PUMP.replace("Rectangle 60.000 90.000", "Rectangle 60 90 1.000"),
        PUMP.replace("(inflow is strong", "( inflow   is strong"),
    ],
)
def test_the_same_file_in_other_clothes(text):
    assert loads_fll(text.encode(), "x") == loads_fll(PUMP, "x")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "  enabled: true\n  range: 0.000 2",
            "  enabled: false\n  range: 0.000 2",
            "6:12: Input",
        ),
        ("range: 0.000 2.000", "range: 2 0", "7:10: range must be low high"),
        ("range: 0.000 2.000", "range: -inf inf", "7:10: range: '-inf' must be a finite number"),
        ("Ramp 1.000 0.500", "Ramp 1.000", "9:13: Ramp takes start end as finite numbers"),
        ("Ramp 1.000 0.500", "Ramp 1.000 0.500 0.7", "9:13: Ramp of the height 0.7: only the"),
        (
            "Ramp 1.000 0.500",
            "Ramp 1 1",
            "9:13: Ramp takes start and end that differ, got '1 1'; a",
        ),
        ("Ramp 1.000 0.500", "Function x", "9:13: a Function term has no counterpart"),
        (
            "Ramp 1.000 0.500",
            "Rampe 1.000 0.500",
            "9:13: .*'Rampe' has no counterpart; did",
        ),
        ("Ramp 1.000 0.500", "Constant 1.000", "9:13: .*'Constant' has no counterpart"),
        (
            "lock-previous: false",
            "lock-previous: true",
            "25:18: lock-previous: an output",
        ),
        ("Centroid 200", "WeightedSum", "23:16: the defuzzifier 'WeightedSum' has no counterpart"),
        ("Centroid 200", "Centroid many", "23:16: Centroid takes a whole number of points"),
        ("Centroid 200", "WeightedAverage", "26:14: a Cosine term in a weighted average"),
        ("Centroid 200", "none", "18:1: 'opening' has no defuzzifier"),
        ("AlgebraicSum", "DrasticSum", "22:16: aggregation 'DrasticSum' has no counterpart"),
        (
            "AlgebraicProduct",
            "DrasticProduct",
            "30:16: conjunction 'DrasticProduct' has",
        ),
        ("AlgebraicProduct", "none", "28:1: rules use 'and' without a conjunction"),
        ("disjunction: Maximum", "disjunction: AlgebraicSum", "35:31: 'or' inside of 'and' has no"),
        ("implication: Minimum", "implication: none", "rules conclude about opening without an im"),
        ("General", "First 2 0.5", "33:15: the activation 'First 2 0.5' has no counterpart"),
        ("activation", "aktivation", "33:3: RuleBlock: unknown key 'aktivation'; did you mean"),
        ("  default: 3.000", "  default: 3\n  default: 4", "25:3: default is given twice"),
        ("default: 3.000", "default: 300", "18:1: default of opening must be within its universe"),
        ("is low and", "is lo and", "34:21: level has no set 'lo'; one of low, good, high"),
        (
            "if level is low",
            "if levl is low",
            "34:12: unknown variable 'levl'; did you mean 'level'\\? allowed: [a-z, ]*$",
        ),
        ("InputVariable: inflow", "InputVariable: level", "a second variable 'level'; rename one"),
        ("if level is low", "level is low", "34:9: expected 'if', got 'level'"),
        ("weak then opening is shut", "weak", "34:43: expected 'then', got 'the end'"),
        ("opening is shut", "opening is", "34:59: a term is missing at the end of the rule"),
        (
            "opening is shut",
            "opening is very shut",
            "34:49: a hedge in a conclusion has",
        ),
        ("opening is shut", "opening is shut now", "34:65: 'now' after the end of the rule"),
        ("with 0.5", "with 1.5", r"35:9: weight must be within \[0, 1\]"),
        ("is not weak)", "is not weak", r"expected '\)', got 'then'"),
        ("Engine: pump\n", "", "2:1: text before the line 'Engine: name'"),
        (
            "level is low and",
            "level is low and level is good and",
            "34:9: two conditions",
        ),
    ],
)
def test_what_has_no_counterpart_or_is_broken_is_named_with_its_place(old, new, said):
    with pytest.raises(RuleBaseError, match=said) as error:
        loads_fll(changed((old, new)), "pump.fll")
    assert error.value.location.file == "pump.fll"
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("kind", ["InputVariable", "OutputVariable", "RuleBlock"])
def test_a_file_that_lacks_a_kind_of_block_is_told_so(kind):
    lines = iter(CHAIN.splitlines(keepends=True))
    kept, block = [], ""
    for line in lines:
        block = line.split(":")[0] if not line.startswith(" ") else block
        kept += [line] if block != kind else []
    with pytest.raises(RuleBaseError, match=f"^x:1:1: there is no {kind}: is the file complete"):
        loads_fll("".join(kept), "x")


def test_nested_parentheses_are_bounded():
    deep = "(" * 500 + "level is low" + ")" * 500
    with pytest.raises(RuleBaseError, match="more than 20 parentheses"):
        loads_fll(changed(("if level is low and", f"if {deep} and")), "x")
    wide = " and ".join(["(level is low or level is good)"] * 40)
    with pytest.raises(RuleBaseError, match="more than 64 alternatives"):
        loads_fll(changed(("if level is low and", f"if {wide} and")), "x")


CHAIN = """\
Engine: chain
InputVariable: x
  range: 0 1
  term: lo Ramp 1 0
  term: hi Ramp 0 1
OutputVariable: y
  range: 0 10
  aggregation: Maximum
  defuzzifier: WeightedAverage TakagiSugeno
  term: one Constant 1
  term: nine Constant 9
OutputVariable: z
  range: 0 10
  aggregation: none
  defuzzifier: WeightedAverage TakagiSugeno
  term: slope Linear 4 1
  term: two Constant 2
RuleBlock:
  conjunction: Minimum
  activation: General
  rule: if x is lo then y is one
  rule: if x is hi then y is nine
  rule: if y is nine then z is slope
  rule: if y is one and x is lo then z is two
"""


@pytest.mark.parametrize("x", [0.0, 0.25, 0.75, 1.0])
def test_conditions_about_outputs_stand_for_those_behind_them(x):
    values = ft.FuzzySystem(loads_fll(CHAIN, "chain.fll"))(x=x)
    assert values["y"] == pytest.approx(1 * (1 - x) + 9 * x, abs=1e-14)
    assert values["z"] == pytest.approx((4 * x + 1) * x + 2 * (1 - x), abs=1e-14)


def test_two_algebras_in_one_file():
    rules = loads_fll(CHAIN, "chain.fll")
    y, z = rules.outputs
    assert (rules.operators_of(y).disjunction, rules.operators_of(z).disjunction) == ("max", "sum")
    again = ft.FuzzySystem(loads_fll(dumps_fll(rules).text, "again.fll"))
    assert again(x=0.3) == ft.FuzzySystem(rules)(x=0.3)


def test_a_condition_about_an_output_of_a_weighted_rule_is_refused():
    text = changed(("then y is nine\n", "then y is nine with 0.5\n"), text=CHAIN)
    with pytest.raises(RuleBaseError, match=r"chain\.fll:23:9: a condition about the output y"):
        loads_fll(text, "chain.fll")


def test_what_the_format_lacks_is_named():
    text = dumps_rulebase(loads_fll(PUMP, "x"))
    for old, new, said in (
        ("not discrete", "not extremely discrete", "the hedge extremely"),
        ("cosine: [10, 40]", "very cosine: [10, 40]", "the hedge of 'opening is shut', very,"),
        ("full@0.5", "full@0.5", "a confidence that is joined by min"),
    ):
        assert old in text
        other = text.replace(old, new)
        if "joined" in said:
            other = other.replace("implication: min", "implication: min, weighting: min")
        with pytest.raises(RuleBaseError, match=f"pump: {said} has no counterpart in FLL"):
            dumps_fll(loads_rulebase(other))
    notes = dumps_fll(loads_rulebase(text.replace(", grid: midpoints", ""))).notes
    assert "200 points with both ends" in notes[0]


def test_names_that_the_language_lacks_are_changed_and_said():
    text = dumps_rulebase(loads_fll(PUMP, "x")).replace("shut", "and").replace("strong", "ze-1")
    found = dumps_fll(loads_rulebase(text))
    assert "'and' of opening is named 'and_'" in found.notes
    assert "'ze-1' of inflow is named 'ze_1'" in found.notes
    assert loads_fll(found.text, "x").outputs[0].set_names == ("and_", "full")
    with pytest.raises(RuleBaseError, match=r"the name 'größe' has no .*; rename the variable"):
        dumps_fll(loads_rulebase(text.replace("inflow", "größe")))
