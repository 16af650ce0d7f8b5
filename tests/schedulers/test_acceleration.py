"""A scheduler without acceleration has less work and the same numbers; one that lets it fade."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, FixedGains, FuzzyScheduler, load_rulebase
from fuzzytrack.lanes import runner as runner_module
from fuzzytrack.schedulers import GainScheduler, KalmanCA, KalmanCV
from fuzzytrack.testing import check_scheduler

OUTPUTS = ("predicted", "filtered", "velocity", "acceleration", "innovation")


@dataclass(frozen=True)
class Falling(GainScheduler):
    """Gains that fall with the innovation, and no acceleration, whatever it says of it."""

    uses_acceleration: bool
    gamma: float = 0.0

    def kernel(self, n_axes):
        gamma = self.gamma

        def falling(innovation, change, dt, sigma, memory):
            alpha = 0.9 / (1.0 + innovation * innovation)
            return alpha, 0.5 * alpha * alpha, gamma, 1.0, memory

        return falling


def recording():
    random = np.random.default_rng(5)
    plots = np.cumsum(random.normal(0.0, 3.0, (40, 11, 2)), axis=0)
    plots[random.random(plots.shape) < 0.1] = np.nan
    return np.cumsum(random.uniform(0.2, 2.0, 40)), plots


@pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")
@pytest.mark.parametrize("start", ["two-point", "one-point"])
@pytest.mark.parametrize("compile_above", [0, 10**9])
def test_to_leave_it_out_changes_no_number(monkeypatch, start, compile_above):
    monkeypatch.setattr(runner_module, "COMPILE_ABOVE", compile_above)
    times, plots = recording()
    without, told = (
        AlphaBetaTracker(Falling(uses), start).run(times, plots) for uses in (False, True)
    )
    for name in OUTPUTS:
        np.testing.assert_array_equal(getattr(without, name), getattr(told, name))
    for ours, theirs in zip(
        (without.gains.alpha, without.gains.beta, without.gains.gamma),
        (told.gains.alpha, told.gains.beta, told.gains.gamma),
        strict=True,
    ):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("compile_above", [0, 10**9])
def test_a_state_with_an_acceleration_is_not_for_a_tracker_without(monkeypatch, compile_above):
    monkeypatch.setattr(runner_module, "COMPILE_ABOVE", compile_above)
    times, plots = recording()
    half = AlphaBetaTracker(FixedGains(0.6, 0.3, 0.1)).run(times[:20], plots[:20]).state
    assert (half.acceleration != 0.0).any()
    tracker = AlphaBetaTracker(FixedGains(0.6, 0.3))
    for go_on in (
        lambda: tracker.run(times[20:], plots[20:], state=half),
        lambda: tracker.step(half, plots[20], times[20]),
    ):
        with pytest.raises(ValueError, match="it comes from AlphaBetaTracker"):
            go_on()


def test_who_has_one():
    assert FixedGains(0.5, 0.2, 0.05).uses_acceleration
    assert not FixedGains(0.5, 0.2).uses_acceleration
    assert KalmanCA(1.0, acceleration_sigma=1.0).uses_acceleration
    assert not KalmanCV(1.0).uses_acceleration
    assert not FuzzyScheduler(load_rulebase("stiffness-damping")).uses_acceleration
    # Who does not say loses nothing.
    assert GainScheduler.uses_acceleration


@dataclass(frozen=True)
class Forgetful(Falling):
    source: ClassVar[str] = "says that it has none, and gives one"


def test_the_conformance_kit_sees_a_gamma_that_nobody_uses():
    with pytest.raises(AssertionError, match=r"gamma must be 0 unless uses_acceleration"):
        check_scheduler(Forgetful(uses_acceleration=False, gamma=0.01))


# ------------------------------------------------------------------ retention


def retention_of(innovation):
    return math.inf if innovation < -2.0 else 0.4 + 9.0 / (1.0 + innovation * innovation)


@dataclass(frozen=True)
class Fading(GainScheduler):
    """Constant gains, and a retention time that the innovation of the plot decides."""

    alpha: float = 0.6
    beta: float = 0.4
    gamma: float = 0.3
    uses_retention: bool = True
    sees_starts: bool = False
    sees_misses: bool = False
    coupled: bool = False

    def kernel(self, n_axes):
        alpha, beta, gamma, coupled = self.alpha, self.beta, self.gamma, self.coupled

        def fading(innovation, change, dt, sigma, memory):
            # After a missed plot, and at a start, it would last a moment.
            retention = retention_of(innovation) if sigma != math.inf else 1e-3
            return alpha, beta, gamma, retention, memory

        def fading_together(innovation, change, dt, sigma, memory):
            retention = retention_of(innovation[0]) if sigma[0] != math.inf else 1e-3
            return alpha, beta, gamma, retention, memory

        return fading_together if coupled else fading


def faded_track(times, plots, gains, missed):
    """Rows of (predicted, filtered, velocity, acceleration) of one axis from a two-point start."""
    alpha, beta, gamma = gains
    (first, second), tau = np.flatnonzero(~np.isnan(plots))[:2], math.inf
    x, v, a = plots[second], (plots[second] - plots[first]) / (times[second] - times[first]), 0.0
    last, rows = second, [(math.nan, x, v, a)]
    for k in range(second + 1, len(times)):
        dt = times[k] - times[last]
        part = dt / tau
        a_now = a / (1.0 + part + 0.5 * part**2)
        x_now, v_now = x + v * dt + a_now * dt**2 / 2, v + a_now * dt
        now, seen = (x_now, v_now, a_now), not math.isnan(plots[k])
        if seen:
            e = plots[k] - x_now
            now = x_now + alpha * e, v_now + beta / dt * e, a_now + gamma / (2 * dt**2) * e
            tau = retention_of(e)
        if seen or missed == "step":
            (x, v, a), last = now, k
        rows.append((x_now, *now))
    return second, np.array(rows).T


def assert_faded(result, times, plots, gains, missed):
    for axis in range(plots.shape[1]):
        second, expected = faded_track(times, plots[:, axis], gains, missed)
        found = result.predicted, result.filtered, result.velocity, result.acceleration
        for ours, theirs in zip(found, expected, strict=True):
            assert ours[second:, axis] == pytest.approx(theirs, rel=1e-9, abs=1e-9, nan_ok=True)


@pytest.mark.parametrize("compile_above", [0, 10**9])
@pytest.mark.parametrize("missed", ["elapsed", "step"])
@pytest.mark.parametrize("follows", [False, True])
def test_acceleration_fades_at_the_prediction(monkeypatch, follows, missed, compile_above):
    """By the retention time of the last plot, over the time to the next one."""
    monkeypatch.setattr(runner_module, "COMPILE_ABOVE", compile_above)
    times, plots = recording()
    scheduler = Fading(sees_starts=follows, sees_misses=follows)
    tracker = AlphaBetaTracker(scheduler, missed=missed)
    result = tracker.run(times, plots, 1.0)
    gains = scheduler.alpha, scheduler.beta, scheduler.gamma
    for track in range(plots.shape[1]):
        part = tracker.run(times, plots[:, track], 1.0)
        np.testing.assert_array_equal(part.filtered, result.filtered[:, track])
        assert_faded(part, times, plots[:, track], gains, missed)
    infinite = np.nan_to_num(result.innovation) < -2.0
    assert 20 < infinite.sum() < np.isfinite(result.innovation).sum() - 20
    state = tracker.start(plots[0], times[0], 1.0)
    for k in range(1, len(times)):
        state = tracker.step(state, plots[k], times[k], 1.0)
        for name, whole in (("position", "filtered"), ("acceleration", "acceleration")):
            np.testing.assert_array_equal(getattr(state, name), getattr(result, whole)[k])


@pytest.mark.parametrize("missed", ["elapsed", "step"])
def test_axes_together_have_one_retention(missed):
    times, plots = recording()
    plots[..., 1] = plots[..., 0]
    tracker = AlphaBetaTracker(Fading(coupled=True), missed=missed)
    for track in range(plots.shape[1]):
        result = tracker.run(times, plots[:, track])
        assert_faded(result, times, plots[:, track], (0.6, 0.4, 0.3), missed)


@pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")
def test_without_retention_the_number_is_not_used():
    times, plots = recording()
    unused = AlphaBetaTracker(Fading(uses_retention=False)).run(times, plots)
    fixed = AlphaBetaTracker(FixedGains(0.6, 0.4, 0.3)).run(times, plots)
    for name in OUTPUTS:
        np.testing.assert_array_equal(getattr(unused, name), getattr(fixed, name))
    assert len(unused.state.lanes) == len(fixed.state.lanes)


def test_a_prediction_fades_too():
    tracker = AlphaBetaTracker(Fading())
    times, plots = recording()
    result = tracker.run(times, plots)
    state, before = result.state, result.state.lanes.copy()
    later = times[-1] + np.array([0.1, 3.0, 40.0])
    found = [tracker.predict(state, t) for t in later]
    np.testing.assert_array_equal(state.lanes, before)
    for track in range(plots.shape[1]):
        coasting = np.full((3, 2), np.nan)
        for k, t in enumerate(later):
            rows = np.concatenate([plots[:, track], coasting[:1]])
            _, expected = zip(
                *(faded_track([*times, t], rows[:, axis], (0.6, 0.4, 0.3), "elapsed")
                  for axis in (0, 1)), strict=True
            )  # fmt: skip
            ends = np.array([each[:, -1] for each in expected]).T
            ours = found[k].position[track], found[k].velocity[track], found[k].acceleration[track]
            assert np.array(ours) == pytest.approx(ends[1:], rel=1e-9, abs=1e-9)
