"""State of a track: a value that can be kept, pickled and continued elsewhere."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.plots import gains_as_plots
from fuzzytrack.reprs import summary
from fuzzytrack.trackers.origin import Origin

__all__ = ["Gains", "TrackState", "check_origin"]


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
    made_by : Origin or None
        The tracker that it comes from. Only a tracker with the same parameters continues it.

    Raises
    ------
    ValueError
        If `lanes` does not have the shape that `shape` and `rows` require.
    """

    time: Array | np.float64
    shape: tuple[int, ...]
    lanes: Array
    rows: Rows
    made_by: Origin | None = None

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
        cls,
        time: Array | np.float64,
        shape: tuple[int, ...],
        lanes: Array,
        rows: Rows,
        made_by: Origin,
    ) -> TrackState:
        """State of values that are known to be consistent; for a stream of plots.

        The constructor of a frozen class takes as long as a compiled step: it sets each attribute
        through `object.__setattr__`, and then checks them. Here the slots are set directly, which
        is possible for an object that is not in use yet.

        Parameters
        ----------
        time, shape, lanes, rows, made_by
            As for the class; `lanes` is contiguous.
        """
        state = object.__new__(cls)
        _set_time(state, time)
        _set_shape(state, shape)
        _set_lanes(state, lanes)
        _set_rows(state, rows)
        _set_made_by(state, made_by)
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


_set_time, _set_shape, _set_lanes, _set_rows, _set_made_by = (
    vars(TrackState)[name].__set__ for name in ("time", "shape", "lanes", "rows", "made_by")
)


def check_origin(state: TrackState, rows: Rows, origin: Origin) -> None:
    """Raise ValueError for a state that comes from a tracker with other parameters.

    Parameters
    ----------
    state : TrackState
    rows : Rows
        Layout of the tracker's lanes.
    origin : Origin
        The tracker.

    Raises
    ------
    ValueError
        If the layouts or the parameters differ; names both trackers.
    """
    # A state that another release pickled has no such attribute.
    made_by = getattr(state, "made_by", None)
    if made_by is not None and not made_by.is_same(origin):
        alike = " of the same name, with other parameters" if made_by.text == origin.text else ""
        raise ValueError(
            f"state: it comes from {made_by.text}, and cannot be continued by {origin.text}{alike};"
            " give a state that this tracker returned"
        )
    # A state that another release pickled may have fewer rows.
    if made_by is None or state.rows != rows or len(state.lanes) != rows.kept:
        raise ValueError(
            f"state: its lanes are laid out for another tracker than {origin.text}, or by another "
            "release of fuzzytrack; give a state that this tracker returned"
        )
