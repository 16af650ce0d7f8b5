"""Figures that an independent implementation found; tolerances are its own plus three of our
standard errors at the number of runs used here."""

import math

import numpy as np
import pytest

from fuzzytrack.papers import njonjo, reproduce

RUNS = 10

pytestmark = pytest.mark.untraced


@pytest.fixture(scope="module")
def found():
    return reproduce("njonjo", RUNS)


@pytest.mark.parametrize(
    ("quantity", "value", "within", "spread"),
    [
        ("α-β-γ, ξ = 0.64: cumulative prediction error (m)", 19_600, 120, 290),
        ("α-β-γ, ξ = 0.64: cumulative estimation error (m)", 10_623, 80, 198),
        ("Kalman, Q = 0.001, R = 1: cumulative prediction error (m)", 19_160, 130, 329),
        ("Kalman, Q = 0.001, R = 1: cumulative estimation error (m)", 10_473, 80, 204),
        ("steady Kalman gain, α", 0.733, 0.002, 0),
        ("steady Kalman gain, β", 0.467, 0.002, 0),
        ("steady Kalman gain, γ", 0.0735, 0.002, 0),
        ("best ξ for prediction", 0.60, 0.01, 0),
        ("best ξ for estimation", 0.63, 0.015, 0),
    ],
)
def test_acceptance(found, quantity, value, within, spread):
    assert found.ours(quantity) == pytest.approx(value, abs=within + 3 * spread / math.sqrt(RUNS))


@pytest.mark.parametrize("what", ["predicted", "estimated"])
def test_the_kalman_filter_is_ahead_in_nearly_all_runs(found, what):
    assert found.ours(f"share of runs with Kalman ahead, {what}") >= 0.97


def test_published_totals_and_tuning_match(found):
    verdicts = {(r.table, r.quantity): r.verdict for r in found.rows if r.published is not None}
    differing = {quantity for (_, quantity), verdict in verdicts.items() if verdict == "differs"}
    assert len(verdicts) == 12
    assert differing == {"best ξ for prediction"}


@pytest.mark.parametrize(
    ("quantity", "value"),
    [
        ("prediction against plots at R = 0.01 (m)", 37_558),
        ("prediction against plots at R = 100 (m)", 56_485),
        ("prediction against plots at Q = 0.0001 (m)", 26_179),
        ("estimation error at Q = 1e-05 (m)", 29_121),
        ("estimation error at R = 10 (m)", 11_930),
    ],
)
def test_sweeps(found, quantity, value):
    assert found.ours(quantity) == pytest.approx(value, rel=0.015)


def test_stored_gains_are_those_of_a_matrix_kalman_filter():
    """A plain filter with state and covariance gives the estimates of the stored gains."""
    period, q, r = njonjo.PERIOD, 1e-3, 1.0
    scenario = njonjo.scenario()
    plots = scenario.position[:30, 0] + np.random.default_rng(4).normal(0, 10, 30)
    transition = np.array([[1, period, period**2 / 2], [0, 1, period], [0, 0, 1]])
    state, covariance = np.array([plots[0], 0, 0]), np.eye(3)
    estimates = [plots[0]]
    for z in plots[1:]:
        state, covariance = (
            transition @ state,
            transition @ covariance @ transition.T + q * np.eye(3),
        )
        gain = covariance[:, :1] / (covariance[0, 0] + r)
        state = state + gain[:, 0] * (z - state[0])
        covariance = (np.eye(3) - gain @ [[1, 0, 0]]) @ covariance
        estimates.append(state[0])
    scheduler = njonjo.StoredGains(njonjo.kalman_gains(q, r, updates=29))
    tracker = njonjo.AlphaBetaTracker(scheduler, start="one-point")
    ours = tracker.run(scenario.time[:30], plots).filtered
    np.testing.assert_allclose(ours, estimates, rtol=1e-9)
