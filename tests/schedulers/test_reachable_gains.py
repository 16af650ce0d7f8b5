from dataclasses import replace

import numpy as np
import pytest

import fuzzytrack as ft
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


def test_a_default_is_reached_too():
    rules = ft.load_rulebase("stiffness-damping")
    outputs = tuple(replace(v, default=v.universe.low) for v in rules.outputs)
    more = reachable_gains(replace(rules, outputs=outputs), "rules")
    corner = ft.alpha_beta_from_w(0.25, 0.54)
    assert np.abs(more - corner).sum(axis=1).min() < 1e-12


@pytest.mark.parametrize("name", ["stiffness-damping", "omega-schedule", "chan-style"])
def test_a_default_outside_of_the_universe_counts(name):
    """Where no rule fires each output is its default, whatever its universe."""
    rules = ft.load_rulebase(name)
    outputs = rules.outputs
    assert certify(rules).verdict == "certified"
    far = replace(outputs[0], default=30.0)
    found = certify(replace(rules, outputs=(far, *outputs[1:])))
    assert found.verdict == "refuted"
    # The sequence uses it: β tends to its limit of 4, or 2 for Kalata, as stiffness grows.
    column, least = {"chan-style": (0, 30), "omega-schedule": (0, 0.998)}.get(name, (1, 3))
    assert found.sequence[:, column].max() >= least


def test_a_period_is_refused_where_a_default_has_a_negative_pole():
    rules = ft.load_rulebase("stiffness-damping")
    far = zip(rules.outputs, (3.0, 2.0), strict=True)
    changed = replace(rules, outputs=tuple(replace(v, default=value) for v, value in far))
    assert certify(rules, period=4).verdict == "certified"
    for call in (certify, ft.FuzzyScheduler):
        with pytest.raises(ft.RuleBaseError, match="at stiffness=3, damping=2, the largest"):
            call(changed, period=4)


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
    changed = replace(rules, outputs=(replace(rules.outputs[0], default=-1.0), rules.outputs[1]))
    with pytest.raises(ft.RuleBaseError, match="must not be negative, and reach -1"):
        certify(changed)


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
    noise = replace(rules.outputs[0], default=0.0)
    found = certify(replace(rules, outputs=(noise, *rules.outputs[1:])))
    assert (found.verdict, found.limits.noise[0]) == ("not decided", 0)
    assert found.missing.startswith("the noise must be above 0")
    with pytest.raises(ValueError, match="period: the covariance of maneuver follows the time"):
        certify(rules, period=3)


def test_reachable_gains_are_not_those_of_a_covariance():
    with pytest.raises(ft.RuleBaseError, match="maneuver cannot be certified: needed are outputs"):
        reachable_gains("maneuver")
