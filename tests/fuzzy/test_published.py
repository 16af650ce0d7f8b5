"""Answers that others print. One formula; each source names its own output grid."""

import numpy as np
import pytest
from builders import is_set, rule, tipper, triangles, whole_triangles

from fuzzytrack.fuzzy.defuzzification import defuzzify
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Operators, RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.variable import Universe, Variable


@pytest.mark.parametrize(
    ("service", "food", "tip"),
    [(2, 1, 7.0169), (4, 5, 14.4585), (7, 8, 20.3414), (1, 2, 5.5586)],
)
def test_matlab_tipper(service, food, tip):
    answer = FuzzySystem(tipper(101, "ends"))(service=service, food=food)["tip"]
    assert round(answer, 4) == tip


@pytest.mark.parametrize(
    ("service", "food", "tip"),
    [(2, 1, 7.015028377), (4, 5, 14.452985691), (7, 8, 20.344497969)],
)
def test_fuzzylite_tipper(service, food, tip):
    answer = FuzzySystem(tipper(1000, "midpoints"))(service=service, food=food)["tip"]
    assert round(answer, 9) == tip


def test_simpful_tip():
    """Its example of a tip for service 4 and food 8."""
    service = Variable(
        "service", Universe(0, 10, 11), triangles(("poor", "good", "excellent"), (0.0, 5.0, 10.0))
    )
    food = Variable("food", Universe(0, 10, 11), triangles(("rancid", "delicious"), (0.0, 10.0)))
    tip = Variable(
        "tip",
        Universe(0, 25, 1000),
        (
            FuzzySet("small", "trimf", (0, 0, 10)),
            FuzzySet("average", "trimf", (0, 10, 20)),
            FuzzySet("generous", "trapmf", (10, 20, 25, 25)),
        ),
    )
    rules = (
        rule({"service": "poor"}, is_set("tip", "small")),
        rule({"food": "rancid"}, is_set("tip", "small")),
        rule({"service": "good"}, is_set("tip", "average")),
        rule({"service": "excellent"}, is_set("tip", "generous")),
        rule({"food": "delicious"}, is_set("tip", "generous")),
    )
    base = RuleBase("simpful", (service, food), (tip,), rules, Operators("min", "max"))
    assert FuzzySystem(base)(service=4, food=8)["tip"] == pytest.approx(
        14.17223614042091, rel=0, abs=1e-13
    )


@pytest.mark.parametrize(
    ("points", "grid", "expected"),
    [(26, "ends", 20.244508), (25_000, "midpoints", 19.857759)],
)
def test_scikit_fuzzy_tip(points, grid, expected):
    """Its tipping problem: the plain sum over its universe, and the area it stands for."""
    names, centers = ("poor", "average", "good"), (0.0, 5.0, 10.0)
    quality, service = (
        Variable(n, Universe(0, 10, 11), triangles(names, centers)) for n in ("quality", "service")
    )
    tip = Variable(
        "tip",
        Universe(0, 25, points, grid),
        triangles(("low", "medium", "high"), (0.0, 13.0, 25.0)),
    )
    rules = (
        rule({"quality": "poor"}, is_set("tip", "low")),
        rule({"service": "poor"}, is_set("tip", "low")),
        rule({"service": "average"}, is_set("tip", "medium")),
        rule({"service": "good"}, is_set("tip", "high")),
        rule({"quality": "good"}, is_set("tip", "high")),
    )
    base = RuleBase("tip", (quality, service), (tip,), rules, Operators("min", "max"))
    answer = FuzzySystem(base)(quality=6.5, service=9.8)["tip"]
    assert round(answer, 6) == expected


# ------------------------------------------------------------ centroid against weights


def quarter_and_three_quarters(output, defuzzification="centroid"):
    """Four evenly spaced output sets; the first fires at 1/4, the second at 3/4."""
    x = Variable("x", Universe(0, 1, 11), triangles("ab", (0.0, 1.0)))
    rules = (rule({"x": "a"}, is_set("y", "z")), rule({"x": "b"}, is_set("y", "s")))
    operators = Operators("product", "sum", defuzzification)
    base = RuleBase("quarters", (x,), (output,), rules, operators)
    return FuzzySystem(base)(x=0.75)["y"]


CLIPPED = triangles("zsml", tuple(np.linspace(0, 1, 4)))


@pytest.mark.parametrize(
    ("points", "grid", "expected"),
    [
        (101, "ends", 0.300312393),
        (121, "ends", 0.300504152),
        (100_000, "midpoints", 19 / 63),  # the integral
    ],
)
def test_clipped_end_sets_move_the_centroid_inwards(points, grid, expected):
    output = Variable("y", Universe(0, 1, points, grid), CLIPPED)
    assert quarter_and_three_quarters(output) == pytest.approx(expected, abs=6e-10)


def test_clipped_end_sets_on_a_fine_grid():
    y = np.linspace(0, 1, 200_001)
    fuzzy = 0.25 * CLIPPED[0].membership(y) + 0.75 * CLIPPED[1].membership(y)
    assert defuzzify("centroid", y, fuzzy) == pytest.approx(0.301586655, abs=6e-10)


def test_whole_end_sets_give_the_weighted_centers():
    output = Variable("y", Universe(-1 / 3, 4 / 3, 201), whole_triangles("zsml", 0, 1))
    assert quarter_and_three_quarters(output) == pytest.approx(0.25, abs=1e-14)


def test_weighted_centers_of_clipped_sets_are_the_peaks():
    output = Variable("y", Universe(0, 1, 101), CLIPPED)
    assert quarter_and_three_quarters(output, "weighted-centers") == pytest.approx(0.25, abs=1e-15)


@pytest.mark.parametrize(
    ("low", "high", "reach"),
    [
        (0.25, 0.35, (0.261111, 0.338889)),
        (0.54, 0.89, (0.578889, 0.851111)),
        (0.2, 0.8, (0.266667, 0.733333)),
        (0.0, 1.3, (0.144444, 1.155556)),
    ],
)
def test_range_that_clipped_centroids_reach(low, high, reach):
    x = Variable("x", Universe(0, 1, 11), triangles("ab", (0.0, 1.0)))
    y = Variable(
        "y",
        Universe(low, high, 30_000, "midpoints"),
        triangles("zsml", np.linspace(low, high, 4)),
    )
    rules = (rule({"x": "a"}, is_set("y", "z")), rule({"x": "b"}, is_set("y", "l")))
    answer = FuzzySystem(RuleBase("range", (x,), (y,), rules))(x=[0.0, 1.0])["y"]
    np.testing.assert_allclose(answer, reach, rtol=0, atol=6e-7)
