"""The conformance kit must fail what breaks the contract."""

import random
from dataclasses import dataclass, replace

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.schedulers import GainScheduler, KalmanCV
from fuzzytrack.testing import check_scheduler, check_tracker


def scheduler_of(kernel, memory=(), frozen=True):
    class Made(GainScheduler):
        def initial_memory(self, n_axes):
            return memory

        def kernel(self, n_axes):
            return kernel

        def __eq__(self, other):
            return type(other) is type(self)

        def __hash__(self):
            return 0

        def __reduce__(self):
            return scheduler_of, (kernel, memory)

    return Made()


def fixed(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0, memory


def divides(innovation, change, dt, sigma, memory):
    return 0.5, 0.2 / innovation, 0.0, 1.0, memory


def forgets_one(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0, ()


def four_answers(innovation, change, dt, sigma, memory):
    return 0.5, 0.2, 0.0, 1.0


def grows_to_infinity(innovation, change, dt, sigma, memory):
    return 0.5, 0.2 + 1e300 * abs(innovation) * 1e300, 0.0, 1.0, memory


def gambles(innovation, change, dt, sigma, memory):
    return random.random(), 0.2, 0.0, 1.0, memory


@dataclass
class Unhashable(GainScheduler):
    def kernel(self, n_axes):
        return fixed


@dataclass(frozen=True, eq=False)
class Unequal(GainScheduler):
    def kernel(self, n_axes):
        return fixed


@pytest.mark.parametrize(
    ("scheduler", "promise"),
    [
        (0.5, "must be a GainScheduler"),
        (Unhashable(), "Unhashable must be hashable: make it a frozen dataclass"),
        (Unequal(), "Unequal must equal its pickled copy"),
    ],
)
def test_a_scheduler_is_a_value(scheduler, promise):
    with pytest.raises(AssertionError, match=promise):
        check_scheduler(scheduler)


@pytest.mark.parametrize(
    ("kernel", "memory", "promise"),
    [
        (forgets_one, (0.0,), "memory must keep its length 1, got 0"),
        (four_answers, (), "must return alpha, beta, gamma, phi, memory"),
        (grows_to_infinity, (), "gains and memory must be finite floats"),
        (gambles, (), "must depend on nothing else"),
    ],
)
def test_kernels(kernel, memory, promise, monkeypatch):
    made = scheduler_of(kernel, memory)
    # A local class does not pickle by itself; its equality is not what is tested here.
    monkeypatch.setattr("fuzzytrack.testing.pickle.loads", lambda data: made)
    with pytest.raises(AssertionError, match=promise):
        check_scheduler(made)


def test_a_kernel_guards_its_divisions(monkeypatch):
    made = scheduler_of(divides)
    monkeypatch.setattr("fuzzytrack.testing.pickle.loads", lambda data: made)
    with pytest.raises(ZeroDivisionError):
        check_scheduler(made)


class Faulty:
    """A good tracker with one method changed."""

    def __init__(self, **changes):
        self.good = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2))
        self.changes = changes

    def run(self, t, z, sigma=None):
        return self.changes.get("run", lambda result, t, z: result)(
            self.good.run(t, z, sigma), t, z
        )

    def start(self, z, t, sigma=None):
        return self.good.start(z, t, sigma)

    def step(self, state, z, t, sigma=None):
        new = self.good.step(state, z, t, sigma)
        return self.changes.get("step", lambda state: state)(new)

    def predict(self, state, t, sigma=None):
        found = self.good.predict(state, t, sigma)
        return self.changes.get("predict", lambda found, state: found)(found, state)


def spoil_input(result, t, z):
    if len(z) > 2:
        z[2] = 0.0
    return result


def shift(result, t, z):
    return replace(result, predicted=result.predicted + z.ndim * 1e-12)


def narrow(result, t, z):
    return replace(result, velocity=result.velocity[..., :1])


def zero_gains(result, t, z):
    gains = replace(result.gains, alpha=np.nan_to_num(result.gains.alpha))
    return replace(result, gains=gains)


def drift(state):
    return replace(state, lanes=state.lanes + 1e-9)


def spoil_state(found, state):
    state.lanes[0] += 1.0
    return found


def hurry(found, state):
    return replace(found, velocity=found.velocity * (1 + 1e-15))


def boast(found, state):
    return replace(found, innovation_variance=np.full(found.position.shape, 100.0))


def one_for_all(found, state):
    return replace(found, position_variance=np.array(1.0))


def less_than_nothing(found, state):
    variance = np.full(found.position.shape, -1.0)
    return replace(found, position_variance=variance, innovation_variance=variance + 100.0)


@pytest.mark.parametrize(
    ("changes", "promise"),
    [
        ({"predict": spoil_state}, "predict must leave the state as it is"),
        ({"predict": hurry}, "equal a step with a missed plot: velocity differs"),
        ({"predict": boast}, "must be position_variance plus the variance of the plot"),
        ({"predict": one_for_all}, r"position_variance must have the shape \(2,\)"),
        ({"predict": less_than_nothing}, "position_variance must not be negative"),
        ({"run": spoil_input}, "run must leave its inputs as they are|same track"),
        ({"run": shift}, "batch must equal its tracks one by one|must be the prediction"),
        ({"run": narrow}, "velocity must have the shape"),
        ({"run": zero_gains}, "innovation and gains must be NaN"),
        ({"step": drift}, "streaming must equal run"),
    ],
)
def test_faulty_trackers(changes, promise):
    with pytest.raises(AssertionError, match=promise):
        check_tracker(Faulty(**changes))


class Accepting(Faulty):
    """Swallows bad input."""

    def run(self, t, z, sigma=None):
        z = np.where(np.isinf(z), np.nan, z)
        return super().run(t, z, sigma)


def test_bad_input_must_not_be_swallowed():
    with pytest.raises(AssertionError, match="an infinite plot must raise ValueError"):
        check_tracker(Accepting())


class Timeless(Faulty):
    """Predicts for times gone by, too."""

    def predict(self, state, t, sigma=None):
        return super().predict(state, np.where(t > state.time, t, state.time + 1.0), sigma)


def test_times_gone_by_must_be_refused():
    with pytest.raises(AssertionError, match=r"a time that is not later .* must raise ValueError"):
        check_tracker(Timeless())


class Confident(KalmanCV):
    """Presumes less noise than there is when it is asked for a prediction."""

    def prediction_variance(self, memory, dt):
        return 0.99 * super().prediction_variance(memory, dt)


def test_a_variance_must_be_that_of_the_covariance():
    tracker = ft.AlphaBetaTracker(Confident(1.0))
    with pytest.raises(AssertionError, match="must be that of track_covariance"):
        check_tracker(tracker)


def test_a_tracker_has_four_verbs():
    with pytest.raises(AssertionError, match="must have run, start, step and predict"):
        check_tracker(ft.FixedGains(0.5, 0.2))
