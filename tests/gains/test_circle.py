"""Best gains on a circle against known values, and against what lies around them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from opponents import ALPHA, BETA, GAMMA, RNG

from fuzzytrack.gains import (
    circular_error,
    is_stable,
    noise_ratio,
    optimal_on_circle,
)

TURN = {"angular_rate": 1.5433333333 / 45, "dt": 3.0, "radius": 45.0}


@pytest.mark.parametrize(
    ("rate", "variance", "expected"),
    [
        (0.034296296, 200.0, (0.45171283, 0.45217978)),
        (0.034, 200.0, (0.45047772, 0.44735355)),
        (0.034296296, 200.0**2, (0.26031667, 0.07767889)),
    ],
)
def test_known_optima_on_the_circle(rate, variance, expected):
    found = optimal_on_circle(rate, 3, 45, sigma=variance**0.5, kappa=0.01)
    assert found.gains == pytest.approx((*expected, 0), abs=3e-8)
    assert found.is_global


def test_known_costs_on_the_circle():
    found = optimal_on_circle(**TURN, sigma=200**0.5, kappa=0.01)
    assert found.cost == pytest.approx(3.67621802, abs=6e-9)
    assert found.error == pytest.approx(1.06618648, abs=3e-8)
    assert found.noise_ratio == pytest.approx(1.26973220, abs=4e-8)
    assert found.cost == pytest.approx(found.error**2 + 2 * found.noise_ratio)
    found = optimal_on_circle(**TURN, sigma=200, kappa=0.01)
    assert found.cost == pytest.approx(182.45026296, abs=3e-8)
    found = optimal_on_circle(**TURN, sigma=200**0.5, kappa=0.01, gamma=True)
    assert found.gains == pytest.approx((0.6641323, 0.1479348, 0.1480772), abs=6e-8)
    assert found.cost == pytest.approx(2.5695247, abs=6e-8)
    assert found.is_global


def test_the_optimum_on_the_circle_is_overtaken_and_then_vanishes():
    """Not the printed limit α = 0.0032, β = 0, which is no minimum."""
    weights = [1, 100, 1090.2, 1090.3, 2000, 3000]
    found = [optimal_on_circle(**TURN, sigma=1, kappa=weight) for weight in weights]
    assert [optimum.is_global for optimum in found] == [True] * 3 + [False] * 3
    assert found[2].gains[:2] == pytest.approx((0.23395, 0.05384), abs=5e-6)
    assert (np.diff([optimum.beta for optimum in found]) < 0).all()
    for weight in (3500, 17000, 1e6):
        with pytest.raises(ValueError, match="kappa must leave a minimum"):
            optimal_on_circle(**TURN, sigma=1, kappa=weight)
    # From 17691.19 on nothing costs less than a filter at rest in the middle of the circle.
    theta, radius = TURN["angular_rate"] * TURN["dt"], TURN["radius"]
    alpha = np.linspace(1e-4, 0.5, 20_000)
    for weight, at_rest in ((17691.0, False), (17691.4, True)):
        edge = circular_error(alpha, 1e-13, 0, theta, 1, radius) ** 2 + weight * noise_ratio(
            alpha, 1e-13
        )
        assert (edge.min() >= radius**2) is np.bool_(at_rest)
    at = np.argmin(
        circular_error(alpha, 1e-13, 0, theta, 1, radius) ** 2 + 1090.26 * noise_ratio(alpha, 1e-13)
    )
    assert alpha[at] == pytest.approx(0.36089, abs=3e-5)


def test_where_the_optimum_is_not_global_the_edge_is_at_rest_or_moving():
    turn = optimal_on_circle(1.0, 1.0, 1.0, sigma=0.1, kappa=2.0)
    assert not turn.is_global
    assert turn.edge_cost < turn.cost
    at_rest = optimal_on_circle(1.6, 1.0, 10.0, sigma=0.1, kappa=1.0)
    assert at_rest.edge_cost == pytest.approx(100)


@settings(max_examples=8)
@given(st.floats(0.05, 0.8), st.floats(-6, -2.5), st.booleans())
def test_the_optimum_on_the_circle_is_a_local_minimum(theta, exponent, gamma):
    weight = 10.0**exponent
    found = optimal_on_circle(-theta / 2, 2.0, 1.0, sigma=1.0, kappa=weight, gamma=gamma)

    def cost(a, b, g):
        return circular_error(a, b, g, theta, 1, 1) ** 2 + weight * noise_ratio(a, b, g)

    assert found.cost == pytest.approx(cost(*found.gains))
    near = np.array(found.gains)[:, None] * (1 + RNG.uniform(-1e-3, 1e-3, (3, 500)))
    near = near[:, is_stable(*near)]
    assert found.cost <= cost(*near).min() * (1 + 1e-12)
    third = GAMMA if gamma else 0
    if found.is_global:
        assert found.cost <= cost(ALPHA, BETA, third).min() * (1 + 1e-12)
