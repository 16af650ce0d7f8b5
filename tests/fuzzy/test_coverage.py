"""Inputs at which no rule fires: found exactly, and named."""

import itertools

import numpy as np
import pytest
from builders import is_set, rule
from hypothesis import given, settings
from hypothesis import strategies as st

import fuzzytrack as ft
from fuzzytrack.fuzzy import coverage
from fuzzytrack.fuzzy.coverage import find_hole
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Operators, RuleBase
from fuzzytrack.fuzzy.variable import Universe, Variable

OUT = Variable("out", Universe(0, 1, 11), (FuzzySet("s", "trimf", (0, 0.5, 1)),))


def base(inputs, conditions, operators=None):
    """Rules with some conditions, all about the one output."""
    rules = tuple(rule(c, is_set("out", "s")) for c in conditions)
    return RuleBase("r", tuple(inputs), (OUT,), rules, operators or Operators())


def touching(name, foot=0.5):
    """A low and a high set that are 0 at `foot`, and one around it."""
    sets = (
        FuzzySet("low", "trapmf", (0, 0, 0.2, foot)),
        FuzzySet("mid", "trimf", (0, foot, 1)),
        FuzzySet("high", "trapmf", (foot, 0.8, 1, 1)),
    )
    return Variable(name, Universe(0, 1, 11), sets)


def test_a_single_point_of_two_inputs_is_named():
    inputs = touching("a", 0.3), touching("b", 0.7)
    conditions = [{n: w} for n, w in itertools.product("ab", ("low", "high"))]
    hole = find_hole(base(inputs, conditions), "out")
    assert hole.stretches == (("a", 0.3, 0.3), ("b", 0.7, 0.7))
    assert hole.point == (0.3, 0.7)
    assert str(hole) == "no rule about out fires at a=0.3, b=0.7"
    assert find_hole(base(inputs, [*conditions, {"a": "mid", "b": "mid"}]), "out") is None


def test_a_stretch_is_named_rather_than_a_point_of_it():
    inputs = touching("a"), touching("b")
    rules = base(inputs, [{"a": "low"}, {"b": "low", "a": "high"}])
    assert str(find_hole(rules, "out")) == (
        "no rule about out fires for a between 0.5 and 1, b between 0.5 and 1"
    )


def test_rules_without_confidence_do_not_count():
    (variable,) = (touching("a"),)
    rules = (
        rule({"a": "low"}, is_set("out", "s")),
        rule({"a": "mid"}, is_set("out", "s", 0.0)),
        rule({"a": "high"}, is_set("out", "s", 0.5)),
    )
    found = find_hole(RuleBase("r", (variable,), (OUT,), rules), "out")
    assert found.stretches == (("a", 0.5, 0.5),)


def test_a_full_table_of_eight_inputs_is_decided():
    names = "abcdefgh"
    conditions = [
        dict(zip(names, words, strict=True))
        for words in itertools.product(("low", "mid", "high"), repeat=8)
    ]
    inputs = [touching(n) for n in names]
    assert find_hole(base(inputs, conditions), "out") is None
    rules = [c for c in conditions if set(c.values()) != {"mid"}]
    assert find_hole(base(inputs, rules), "out").where == "at " + ", ".join(
        f"{n}=0.5" for n in names
    )


def test_too_many_combinations_are_no_hole_and_no_proof(monkeypatch):
    monkeypatch.setattr(coverage, "_MOST_TRIED", 1)
    conditions = [{"a": w, "b": v} for w in ("low", "mid", "high") for v in ("low", "mid", "high")]
    found = find_hole(base([touching("a"), touching("b")], conditions), "out")
    assert found.stretches == ()


POINT = st.integers(0, 6).map(lambda k: k / 6)
SHAPE = st.one_of(
    st.lists(POINT, min_size=3, max_size=3).map(lambda p: ("trimf", tuple(sorted(p)))),
    st.lists(POINT, min_size=4, max_size=4).map(lambda p: ("trapmf", tuple(sorted(p)))),
    POINT.map(lambda p: ("singleton", (p,))),
)


@st.composite
def rulebases(draw):
    inputs = []
    for name in "ab"[: draw(st.integers(1, 2))]:
        shapes = draw(st.lists(SHAPE, min_size=1, max_size=3))
        sets = tuple(FuzzySet(f"s{k}", *shape) for k, shape in enumerate(shapes))
        inputs.append(Variable(name, Universe(0, 1, 13), sets))
    term = {v.name: st.sampled_from([*v.set_names, None]) for v in inputs}
    rows = draw(st.lists(st.fixed_dictionaries(term), min_size=1, max_size=6))
    rows = [{k: w for k, w in row.items() if w} for row in rows]
    distinct = {frozenset(row.items()): row for row in rows if row}
    if not distinct:
        distinct = {0: {inputs[0].name: "s0"}}
    return base(inputs, distinct.values())


@pytest.mark.untraced
@settings(max_examples=300)
@given(rulebases())
def test_there_is_a_hole_exactly_where_a_fine_grid_has_one(rules):
    # All feet lie on sixths, so points on twelfths meet every point and stretch.
    grid = np.meshgrid(*[np.arange(13) / 12] * len(rules.inputs), indexing="ij")
    points = np.stack([g.ravel() for g in grid], axis=1)
    strongest = ft.FuzzySystem(rules).strengths(points).max(axis=1)
    hole = find_hole(rules, "out")
    assert (hole is not None) == (strongest == 0).any()
    if hole is not None:
        middle = ft.FuzzySystem(rules).strengths(np.array([hole.point]))
        assert middle.max() == 0


# ---------------------------------------------------------------- underflow


def narrow(name, sigma):
    sets = tuple(FuzzySet(w, "gaussmf", (c, sigma)) for w, c in (("low", 0.0), ("high", 1.0)))
    return Variable(name, Universe(0, 1, 11), sets)


def gaussians(sigma, conjunction="product"):
    inputs = [narrow(n, sigma) for n in "ab"]
    conditions = [{"a": w, "b": v} for w in ("low", "high") for v in ("low", "high")]
    return base(inputs, conditions, Operators(conjunction, "max"))


# 0.5 is 33 sigma from both centers: each grade is 1e-240, and their product is 0.
NARROW = 0.5 / 33


def test_underflow_of_narrow_gaussians_is_named():
    hole = find_hole(gaussians(NARROW), "out")
    assert hole.underflow
    assert str(hole) == (
        "the strengths of all rules about out underflow to 0 at a=0.5, b=0.5: their sets are too "
        "narrow for the distances between them"
    )
    assert np.isnan(ft.FuzzySystem(gaussians(NARROW)).evaluate(np.array([hole.point]))["out"][0])
    # The smaller of two grades is not too small.
    assert find_hole(gaussians(NARROW, "min"), "out") is None
    assert find_hole(gaussians(0.03), "out") is None


@settings(max_examples=60)
@given(st.floats(0.005, 0.1))
def test_underflow_is_found_where_a_grid_meets_it(sigma):
    rules = gaussians(sigma)
    grid = np.linspace(0, 1, 41)
    points = np.stack([g.ravel() for g in np.meshgrid(grid, grid)], axis=1)
    lost = (ft.FuzzySystem(rules).strengths(points).max(axis=1) == 0).any()
    assert not lost or find_hole(rules, "out") is not None


def test_a_warning_says_that_strengths_underflow():
    system = ft.FuzzySystem(gaussians(NARROW))
    with pytest.warns(ft.NoRuleFiresWarning, match="underflow to 0 at a=0.5, b=0.5"):
        system(a=0.5, b=0.5)
