"""Trackers whose arithmetic runs over lanes: at once or plot by plot, with the same numbers."""

from __future__ import annotations

import math
import operator
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.lanes.runner import InfinitePlotError, Runner
from fuzzytrack.trackers.compiled_step import Hop
from fuzzytrack.trackers.result import TrackResult, checked_keep
from fuzzytrack.trackers.state import Gains, TrackState, spread

__all__ = ["LaneTracker", "announce", "runner"]


GAINS = ("alpha", "beta", "gamma")
#: Shapes of plots for which a tracker keeps a short way to the next state.
_HOPS = 64


class LaneTracker(ABC):
    """A tracker that is given by its lane program; all of `fuzzytrack.Tracker` follows from it.

    It is immutable and hashable, and must pickle: make it a frozen dataclass.

    Attributes
    ----------
    coupled : bool
        Whether a lane is a whole track, and not one of its axes.
    needs_sigma : bool
        Whether plots need a standard deviation.
    """

    coupled: bool = False
    needs_sigma: bool = False

    @property
    def name(self) -> str:
        """Name for messages."""
        return type(self).__name__

    @abstractmethod
    def program(self, n_axes: int) -> LaneProgram:
        """The arithmetic of a lane.

        Parameters
        ----------
        n_axes : int
            Axes of a lane: 1 unless the tracker is coupled.
        """

    def run(
        self,
        t: ArrayLike,
        z: ArrayLike,
        sigma: ArrayLike | None = None,
        *,
        state: TrackState | None = None,
        keep: Sequence[str] | None = None,
        threads: int | None = None,
        dtype: DTypeLike = np.float64,
    ) -> TrackResult:
        """Track plots over time.

        Parameters
        ----------
        t : array_like, shape (n_steps,) or (n_steps, ...batch)
            Times (s), strictly increasing; for a batch, common or each track's own.
        z : array_like, shape (n_steps,), (n_steps, n_axes) or (n_steps, ...batch, n_axes)
            Plots (m); NaN where missed.
        sigma : array_like, optional
            Standard deviation of the plots (m), broadcast against `z`; needed by some schedulers.
        state : TrackState, optional
            State from which to go on; a new track unless given.
        keep : sequence of str, optional
            What the result is to hold, out of `fuzzytrack.trackers.result.KEPT`: predicted,
            filtered, velocity, acceleration, innovation, gains. All of it unless given. Less is
            faster, and takes less memory.
        threads : int, optional
            Threads that share the tracks of a large job; all processors unless given. The numbers
            do not depend on it.
        dtype : dtype
            np.float64, or np.float32 for half the memory and more speed: plots and results are
            then rounded to 7 digits, and so is every operation, so give coordinates from an origin
            nearby. Such a run is always compiled.

        Returns
        -------
        TrackResult

        Raises
        ------
        DataError
            If a plot is infinite, or times are not finite and increasing; says where.
        ValueError
            If shapes do not fit, the scheduler needs `sigma`, a name in `keep` is unknown,
            `threads` is less than 1, `dtype` is another, or the tracker works with numbers that
            are too large or too small for it.
        """
        wanted = checked_keep(keep)
        _check_threads(threads)
        plots, times = _as_plots(z, dtype), _as_times(t, state)
        layout = _Layout.of(plots, self.coupled)
        core = runner(self, layout.lane_axes)
        _check_state(plots, state, core.rows)
        dts = _time_steps(times, plots.shape, state)
        deviation = self._sigma(sigma, plots)
        if plots.dtype == np.float32:
            _check_single("t: a time step of", dts, times)
            _check_single("sigma:", deviation, plots)
        sigmas = layout.to_lanes(deviation)
        try:
            after, raw = core(
                None if state is None else state.lanes,
                layout.to_lanes(plots),
                layout.times_to_lanes(dts),
                sigmas,
                keep=[part for name in wanted for part in (GAINS if name == "gains" else (name,))],
                threads=threads,
            )
        except InfinitePlotError:
            raise _infinite_plot(plots) from None
        outputs: dict[str, Any] = {name: layout.from_lanes(raw[name]) for name in raw}
        if "gains" in wanted:
            outputs["gains"] = Gains(*(outputs.pop(name) for name in GAINS))
        last = state
        if len(plots):
            last = TrackState(times[-1].copy(), plots.shape[1:], after, core.rows)
        return TrackResult.of(times, plots, last, outputs)

    def start(self, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None = None) -> TrackState:
        """State of a new track, or batch of tracks, after a first plot.

        Parameters
        ----------
        z : array_like, shape (), (n_axes,) or (...batch, n_axes)
            Plot (m).
        t : array_like, shape () or (...batch)
            Its time (s).
        sigma : array_like, optional
            Its standard deviation (m).
        """
        return self._one_step(None, z, t, sigma)

    def step(
        self, state: TrackState, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None = None
    ) -> TrackState:
        """State after one more plot; equals `run` to the last bit.

        Parameters
        ----------
        state : TrackState
            From `start`, `step` or a result.
        z, t, sigma : array_like
            As for `start`; the time later than that of the state.

        Raises
        ------
        DataError, ValueError
            As for `run`.
        """
        hop = self._hops.get(state.shape) or self._new_hop(state)
        after = None if hop is None else hop(state, z, t, sigma)
        return self._one_step(state, z, t, sigma) if after is None else after

    def compile(self, n_axes: int = 1) -> None:
        """Compile now what `run` compiles when a job is large, and make `step` run compiled.

        Until then `step` runs in plain Python, unless a large `run` went before: a stream of plots
        never stops for the compiler. Compiled code is kept on disk for the next process.

        Parameters
        ----------
        n_axes : int
            Axes of the plots.
        """
        if operator.index(n_axes) < 1:
            raise ValueError(f"n_axes must be at least 1, got {n_axes}")
        runner(self, n_axes if self.coupled else 1).compile()

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_hops"}

    @cached_property
    def _hops(self) -> dict[tuple[int, ...], Hop]:
        """Short ways to a next state, by shape of the plots."""
        return {}

    def _new_hop(self, state: TrackState) -> Hop | None:
        """Short way from states like this one, if the tracker is compiled."""
        if len(self._hops) >= _HOPS:
            self._hops.clear()
        layout = _Layout.of(np.empty((0, *state.shape)), self.coupled)
        core = runner(self, layout.lane_axes)
        if core.hop is None:
            return None
        hop = self._hops[state.shape] = Hop(core, state.shape, layout.lanes, self.needs_sigma)
        return hop

    def _one_step(
        self, state: TrackState | None, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None
    ) -> TrackState:
        plots = _as_plots(z, np.float64)[None]
        times = _as_times(np.asarray(t)[None], state)
        layout = _Layout.of(plots, self.coupled)
        if np.isinf(plots).any():
            raise _infinite_plot(plots)
        core = runner(self, layout.lane_axes)
        _check_state(plots, state, core.rows)
        dts = layout.times_to_lanes(_time_steps(times, plots.shape, state))
        deviation = None if sigma is None else np.asarray(sigma, dtype=np.float64)[None]
        sigmas = layout.to_lanes(self._sigma(deviation, plots))
        shape = (layout.lanes, layout.lane_axes)
        lanes = core.fresh(layout.lanes) if state is None else state.lanes
        if core.native:
            after, _ = core(lanes, plots.reshape(1, *shape), dts, sigmas, True, (), 1)
        else:
            after = core.step(
                lanes,
                plots.reshape(shape),
                dts[0].tolist() * (layout.lanes if dts.shape[1] == 1 else 1),
                np.broadcast_to(sigmas[0], shape).tolist(),
            )
        return TrackState(times[0].copy(), plots.shape[1:], after, core.rows)

    def _sigma(self, sigma: ArrayLike | None, plots: Array) -> Array:
        if sigma is None:
            if self.needs_sigma:
                raise ValueError(
                    f"sigma: {self.name} needs the standard deviation of the plots (m)"
                )
            return np.full((1,) * plots.ndim, np.nan)
        values = np.asarray(sigma, dtype=np.float64)
        try:
            full = np.broadcast_to(values, plots.shape)
        except ValueError:
            raise ValueError(
                f"sigma: shape {values.shape} does not broadcast with the plots' {plots.shape}"
            ) from None
        fits = np.isfinite(values) & (values > 0)
        if not fits.all():
            bad = ~np.broadcast_to(fits, plots.shape) & ~np.isnan(plots)
            for place in np.argwhere(bad)[:1].tolist():
                raise ValueError(
                    "sigma must be positive and finite where there is a plot; at index "
                    f"{tuple(place)} it is {full[tuple(place)]:g}"
                )
        return values.reshape((1,) * (plots.ndim - values.ndim) + values.shape)


# Asked by identity first; comparing rule bases takes longer than a step.
@dataclass(frozen=True, eq=False)
class _Identity:
    tracker: LaneTracker

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Identity) and self.tracker is other.tracker

    def __hash__(self) -> int:
        return id(self.tracker)


def runner(tracker: LaneTracker, n_axes: int) -> Runner:
    """Runner of a tracker; equal trackers share one, and what was compiled for it.

    Parameters
    ----------
    tracker : LaneTracker
    n_axes : int
        Axes of a lane: 1 unless the tracker is coupled.
    """
    return _runner_of_this(_Identity(tracker), n_axes)


def announce(tracker: object, n_axes: int, coordinates: int) -> None:
    """Tell a tracker of a job in many parts, so that it is compiled from the first of them.

    Parameters
    ----------
    tracker : object
        A tracker; of one that is no `LaneTracker` nothing is asked.
    n_axes : int
        Axes of the plots.
    coordinates : int
        Number of coordinates in all.
    """
    if isinstance(tracker, LaneTracker):
        core = runner(tracker, n_axes if tracker.coupled else 1)
        core.horizon = max(core.horizon, core.work + coordinates)


@lru_cache(maxsize=256)
def _runner_of_this(key: _Identity, n_axes: int) -> Runner:
    return _runner_of_equal(key.tracker, n_axes)


@lru_cache(maxsize=64)
def _runner_of_equal(tracker: LaneTracker, n_axes: int) -> Runner:
    return Runner(tracker.program(n_axes))


@dataclass(frozen=True)
class _Layout:
    """How plots of a shape are laid out as lanes; see `fuzzytrack.lanes.runner`."""

    shape: tuple[int, ...]
    n_axes: int
    coupled: bool

    @classmethod
    def of(cls, plots: Array, coupled: bool) -> _Layout:
        if plots.ndim == 0:
            raise ValueError("z: needs a time axis; got a single number")
        n_axes = plots.shape[-1] if plots.ndim > 1 else 1
        if n_axes == 0:
            raise ValueError(f"z: needs at least one axis of space; got shape {plots.shape}")
        return cls(plots.shape, n_axes, coupled)

    @property
    def lane_axes(self) -> int:
        return self.n_axes if self.coupled else 1

    @property
    def lanes(self) -> int:
        return math.prod(self.shape[1:]) // self.lane_axes

    def to_lanes(self, values: NDArray[Any]) -> NDArray[Any]:
        """Array that broadcasts with the plots, to one that does with (n_steps, lanes, axes)."""
        if math.prod(values.shape[1:]) == 1:
            return values.reshape(-1, 1, 1)
        # What is the same at all times is not repeated.
        full = np.broadcast_to(values, (len(values), *self.shape[1:]))
        return full.reshape(len(values), self.lanes, self.lane_axes)

    def times_to_lanes(self, dts: Array) -> Array:
        if dts.ndim == 1:
            return dts[:, None]
        flat = dts.reshape(len(dts), math.prod(dts.shape[1:]))
        return np.repeat(flat, self.n_axes // self.lane_axes, axis=1)

    def from_lanes(self, values: Array) -> Array:
        """Output of the runner in the shape of the plots."""
        if values.ndim == 3:
            return values.reshape(self.shape)
        return spread(values, self.shape, self.lane_axes)


def _as_plots(z: ArrayLike, dtype: DTypeLike) -> NDArray[Any]:
    kind = np.dtype(dtype)
    if kind not in (np.dtype(np.float64), np.dtype(np.float32)):
        raise ValueError(f"dtype must be float64 or float32, got {kind}")
    if isinstance(z, np.ma.MaskedArray):
        z = np.ma.filled(z.astype(np.float64), np.nan)
    given = _real("z", z)
    # What is too large for it is found as an infinite plot.
    with np.errstate(over="ignore"):
        return np.asarray(given, dtype=kind)


def _as_times(t: ArrayLike, state: TrackState | None) -> Array:
    times = np.asarray(_real("t", t), dtype=np.float64)
    if not (state is None or isinstance(state, TrackState)):
        raise TypeError(f"state must be a TrackState, got {type(state).__name__}")
    if state is None or times.ndim != 1 or not np.ndim(state.time):
        return times
    # Tracks that had times of their own go on with common ones.
    common = times.reshape(-1, *(1,) * np.ndim(state.time))
    return np.broadcast_to(common, (len(times), *np.shape(state.time)))


def _real(name: str, values: ArrayLike) -> NDArray[Any]:
    given = np.asarray(values)
    if given.dtype.kind in "mMc":
        seconds = "seconds as " if name == "t" else ""
        raise ValueError(f"{name}: needs {seconds}real numbers, got {given.dtype}")
    return given


def _check_threads(threads: int | None) -> None:
    if threads is not None and operator.index(threads) < 1:
        raise ValueError(f"threads must be at least 1, got {threads}")


def _infinite_plot(plots: Array) -> DataError:
    place = tuple(int(k) for k in np.argwhere(np.isinf(plots))[0])
    large = " (or too large for float32)" if plots.dtype == np.float32 else ""
    return DataError(f"z: infinite plot{large} at index {place}; use NaN for a missed one")


def _check_single(what: str, values: Array, needed: NDArray[Any]) -> None:
    """Refuse what is 0 or infinite in single precision, where it is needed."""
    with np.errstate(over="ignore", under="ignore"):
        single = values.astype(np.float32)
    lost = (values > 0) & np.isfinite(values) & ~((single > 0) & np.isfinite(single))
    if lost.any():
        lost = lost & ~np.isnan(needed)
    if lost.any():
        value = np.broadcast_to(values, lost.shape)[lost][0]
        raise ValueError(f"{what} {value:g} is out of the range of float32; use float64")


def _check_state(plots: Array, state: TrackState | None, rows: Rows) -> None:
    if state is None:
        return
    if state.shape != plots.shape[1:]:
        raise ValueError(
            f"z: plots of shape {plots.shape[1:]} do not go on from a state of shape {state.shape}"
        )
    if state.rows != rows:
        raise ValueError("state: it comes from a tracker that remembers other things")


def _time_steps(times: Array, shape: tuple[int, ...], state: TrackState | None) -> Array:
    """T of every step, shape of the times; 0 for the first step of a new track."""
    if times.shape not in (shape[:1], shape[:-1]):
        own = f" or {shape[:-1]}" if len(shape) > 2 else ""
        raise ValueError(
            f"t: shape {times.shape} does not fit plots of shape {shape}; {shape[:1]}{own} does"
        )
    if not np.isfinite(times).all():
        place = int(np.argwhere(~np.isfinite(times))[0][0])
        raise DataError(f"t: time at index {place} is not finite")
    before = times[:1] if state is None else np.broadcast_to(state.time, times.shape[1:])[None]
    # In place: times of each track's own take as much memory as its plots.
    dts = np.empty(times.shape)
    np.subtract(times[:1], before, out=dts[:1])
    np.subtract(times[1:], times[:-1], out=dts[1:])
    bad = dts <= 0
    if state is None:
        bad[:1] = False
    if bad.any():
        step, *track = (int(k) for k in np.argwhere(bad)[0])
        where = (step, *track) if track else step
        raise DataError(
            f"t: times must increase; the one at index {where} ({times[where]} s) is not later "
            "than the one before"
        )
    return dts
