import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack import AlphaBetaTracker, FuzzyScheduler, FuzzySystem, loads_rulebase
from fuzzytrack.gains import noise_ratio
from fuzzytrack.normalizations import Predicted, Scale, Smoothed, SmoothedMagnitude
from fuzzytrack.schedulers import GainScheduler

meters = st.floats(-1e6, 1e6)
unit = st.floats(-1, 1)


def signals(normalization, innovation, change, memory, sigma=1.0, n_axes=1):
    return normalization.kernel(n_axes)(innovation, change, 1.0, sigma, memory)


def test_scale_divides_by_the_standard_deviation():
    (error, rate), memory = signals(Scale(), 6.0, 100.0, (0.5,), sigma=2.0)
    assert (error, rate, memory) == (3.0, 2.5, (3.0,))


@given(st.lists(st.tuples(st.floats(-1e3, 1e3), st.floats(0.1, 1e3)), min_size=1, max_size=30),
       st.floats(0, 0.99))  # fmt: skip
def test_smoothed_is_a_weighted_mean_of_scaled_innovations(plots, rho):
    memory = Smoothed(rho).initial_memory(1)
    for innovation, sigma in plots:
        (mean, error), memory = signals(Smoothed(rho), innovation, 1.0, memory, sigma)
        assert error == innovation / sigma
    scaled = np.array([e / s for e, s in plots])
    weights = (1 - rho) * rho ** np.arange(len(plots))[::-1]
    assert mean == pytest.approx(weights @ scaled, rel=1e-9, abs=1e-9)
    assert memory == (mean,)


@given(st.lists(st.tuples(meters, st.floats(0.1, 1e3), unit), min_size=1, max_size=4))
def test_smoothed_magnitude_is_the_root_mean_square_of_smoothed(axes):
    innovations, sigmas, before = zip(*axes, strict=True)
    alone = [signals(Smoothed(), e, 1.0, (b,), s)[0] for e, s, b in axes]
    n = len(axes)
    (mean, error), memory = signals(
        SmoothedMagnitude(), innovations, (1.0,) * n, before, sigmas, n)  # fmt: skip
    assert mean == pytest.approx(np.sqrt(np.mean([m * m for m, _ in alone])))
    assert error == pytest.approx(np.sqrt(np.mean([e * e for _, e in alone])))
    assert memory == tuple(m for m, _ in alone)
    assert SmoothedMagnitude().initial_memory(n) == (0.0,) * n


@pytest.mark.parametrize("rho", [-0.1, 1.0])
@pytest.mark.parametrize("normalization", [Smoothed, SmoothedMagnitude])
def test_the_smoothing_is_checked(normalization, rho):
    with pytest.raises(ValueError, match=f"rho must be >= 0 and < 1, got {rho:g}"):
        normalization(rho)


RULES = """
rulebase: 1
name: by-lag
inputs:
  lag: {universe: [-3, 3, 61], sets: {left: {trimf: [-3, -3, 0]},
        small: {trimf: [-3, 0, 3]}, right: {trimf: [0, 3, 3]}}}
outputs:
  alpha: {universe: [0.2, 0.8, 61], sets: {low: {trimf: [0.2, 0.2, 0.8]},
          high: {trimf: [0.2, 0.8, 0.8]}}}
  beta: {universe: [0.05, 0.5, 46], sets: {low: {trimf: [0.05, 0.05, 0.5]},
         high: {trimf: [0.05, 0.5, 0.5]}}}
operators: {and: product, or: sum, defuzzification: weighted-centers}
rules:
  - {if: {lag: small}, then: {alpha: low, beta: low}}
  - {if: {lag: left}, then: {alpha: high, beta: high}}
  - {if: {lag: right}, then: {alpha: high, beta: high}}
scheduler: {normalization: NAME, gains: direct}
"""


# ------------------------------------------------------------------ predicted


def predicted(innovations, gains, dts, sigmas):
    """Signals of `Predicted`, step by step; a sigma of infinity stands for a missed plot."""
    kernel, feedback = Predicted().kernel(1), Predicted().feedback(1)
    memory, found = Predicted().initial_memory(1), []
    for e, (alpha, beta, gamma), dt, sigma in zip(innovations, gains, dts, sigmas, strict=True):
        both, memory = kernel(e, 0.0, dt, sigma, memory)
        memory = feedback(memory, alpha, beta, gamma, dt, sigma)
        found.append(both)
    return np.array(found)


def joseph_variances(gains, dts, sigmas):
    """Variances of the innovations by full matrices; NaN until there are two plots before."""
    h = np.array([[1.0, 0.0, 0.0]])
    p, plots, gap, found = np.zeros((3, 3)), 0, 0.0, []
    for (alpha, beta, gamma), dt, sigma in zip(gains, dts, sigmas, strict=True):
        move = np.array([[1, dt, dt * dt / 2], [0, 1, dt], [0, 0, 1]])
        gap += dt
        if plots > 0:
            p = move @ p @ move.T
        running = plots >= 2 and sigma < np.inf
        found.append(p[0, 0] + sigma**2 if running else np.nan)
        if sigma == np.inf:
            continue
        k = np.array([[alpha], [beta / dt], [gamma / (2 * dt * dt)]])
        if plots == 0:
            k, gap = np.array([[1.0], [0.0], [0.0]]), 0.0
        elif plots == 1:
            k = np.array([[1.0], [1 / gap], [0.0]])
        rest = np.eye(3) - k @ h
        p = rest @ p @ rest.T + k @ k.T * sigma**2
        plots += 1
    return np.array(found)


def record(n=60, seed=3):
    """Random gains, time steps and standard deviations, with missed plots."""
    random = np.random.default_rng(seed)
    gains = random.uniform([0.1, 0.05, 0.0], [0.9, 0.5, 0.02], (n, 3))
    sigmas = random.uniform(1.0, 30.0, n)
    sigmas[[1, 2, 7, 20, 21, 22]] = np.inf
    return gains, random.uniform(0.3, 3.0, n), sigmas


def test_predicted_divides_by_the_matrix_recursion():
    gains, dts, sigmas = record()
    variances = joseph_variances(gains, dts, sigmas)
    innovations = np.where(np.isnan(variances), 0.0, np.random.default_rng(8).normal(0, 9, 60))
    error, change = predicted(innovations, gains, dts, sigmas).T
    known = ~np.isnan(variances)
    assert known.sum() == 60 - 8
    expected = innovations[known] / np.sqrt(variances[known])
    assert error[known] == pytest.approx(expected, rel=1e-9)
    assert change[known] == pytest.approx(np.diff(expected, prepend=0.0), rel=1e-9, abs=1e-12)
    assert (error[~known] == 0).all()
    assert (change[~known] == 0).all()


@pytest.mark.parametrize("gains", [(0.5, 0.2, 0.0), (0.9, 0.7, 0.0), (0.4, 0.12, 0.01)])
def test_at_constant_gains_it_settles_at_the_closed_form(gains):
    sigma, n = 3.0, 400
    error = predicted(np.ones(n), [gains] * n, [2.0] * n, [sigma] * n)[-1, 0]
    assert 1 / error**2 == pytest.approx(sigma**2 * (1 + noise_ratio(*gains)), rel=1e-9)


@dataclass(frozen=True)
class Playback(GainScheduler):
    """Gains from a list, one entry a row from the first plot on."""

    gains: tuple[tuple[float, ...], ...]
    sees_starts = True
    sees_misses = True

    def initial_memory(self, n_axes):
        return (0.0,)

    def kernel(self, n_axes):
        def playback(innovation, change, dt, sigma, memory):
            alpha, beta, gamma = self.gains[int(memory[0])]
            return alpha, beta, gamma, 1.0, (memory[0] + 1.0,)

        return playback


def told(missed, values, times, sigmas):
    """Of each list in `values`, and of dt and sigma, what the normalization is told.

    That is every row, or if time counts from the last plot the rows with one.
    """
    rows = np.isfinite(sigmas) | (missed == "step")
    steps = np.diff(times[rows], prepend=times[0] - 1.0)
    return rows, [np.asarray(value)[rows] for value in values], steps, sigmas[rows]


@pytest.mark.untraced
@pytest.mark.parametrize("missed", ["elapsed", "step"])
def test_on_a_straight_run_the_signal_has_unit_variance(missed):
    n, tracks = 24, 4000
    gains, dts, sigmas = record(n, seed=5)
    times = np.cumsum(dts)
    random = np.random.default_rng(6)
    plots = (
        7.0 * times[:, None] + random.normal(size=(n, tracks)) * np.minimum(sigmas, 1e9)[:, None]
    )
    plots[np.isinf(sigmas)] = np.nan
    tracker = AlphaBetaTracker(Playback(tuple(map(tuple, gains.tolist()))), missed=missed)
    innovations = tracker.run(times, plots[:, :, None]).innovation[:, :, 0]
    seen = ~np.isnan(innovations[:, 0])
    # The signal is the innovation times a factor that the noise has no part in.
    rows, values, *given = told(missed, (seen.astype(float), gains), times, sigmas)
    factor = np.zeros(n)
    factor[rows] = predicted(*values, *given)[:, 0]
    variance = np.mean((factor[:, None] * np.nan_to_num(innovations)) ** 2, axis=1)[seen]
    assert seen.sum() == n - 8
    # Four standard errors of a variance
    assert variance == pytest.approx(1.0, abs=4 * math.sqrt(2 / tracks))


@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("opening", ["", ", opening: growing-memory"])
def test_the_gains_that_were_chosen_come_back_to_the_normalization(opening, missed):
    rules = loads_rulebase(RULES.replace("NAME", "predicted" + opening))
    _, dts, sigmas = record()
    plots = 5.0 * np.cumsum(dts) ** 1.3 + np.random.default_rng(4).normal(0, 9, 60)
    plots[np.isinf(sigmas)] = np.nan
    times = np.cumsum(dts)
    tracker = AlphaBetaTracker(FuzzyScheduler(rules), missed=missed)
    result = tracker.run(times, plots, np.minimum(sigmas, 1e9))
    used = np.nan_to_num(np.stack([result.gains.alpha, result.gains.beta, 0 * plots], axis=1))
    values = (np.nan_to_num(result.innovation), used)
    rows, values, *given = told(missed, values, times, sigmas)
    error = np.zeros(60)
    error[rows] = predicted(*values, *given)[:, 0]
    expected = FuzzySystem(rules)(lag=error)["alpha"]
    seen = ~np.isnan(result.gains.alpha)
    opens = np.zeros(60, dtype=bool)
    if opening:
        n = np.cumsum(~np.isnan(plots))
        first = 2 * (2 * n - 1) / (n * (n + 1))
        opens = first > expected
        expected = np.maximum(first, expected)
        assert opens[seen].sum() > 1
    assert result.gains.alpha[seen] == pytest.approx(expected[seen], rel=1e-9)
    assert len(set(result.gains.alpha[seen & ~opens])) > 20


def test_predicted_gains_less_after_missed_plots():
    gains, sigmas = [(0.5, 0.2, 0.0)] * 12, [1.0] * 12
    with_gap = [*sigmas[:8], *[math.inf] * 3, 1.0]
    full = predicted(np.ones(12), gains, [1.0] * 12, sigmas)[-1, 0]
    late = predicted([*np.ones(8), 0, 0, 0, 1], gains, [1.0] * 12, with_gap)[-1, 0]
    assert 0 < late < 0.8 * full


def test_only_a_normalization_with_feedback_has_one():
    assert Scale().feedback(1) is None
    assert not Scale().sees_starts
    on_scale = FuzzyScheduler(loads_rulebase(RULES.replace("NAME", "scale")))
    assert not on_scale.sees_starts
    opened = replace(
        on_scale.rules, scheduler=(*on_scale.rules.scheduler, ("opening", "growing-memory"))
    )
    on_predicted = FuzzyScheduler(loads_rulebase(RULES.replace("NAME", "predicted")))
    assert FuzzyScheduler(opened).sees_starts
    assert on_predicted.sees_starts
    assert not any(s.sees_misses for s in (on_scale, FuzzyScheduler(opened), on_predicted))
