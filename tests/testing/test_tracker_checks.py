"""The checks of trackers fail what breaks the contract."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from subjects import Faulty, run_check

import fuzzytrack as ft
from fuzzytrack.errors import PluginError
from fuzzytrack.schedulers import KalmanCV
from fuzzytrack.testing import check_tracker, checks_for
from fuzzytrack.trackers import LaneProgram, LaneTracker, Rows, single_axis_step


@dataclass(frozen=True)
class Corrected(LaneTracker):
    """A tracker with fixed gains whose `correct` is replaced."""

    kind: str

    def program(self, n_axes):
        rows = Rows(n_axes, 0)

        def four_answers(b, lane, z, prediction, velocity, dt, gap, sigma, update, starts):
            return prediction, prediction, 0.5, 0.1

        def nine_arguments(b, lane, z, prediction, velocity, dt, gap, sigma, update):
            return prediction, prediction, velocity, 0.5, 0.1

        def divides(b, lane, z, prediction, velocity, dt, gap, sigma, update, starts):
            return prediction, prediction, velocity, 0.5 / (0.0 * gap), 0.1

        correct = locals()[self.kind]
        return LaneProgram(rows, (), lambda stride: single_axis_step(rows, stride, correct))


@pytest.mark.parametrize(
    ("kind", "error"),
    [
        ("four_answers", r"not enough values to unpack \(expected 5, got 4\)"),
        ("nine_arguments", "takes 9 positional arguments but 10 were given"),
    ],
)
def test_what_correct_takes_and_returns(kind, error):
    expected = (
        r"Corrected: correct must take \(buffer, lane, z, .*, update, starts\) and return "
        rf"\(prediction, position, velocity, alpha, beta\); .*{error}$"
    )
    with pytest.raises(AssertionError, match=f"^results-have-shape-of-plots: {expected}"):
        check_tracker(Corrected(kind))
    with pytest.raises(PluginError, match=expected) as caught:
        Corrected(kind).start(0.0, 0.0)
    assert caught.value.location.file == __file__


def test_an_error_inside_of_correct_is_its_own():
    with pytest.raises(AssertionError, match="Corrected raises ZeroDivisionError: float division"):
        check_tracker(Corrected("divides"))
    with pytest.raises(ZeroDivisionError) as caught:
        Corrected("divides").run([0.0, 1.0], [0.0, 1.0])
    assert caught.value.__notes__ == ["in a step of Corrected"]


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
    with pytest.raises(AssertionError, match="must have run, start, step and predict, got FixedG"):
        check_tracker(ft.FixedGains(0.5, 0.2))
    with pytest.raises(AssertionError, match="got the class Faulty; give an object"):
        list(checks_for(Faulty))


@dataclass(frozen=True)
class Counting(LaneTracker):
    """Fixed gains that fall with every row without a plot, or with none."""

    counts: bool = False
    keeps: bool = True
    sees_misses: bool = False
    missed: str = "elapsed"

    def program(self, n_axes):
        rows = Rows(n_axes, 1)
        row, counts = rows.memory, self.counts

        def make(stride):
            def correct(b, lane, z, prediction, velocity, dt, gap, sigma, update, starts):
                b[row * stride + lane] += 1.0 if counts & (z != z) else 0.0
                alpha = 0.5 / (1.0 + b[row * stride + lane])
                e = z - prediction if update else 0.0
                return prediction, prediction + alpha * e, velocity + 0.1 / dt * e, alpha, 0.1

            return single_axis_step(rows, stride, correct)

        return LaneProgram(rows, (0.0,), make, keeps_state=self.keeps)


@pytest.mark.parametrize(
    "tracker",
    [
        Counting(counts=True, keeps=False),
        Counting(counts=True, sees_misses=True),
        Counting(counts=True, missed="step"),
    ],
    ids=["restored", "declared", "by steps"],
)
def test_rows_left_out_may_count_where_that_is_told(tracker):
    run_check("rows-left-out", tracker)


def test_rows_left_out_must_not_count():
    with pytest.raises(AssertionError, match=r"^rows-left-out: rows without a plot must"):
        run_check("rows-left-out", Counting(counts=True))
    # Also without a count, this step writes what a track that coasts has.
    with pytest.raises(AssertionError, match=r"^rows-left-out: rows without a plot must"):
        run_check("rows-left-out", Counting())
