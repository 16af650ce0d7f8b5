"""Rule bases from YAML: what is read, and how everything else is refused."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from texts import LIST, TABLE, changed, refusal

from fuzzytrack.errors import Location, Word
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Consequent, Rule, TableLayout
from fuzzytrack.fuzzy.variable import Universe, Variable

# ------------------------------------------------------------------ what is read


@pytest.mark.usefixtures("parser")
def test_table():
    rules = loads_rulebase(TABLE)
    assert rules.name == "small"
    assert rules.layout == TableLayout("E", "dE", ("power", "grip"))
    assert rules.scheduler == (("gains", "direct"),)
    assert rules.input("E").label == "error"
    assert rules.input("E").unit == "m"
    assert rules.input("dE").universe == Universe(-1, 1, 20, "midpoints")
    assert rules.input("dE").sets[0] == FuzzySet("ne", "trapmf", (-1, -1, -0.5, 0))
    assert len(rules.rules) == 6
    # row by row, the columns in the order of the sets
    assert rules.rules[1] == Rule(
        (("E", "hi"), ("dE", "ne")), (Consequent("power", "S"), Consequent("grip", "L"))
    )
    assert rules.rules[3].consequents == (
        Consequent("power", "L", 0.5),
        Consequent("grip", "L", 0.5),
    )
    # equal consequents within a cell add up
    assert rules.rules[5].consequents == (
        Consequent("power", "S", 0.5),
        Consequent("power", "L", 0.5),
        Consequent("grip", "L", 1.0),
    )


@pytest.mark.usefixtures("parser")
def test_list():
    rules = loads_rulebase(LIST)
    assert rules.layout is None
    assert rules.output("v").default == 1.5
    assert rules.rules[1] == Rule(
        (("E", "hi"), ("d", "lo")),
        (Consequent("u", "S", 0.25), Consequent("u", "L", 0.75), Consequent("v", "L", 0.5)),
    )
    # "if any" is one rule for each alternative
    assert rules.rules[2:] == (
        Rule((("E", "hi"),), (Consequent("u", "L"),)),
        Rule((("d", "hi"),), (Consequent("u", "L"),)),
    )


def test_cells_of_one_output_and_cells_as_mappings():
    text = TABLE[: TABLE.index("  grip:")] + TABLE[TABLE.index("operators:") :]
    text = text.replace("[power, grip]", "power")
    table = "    ne: [S, [S@0.5, L@0.5]]\n    ze: [{power: L@0.1}, S]\n    po: [L, L]\n"
    rules = loads_rulebase(text[: text.index("    #")] + table)
    assert rules.rules[1].consequents == (
        Consequent("power", "S", 0.5),
        Consequent("power", "L", 0.5),
    )
    assert rules.rules[2].consequents == (Consequent("power", "L", 0.1),)


def test_rows_may_stand_in_any_order_and_layout_does_not_matter():
    lines = TABLE.split("\n")
    start = lines.index("    #    lo   hi") + 1
    shuffled = [
        *lines[:start],
        lines[start + 2],
        lines[start],
        lines[start + 1],
        *lines[start + 3 :],
    ]
    assert loads_rulebase("\n".join(shuffled)) == loads_rulebase(TABLE)
    assert loads_rulebase(TABLE.replace("\n", "\r\n")) == loads_rulebase(TABLE)
    assert loads_rulebase(("\ufeff" + TABLE).encode()) == loads_rulebase(TABLE)


def test_order_of_conditions_does_not_matter():
    swapped = changed(LIST, "if: {E: hi, d: lo}", "if: {d: lo, E: hi}")
    assert loads_rulebase(swapped) == loads_rulebase(LIST)


@pytest.mark.parametrize("word", ["no", "on", "null", "~", "1", "1e-3", "0x1F", "2001-01-01", "é"])
def test_words_stay_words(word):
    rules = loads_rulebase(LIST.replace("hi", word))
    assert rules.input("E").set_names == ("lo", word)


@pytest.mark.parametrize(
    ("word", "value"), [("1e-1", 0.1), (".5", 0.5), ("+0.25", 0.25), ("0.5e0", 0.5), ("'0.5'", 0.5)]
)
def test_numbers(word, value):
    text = changed(LIST, "[0, 0, 0.2, 0.3]", f"[0, 0, {word}, 0.9]")
    assert loads_rulebase(text).input("d").sets[0].parameters[2] == value


def test_aliases():
    text = changed(LIST, "    sets: {S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}\n  v", "!")
    text = text.replace("!", "    sets: &x {S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}\n  v")
    text = changed(text, "    sets: {S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}", "    sets: *x")
    assert loads_rulebase(text) == loads_rulebase(LIST)


def test_scheduler_settings_are_words_that_know_their_place():
    ((_, word),) = loads_rulebase(TABLE, "a.yaml").scheduler
    assert word == "direct"
    assert word.location == Location("a.yaml", 30, 20)
    copy = pickle.loads(pickle.dumps(word))
    assert isinstance(copy, Word)
    assert (copy, copy.location) == (word, word.location)
    assert hash(word) == hash("direct")


def test_confidences_that_add_to_one_but_for_rounding():
    text = changed(LIST, "[S@0.25, L@0.75]", "[S@0.7, S@0.2, S@0.1]")
    assert loads_rulebase(text).rules[1].consequents[0] == Consequent("u", "S", 1.0)


def with_names(first, second):
    """Two outputs whose sets have the given names, and one cell for each pair of them."""
    sets = [
        "{" + ", ".join(f"'{n}': {{trimf: [0, 1, 2]}}" for n in names) + "}"
        for names in (first, second)
    ]
    text = changed(LIST, "    default: 1.5\n", "")
    text = text.replace("{S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}", sets[0], 1)
    text = text.replace("{S: {trimf: [0, 0, 2]}, L: {trimf: [0, 2, 2]}}", sets[1], 1)
    return text[: text.index("rules:")]


def test_hyphens_in_set_names():
    text = with_names(("very-low", "low"), ("a", "b-c"))
    rules = "rules: [{if: {E: lo}, then: very-low-b-c}, {if: {E: hi}, then: low-a@0.5}]"
    first, second = loads_rulebase(text + rules).rules
    assert [c.set_name for c in first.consequents] == ["very-low", "b-c"]
    assert [c.set_name for c in second.consequents] == ["low", "a"]


def test_ambiguous_hyphens():
    text = with_names(("a", "a-b"), ("c", "b-c"))
    rules = "rules:\n- {if: {E: lo}, then: a-b-c}\n- {if: {E: hi}, then: a-c}"
    error = refusal(text + rules)
    assert "'a' and 'b-c' or 'a-b' and 'c'" in error.message
    assert error.location.column == 23
    spelt = rules.replace("a-b-c", "{u: a, v: b-c}")
    assert loads_rulebase(text + spelt).rules[0].consequents[1].set_name == "b-c"


# ------------------------------------------------------------------ what is refused


def place(text, word):
    """Line and column of a word that is there once."""
    assert text.count(word) == 1, word
    before = text[: text.index(word)]
    return before.count("\n") + 1, len(before) - before.rfind("\n")


# old text, new text, where the complaint points (a word of the new text), what it must say
TABLE_MISTAKES = {
    "version": ("rulebase: 1", "rulebase: 9", "9", ["'9'", "allowed: 1"]),
    "no version": ("rulebase: 1", "nam: x", "nam: x", ["lacks its format version"]),
    "unknown key": ("label:", "lable:", "lable", ["'lable'", "mean 'label'", "universe", "sets"]),
    "unknown top key": ("scheduler:", "sheduler:", "sheduler", ["mean 'scheduler'"]),
    "list for a setting": (
        "{gains: direct}",
        "{gains: [direct]}",
        "[direct]",
        ["'gains' must be a word", "a list"],
    ),
    "default of an input": ("unit: m", "default: 1", "default", ["'default'", "allowed"]),
    "missing key": ("    universe: [0, 1, 11]\n", "", "label", ["lacks the key 'universe'"]),
    "missing operator": ("or: sum, ", "", "{and", ["lacks the key 'or'"]),
    "operator": ("and: product", "and: prod", "prod,", ["'prod'", "'product'", "min"]),
    "defuzzification": ("centroid", "cog", "cog", ["'cog'", "centroid", "weighted-centers"]),
    "grid": ("midpoints", "middle", "middle", ["'middle'", "ends", "midpoints"]),
    "arity of a universe": ("[0, 1, 11]", "[0, 1]", "[0, 1]", ["[low, high, points]", "2"]),
    "reversed universe": ("[0, 1, 11]", "[1, 0, 11]", "[1, 0, 11]", ["low < high"]),
    "points": ("[0, 1, 11]", "[0, 1, 1.5]", "1.5", ["whole number", "1.5"]),
    "too many points": ("[0, 1, 11]", "[0, 1, 200000]", "[0, 1, 2", ["100001"]),
    "shape": ("trimf: [-0.5", "trinf: [-0.5", "trinf", ["'trinf'", "mean 'trimf'", "gbellmf"]),
    "two shapes": (
        "{trimf: [-0.5, 0, 0.5]}",
        "{trimf: [-0.5, 0, 0.5], smf: [0, 1]}",
        "{trimf: [-0.5, 0, 0.5], ",
        ["one shape, not 2"],
    ),
    "arity of a shape": ("[-0.5, 0, 0.5]", "[-0.5, 0]", "[-0.5, 0]", ["3 parameters (a, b, c)"]),
    "parameters": ("[-0.5, 0, 0.5]", "[0.5, 0, -0.5]", "[0.5, 0, -0.5]", ["a <= b <= c"]),
    "nan": ("[-0.5, 0, 0.5]", "[-0.5, .nan, 0.5]", ".nan", ["finite number", "'.nan'"]),
    "inf": ("[-0.5, 0, 0.5]", "[-0.5, 1e999, 0.5]", "1e999", ["finite number", "'1e999'"]),
    "underscore": ("[-0.5, 0, 0.5]", "[-0.5, 0_0, 0.5]", "0_0", ["finite number"]),
    "foreign digits": ("[-0.5, 0, 0.5]", "[-0.5, ٠, 0.5]", "٠", ["finite number"]),
    "a word for a number": ("[-0.5, 0, 0.5]", "[-0.5, no, 0.5]", "no,", ["finite number", "'no'"]),
    "doubled set": ("ze: {", "ne: {", "ne: {trimf", ["key 'ne' is given twice"]),
    "order": (
        "ze: {trimf: [-0.5, 0, 0.5]}\n",
        "ze: {trimf: [-0.9, -0.8, 0.5]}\n",
        "ze: {",
        ["ascending", "'ze' at -0.8", "'ne' at -0.75"],
    ),
    "outside": ("[0, 0.5, 1, 1]", "[1.1, 1.5, 2, 2]", "{trapmf: [1.1", ["outside", "[-1, 1]"]),
    "bare stretch": ("[0, 0.5, 1, 1]", "[0.6, 0.7, 1, 1]", "dE:\n    u", ["between 0.5 and 0.6"]),
    "bare point": ("[0, 0.5, 1, 1]", "[0.5, 0.7, 1, 1]", "dE:\n    u", ["dE at 0.5"]),
    "set name": ("ze: {", '"z e": {', '"z e"', ["'z e'", "blank"]),
    "set name with @": ("ze: {", "z@e: {", "z@e", ["'z@e'", "'@'"]),
    "variable name": ("  E:\n", "  E-1:\n", "E-1", ["'E-1'", "Python name"]),
    "keyword": ("  E:\n", "  class:\n", "class", ["'class'", "keyword"]),
    "input again": ("  power: {", "  E: {", "E: {universe", ["'E' is an input already"]),
    "columns": ("columns: E", "columns: e", "e\n  rows", ["'e'", "mean 'E'", "dE"]),
    "columns are rows": ("rows: dE", "rows: E", "columns", ["two inputs"]),
    "cells": ("[power, grip]", "[power, gript]", "gript", ["'gript'", "mean 'grip'"]),
    "cells not all": ("[power, grip]", "[power]", "[power]", ["every output once"]),
    "doubled cells": ("[power, grip]", "[power, power]", "[power, power]", ["every output once"]),
    "unknown row": ("    ze: [S", "    zee: [S", "zee", ["'zee'", "mean 'ze'", "ne, ze, po"]),
    "missing row": ("    ze: [S-S, L-L@0.5]\n", "", "ne: [S-S, ", ["lacks the row 'ze'"]),
    "doubled row": ("    ze: [S", "    ne: [S", "ne: [S-S, L-L", ["key 'ne' is given twice"]),
    "missing cell": ("[S-S, S-L]", "[S-S]", "[S-S]", ["1 cells, not 2", "lo, hi"]),
    "empty cell": ("[S-S, S-L]", "[S-S, '']", "''", ["nothing"]),
    "extra cell": ("[S-S, S-L]", "[S-S, S-L, S-S]", "[S-S, S-L, S-S]", ["3 cells, not 2"]),
    "word in a cell": ("[S-S, S-L]", "[S-S, S-M]", "M]", ["set of grip 'M'", "S, L"]),
    "cell form": ("[S-S, S-L]", "[S-S, S]", "S]\n    ze", ["'S'", "power-grip"]),
    "confidence": ("L-L@0.5]\n", "L-L@1.5]\n", "1.5", ["[0, 1]", "'1.5'"]),
    "confidence word": ("L-L@0.5]\n", "L-L@half]\n", "half", ["'half'", "finite number"]),
    "sum of confidences": (
        "[S-L@0.5, L-L@0.5]",
        "[S-L@0.5, L-L@0.6]",
        "[S-L@0.5, L-L@0.6]",
        ["[0, 1]", "1.1"],
    ),
    "output never concluded": (
        "operators:",
        "  rest: {universe: [0, 1, 3], sets: {a: {trimf: [0, 0, 1]}}}\noperators:",
        "[power, grip]",
        ["every output once", "rest"],
    ),
    "set between grid points": (
        "power: {universe: [0, 2, 21], sets: {S: {trimf: [0, 0, 2]}",
        "power: {universe: [0, 2, 21], sets: {S: {trimf: [0.01, 0.02, 0.03]}",
        "{trimf: [0.01",
        ["'S' is zero at all 21 points of power"],
    ),
    "list for a mapping": ("{gains: direct}", "[gains]", "[gains]", ["mapping", "a list"]),
    "nothing": ("{gains: direct}", "", "", ["mapping", "nothing"]),
}

LIST_MISTAKES = {
    "no rules": (LIST[LIST.index("  - {if: {E: lo}") :], "  []\n", "[]", ["list"]),
    "rule without then": (", then: {u: S}}", "}", "{if: {E: lo}}", ["'then'"]),
    "unknown key": ("then: {u: S}", "than: {u: S}", "than", ["'than'", "mean 'then'"]),
    "both": ("{if: {E: lo}, ", "{if: {E: lo}, if any: {d: lo}, ", "if: {E: lo}", ["not both"]),
    "unknown input": ("if: {E: lo}", "if: {F: lo}", "F: lo", ["'F'", "allowed: E, d"]),
    "unknown set": ("if: {E: lo}", "if: {E: mid}", "mid", ["'mid'", "lo, hi"]),
    "unknown output": ("then: {u: S}", "then: {w: S}", "w: S", ["'w'", "allowed: u, v"]),
    "unknown output set": ("then: {u: S}", "then: {u: M}", "M}", ["set of u 'M'", "S, L"]),
    "input twice": ("if: {E: lo}", "if: {E: lo, E: hi}", "E: hi}", ["key 'E' is given twice"]),
    "doubled rule": (
        "{E: hi, d: lo}",
        "{E: lo}",
        "{if: {E: lo}, then: {u: [",
        ["two rules with the same"],
    ),
    "doubled by any": (
        "{E: hi, d: hi}",
        "{d: hi, E: lo}",
        "{if any",
        ["two rules with the same"],
    ),
    "no rule left": (
        LIST[LIST.index("  - {if: {E: hi, d") :],
        "  - {if: {d: hi}, then: {v: S}}\n",
        "E:\n    u",
        ["u can fire for E at 1"],
    ),
    "certainty zero": (
        LIST[LIST.index("  - {if: {E: hi, d") :],
        "  - {if: {E: hi}, then: {u: L@0, v: S}}\n",
        "E:\n    u",
        ["u can fire for E at 1"],
    ),
    "silent output": (
        LIST[LIST.index("  - {if: {E: hi, d") :],
        "  - {if: {E: hi}, then: {u: L}}\n",
        "- {if: {E: lo}",
        ["no rule concludes about output 'v'"],
    ),
}
# Without the rule about E alone, the gap of d matters.
GAP = LIST.replace("  - {if: {E: lo}, then: {u: S}}\n", "").replace(
    "{E: hi, d: hi}, then", "{d: hi}, then"
)


@pytest.mark.parametrize("name", TABLE_MISTAKES)
@pytest.mark.usefixtures("parser")
def test_mistakes_in_a_table(name):
    old, new, where, words = TABLE_MISTAKES[name]
    check(TABLE, old, new, where, words)


@pytest.mark.parametrize("name", LIST_MISTAKES)
@pytest.mark.usefixtures("parser")
def test_mistakes_in_a_list(name):
    old, new, where, words = LIST_MISTAKES[name]
    check(LIST, old, new, where, words)


def check(text, old, new, where, words):
    start = text.index(old)
    mistaken = text[:start] + new + text[start + len(old) :]
    error = refusal(mistaken)
    for word in words:
        assert word in error.message
    # the complaint points at the first such word at or after the change, or before it
    lines = mistaken.split("\n")
    pointed = "\n".join(
        [lines[error.location.line - 1][error.location.column - 1 :], *lines[error.location.line :]]
    )
    assert pointed.startswith(where), pointed[:40]
    assert error.location.file == "rules.yaml"


def test_a_gap_matters_only_where_every_rule_looks():
    assert "d between 0.3 and 0.7" in refusal(GAP).message
    with_default = GAP.replace("  u:\n", "  u:\n    default: 1\n")
    assert loads_rulebase(with_default)


@pytest.mark.parametrize("value", ["2.001", "-0.5", "1e300"])
def test_a_default_outside_of_its_universe_is_refused(value):
    error = refusal(changed(LIST, "default: 1.5", f"default: {value}"))
    assert error.message == (
        f"default of v must be within its universe, [0, 2], got {float(value):g}"
    )
    lines = LIST.split("\n")
    line = next(k for k, text in enumerate(lines) if "default: 1.5" in text)
    assert (error.location.line, error.location.column) == (line + 1, lines[line].index("1.5") + 1)
    assert loads_rulebase(changed(LIST, "default: 1.5", "default: 2")).output("v").default == 2


def test_sigmoids_and_extended_end_sets_are_fine():
    text = changed(LIST, "hi: {trimf: [0, 1, 1]}", "hi: {sigmf: [0.5, 10]}")
    text = changed(text, "{trapmf: [0.7, 0.8, 1, 1]}", "{trimf: [0.7, 1, 1.3]}")
    assert loads_rulebase(text).input("E").sets[1].shape == "sigmf"


# ------------------------------------------------------------------ coverage

GRID = st.integers(-4, 14).map(lambda k: k / 10)
SHAPES = st.one_of(
    st.lists(GRID, min_size=3, max_size=3).map(lambda p: ("trimf", sorted(p))),
    st.lists(GRID, min_size=4, max_size=4).map(lambda p: ("trapmf", sorted(p))),
    st.lists(GRID, min_size=4, max_size=4).map(lambda p: ("pimf", sorted(p))),
    st.lists(GRID, min_size=2, max_size=2).map(lambda p: ("smf", sorted(p))),
    st.lists(GRID, min_size=2, max_size=2).map(lambda p: ("zmf", sorted(p))),
    st.tuples(GRID, st.just(0.002)).map(lambda p: ("gaussmf", p)),
    st.tuples(GRID, st.sampled_from([-4000.0, 4000.0])).map(lambda p: ("sigmf", p)),
    GRID.map(lambda p: ("singleton", [p])),
)


@settings(max_examples=300)  # the first one imports scikit-fuzzy
@given(st.lists(SHAPES, min_size=1, max_size=4))
def test_uncovered_stretches_are_where_all_grades_are_zero(shapes):
    sets = tuple(FuzzySet(str(k), name, tuple(p)) for k, (name, p) in enumerate(shapes))
    variable = Variable("x", Universe(0.0, 1.0, 11), sets)
    stretches = list(variable.uncovered())
    # between the tenths, and a little beside them, nothing changes but far out on a smooth curve
    x = np.unique(np.concatenate([np.arange(11) / 10, np.arange(10) / 10 + 0.05]))
    bare = variable.memberships(x).max(axis=0) <= 0
    inside = np.zeros(x.shape, bool)
    edge = np.zeros(x.shape, bool)
    for low, high in stretches:
        inside |= (x > low) & (x < high)
        edge |= (x == low) | (x == high)
    # the ends of a stretch themselves may belong to a set
    assert (bare == inside)[~edge].all()
    lone = [low for low, high in stretches if low == high]
    assert bare[np.isin(x, lone)].all()
    assert [s for s in stretches if s[0] > s[1]] == []
    assert (bare & ~inside & ~edge).sum() == 0
