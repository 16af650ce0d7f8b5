"""What every tracker promises, and every `LaneTracker`, a function for each promise."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np

from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.testing.kernel_words import foreign_word
from fuzzytrack.testing.prediction_checks import (
    predict_equals_missed_plot,
    variance_equals_track_covariance,
)
from fuzzytrack.testing.samples import (
    AXES,
    SIGMA,
    STEPS,
    TRACKS,
    arrays,
    expect,
    expect_refused,
    expect_same,
    sample_plots,
)
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.trackers.runners import runner

__all__ = [
    "LANE_CHECKS",
    "TRACKER_CHECKS",
    "compiled_equals_plain",
    "equals_pickled_copy",
    "hashable",
    "rows_left_out",
]


def hashable(subject: GainScheduler | LaneTracker, seed: int) -> None:
    """It can be a key, by which compiled code is found again."""
    name = type(subject).__name__
    try:
        hash(subject)
    except TypeError:
        raise AssertionError(f"{name} must be hashable: make it a frozen dataclass") from None


def equals_pickled_copy(subject: GainScheduler | LaneTracker, seed: int) -> None:
    """It can be sent to another process, and its copy is equal to it."""
    name = type(subject).__name__
    try:
        copy = pickle.loads(pickle.dumps(subject))
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise AssertionError(
            f"{name} must pickle ({error}): define the class at the top of a module"
        ) from None
    expect(copy == subject, f"{name} must equal its pickled copy: make it a frozen dataclass")


def program_uses_numbers_only(tracker: LaneTracker, seed: int) -> None:
    """The step, and what it calls, refers to nothing that cannot be compiled."""
    found = foreign_word(tracker.program(AXES if tracker.coupled else 1).step(1))
    expect(found is None, str(found))


def same_plots_give_the_same_track(tracker: Tracker, seed: int) -> None:
    """Two runs give the same numbers."""
    times, plots = sample_plots(seed)
    first = tracker.run(times, plots, SIGMA)
    again = tracker.run(times, plots, SIGMA)
    expect_same(arrays(first), arrays(again), "the same plots must give the same track")


def inputs_are_left_alone(tracker: Tracker, seed: int) -> None:
    """A run does not write to its arguments."""
    times, plots = sample_plots(seed)
    times_before, plots_before = times.copy(), plots.copy()
    tracker.run(times, plots, SIGMA)
    untouched = np.array_equal(times, times_before) and np.array_equal(
        plots, plots_before, equal_nan=True
    )
    expect(untouched, "run must leave its inputs as they are")


def results_have_the_shape_of_plots(tracker: Tracker, seed: int) -> None:
    """One track, batches of any number of axes, one plot, and none."""
    times, plots = sample_plots(seed)
    for z in (plots[:, 0], plots, plots.reshape(STEPS, 1, TRACKS, AXES), plots[:, :, :1]):
        for name, array in arrays(tracker.run(times, z, SIGMA)).items():
            expect(
                array.shape == z.shape,
                f"{name} must have the shape {z.shape} of the plots, has {array.shape}",
            )
    for z in (plots[:1, 0], plots[:0, 0], plots[:, :0]):
        result = tracker.run(times[: len(z)], z, SIGMA)
        expect(result.predicted.shape == z.shape, f"plots of shape {z.shape} must be tracked")


def missed_plots_are_coasted(tracker: Tracker, seed: int) -> None:
    """Where a plot is missed the position is the prediction, and there are no gains."""
    times, plots = sample_plots(seed)
    result = tracker.run(times, plots[:, 0], SIGMA)
    known = np.isnan(plots[:, 0]).any(axis=-1) & ~np.isnan(result.predicted).any(axis=-1)
    expect(bool(known.any()), "predictions must go on while plots are missed")
    expect(
        np.array_equal(result.filtered[known], result.predicted[known]),
        "where a plot is missed, the filtered position must be the prediction",
    )
    expect(
        bool(
            np.isnan(result.innovation[known]).all() and np.isnan(result.gains.alpha[known]).all()
        ),
        "where a plot is missed, innovation and gains must be NaN",
    )
    expect(bool(np.isfinite(result.filtered[-4:]).all()), "a track must recover from missed plots")


def batch_equals_single(tracker: Tracker, seed: int) -> None:
    """A batch gives the numbers of its tracks one by one; times are common or each track's own."""
    times, plots = sample_plots(seed)
    batch = arrays(tracker.run(times, plots, SIGMA))
    own_times = np.repeat(times[:, None], TRACKS, axis=1)
    expect_same(
        batch, arrays(tracker.run(own_times, plots, SIGMA)), "times may be each track's own"
    )
    for track in range(TRACKS):
        alone = arrays(tracker.run(times, plots[:, track], SIGMA))
        part = {name: array[:, track] for name, array in batch.items()}
        expect_same(part, alone, f"a batch must equal its tracks one by one (track {track})")


def streaming_equals_run(tracker: Tracker, seed: int) -> None:
    """Plot by plot, and pickled half way, a track has the numbers of a run."""
    times, plots = sample_plots(seed)
    for z in (plots[:, 0], plots):
        whole = arrays(tracker.run(times, z, SIGMA))
        state = tracker.start(z[0], times[0], SIGMA)
        for k in range(1, STEPS):
            if k == STEPS // 2:
                state = pickle.loads(pickle.dumps(state))
            state = tracker.step(state, z[k], times[k], SIGMA)
            now = {name: array[k] for name, array in whole.items()}
            expect_same(now, arrays(state), f"streaming must equal run (step {k})")


def bad_input_is_refused(tracker: Tracker, seed: int) -> None:
    """Plots and times that cannot be tracked raise ValueError."""
    times, batch = sample_plots(seed)
    plots = batch[:, 0]
    infinite, repeated = plots.copy(), times.copy()
    infinite[3, 0] = np.inf
    repeated[5] = repeated[4]
    bad: dict[str, Callable[[], Any]] = {
        "an infinite plot": lambda: tracker.run(times, infinite, SIGMA),
        "a repeated time": lambda: tracker.run(repeated, plots, SIGMA),
        "falling times": lambda: tracker.run(times[::-1], plots, SIGMA),
        "times of another length": lambda: tracker.run(times[:-1], plots, SIGMA),
    }
    for what, call in bad.items():
        expect_refused(call, what)


def compiled_equals_plain(tracker: LaneTracker, seed: int) -> None:
    """Compiled code gives the numbers of plain Python, to the last bit."""
    times, plots = sample_plots(seed)
    n_axes = AXES if tracker.coupled else 1
    core = runner(tracker, n_axes)
    lanes = plots.reshape(STEPS, -1, n_axes)
    together, apart = times[:, None], np.repeat(times[:, None], lanes.shape[1], axis=1)
    sigmas = np.full((1, 1, 1), SIGMA)
    fresh = core.fresh(lanes.shape[1])
    plain_state, plain = core(fresh, lanes, together, sigmas, native=False)
    # Together and each by itself, a track may take other ways through the code.
    for given in (together, apart):
        native_state, native = core(fresh, lanes, given, sigmas, native=True)
        expect_same(plain, native, "compiled code must equal plain Python to the last bit")
        expect(
            np.array_equal(plain_state, native_state, equal_nan=True),
            "compiled code must leave the same state as plain Python",
        )


def rows_left_out(tracker: LaneTracker, seed: int) -> None:
    """Rows without a plot and rows left out give the same numbers, unless time goes by steps.

    A tracker that counts missed plots is the exception.
    """
    if tracker.missed != "elapsed" or tracker.sees_misses:
        return
    times, plots = sample_plots(seed)
    n_axes = AXES if tracker.coupled else 1
    core = runner(tracker, n_axes)
    lanes, sigmas = plots.reshape(STEPS, -1, n_axes), np.full((1, 1, 1), SIGMA)
    seen = np.asarray(~np.isnan(lanes).any(axis=2))
    for native in (False, True):
        state, whole = core(None, lanes, times[:, None], sigmas, native)
        for lane in range(lanes.shape[1]):
            rows = seen[:, lane]
            one = lanes[rows, lane : lane + 1]
            own_state, alone = core(None, one, times[rows, None], sigmas, native)
            part = {name: array[rows, lane] for name, array in whole.items()}
            own = {name: array[:, 0] for name, array in alone.items()}
            expect_same(part, own, "rows without a plot must give the numbers of rows left out")
            kept = slice(0, core.rows.state)
            expect(
                np.array_equal(state[kept, lane], own_state[kept, 0]),
                "rows without a plot must leave the state as it is",
            )


#: Checks of every tracker, by name.
TRACKER_CHECKS: dict[str, Callable[[Any, int], None]] = {
    "results-have-shape-of-plots": results_have_the_shape_of_plots,
    "same-plots-give-same-track": same_plots_give_the_same_track,
    "inputs-left-alone": inputs_are_left_alone,
    "missed-plots-coasted": missed_plots_are_coasted,
    "batch-equals-single": batch_equals_single,
    "streaming-equals-run": streaming_equals_run,
    "predict-equals-missed-plot": predict_equals_missed_plot,
    "variance-equals-track-covariance": variance_equals_track_covariance,
    "bad-input-refused": bad_input_is_refused,
}

#: Checks of a `LaneTracker`, by name.
LANE_CHECKS: dict[str, Callable[[Any, int], None]] = {
    "hashable": hashable,
    "equals-pickled-copy": equals_pickled_copy,
    "program-uses-numbers-only": program_uses_numbers_only,
    **TRACKER_CHECKS,
    "compiled-equals-plain": compiled_equals_plain,
    "rows-left-out": rows_left_out,
}
