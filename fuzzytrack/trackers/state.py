"""State of a track: a value that can be kept, pickled and continued elsewhere."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.plots import gains_as_plots
from fuzzytrack.reprs import summary

__all__ = ["Gains", "TrackState", "check_rows"]


@dataclass(frozen=True, eq=False)
class Gains:
    """Gains of a tracker, arrays of one shape.

    Attributes
    ----------
    alpha, beta, gamma : ndarray
        Shaped as the plots they corrected; NaN where no correction was made (missed plot, start).
        Gamma is the one whose acceleration gain is γ/(2T²).
    """

    alpha: Array
    beta: Array
    gamma: Array

    def __repr__(self) -> str:
        return summary(self, "alpha", "beta", "gamma")


@dataclass(frozen=True, eq=False, slots=True)
class TrackState:
    """State of a track, or of a batch of tracks, after a step.

    Attributes
    ----------
    time : float or ndarray
        Time of the last step (s), a NumPy number or of the batch's shape.
    shape : tuple of int
        Shape of a plot: (n_axes,), (n_tracks, n_axes), or () for one axis alone.
    lanes : ndarray, shape (rows.kept, lanes)
        All numbers, laid out as `rows` says.
    rows : Rows
        The layout.

    Raises
    ------
    ValueError
        If `lanes` does not have the shape that `shape` and `rows` require.
    """

    time: Array | np.float64
    shape: tuple[int, ...]
    lanes: Array
    rows: Rows

    def __repr__(self) -> str:
        return summary(self, "time", "shape")

    def __post_init__(self) -> None:
        # Compiled code uses the numbers as they are in memory, without checks.
        lanes = np.ascontiguousarray(self.lanes, dtype=np.float64)
        expected = (self.rows.kept, math.prod(self.shape) // self.rows.n_axes)
        if lanes.shape != expected:
            raise ValueError(f"lanes: shape {lanes.shape}; plots of {self.shape} need {expected}")
        object.__setattr__(self, "lanes", lanes)

    @classmethod
    def unchecked(
        cls, time: Array | np.float64, shape: tuple[int, ...], lanes: Array, rows: Rows
    ) -> TrackState:
        """State of values that are known to be consistent; for a stream of plots.

        The constructor of a frozen class takes as long as a compiled step: it sets each attribute
        through `object.__setattr__`, and then checks them. Here the slots are set directly, which
        is possible for an object that is not in use yet.

        Parameters
        ----------
        time, shape, lanes, rows
            As for the class; `lanes` is contiguous.
        """
        state = object.__new__(cls)
        _set_time(state, time)
        _set_shape(state, shape)
        _set_lanes(state, lanes)
        _set_rows(state, rows)
        return state

    def _read(self, row: int, count: int) -> Array:
        # A copy: what is written into it must not change the state.
        return np.array(self.lanes[row : row + count].T).reshape(self.shape)

    @property
    def position(self) -> Array:
        """Position at `time` (m), shaped as a plot; NaN before the first plot."""
        return self._read(self.rows.shown("filtered"), self.rows.n_axes)

    @property
    def velocity(self) -> Array:
        """Velocity at `time` (m/s); 0 before it is known."""
        return self._read(self.rows.shown("velocity"), self.rows.n_axes)

    @property
    def acceleration(self) -> Array:
        """Acceleration at `time` (m/s²); 0 before it is known."""
        return self._read(self.rows.shown("acceleration"), self.rows.n_axes)

    @property
    def predicted(self) -> Array:
        """Position before the last plot was used (m); NaN until the tracker has started."""
        return self._read(self.rows.predicted, self.rows.n_axes)

    @property
    def innovation(self) -> Array:
        """Last plot minus prediction (m); NaN where there was no prediction or no plot."""
        return self._read(self.rows.innovation, self.rows.n_axes)

    @property
    def gains(self) -> Gains:
        """Gains of the last step."""
        rows, sets = self.rows, self.rows.gain_sets
        parts = (self.lanes[k : k + sets].T for k in range(rows.gains, rows.results, sets))
        return Gains(*(gains_as_plots(part, self.shape, rows.n_axes // sets) for part in parts))


_set_time, _set_shape, _set_lanes, _set_rows = (
    vars(TrackState)[name].__set__ for name in ("time", "shape", "lanes", "rows")
)


def check_rows(state: TrackState, rows: Rows, name: str) -> None:
    """Raise ValueError for a state whose lanes have another layout than those of a tracker.

    Parameters
    ----------
    state : TrackState
    rows : Rows
        Layout of the tracker's lanes.
    name : str
        Name of the tracker.

    Raises
    ------
    ValueError
        If the layouts differ.
    """
    # A state that another release pickled may have fewer rows.
    if state.rows != rows or len(state.lanes) != rows.kept:
        raise ValueError(
            f"state: its lanes are laid out for another tracker than {name} with these settings; "
            "give a state that the same tracker returned"
        )
