"""Conformance kit: one call in one test proves that a plug-in keeps the contract.

`check_scheduler` and `check_tracker` raise `AssertionError` with the first promise that is broken.
"""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.normalizations.predicted import Predicted
from fuzzytrack.schedulers.base import GainScheduler
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.schedulers.kalman_ca import KalmanCA
from fuzzytrack.schedulers.kalman_cv import KalmanCV
from fuzzytrack.trackers.alpha_beta import STARTS, AlphaBetaTracker
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.covariance import track_covariance
from fuzzytrack.trackers.lane_tracker import LaneTracker, runner
from fuzzytrack.trackers.prediction import Prediction
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
    that a batch equals its tracks one by one, that streaming equals `run` to the last bit, that
    `predict` equals a step with a missed plot and tells the innovation variance of
    `fuzzytrack.trackers.covariance.track_covariance` where that knows the model, pickling of the
    state in the middle of a track, determinism, that inputs are left alone, that bad input
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
    _expect(isinstance(tracker, Tracker), "must have run, start, step and predict")
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
    _check_prediction(tracker, times, plots)
    _check_innovation_variance(tracker, times, plots)
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


def _check_prediction(tracker: Tracker, times: Array, plots: Array) -> None:
    own_delay = np.linspace(0.0, 1.0, _TRACKS)
    for k in (1, 2, 3, 10, _STEPS - 1):
        for z, delay in ((plots[:, 0], 0.0), (plots, 0.0), (plots, own_delay)):
            state, t = tracker.run(times[:k], z[:k], _SIGMA).state, times[k] + delay
            assert state is not None
            before = pickle.dumps(state)
            found = tracker.predict(state, t, _SIGMA)
            _expect(pickle.dumps(state) == before, "predict must leave the state as it is")
            coasted = tracker.step(state, np.full(z[k].shape, np.nan), t, _SIGMA)
            for name in ("time", "position", "velocity", "acceleration"):
                _expect(
                    np.array_equal(getattr(found, name), getattr(coasted, name), equal_nan=True),
                    f"predict must equal a step with a missed plot: {name} differs (step {k})",
                )
            _check_variances(found, z[k].shape)
    _check_late_predictions(tracker, tracker.start(plots[0], 5.0, _SIGMA))


def _check_late_predictions(tracker: Tracker, state: TrackState) -> None:
    for t in (5.0, 4.0, math.nan):
        _expect_refused(
            partial(tracker.predict, state, t, _SIGMA),
            "to predict for a time that is not later than that of the state",
        )


def _check_variances(found: Prediction, shape: tuple[int, ...]) -> None:
    variance, s = found.position_variance, found.innovation_variance
    for name, array in (("position_variance", variance), ("innovation_variance", s)):
        _expect(
            array.shape == shape,
            f"{name} must have the shape {shape} of the plots, has {array.shape}",
        )
    _expect(
        np.array_equal(s, variance + _SIGMA**2, equal_nan=True),
        "innovation_variance must be position_variance plus the variance of the plot",
    )
    _expect(not (variance < 0).any(), "position_variance must not be negative")


def _check_innovation_variance(tracker: Tracker, times: Array, plots: Array) -> None:
    model = _model(tracker)
    if model is None:
        return
    # A tracker with a noise of its own does not see that of the plots.
    sigma = getattr(tracker, "sigma_w", None) or _SIGMA
    known = track_covariance(tracker.run(times, plots, sigma), sigma, **model).innovation_variance
    state = tracker.start(plots[0], times[0], sigma)
    for k in range(1, _STEPS):
        found = tracker.predict(state, times[k], sigma).innovation_variance
        there = ~np.isnan(known[k])
        _expect(
            bool((abs(found[there] - known[k][there]) <= 1e-12 * known[k][there]).all()),
            f"innovation_variance must be that of track_covariance (step {k})",
        )
        state = tracker.step(state, plots[k], times[k], sigma)


def _model(tracker: Tracker) -> dict[str, Any] | None:
    """Arguments of `track_covariance` for the model behind a tracker's variances, if they fit."""
    if not isinstance(tracker, AlphaBetaTracker):
        return None
    scheduler, two_point = tracker.scheduler, tracker.start_mode == "two-point"
    if isinstance(scheduler, FuzzyScheduler) and isinstance(scheduler.normalization, Predicted):
        still = 0.0 if scheduler.uses_acceleration else None
        return {"sigma_v": 0.0, "acceleration_sigma": still} if two_point else None
    # What is presumed of a new track's velocity is for the start that uses it.
    if not isinstance(scheduler, KalmanCV | KalmanCA) or (two_point and scheduler.velocity_sigma):
        return None
    return {
        "sigma_v": scheduler.sigma_v,
        "velocity_sigma": scheduler.velocity_sigma,
        "acceleration_sigma": getattr(scheduler, "acceleration_sigma", None),
    }


def _expect_refused(call: Callable[[], Any], what: str) -> None:
    try:
        call()
    except ValueError:
        return
    raise AssertionError(f"{what} must raise ValueError")


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
        _expect_refused(call, what)


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
