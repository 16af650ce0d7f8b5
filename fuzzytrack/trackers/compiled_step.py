"""A single step through compiled code, with no more checks than it needs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.lanes.layout import BLOCK, aligned
from fuzzytrack.lanes.plots import SIGMAS
from fuzzytrack.lanes.runner import Runner
from fuzzytrack.trackers.origin import Origin
from fuzzytrack.trackers.state import TrackState, check_origin

__all__ = ["CompiledStep"]

_FLOAT = np.dtype(np.float64)
_NUMBERS = (float, int)
_LEAST, _MOST = SIGMAS[np.float64]


class CompiledStep:
    """Steps states of one layout, any number of tracks.

    It serves the ordinary case only: floats, times as a number or as an array with one for each
    track, and sigmas as a number or an array. Everything else, errors included, is left to
    `fuzzytrack.trackers.lane_tracker.LaneTracker`, which has the checks and the messages.

    Parameters
    ----------
    core : Runner
        Compiled, see `fuzzytrack.lanes.runner.Runner.compile`.
    needs_sigma : bool
        Whether plots need a standard deviation.
    origin : Origin
        The tracker.
    """

    def __init__(self, core: Runner, needs_sigma: bool, origin: Origin) -> None:
        # Compiled code is called by its address, so it must be kept.
        self._core = core
        self._common_step: Any = core.common_step
        self._own_step: Any = core.own_step
        self._rows, self._needs_sigma, self._origin = core.rows, needs_sigma, origin
        # Shapes of the plots and of the lanes of the last state.
        self._sizes: tuple[tuple[int, ...] | None, tuple[int, ...]] = (None, ())
        # Taken out while in use, so that threads do not share one.
        self._room: list[tuple[NDArray[np.float64], NDArray[np.int64]]] = []

    def __call__(self, state: TrackState, z: Any, t: Any, sigma: Any) -> TrackState | None:
        """Next state; None if the arguments are not of the ordinary kind, or wrong."""
        if type(z) is not np.ndarray:
            if isinstance(z, np.ma.MaskedArray):
                return None
            z = np.array(z)
            # Only these: of dates, for example, NumPy would make numbers, too.
            if z.dtype.kind == "i":
                z = z.astype(_FLOAT)
        if sigma is None:
            if self._needs_sigma:
                return None
            sigma, common = math.nan, True
        else:
            common = isinstance(sigma, float) and _LEAST <= sigma <= _MOST
        time, lanes, rows, shape = state.time, state.lanes, self._rows, state.shape
        if (
            z.dtype != _FLOAT
            or z.shape != shape
            or not z.flags.c_contiguous
            or (state.made_by is not self._origin and not self._continues(state))
        ):
            return None
        when: Any
        if common and type(time) is np.float64 and isinstance(t, _NUMBERS):
            t = np.float64(t)
            if not 0.0 < t - time < math.inf:
                return None
            when, step = float(t), self._common_step
        else:
            given = _of_each(state, t, sigma, common)
            if given is None:
                return None
            (t, when, sigma), step = given, self._own_step
        try:
            room = self._room.pop()
        except IndexError:
            room = (aligned(rows.total * BLOCK), np.empty(BLOCK, np.int64))
        # The states of a stream share their shape; reading that of an array takes longer.
        sizes = self._sizes
        if sizes[0] is not shape or len(lanes) != rows.kept:
            check_origin(state, rows, self._origin)
            sizes = self._sizes = (shape, lanes.shape)
        after = np.empty(sizes[1])
        plots = z if len(shape) == 1 else z.reshape(-1)
        bad = step(*room, lanes, plots, when, sigma, after)
        self._room.append(room)
        if bad:
            return None
        return TrackState.unchecked(t, shape, after, rows, self._origin)

    def _continues(self, state: TrackState) -> bool:
        """Whether a state of another tracker object can be continued."""
        return state.rows == self._rows and self._origin.is_same(getattr(state, "made_by", None))


def _of_each(
    state: TrackState, t: Any, sigma: Any, common: bool
) -> tuple[Any, Array, Array] | None:
    """Times, the same as an array, and sigmas of the plots, or one `common` sigma for all.

    None where they are not simple, or a time is not later than that of its track.
    """
    time, shape = state.time, state.shape
    tracks = shape[:-1]
    if not state.lanes.size:
        return None
    if isinstance(t, _NUMBERS):
        times = np.full(np.shape(time), t, _FLOAT)[()]
    elif type(t) is np.ndarray and t.dtype == _FLOAT and tracks and t.shape == tracks:
        times = t.copy()
    else:
        return None
    if common:
        sigmas = np.array([sigma])
    elif type(sigma) is np.ndarray and sigma.dtype == _FLOAT and sigma.ndim <= len(shape):
        if any(n not in (1, m) for n, m in zip(sigma.shape[::-1], shape[::-1], strict=False)):
            return None
        sigmas = np.ascontiguousarray(np.broadcast_to(sigma, shape)).reshape(-1)
        if not ((sigmas >= _LEAST) & (sigmas <= _MOST)).all():
            return None
    else:
        return None
    steps = times - time
    if not ((steps > 0.0) & (steps < math.inf)).all():
        return None
    return times, np.ascontiguousarray(times).reshape(-1), sigmas
