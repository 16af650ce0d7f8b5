"""Tracks that come and go: the states of many tracks, of which any can be stepped together."""

from __future__ import annotations

import math
import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.plurals import counted
from fuzzytrack.reprs import summary
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_tracker
from fuzzytrack.trackers.origin import Origin
from fuzzytrack.trackers.prediction import Prediction
from fuzzytrack.trackers.state import TrackState, check_origin

__all__ = ["TrackStore"]

#: Numbers that identify the tracks of a store, from 0 on.
Slots = NDArray[np.intp]


class TrackStore:
    """States of many tracks, each at a time of its own.

    A track is identified by its slot, a small whole number that `add` returns. When a track is
    dropped, its slot may be used for another one. Any of the tracks can be stepped or predicted
    together, in any order; the numbers are those of each track run by itself, to the last bit.

    Parameters
    ----------
    tracker : Tracker or str
        Tracker of all tracks, or a text that names it, see
        `fuzzytrack.trackers.catalog.make_tracker`.
    n_axes : int
        Axes of the plots.

    Raises
    ------
    TypeError
        If `n_axes` is no whole number, or `tracker` is no tracker.
    ValueError
        If there is no axis, or the text names no tracker.

    Notes
    -----
    Takes ``8·rows.kept`` bytes a lane (see `fuzzytrack.lanes.layout.Rows`) and 8 a track, for the
    largest number of tracks at one time and a quarter more. Slots of dropped tracks are used again,
    the last one dropped first.

    Examples
    --------
    >>> from fuzzytrack import AlphaBetaTracker, FixedGains
    >>> from fuzzytrack.trackers.track_store import TrackStore
    >>> tracker = AlphaBetaTracker(FixedGains(0.5, 0.2))
    >>> store = TrackStore(tracker, n_axes=1)
    >>> slots = store.add(tracker.start([[0.0], [50.0]], t=0.0))
    >>> _ = store.step(slots, [[10.0], [40.0]], t=1.0)
    >>> store.drop(slots[:1])
    >>> store.slots
    array([1])
    >>> store.gather(store.slots).velocity
    array([[-10.]])
    """

    def __init__(self, tracker: Tracker | str, n_axes: int) -> None:
        tracker = as_tracker(tracker)
        if operator.index(n_axes) < 1:
            raise ValueError(f"n_axes must be at least 1, got {n_axes}")
        self.tracker, self.n_axes = tracker, n_axes
        # Without a plot, so the standard deviation is of no meaning.
        nobody = tracker.start(np.empty((0, n_axes)), 0.0, 1.0)
        self._rows, self._origin = nobody.rows, nobody.made_by or Origin(tracker)
        # One row for each track, since its numbers are used together. A cell is a number of all
        # lanes of the track, which are copied together.
        self._cell = np.dtype((np.void, 8 * (n_axes // nobody.rows.n_axes)))
        self._numbers = np.empty((0, nobody.rows.kept), self._cell)
        # NaN in slots without a track.
        self._time = np.empty(0)
        self._used = 0
        self._free: list[int] = []

    def __repr__(self) -> str:
        return summary(self, "tracker", "n_axes", tracks=len(self))

    def __len__(self) -> int:
        """Number of tracks."""
        return self._used - len(self._free)

    def __getstate__(self) -> dict[str, Any]:
        return {
            "tracker": self.tracker, "n_axes": self.n_axes, "numbers": self._numbers,
            "time": self._time, "used": self._used, "free": self._free,
        }  # fmt: skip

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(state["tracker"], state["n_axes"])  # type: ignore[misc]
        self._numbers, self._time = state["numbers"], state["time"]
        self._used, self._free = state["used"], state["free"]

    def copy(self) -> TrackStore:
        """Another store with the same tracks in the same slots."""
        made = object.__new__(TrackStore)
        made.__dict__.update(self.__dict__)
        made._numbers, made._time, made._free = (
            self._numbers.copy(), self._time.copy(), self._free.copy(),
        )  # fmt: skip
        return made

    @property
    def slots(self) -> Slots:
        """Slots of all tracks, in increasing order."""
        return np.flatnonzero(~np.isnan(self._time[: self._used]))

    @property
    def room(self) -> int:
        """Number of slots, with and without a track.

        Arrays beside the store with one entry for each slot need this length.
        """
        return len(self._time)

    def time(self, slots: ArrayLike) -> Array:
        """Times of the last steps of some tracks (s).

        Parameters
        ----------
        slots : array_like of int, shape (n,)
            The tracks, each once.
        """
        times: Array = self._time[self._checked(slots)]
        return times

    def add(self, state: TrackState) -> Slots:
        """Take in new tracks.

        Parameters
        ----------
        state : TrackState
            Of a batch of tracks, shape (n, n_axes), or of one, shape (n_axes,): from the tracker's
            `start`, or a result.

        Returns
        -------
        ndarray of int, shape (n,)
            Their slots, in the same order.

        Raises
        ------
        TypeError
            If `state` is something else.
        ValueError
            If the state has another shape, or comes from another kind of tracker.
        """
        if not isinstance(state, TrackState):
            raise TypeError(f"state must be a TrackState, got {type(state).__name__}")
        count = math.prod(state.shape[:-1])
        self._check_state(state, count)
        reused = [self._free.pop() for _ in range(min(count, len(self._free)))]
        begin = self._used
        self._used += count - len(reused)
        self._make_room(self._used)
        slots = np.array([*reused, *range(begin, self._used)], dtype=np.intp)
        self._put(slots, state)
        return slots

    def drop(self, slots: ArrayLike) -> None:
        """End some tracks; their slots may be used again.

        Parameters
        ----------
        slots : array_like of int, shape (n,)
            The tracks, each once.

        Raises
        ------
        ValueError
            If there is no track in a slot, or a slot is named twice.
        """
        whom = self._checked(slots)
        self._time[whom] = math.nan
        self._free.extend(whom.tolist())

    def gather(self, slots: ArrayLike) -> TrackState:
        """State of some tracks, as of a batch; a copy.

        Parameters
        ----------
        slots : array_like of int, shape (n,)
            The tracks, each once.

        Returns
        -------
        TrackState
            Of shape (n, n_axes), each track with its own time.

        Raises
        ------
        ValueError
            As for `drop`.
        """
        return self._state(self._checked(slots))

    @property
    def width(self) -> int:
        """How many numbers `numbers` gives of a track."""
        return 1 + self._rows.kept * (self._cell.itemsize // 8)

    def numbers(self, slots: ArrayLike) -> Array:
        """Time and state of some tracks as plain numbers, with which `restored` makes the state.

        Parameters
        ----------
        slots : array_like of int, shape (n,)
            The tracks, each once.

        Returns
        -------
        ndarray, shape (n, width)

        Raises
        ------
        ValueError
            As for `drop`.
        """
        whom = self._checked(slots)
        # Lane by lane of a number after the other; a cell has those of a track.
        numbers = self._numbers[whom].view(np.float64).reshape(len(whom), self.width - 1)
        return np.column_stack([self._time[whom], numbers])

    def restored(self, numbers: Array) -> TrackState:
        """State of the tracks of which `numbers` are, also in another process.

        Parameters
        ----------
        numbers : ndarray, shape (n, width)
            From `numbers` of a store of the same tracker.

        Raises
        ------
        ValueError
            If there are not as many numbers as the tracker has.
        """
        if numbers.ndim != 2 or numbers.shape[1] != self.width:
            raise ValueError(f"numbers: shape {numbers.shape}; expected (n, {self.width})")
        cells = np.ascontiguousarray(numbers[:, 1:], dtype=np.float64).view(self._cell)
        lanes = np.ascontiguousarray(cells.T).view(np.float64)
        time = np.array(numbers[:, 0])
        return TrackState(time, (len(time), self.n_axes), lanes, self._rows, self._origin)

    def scatter(self, slots: ArrayLike, state: TrackState) -> None:
        """Replace the state of some tracks.

        Parameters
        ----------
        slots : array_like of int, shape (n,)
            The tracks, each once.
        state : TrackState
            Their new state, of shape (n, n_axes) or for one track (n_axes,).

        Raises
        ------
        ValueError
            As for `drop`, and as for `add`.
        """
        whom = self._checked(slots)
        self._check_state(state, len(whom))
        self._put(whom, state)

    def step(
        self, slots: ArrayLike, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None = None
    ) -> TrackState:
        """Step some tracks by a plot each; the others stay as they are.

        Parameters
        ----------
        slots : array_like of int, shape (n,)
            The tracks, each once.
        z : array_like, shape (n, n_axes)
            Their plots (m); NaN where missed.
        t : array_like, shape () or (n,)
            Times (s), common or each track's own, later than those of the tracks.
        sigma : array_like, optional
            Standard deviation of the plots (m), broadcast against `z`.

        Returns
        -------
        TrackState
            State of these tracks after the step.

        Raises
        ------
        DataError, ValueError
            As for `drop`, and as for the tracker's `step`. No track is then changed.
        """
        whom = self._checked(slots)
        state = self.tracker.step(self._state(whom), z, t, sigma)
        self._put(whom, state)
        return state

    def predict(self, slots: ArrayLike, t: ArrayLike, sigma: ArrayLike | None = None) -> Prediction:
        """Predicted positions of some tracks at a later time; the tracks do not change.

        Parameters
        ----------
        slots : array_like of int, shape (n,)
            The tracks, each once.
        t : array_like, shape () or (n,)
            Times (s), common or each track's own, later than those of the tracks.
        sigma : array_like, optional
            Standard deviation of the next plots (m), broadcast against shape (n, n_axes).

        Returns
        -------
        Prediction

        Raises
        ------
        DataError, ValueError
            As for `step`.
        """
        return self.tracker.predict(self.gather(slots), t, sigma)

    def _state(self, slots: Slots) -> TrackState:
        lanes = np.ascontiguousarray(self._numbers[slots].T).view(np.float64)
        return TrackState(
            self._time[slots], (len(slots), self.n_axes), lanes, self._rows, self._origin
        )

    def _put(self, slots: Slots, state: TrackState) -> None:
        self._numbers[slots] = state.lanes.view(self._cell).T
        self._time[slots] = state.time

    def _make_room(self, count: int) -> None:
        """Make room for `count` tracks in all."""
        have = self.room
        if count > have:
            room = count + count // 4
            # In place where the system can move pages, and never twice the memory; there are no
            # other views of the arrays. Arrays from a pickle belong to it, and are copied once.
            for name in ("_time", "_numbers"):
                array = np.require(getattr(self, name), requirements="O")
                array.resize((room, *array.shape[1:]), refcheck=False)
                setattr(self, name, array)
            self._time[have:] = math.nan

    def _checked(self, slots: ArrayLike) -> Slots:
        """Slots as an array; ValueError unless there is a track in each and none is named twice."""
        whom = np.asarray(slots)
        if whom.ndim != 1 or (whom.size and whom.dtype.kind not in "iu"):
            raise ValueError(
                f"slots: needs whole numbers, shape (n,); got {whom.dtype}, shape {whom.shape}"
            )
        whom = whom.astype(np.intp, copy=False)
        live = (whom >= 0) & (whom < self._used)
        live[live] = ~np.isnan(self._time[whom[live]])
        if not live.all():
            raise ValueError(f"slots: there is no track in slot {whom[~live][0]}")
        ordered = np.sort(whom)
        twice = ordered[1:] == ordered[:-1]
        if twice.any():
            raise ValueError(f"slots: slot {ordered[1:][twice][0]} is named twice")
        return whom

    def _check_state(self, state: TrackState, count: int) -> None:
        alone = (self.n_axes,)
        if state.shape != (count, *alone) and not (count == 1 and state.shape == alone):
            raise ValueError(
                f"state: shape {state.shape} does not fit; a state of "
                f"{counted(count, 'track')} and {counted(self.n_axes, 'axis', 'axes')} has "
                f"{(count, *alone)}"
            )
        check_origin(state, self._rows, self._origin)
