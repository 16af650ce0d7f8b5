"""A scheduler without acceleration: less work, and the same numbers."""

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
def test_an_acceleration_from_elsewhere_is_dropped(monkeypatch, compile_above):
    monkeypatch.setattr(runner_module, "COMPILE_ABOVE", compile_above)
    times, plots = recording()
    half = AlphaBetaTracker(FixedGains(0.6, 0.3, 0.1)).run(times[:20], plots[:20]).state
    assert (half.acceleration != 0.0).any()
    tracker = AlphaBetaTracker(FixedGains(0.6, 0.3))
    after = tracker.run(times[20:], plots[20:], state=half)
    first = half.position + half.velocity * (times[20] - times[19])
    np.testing.assert_array_equal(after.predicted[0], first)
    assert (after.acceleration == 0.0).all()
    assert (tracker.step(half, plots[20], times[20]).acceleration == 0.0).all()


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
