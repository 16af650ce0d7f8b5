"""Fuzzy sets changed in place: only what was meant changes, and the inverse gives the text back."""

from __future__ import annotations

import difflib
import re
from dataclasses import replace
from itertools import cycle

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from texts import LIST, TABLE, changed

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.anchors import write_out
from fuzzytrack.fuzzy.loading import loads_rulebase, rulebase_path, shipped_rulebases
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rule_edits import OPERATORS, set_cell, set_operator
from fuzzytrack.fuzzy.saving import cell_text, consequents_text
from fuzzytrack.fuzzy.set_edits import add_set, remove_set, rename_set
from fuzzytrack.fuzzy.shape_edits import set_shape

SHIPPED = {name: rulebase_path(name).read_bytes().decode() for name in shipped_rulebases()}
FLOW = TABLE.replace("sets:\n      lo:", "sets: {lo:").replace(
    "}\n      hi: {trimf: [0, 1, 1]}", "},\n        hi: {trimf: [0, 1, 1]} }  # both"
)
BLOCK = changed(
    LIST,
    "      lo: {trimf: [0, 0, 1]}\n",
    "      lo:\n        trimf:\n        - 0  # left\n        - 0\n        - 1\n",
)
SEVEN = SHIPPED["stiffness-damping"]


def odd(text, layout):
    """The same rule base in another layout."""
    if layout == "crlf":
        return text.replace("\n", "\r\n")
    if layout == "no final newline":
        return text.rstrip("\n")
    if layout == "tabs and unicode in comments":
        return text.replace("\n", "  # é\t速い {[&x *y\n").replace(">-  # é\t速い {[&x *y", ">-")
    if layout == "byte order mark":
        return "\ufeff" + text
    return text


LAYOUTS = ["as it is", "crlf", "no final newline", "byte order mark"]
IN_LAYOUTS = list(zip(sorted(SHIPPED), cycle(LAYOUTS), strict=False))
BASES = {**SHIPPED, "flow": FLOW, "block": BLOCK, "table": TABLE}
BASES["commented"] = odd(TABLE, "tabs and unicode in comments")


def comments(text):
    return re.findall(r"#[^\r\n]*", text)


def same_but(a, b, names):
    """Whether two rule bases have the same sets but for those of some variables."""
    pairs = zip((*a.inputs, *a.outputs), (*b.inputs, *b.outputs), strict=True)
    return all(x == y for x, y in pairs if x.name not in names)


@st.composite
def texts(draw):
    return odd(BASES[draw(st.sampled_from(sorted(BASES)))], draw(st.sampled_from(LAYOUTS)))


def variables(rules):
    return (*rules.inputs, *rules.outputs)


def edit(draw, text):
    """A random edit: the text after it, the variables it may change, and its inverse."""
    rules = loads_rulebase(text)
    variable = draw(st.sampled_from(variables(rules)))
    old = draw(st.sampled_from(variable.sets))
    name = variable.name
    kind = draw(st.sampled_from(["shape", "rename", "add", "cell", "operator"]))
    if kind == "shape":
        u = variable.universe
        moved = tuple(p + draw(st.integers(-3, 3)) * (u.high - u.low) / 64 for p in old.parameters)
        edited = set_shape(text, name, old.name, moved)
        back = set_shape(edited, name, old.name, old.parameters)
        return edited, {name, *(n for n, _ in edited.also)}, back
    if kind == "rename":
        new = draw(st.sampled_from(["x", "größe", "very-long-name", "Nx"]))
        edited = rename_set(text, name, old.name, new)
        return (
            edited,
            {name, *(n for n, _ in edited.also)},
            rename_set(edited, name, new, old.name),
        )
    if kind == "add":
        new = FuzzySet("added", old.shape, old.parameters)
        edited = add_set(text, name, new)
        touched = {name, *(n for n, _ in edited.also)}
        return edited, touched, remove_set(edited, name, "added", with_rules=True)
    if kind == "operator":
        word = draw(st.sampled_from(sorted(OPERATORS)))
        attribute, allowed = OPERATORS[word]
        edited = set_operator(text, word, draw(st.sampled_from(allowed)))
        return edited, set(), set_operator(edited, word, getattr(rules.operators, attribute))
    rule, other = (draw(st.sampled_from(rules.rules)) for _ in range(2))
    where = dict(rule.conditions)
    says = [
        cell_text(r, rules.layout.cells, rules) if rules.layout else consequents_text(r.consequents)
        for r in (other, rule)
    ]
    edited = set_cell(text, where, says[0])
    return edited, set(), set_cell(edited, where, says[1])


@pytest.mark.untraced
@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_an_edit_changes_its_part_and_its_inverse_gives_the_text_back(data):
    text = data.draw(texts())
    try:
        edited, touched, back = edit(data.draw, text)
    except RuleBaseError:
        assume(False)  # the edited text would be no rule base
    before, after = loads_rulebase(text), loads_rulebase(edited)
    assert same_but(before, after, touched)
    assert len(comments(edited)) == len(comments(text))
    heading = {c for c in comments(text) if re.search(r"#\s+[a-z]+\s+[a-z]+", c)}
    assert set(comments(text)) - set(comments(edited)) <= heading
    assert back == text


@pytest.mark.parametrize(("name", "layout"), IN_LAYOUTS)
def test_renaming_and_back_gives_every_byte_back(name, layout):
    text = odd(SHIPPED[name], layout)
    for variable in variables(loads_rulebase(text)):
        for each in variable.set_names:
            edited = rename_set(text, variable.name, each, "other")
            lines = sum(d[0] == "+" for d in difflib.ndiff(text.splitlines(), edited.splitlines()))
            assert lines <= 1 + len(loads_rulebase(text).rules) + 1
            assert rename_set(edited, variable.name, "other", each) == text


@pytest.mark.parametrize(("name", "layout"), IN_LAYOUTS)
def test_adding_and_removing_gives_every_byte_back(name, layout):
    text = odd(SHIPPED[name], layout)
    for variable in variables(loads_rulebase(text)):
        for each in variable.sets:
            new = FuzzySet("new", each.shape, each.parameters)
            edited = add_set(text, variable.name, new)
            assert len(comments(edited)) == len(comments(text))
            assert remove_set(edited, variable.name, "new", with_rules=True) == text


# ------------------------------------------------------------------ shapes


def test_numbers_that_stay_are_left_as_they_are_written():
    text = changed(LIST, "lo: {trimf: [0, 0, 1]}", "lo: {trimf: [0.00, 0e0,  1.50] }  # wide")
    expected = text.replace("0e0,", "0.25,")
    assert set_shape(text, "E", "lo", [0, 0.25, 1.5]) == expected
    assert set_shape(text, "E", "lo", (0, 0, 1.5)) == text


@pytest.mark.parametrize(
    ("parameters", "shape", "expected"),
    [
        ([0.5, 0.1], "gaussmf", "{gaussmf: [0.5, 0.1]}"),
        ([0, 0, 0.5, 1], "trapmf", "{trapmf: [0, 0, 0.5, 1]}"),
        ([0.5], "singleton", "{singleton: [0.5]}"),
    ],
)
def test_other_shapes(parameters, shape, expected):
    edited = set_shape(LIST, "v", "S", parameters, shape)
    head, _, tail = LIST.rpartition("{trimf: [0, 0, 2]}")
    assert edited == head + expected + tail
    assert set_shape(edited, "v", "S", [0, 0, 2], "trimf") == LIST


def test_shape_in_block_style():
    edited = set_shape(BLOCK, "E", "lo", [0, 0, 0.5, 1], "trapmf")
    assert edited == BLOCK.replace("trimf:\n        - 0  # left\n        - 0\n        - 1\n",
        "trapmf:\n        - 0  # left\n        - 0\n        - 0.5\n        - 1\n")  # fmt: skip
    back = set_shape(edited, "E", "lo", [0, 0, 1], "trimf")
    assert back == BLOCK


def test_shared_sets_are_changed_together_and_the_result_says_so():
    edited = set_shape(SEVEN, "dE", "ze", [-0.2, 0, 0.2])
    assert edited == SEVEN.replace("ze: {trimf: [-0.1, 0, 0.1]}", "ze: {trimf: [-0.2, 0, 0.2]}")
    assert edited.also == (("E", "ze"),)
    assert set_shape(SEVEN, "stiffness", "Z", [0.25, 0.25, 0.3]).also == ()


def test_shared_sets_are_written_out_on_request():
    for variable, other in (("E", "dE"), ("dE", "E")):
        edited = set_shape(SEVEN, variable, "ze", [-0.2, 0, 0.2], apart=True)
        assert edited.also == ()
        assert "&" not in edited.replace("Singh, Chen & Tenne", "")
        rules = loads_rulebase(edited)
        assert rules.input(variable).sets[3].parameters == (-0.2, 0, 0.2)
        assert rules.input(other) == loads_rulebase(SEVEN).input(other)
        assert comments(edited) == comments(SEVEN)


def test_written_out():
    assert write_out(SEVEN, "stiffness") == SEVEN
    start = SEVEN.index("      nl:")
    seven = SEVEN[start : SEVEN.index("  dE:")]
    expected = SEVEN.replace("sets: &seven   ", "sets:   ").replace("*seven\n", "\n" + seven)
    assert write_out(SEVEN, "E") == expected.replace("sets: \n", "sets:\n")
    crlf = SEVEN.replace("\n", "\r\n")
    assert write_out(crlf, "dE") == write_out(SEVEN, "dE").replace("\n", "\r\n")


@pytest.mark.usefixtures("parser")
def test_both_parsers_place_anchors_alike():
    assert set_shape(SEVEN, "dE", "ze", [-0.2, 0, 0.2]).also == (("E", "ze"),)
    assert "&seven" not in write_out(SEVEN, "E")
    text = TABLE.replace("ze: [S-S,", "ze: [&c S-S,").replace("po: [L-S,", "po: [*c,")
    assert "&c s-S" in rename_set(text, "power", "S", "s")


def test_anchors_of_keys_and_of_copied_cells():
    text = changed(SEVEN, "label: normalized error\n", "&k label: normalized error\n")
    text = changed(text, "label: normalized error rate", "*k : normalized error rate")
    assert "&seven" not in write_out(text, "E")
    text = SEVEN.replace("ze: [Z-Z, S-S, M-M", "ze: [Z-Z, &c S-S, M-M").replace(
        "ps: [M-Z, S-Z, M-M", "ps: [M-Z, S-Z, *c"
    )
    edited = add_set(text, "E", FuzzySet("zz", "trimf", (0, 0.01, 0.02)))
    assert "    zz: [Z-Z, S-S, M-M" in edited
    assert remove_set(edited, "E", "zz", with_rules=True) == text
    with pytest.raises(
        RuleBaseError, match=r"the anchor &c is in what is .* \*c in line 56 repeats"
    ):
        remove_set(text, "E", "nm", with_rules=True)


def test_of_three_that_share_two_go_on_sharing():
    sets = "{S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}"
    text = TABLE.replace(f"power: {{universe: [0, 2, 21], sets: {sets}}}",
        f"power: {{universe: [0, 2, 21], sets: &x {sets}}}")  # fmt: skip
    text = text.replace(f"grip:  {{universe: [0, 2, 21], sets: {sets}}}",
        "grip: &g {universe: [0, 2, 21], sets: *x}\n  more: *g")  # fmt: skip
    text = text.replace("cells: [power, grip]", "cells: [power, grip, more]")
    text = re.sub(r"\b([SL]-[SL])\b", r"\1-S", text)
    assert set_shape(text, "power", "S", [0, 0, 1]).also == (("grip", "S"), ("more", "S"))
    apart = write_out(text, "power")
    assert f"power: {{universe: [0, 2, 21], sets: {sets}}}" in apart
    assert f"grip: &g {{universe: [0, 2, 21], sets: {sets}}}" in apart
    assert rename_set(apart, "more", "S", "s").also == (("grip", "s"),)
    assert rename_set(text, "more", "S", "s", apart=True).also == ()
    assert loads_rulebase(rename_set(text, "grip", "S", "s")).output("power").set_names[0] == "s"


def test_sets_that_share_their_shape():
    text = changed(
        TABLE, "ze: {trimf: [-0.5, 0, 0.5]}", "ze: &z {trimf: [-0.5, 0, 0.5]}\n      zz: *z"
    )
    text = changed(text, "    po: [L", "    zz: [S-S, S-S]\n    po: [L")
    edited = set_shape(text, "dE", "zz", [-0.4, 0, 0.4])
    assert edited == text.replace("[-0.5, 0, 0.5]", "[-0.4, 0, 0.4]")
    assert edited.also == (("dE", "ze"),)
    apart = set_shape(text, "dE", "ze", [-0.4, 0, 0.4], apart=True)
    assert "ze: {trimf: [-0.4, 0, 0.4]}\n      zz: {trimf: [-0.5, 0, 0.5]}" in apart


def test_numbers_that_an_anchor_shares_are_refused():
    text = changed(LIST, "lo: {trimf: [0, 0, 1]}", "lo: {trimf: [0, &a 0.5, 1]}")
    with pytest.raises(RuleBaseError, match=r"rules.yaml:7:23: a number that an anchor shares"):
        set_shape(text, "E", "lo", [0, 0.6, 1], file="rules.yaml")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("F", "lo", [0, 0, 1]), "unknown variable 'F'; one of E, d, u, v"),
        (("E", "zz", [0, 0, 1]), "E has no set 'zz'; one of lo, hi"),
        (("E", "lo", [0, 1]), "trimf takes 3 parameters (a, b, c), not 2"),
        (("E", "lo", [1, 0, 1]), "trimf requires a <= b <= c, got [1.0, 0.0, 1.0]"),
        (("E", "lo", [0, 0, 1], "tri"), "unknown shape 'tri'; one of trimf"),
        (("E", "lo", [0, 0, float("nan")]), "parameters must be finite numbers"),
        (("d", "lo", [0, 0, 0.2, 0.1]), "trapmf requires"),
        (("d", "hi", [0, 0, 0.1, 0.1]), "x:13:7: sets of d must be listed by ascending peak"),
    ],
)
def test_refused_shapes(arguments, message):
    with pytest.raises(RuleBaseError, match=re.escape(message)):
        set_shape(LIST, *arguments, file="x")


def test_a_shape_that_leaves_a_gap_is_refused():
    text = LIST.replace("    default: 1.5\n", "")
    with pytest.raises(RuleBaseError, match="no rule about"):
        set_shape(text.replace("  - {if: {E: hi, d", "  - {if: {E: lo, d"), "E", "lo", [0, 0, 0.1])


# ------------------------------------------------------------------ adding and removing


def test_a_column_and_a_row_come_with_the_set_of_a_table():
    edited = add_set(TABLE, "E", FuzzySet("mid", "trimf", (0, 0.5, 1)))
    assert "      lo: {trimf: [0, 0, 1]}\n      mid: {trimf: [0, 0.5, 1]}\n      hi:" in edited
    assert "    ne: [S-S, S-S, S-L]\n" in edited
    assert "    #    lo   mid   hi\n" in edited
    edited = add_set(TABLE, "dE", FuzzySet("tiny", "trimf", (0, 0.1, 1)), like="po")
    assert "    ze: [S-S, L-L@0.5]\n    tiny: [L-S, [S-L@0.5, L-L@0.5]]\n    po: [L" in edited


def test_shared_sets_get_a_column_and_a_row():
    edited = add_set(SEVEN, "E", FuzzySet("px", "trimf", (0.1, 0.2, 0.3)))
    assert edited.also == (("dE", "px"),)
    assert "    #    nl   nm   ns   ze   ps   px   pm   pl\n" in edited
    assert "    ps: [M-Z, S-Z, M-M, L-L, M-L, M-L, S-M, Z-S]\n" in edited
    assert "    px: [M-Z, S-Z, M-M, L-L, M-L, M-L, S-M, Z-S]\n" in edited
    assert remove_set(edited, "dE", "px", with_rules=True) == SEVEN
    apart = add_set(SEVEN, "E", FuzzySet("px", "trimf", (0.1, 0.2, 0.3)), apart=True)
    assert loads_rulebase(apart).input("dE") == loads_rulebase(SEVEN).input("dE")


def test_sets_of_lists_and_outputs():
    edited = add_set(LIST, "u", FuzzySet("M", "trimf", (0, 1, 2)))
    assert (
        edited.count("{S: {trimf: [0, 0, 2]}, M: {trimf: [0, 1, 2]}, L: {trimf: [0, 2, 2]}}") == 1
    )
    assert remove_set(edited, "u", "M") == LIST
    first = add_set(LIST, "d", FuzzySet("none", "trimf", (0, 0, 1)))
    assert first == LIST.replace(
        "      lo: {trap", "      none: {trimf: [0, 0, 1]}\n      lo: {trap"
    )
    assert remove_set(first, "d", "none") == LIST


def test_a_set_in_use_is_not_removed():
    with pytest.raises(
        RuleBaseError, match=r"t:7:7: the set 'lo' of E is used by the rules for E=lo: change"
    ):
        remove_set(LIST, "E", "lo", file="t")
    with pytest.raises(RuleBaseError, match=r"'L' of grip is used by the rules for E=hi, dE=ne; E"):
        remove_set(TABLE, "grip", "L", with_rules=True)
    with pytest.raises(RuleBaseError, match=r"E=nl, dE=nl; .*; and 7 more: change these first"):
        remove_set(SEVEN, "E", "nl")
    with pytest.raises(RuleBaseError, match="E has a set 'lo' already"):
        add_set(LIST, "E", FuzzySet("lo", "trimf", (0, 0, 1)))


# ------------------------------------------------------------------ names


def test_rules_follow_a_new_name():
    assert rename_set(LIST, "d", "hi", "big") == LIST.replace(
        "hi: {trapmf", "big: {trapmf"
    ).replace("d: hi}, then", "d: big}, then")
    edited = rename_set(TABLE, "grip", "L", "tight")
    assert edited == TABLE[: TABLE.index("grip:")] + TABLE[TABLE.index("grip:") :].replace(
        "L: {trimf", "tight: {trimf"
    ).replace("S-L", "S-tight").replace("L-L", "L-tight")
    rows = rename_set(TABLE, "dE", "ze", "none")
    assert rows == TABLE.replace("ze: ", "none: ")
    columns = rename_set(TABLE, "E", "lo", "low")
    assert columns == TABLE.replace("lo: {", "low: {").replace("#    lo ", "#    low ")


def test_names_in_quotes_and_odd_names():
    text = LIST.replace("{u: S}", "{u: 'S'}").replace("{if: {E: lo}", '{if: {E: "lo"}')
    edited = rename_set(rename_set(text, "u", "S", "small"), "E", "lo", "1")
    assert "{u: 'small'}" in edited
    assert '{if: {E: "1"}' in edited
    assert '      "1": {trimf' in edited
    quoted = rename_set(text, "u", "S", 'a"#')
    assert loads_rulebase(quoted).output("u").set_names == ('a"#', "L")


@pytest.mark.parametrize(
    ("new", "message"),
    [
        ("hi", "E has a set 'hi' already"),
        ("a b", "set name 'a b' must have"),
        ("a@b", "set name 'a@b' must have"),
        ("", "set name '' must have"),
    ],
)
def test_refused_names(new, message):
    with pytest.raises(RuleBaseError, match=re.escape(message)):
        rename_set(LIST, "E", "lo", new)


def test_a_name_that_makes_a_cell_ambiguous_is_refused():
    text = rename_set(rename_set(TABLE, "power", "S", "a-b"), "grip", "L", "b-c")
    text = rename_set(text, "power", "L", "a")
    with pytest.raises(RuleBaseError, match=r"'a-b-c' can be read as .* a mapping of outputs"):
        rename_set(text, "grip", "S", "c")


def test_a_shared_word_of_two_inputs_is_left_alone():
    text = changed(LIST, "{if any: {E: hi, d: hi}", "{if any: {E: &w hi, d: *w}")
    with pytest.raises(RuleBaseError):
        rename_set(text, "E", "hi", "high")


def test_models_of_edits_are_those_made_by_hand():
    rules = loads_rulebase(SEVEN)
    output = rules.output("damping")
    sets = tuple(replace(s, name="zero") if s.name == "Z" else s for s in output.sets)
    assert loads_rulebase(rename_set(SEVEN, "damping", "Z", "zero")).output("damping").sets == sets
