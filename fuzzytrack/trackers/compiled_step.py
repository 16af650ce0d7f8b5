"""The short way from a state to the next one, through compiled code."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.lanes.layout import BLOCK, aligned
from fuzzytrack.lanes.runner import Runner
from fuzzytrack.trackers.state import TrackState

__all__ = ["Hop"]

_FLOAT = np.dtype(np.float64)
_NUMBERS = (float, int)
_set_time, _set_shape, _set_lanes, _set_rows = (
    vars(TrackState)[name].__set__ for name in ("time", "shape", "lanes", "rows")
)


class Hop:
    """Steps states whose plots have one shape.

    It takes the ordinary case only: floats, one time and one sigma for all. Whatever is different,
    or wrong, is left to `fuzzytrack.trackers.lane_tracker.LaneTracker`, which has words for it.

    Parameters
    ----------
    core : Runner
        Compiled, see `fuzzytrack.lanes.runner.Runner.compile`.
    shape : tuple of int
        Shape of a plot.
    lanes : int
        Number of lanes.
    needs_sigma : bool
        Whether plots need a standard deviation.
    """

    def __init__(self, core: Runner, shape: tuple[int, ...], lanes: int, needs_sigma: bool) -> None:
        # Its code is called by address, and must not go.
        self._core = core
        self._call: Any = core.hop
        self._shape, self._lanes, self._rows = shape, lanes, core.rows
        self._kept = (core.rows.kept, lanes)
        self._needs_sigma = needs_sigma
        # Taken out while in use, so that threads do not share one.
        self._buffers: list[NDArray[np.float64]] = []

    def __call__(self, state: TrackState, z: Any, t: Any, sigma: Any) -> TrackState | None:
        """Next state, or None where there is more to say or do."""
        if type(z) is not np.ndarray:
            if isinstance(z, np.ma.MaskedArray):
                return None
            z = np.array(z, dtype=_FLOAT)
        if sigma is None:
            sigma = math.nan
            if self._needs_sigma:
                return None
        elif not (isinstance(sigma, float) and 0.0 < sigma < math.inf):
            return None
        time, lanes, rows, shape = state.time, state.lanes, self._rows, self._shape
        if (
            type(time) is not np.float64
            or not isinstance(t, _NUMBERS)
            or z.dtype != _FLOAT
            or z.shape != shape
            or not z.flags.c_contiguous
            or (state.rows is not rows and state.rows != rows)
        ):
            return None
        t = np.float64(t)
        dt = float(t - time)
        if not 0.0 < dt < math.inf:
            return None
        try:
            buffer = self._buffers.pop()
        except IndexError:
            buffer = aligned(rows.total * BLOCK)
        after = np.empty(self._kept)
        plots = z if len(shape) == 1 else z.reshape(-1)
        infinite = self._call(buffer, self._lanes, lanes, plots, dt, sigma, after)
        self._buffers.append(buffer)
        if infinite:
            return None
        # The constructor of a frozen class takes as long as all the arithmetic.
        new = object.__new__(TrackState)
        _set_time(new, t)
        _set_shape(new, shape)
        _set_lanes(new, after)
        _set_rows(new, rows)
        return new
