"""The states of the tracks of a session, in a store of a tracker of the package."""

from __future__ import annotations

from typing import Any

import numpy as np

from fuzzytrack.scan.clock import LATEST, PLOTS, ROWS
from fuzzytrack.scan.plot_columns import PLOT_TIME, PLOT_X, PLOT_Y, R11, R22, RECORDED
from fuzzytrack.scan.track_columns import PLOT, STATUS, TIME, X, Y
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.track_store import TrackStore

__all__ = ["MEMORY", "NEXT", "PREDICTED", "SLOT", "TrackedStates"]

#: Places in the memory of a track: slot in the store, -1 before it has one; time, x, y, their
#: velocities and variances as predicted; x, y and their velocities after the plot of this scan.
SLOT, PREDICTED, NEXT, MEMORY = 0, 1, 8, 12


class TrackedStates:
    """States in a `TrackStore`, copied to and from the array of tracks.

    Parameters
    ----------
    tracker : str
        Text of the tracker.
    at : int
        Column of the array of tracks where the memory begins.
    """

    def __init__(self, tracker: str, at: int) -> None:
        self._at = at
        self._store = TrackStore(tracker, 2)

    @property
    def tracker(self) -> Tracker:
        """Tracker of the states."""
        return self._store.tracker

    def copy(self) -> TrackedStates:
        """As it is now."""
        made = object.__new__(TrackedStates)
        made._at, made._store = self._at, self._store.copy()
        return made

    def predict(self, work: Any) -> None:
        """Predict all tracks to the time of the latest plot."""
        tracks, latest, at = work.tracks, work.clock[LATEST], self._at + PREDICTED
        rows = self._rows(work)
        rows = rows[tracks[rows, TIME] < latest]
        if len(rows) == 0:
            return
        ahead = self._store.predict(self._slots(tracks, rows), latest)
        tracks[rows, at] = latest
        tracks[rows[:, None], at + 1 + np.arange(2)] = ahead.position
        tracks[rows[:, None], at + 3 + np.arange(2)] = ahead.velocity
        variance = ahead.position_variance
        tracks[rows[:, None], at + 5 + np.arange(2)] = np.where(variance > 0.0, variance, -1.0)

    def correct(self, work: Any) -> None:
        """Step the tracks that have a plot."""
        tracks, at = work.tracks, self._at + NEXT
        rows = self._rows(work)
        rows = rows[work.plot_of[rows] >= 0]
        if len(rows) == 0:
            return
        plots = work.plots[work.plot_of[rows]]
        state = self._store.step(
            self._slots(tracks, rows),
            plots[:, [PLOT_X, PLOT_Y]],
            plots[:, PLOT_TIME],
            np.sqrt(plots[:, [R11, R22]]),
        )
        tracks[rows[:, None], at + np.arange(2)] = state.position
        tracks[rows[:, None], at + 2 + np.arange(2)] = state.velocity

    def end(self, work: Any) -> None:
        """Drop the tracks that have ended."""
        count = work.counts[ROWS]
        tracks = work.tracks[:count]
        rows = np.flatnonzero((tracks[:, STATUS] == 0.0) & (tracks[:, self._at + SLOT] >= 0.0))
        self._store.drop(self._slots(tracks, rows))
        tracks[rows, self._at + SLOT] = -1.0

    def start(self, work: Any) -> None:
        """Take in the new tracks."""
        tracks, at = work.tracks[: work.counts[ROWS]], self._at + SLOT
        rows = np.flatnonzero((tracks[:, STATUS] > 0.0) & (tracks[:, at] < 0.0))
        if len(rows) == 0:
            return
        plots = work.plots[self._plots(work, rows)]
        state = self._store.tracker.start(
            tracks[rows[:, None], [X, Y]], tracks[rows, TIME], np.sqrt(plots[:, [R11, R22]])
        )
        tracks[rows, at] = self._store.add(state)

    def _plots(self, work: Any, rows: Any) -> Any:
        """Plots at which tracks have started."""
        count = work.counts[ROWS]
        row = work.track_of[: work.counts[PLOTS]]
        used = np.flatnonzero((row >= 0) & (row < count))
        # A track may end with a plot: its row is then gone, or that of a new track.
        last = work.tracks[row[used], PLOT]
        used = used[work.plots[used, RECORDED] == last]
        plot = np.zeros(count, np.int64)
        plot[row[used]] = used
        return plot[rows]

    def _rows(self, work: Any) -> Any:
        """Rows of tracks that have a slot."""
        tracks = work.tracks[: work.counts[ROWS]]
        return np.flatnonzero((tracks[:, STATUS] > 0.0) & (tracks[:, self._at + SLOT] >= 0.0))

    def _slots(self, tracks: Any, rows: Any) -> Any:
        return tracks[rows, self._at + SLOT].astype(np.intp)
