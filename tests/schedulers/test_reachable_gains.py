from dataclasses import replace

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.rulebase import Consequent, Operators
from fuzzytrack.schedulers.reachable_gains import certify, reachable_gains


@pytest.mark.parametrize(
    ("name", "reach", "verdict", "rate"),
    [
        ("stiffness-damping", "universe", "certified", 0.815936),
        ("stiffness-damping", "rules", "certified", 0.799842),
        ("stiffness-damping-cog", "universe", "certified", 0.815936),
        ("stiffness-damping-wide", "universe", "refuted", 1.516598),
        ("stiffness-damping-wide", "rules", "refuted", 1.364012),
        ("omega-schedule", "universe", "certified", 0.836665),
        ("chan-style", "universe", "certified", 0.999794),
        ("chan-style", "rules", "certified", 0.989968),
    ],
)
def test_shipped_rule_bases(name, reach, verdict, rate):
    found = certify(ft.load_rulebase(name), reach=reach)
    assert found.verdict == verdict
    assert found.rate == pytest.approx(rate, abs=1e-6)


def test_gains_themselves():
    assert certify([[0.5377, 0.2018], [0.6, 0.3]]).verdict == "certified"
    rules = ft.load_rulebase("chan-style")
    box = reachable_gains(rules)
    assert box.tolist() == [[0.3, 0.1], [0.3, 0.6], [0.9, 0.1], [0.9, 0.6]]
    assert len(np.unique(reachable_gains(rules, "rules"), axis=0)) == 5


@pytest.mark.parametrize("reach", ["universe", "rules"])
def test_everything_that_is_scheduled_lies_in_the_hull(reach):
    from scipy.spatial import Delaunay

    rules = ft.load_rulebase("stiffness-damping")
    error, rate = np.random.default_rng(4).uniform(-1, 1, (2, 2000))
    gains = ft.FuzzySystem(rules)(E=error, dE=rate)
    points = np.stack(ft.alpha_beta_from_w(gains["stiffness"], gains["damping"]), axis=1)
    hull = Delaunay(reachable_gains(rules, reach))
    # Corners of the table lie on the hull itself.
    middle = hull.points.mean(axis=0)
    assert (hull.find_simplex(middle + (points - middle) * (1 - 1e-9)) >= 0).all()


@pytest.mark.parametrize("reach", ["universe", "rules"])
def test_kalatas_curve_lies_in_the_hull(reach):
    from scipy.spatial import Delaunay

    rules = ft.load_rulebase("omega-schedule")
    corners = reachable_gains(rules, reach)
    # ω₀ = √λ/2
    curve = np.stack(ft.gains.kalata((2 * np.linspace(0.29, 0.778, 500)) ** 2), axis=1)
    hull = Delaunay(corners)
    middle = hull.points.mean(axis=0)
    assert (hull.find_simplex(middle + (curve - middle) * (1 - 1e-9)) >= 0).all()
    # It is no larger than needed: its corners are next to the curve, or on it.
    apart = np.linalg.norm(corners[:, None] - curve, axis=2).min(axis=1)
    assert apart.max() < 2e-3


def test_an_output_that_reaches_zero_stiffness():
    rules = ft.load_rulebase("omega-schedule")
    stiffness = replace(rules.outputs[0], universe=replace(rules.outputs[0].universe, low=0.0))
    corners = reachable_gains(replace(rules, outputs=(stiffness,)))
    assert corners.min() == 0
    assert np.abs(corners - reachable_gains(rules, "rules")[:, None]).max() > 0.3


@pytest.fixture
def with_hole():
    """Rules without the first one, and with defaults at the lower ends of the universes."""
    rules = ft.load_rulebase("stiffness-damping")
    outputs = tuple(replace(v, default=v.universe.low) for v in rules.outputs)
    return replace(rules, rules=rules.rules[1:], outputs=outputs, layout=None)


def test_a_default_is_reached_where_no_rule_fires(with_hole):
    corner = ft.alpha_beta_from_w(0.25, 0.54)
    more = reachable_gains(with_hole, "rules")
    assert np.abs(more - corner).sum(axis=1).min() < 1e-12
    # Where a rule always fires it is not.
    whole = replace(ft.load_rulebase("stiffness-damping"), outputs=with_hole.outputs)
    assert np.array_equal(
        reachable_gains(whole, "rules"), reachable_gains("stiffness-damping", "rules")
    )


GAP = """\
rulebase: 1
name: gap
inputs:
  E: {universe: [-1, 1, 21], sets: {n: {trapmf: [-1, -1, -0.9, FOOT]}, p: {trapmf: [0, 0.9, 1, 1]}}}
outputs:
  alpha: {universe: [0.1, 1.9, 19], default: 1.9, sets: {a: {singleton: [0.5]}}}
  beta: {universe: [0.1, 0.3, 19], default: 0.3, sets: {b: {singleton: [0.2]}}}
operators: {and: product, or: sum, defuzzification: weighted-centers}
rules:
  - {if: {E: n}, then: {alpha: a, beta: b}}
  - {if: {E: p}, then: {alpha: a, beta: b}}
"""


@pytest.mark.parametrize(("foot", "reached"), [("0", True), ("-0.5", True), ("0.1", False)])
def test_a_default_counts_for_a_single_point_too(foot, reached):
    """With feet that touch in 0, no rule fires there alone; with feet that overlap, one does."""
    rules = loads_rulebase(GAP.replace("FOOT", foot))
    found = reachable_gains(rules, "rules")
    assert (found == [1.9, 0.3]).all(axis=1).any() == reached
    assert certify(rules, reach="rules").verdict == ("refuted" if reached else "certified")


def test_what_cannot_be_certified():
    with pytest.raises(ft.RuleBaseError, match="tipper cannot be certified: needed are outputs"):
        certify(ft.load_rulebase("tipper"))
    rules = ft.load_rulebase("stiffness-damping")
    with pytest.raises(ValueError, match="reach: unknown 'all'; one of universe, rules"):
        certify(rules, reach="all")
    clipped = replace(rules, operators=Operators("min", "max"))
    with pytest.raises(ft.RuleBaseError, match="use reach 'universe'"):
        certify(clipped, reach="rules")
    first = rules.rules[0]
    unsure = replace(
        first,
        consequents=(Consequent("stiffness", "S", 0.5), Consequent("damping", "L", 1.0)),
    )
    uneven = replace(rules, rules=(unsure, *rules.rules[1:]))
    with pytest.raises(ft.RuleBaseError, match="same confidence for stiffness and damping"):
        certify(uneven, reach="rules")


def test_negative_stiffness_is_refused():
    rules = ft.load_rulebase("stiffness-damping")
    low = replace(rules.outputs[0], universe=replace(rules.outputs[0].universe, low=-1.0))
    with pytest.raises(ft.RuleBaseError, match="must not be negative, and reach -1"):
        certify(replace(rules, outputs=(low, rules.outputs[1])))


def test_limits_of_a_covariance():
    rules = ft.load_rulebase("maneuver")
    found = certify(rules, steps=(0.5, 2), missed=1, sigma_ratio=1.5)
    limits = found.limits
    assert found.verdict == "certified"
    assert (limits.noise, limits.retention) == ((0.09, 2.7), (0.3, 7.0))
    assert (limits.delay, limits.gap, limits.sigma_ratio) == (1.0, 0.6, 1.5)
    assert limits.times.intervals == [(0.5, 4.0)]
    assert sorted(found.contraction) == [10, 20, 40]
    # Weighted centers: all values lie between those that the rules name.
    assert certify(rules, reach="rules").limits.noise == (0.09, 2.7)
    noise = replace(rules.outputs[0], universe=replace(rules.outputs[0].universe, low=0.0))
    found = certify(replace(rules, outputs=(noise, *rules.outputs[1:])))
    assert (found.verdict, found.limits.noise[0]) == ("not decided", 0)
    assert found.missing.startswith("the noise must be above 0")
    with pytest.raises(ValueError, match="period: the covariance of maneuver follows the time"):
        certify(rules, period=3)


def test_reachable_gains_are_not_those_of_a_covariance():
    with pytest.raises(ft.RuleBaseError, match="maneuver cannot be certified: needed are outputs"):
        reachable_gains("maneuver")
