"""Rules and operators changed in place."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from texts import LIST, TABLE

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.loading import loads_rulebase, rulebase_path
from fuzzytrack.fuzzy.rule_edits import (
    add_rule,
    remove_rule,
    set_cell,
    set_consequents,
    set_operator,
)
from fuzzytrack.fuzzy.rulebase import Consequent

# ------------------------------------------------------------------ one cell


@pytest.mark.untraced
@given(st.data())
@settings(max_examples=60)
def test_exactly_one_cell_changes(data):
    text = rulebase_path("stiffness-damping").read_text()
    rules = loads_rulebase(text)
    number = data.draw(st.integers(0, 48))
    pair = data.draw(st.tuples(st.sampled_from("ZSML"), st.sampled_from("ZSML")))
    where = dict(rules.rules[number].conditions)
    changed = set_cell(text, where, "-".join(pair))
    # the same table, edited by hand
    lines = text.split("\n")
    row = lines.index("    #    nl   nm   ns   ze   ps   pm   pl") + 1 + number // 7
    start = 9 + 5 * (number % 7)
    lines[row] = lines[row][:start] + "-".join(pair) + lines[row][start + 3 :]
    assert changed == "\n".join(lines)
    consequents = loads_rulebase(changed).rules[number].consequents
    assert tuple(c.set_name for c in consequents) == pair


def test_forms_of_new_cells():
    where = {"dE": "po", "E": "hi"}
    for cell in ("L-L", "S-S@0.25", "[S-L@0.5, L-S@0.5]", "{power: S, grip: [S@0.5, L@0.5]}"):
        assert set_cell(TABLE, where, cell) == TABLE.replace("[S-L@0.5, L-L@0.5]", cell)


def test_comments_line_ends_and_byte_order_mark_stay():
    text = "\ufeff" + TABLE.replace("\n", "  # é\r\n").replace(">-", "")
    assert set_cell(text, {"E": "lo", "dE": "ze"}, "L-L") == text.replace(
        "[S-S, L-L@", "[L-L, L-L@"
    )


@pytest.mark.parametrize(
    ("where", "cell", "old", "new"),
    [
        ({"E": "lo"}, "L", "{u: S}", "{u: L}"),
        ({"E": "lo"}, "L@0.5", "{u: S}", "{u: L@0.5}"),
        ({"E": "lo"}, "[S@0.5, L@0.5]", "{u: S}", "{u: [S@0.5, L@0.5]}"),
        ({"E": "lo"}, "{v: S, u: S}", "{u: S}", "{v: S, u: S}"),
        ({"E": "hi", "d": "lo"}, "S-L", "{u: [S@0.25, L@0.75], v: L@0.5}", "{u: S, v: L}"),
    ],
)
def test_rule_of_a_list(where, cell, old, new):
    assert set_cell(LIST, where, cell) == LIST.replace(old, new)


def test_rule_in_block_style():
    block = LIST.replace(
        "  - {if: {E: lo}, then: {u: S}}",
        "  - if:\n      E: lo\n    then:\n      u: S\n      # a comment",
    )
    assert set_cell(block, {"E": "lo"}, "L") == block.replace("      u: S\n", "      {u: L}\n")


def test_cells_that_share_their_text_are_left_alone():
    with pytest.raises(RuleBaseError, match="other rules share"):
        set_cell(LIST, {"E": "hi"}, "S")
    anchored = TABLE.replace("ne: [S-S, S-L]", "ne: &row [S-S, S-L]")
    anchored = anchored.replace("ze: [S-S, L-L@0.5]", "ze: *row")
    for row in ("ne", "ze"):
        with pytest.raises(RuleBaseError, match="other rules share"):
            set_cell(anchored, {"E": "lo", "dE": row}, "L-L")
    one = TABLE.replace("[S-S, S-L]", "[&cell S-S, *cell]")
    assert set_cell(one, {"E": "hi", "dE": "ne"}, "S-L") == TABLE.replace(
        "[S-S, S-L]", "[&cell S-S, S-L]"
    )
    with pytest.raises(RuleBaseError, match="other rules share"):
        set_cell(one, {"E": "lo", "dE": "ne"}, "S-L")


@pytest.mark.parametrize(
    ("where", "cell", "message"),
    [
        ({"E": "lo", "dE": "zz"}, "S-S", "dE has no set 'zz'; one of ne, ze, po"),
        ({"E": "lo", "F": "ze"}, "S-S", "unknown input 'F'"),
        ({"E": "lo"}, "S-S", "no rule has exactly the conditions E=lo"),
        ({}, "S-S", "no rule"),
        ({"E": "lo", "dE": "ze"}, "S-M", "<cell>:1:3: unknown set of grip 'M'"),
        ({"E": "lo", "dE": "ze"}, "S-S, S-S", "<cell>:1:1: "),
        ({"E": "lo", "dE": "ze"}, "S-S]\n    zz: [S-S", "<cell>:2:7: not YAML"),
        ({"E": "lo", "dE": "ze"}, "", "<cell>:1:1: the text is empty"),
        ({"E": "lo", "dE": "ze"}, "S-S #", "not YAML"),
    ],
)
def test_refused_cells(where, cell, message):
    with pytest.raises(RuleBaseError, match=re.escape(message)):
        set_cell(TABLE, where, cell)


def test_set_cell_names_the_file():
    with pytest.raises(RuleBaseError, match=r"a\.yaml:5:5"):
        set_cell(TABLE.replace("label", "lable"), {"E": "lo", "dE": "ze"}, "S-S", file="a.yaml")


# ------------------------------------------------------------------ consequents, lists, operators


def test_consequents_in_the_shortest_form():
    where = {"E": "lo", "dE": "ze"}
    half = [Consequent("power", "S", 0.5), Consequent("grip", "L", 0.5)]
    assert set_consequents(TABLE, where, half) == TABLE.replace("[S-S, L-L@", "[S-L@0.5, L-L@")
    several = [Consequent("u", "S", 0.25), Consequent("u", "L", 0.75)]
    expected = LIST.replace("{u: S}", "{u: [S@0.25, L@0.75]}")
    assert set_consequents(LIST, {"E": "lo"}, several) == expected
    with pytest.raises(RuleBaseError, match="u has no set 'M'"):
        set_consequents(LIST, {"E": "lo"}, [Consequent("u", "M")])
    with pytest.raises(RuleBaseError, match="needs at least one consequent"):
        set_consequents(LIST, {"E": "lo"}, [])


@pytest.mark.parametrize("end", ["\n", "\r\n", ""])
def test_rules_of_a_list_come_and_go(end):
    text = LIST.replace("\n", end or "\n").removesuffix(end or "\n") + "  # last" + end
    where, says = {"E": "lo", "d": "hi"}, [Consequent("v", "S", 0.5)]
    longer = add_rule(text, where, says)
    assert "# last" + (end or "\n") + "  - {if: {E: lo, d: hi}, then: {v: S@0.5}}" in longer
    assert longer.endswith("}}" + end)
    assert remove_rule(longer, where) == text
    line = "  - {if: {E: lo}, then: {u: S}}" + (end or "\n")
    assert remove_rule(add_rule(text, where, [Consequent("u", "S")]), {"E": "lo"}).count(line) == 0
    with pytest.raises(RuleBaseError, match="a rule for E=lo, d=hi is there already"):
        add_rule(longer, where, says)
    with pytest.raises(RuleBaseError, match="other rules share"):
        remove_rule(text, {"E": "hi"})
    with pytest.raises(RuleBaseError, match="no rule has exactly the conditions E=hi, d=hi"):
        remove_rule(text, {"E": "hi", "d": "hi"})


def test_rules_of_a_list_in_brackets():
    rules = [line.removeprefix("  - ") for line in LIST.splitlines() if line.startswith("  - ")]
    text = LIST[: LIST.index("  - ")].replace("rules:\n", f"rules: [{', '.join(rules)}]\n")
    longer = add_rule(text, {"E": "lo", "d": "hi"}, [Consequent("u", "S")])
    assert longer == text.removesuffix("]\n") + ", {if: {E: lo, d: hi}, then: {u: S}}]\n"
    assert remove_rule(longer, {"E": "lo", "d": "hi"}) == text


def test_a_table_takes_no_rules():
    with pytest.raises(RuleBaseError, match="no rule can be added"):
        add_rule(TABLE, {"E": "lo"}, [Consequent("power", "S")])
    with pytest.raises(RuleBaseError, match="no rule can be removed"):
        remove_rule(TABLE, {"E": "lo", "dE": "ze"})


def test_operators():
    assert set_operator(TABLE, "and", "min") == TABLE.replace("and: product", "and: min")
    expected = TABLE.replace("centroid", "weighted-centers")
    assert set_operator(TABLE, "defuzzification", "weighted-centers") == expected
    with pytest.raises(RuleBaseError, match=r"unknown operator 'implication'; .* allowed: and, or"):
        set_operator(TABLE, "implication", "min")
    with pytest.raises(RuleBaseError, match="unknown or 'mx'; did you mean 'max'"):
        set_operator(TABLE, "or", "mx")


def test_rules_of_if_any_are_set_together_on_request():
    text = rulebase_path("tipper").read_text(encoding="utf-8")
    where = {"food": "rancid"}
    with pytest.raises(RuleBaseError, match="other rules share the conclusions"):
        set_cell(text, where, "average")
    for changed in (
        set_cell(text, where, "average@0.5", together=True),
        set_consequents(text, where, [Consequent("tip", "average", 0.5)], together=True),
    ):
        assert changed == text.replace("then: {tip: cheap}", "then: {tip: average@0.5}")
        assert [str(rule).rpartition("then ")[2] for rule in changed.rules.rules] == [
            "tip is average @ 0.5",
            "tip is average @ 0.5",
            "tip is average",
            "tip is generous",
            "tip is generous",
        ]
