"""Conformance kit: one call in one test proves that a plug-in keeps the contract.

`check_scheduler` and `check_tracker` raise `AssertionError` with the first promise that is broken.
"""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.trackers.alpha_beta import STARTS, AlphaBetaTracker
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker, runner
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import TrackState

__all__ = ["check_scheduler", "check_tracker"]


_STEPS, _TRACKS, _AXES = 24, 5, 2
_SIGMA = 10.0


def check_scheduler(scheduler: GainScheduler, seed: int = 0) -> None:
    """Check that a scheduler keeps the contract of `fuzzytrack.schedulers.base.GainScheduler`.

    Checked are: immutability (equal hash and answers after pickling), memory and gains of the
    right form at ordinary and extreme innovations, and, through an `fuzzytrack.AlphaBetaTracker`
    with either start, all that `check_tracker` checks; compiled with one start, since a kernel is
    compiled in the same way for the other.

    Parameters
    ----------
    scheduler : GainScheduler
    seed : int
        Seed of the random plots.

    Raises
    ------
    AssertionError
        If a promise is broken; says which.
    """
    _expect(isinstance(scheduler, GainScheduler), "must be a GainScheduler")
    name = type(scheduler).__name__
    try:
        hash(scheduler)
    except TypeError:
        raise AssertionError(f"{name} must be hashable: make it a frozen dataclass") from None
    copy = pickle.loads(pickle.dumps(scheduler))
    _expect(copy == scheduler, f"{name} must equal its pickled copy")
    n_axes = _AXES if scheduler.coupled else 1
    _check_kernel(scheduler, n_axes)
    for start in STARTS:
        _check_behaviour(AlphaBetaTracker(scheduler, start), seed)
        _check_same_run(AlphaBetaTracker(scheduler, start), AlphaBetaTracker(copy, start), seed)
    _check_compiled(AlphaBetaTracker(scheduler), seed)


def check_tracker(tracker: Tracker, seed: int = 0) -> None:
    """Check that a tracker keeps the contract of `fuzzytrack.trackers.base.Tracker`.

    Checked are: shapes of one track and of batches, coasting on missed plots, irregular times,
    that a batch equals its tracks one by one, that streaming equals `run` to the last bit, pickling
    of the state in the middle of a track, determinism, that inputs are left alone, that bad input
    raises ValueError, and of a `fuzzytrack.trackers.lane_tracker.LaneTracker` that it gives the
    same to the last bit when compiled.

    Parameters
    ----------
    tracker : Tracker
    seed : int
        Seed of the random plots.

    Raises
    ------
    AssertionError
        If a promise is broken; says which.
    """
    _expect(isinstance(tracker, Tracker), "must have run, start and step")
    _check_behaviour(tracker, seed)
    if isinstance(tracker, LaneTracker):
        _check_compiled(tracker, seed)


def _check_behaviour(tracker: Tracker, seed: int) -> None:
    times, plots = _plots(seed)
    _check_determinism(tracker, times, plots)
    _check_shapes(tracker, times, plots)
    _check_coasting(tracker, times, plots)
    _check_one_by_one(tracker, times, plots)
    _check_streaming(tracker, times, plots)
    _check_errors(tracker, times, plots[:, 0])


def _expect(holds: bool, promise: str) -> None:
    if not holds:
        raise AssertionError(promise)


def _plots(seed: int) -> tuple[Array, Array]:
    """Irregular times, and noisy turning tracks with missed plots, also in one axis alone."""
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.5, 2.0, _STEPS))
    angle = np.outer(times, random.uniform(-0.1, 0.1, _TRACKS))
    plots = 1e3 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    plots += random.normal(0.0, _SIGMA, plots.shape)
    plots[random.random((_STEPS, _TRACKS)) < 0.15] = np.nan
    plots[9:12, 0] = np.nan
    plots[:2, 1] = np.nan
    plots[7, 2, 0] = np.nan
    return times, plots


def _arrays(result: TrackResult | TrackState) -> dict[str, Array]:
    names = ("predicted", "velocity", "acceleration", "innovation")
    arrays = {name: getattr(result, name) for name in names}
    position = result.filtered if isinstance(result, TrackResult) else result.position
    gains = result.gains
    return {
        **arrays, "filtered": position,
        "alpha": gains.alpha, "beta": gains.beta, "gamma": gains.gamma,
    }  # fmt: skip


def _expect_same(one: dict[str, Array], other: dict[str, Array], promise: str) -> None:
    for name, array in one.items():
        _expect(np.array_equal(array, other[name], equal_nan=True), f"{promise}: {name} differs")


def _check_shapes(tracker: Tracker, times: Array, plots: Array) -> None:
    for z in (plots[:, 0], plots, plots.reshape(_STEPS, 1, _TRACKS, _AXES), plots[:, :, :1]):
        for name, array in _arrays(tracker.run(times, z, _SIGMA)).items():
            _expect(
                array.shape == z.shape,
                f"{name} must have the shape {z.shape} of the plots, has {array.shape}",
            )
    for z in (plots[:1, 0], plots[:0, 0], plots[:, :0]):
        result = tracker.run(times[: len(z)], z, _SIGMA)
        _expect(result.predicted.shape == z.shape, f"plots of shape {z.shape} must be tracked")


def _check_determinism(tracker: Tracker, times: Array, plots: Array) -> None:
    times_before, plots_before = times.copy(), plots.copy()
    first = tracker.run(times, plots, _SIGMA)
    again = tracker.run(times, plots, _SIGMA)
    _expect_same(_arrays(first), _arrays(again), "the same plots must give the same track")
    untouched = np.array_equal(times, times_before) and np.array_equal(
        plots, plots_before, equal_nan=True
    )
    _expect(untouched, "run must leave its inputs as they are")


def _check_coasting(tracker: Tracker, times: Array, plots: Array) -> None:
    result = tracker.run(times, plots[:, 0], _SIGMA)
    known = np.isnan(plots[:, 0]).any(axis=-1) & ~np.isnan(result.predicted).any(axis=-1)
    _expect(bool(known.any()), "predictions must go on while plots are missed")
    _expect(
        np.array_equal(result.filtered[known], result.predicted[known]),
        "where a plot is missed, the filtered position must be the prediction",
    )
    _expect(
        bool(
            np.isnan(result.innovation[known]).all() and np.isnan(result.gains.alpha[known]).all()
        ),
        "where a plot is missed, innovation and gains must be NaN",
    )
    _expect(bool(np.isfinite(result.filtered[-4:]).all()), "a track must recover from missed plots")


def _check_one_by_one(tracker: Tracker, times: Array, plots: Array) -> None:
    batch = _arrays(tracker.run(times, plots, _SIGMA))
    own_times = np.repeat(times[:, None], _TRACKS, axis=1)
    _expect_same(
        batch, _arrays(tracker.run(own_times, plots, _SIGMA)), "times may be each track's own"
    )
    for track in range(_TRACKS):
        alone = _arrays(tracker.run(times, plots[:, track], _SIGMA))
        part = {name: array[:, track] for name, array in batch.items()}
        _expect_same(part, alone, f"a batch must equal its tracks one by one (track {track})")


def _check_streaming(tracker: Tracker, times: Array, plots: Array) -> None:
    for z in (plots[:, 0], plots):
        whole = _arrays(tracker.run(times, z, _SIGMA))
        state = tracker.start(z[0], times[0], _SIGMA)
        for k in range(1, _STEPS):
            if k == _STEPS // 2:
                state = pickle.loads(pickle.dumps(state))
            state = tracker.step(state, z[k], times[k], _SIGMA)
            now = {name: array[k] for name, array in whole.items()}
            _expect_same(now, _arrays(state), f"streaming must equal run (step {k})")


def _check_errors(tracker: Tracker, times: Array, plots: Array) -> None:
    infinite, repeated = plots.copy(), times.copy()
    infinite[3, 0] = np.inf
    repeated[5] = repeated[4]
    bad: dict[str, Callable[[], Any]] = {
        "an infinite plot": lambda: tracker.run(times, infinite, _SIGMA),
        "a repeated time": lambda: tracker.run(repeated, plots, _SIGMA),
        "falling times": lambda: tracker.run(times[::-1], plots, _SIGMA),
        "times of another length": lambda: tracker.run(times[:-1], plots, _SIGMA),
    }
    for what, call in bad.items():
        try:
            call()
        except ValueError:
            continue
        raise AssertionError(f"{what} must raise ValueError")


def _check_same_run(one: Tracker, other: Tracker, seed: int) -> None:
    times, plots = _plots(seed)
    _expect_same(
        _arrays(one.run(times, plots, _SIGMA)),
        _arrays(other.run(times, plots, _SIGMA)),
        "a pickled scheduler must give the same gains",
    )


def _check_kernel(scheduler: GainScheduler, n_axes: int) -> None:
    memory = tuple(scheduler.initial_memory(n_axes))
    kernel = scheduler.kernel(n_axes)
    magnitudes = (0.0, 1e-12, 1.0, -3.0, 50.0, -1e9)
    for innovation in magnitudes:
        for change in magnitudes:
            arguments: tuple[Any, Any, float, Any] = (innovation, change, 0.5, _SIGMA)
            if scheduler.coupled:
                arguments = (
                    (innovation,) * n_axes, (change,) * n_axes, 0.5, (_SIGMA,) * n_axes
                )  # fmt: skip
            answer = kernel(*arguments, memory)
            where = f"kernel at innovation {innovation:g}, change {change:g}"
            _expect(len(answer) == 5, f"{where}: must return alpha, beta, gamma, phi, memory")
            numbers = (*answer[:4], *answer[4])
            _expect(
                all(isinstance(n, float) and math.isfinite(n) for n in numbers),
                f"{where}: gains and memory must be finite floats, got {answer}",
            )
            _expect(
                answer[2] == 0.0 or scheduler.uses_acceleration,
                f"{where}: gamma must be 0 unless uses_acceleration is set, got {answer[2]:g}",
            )
            _expect(
                len(answer[4]) == len(memory),
                f"{where}: memory must keep its length {len(memory)}, got {len(answer[4])}",
            )
            _expect(kernel(*arguments, memory) == answer, f"{where}: must depend on nothing else")


def _check_compiled(tracker: LaneTracker, seed: int) -> None:
    times, plots = _plots(seed)
    n_axes = _AXES if tracker.coupled else 1
    core = runner(tracker, n_axes)
    lanes = plots.reshape(_STEPS, -1, n_axes)
    dts = np.diff(times, prepend=times[0])[:, None]
    sigmas = np.full((1, 1, 1), _SIGMA)
    fresh = core.fresh(lanes.shape[1])
    plain_state, plain = core(fresh, lanes, dts, sigmas, native=False)
    own_dts = np.repeat(dts, lanes.shape[1], axis=1)
    # Together and each by itself, a track may take other ways through the code.
    for steps in (dts, own_dts):
        native_state, native = core(fresh, lanes, steps, sigmas, native=True)
        _expect_same(plain, native, "compiled code must equal plain Python to the last bit")
        _expect(
            np.array_equal(plain_state, native_state, equal_nan=True),
            "compiled code must leave the same state as plain Python",
        )
