"""The state of a scan tracker while it follows a recording."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError
from fuzzytrack.reprs import summary
from fuzzytrack.scan.clock import (
    FREE,
    HAS_COVARIANCES,
    HAS_DUE,
    HAS_ROWS,
    HAS_STARTS,
    HAS_TIMES,
    LAST_TIME,
    NEW_SCAN,
    OWN_X,
    OWN_Y,
    PLOTS,
    ROWS,
    SCAN,
    SCAN_TIME,
    TENTATIVE_TOO,
    WHERE,
)
from fuzzytrack.scan.plot_columns import PLOT_ROW
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_arrays import complaint, scan_arrays
from fuzzytrack.scan.scan_parts import ScanParts
from fuzzytrack.scan.scan_pass import PAIRS, scan_pass
from fuzzytrack.scan.stages.pairs import MORE_EDGES
from fuzzytrack.scan.stages.plots import DONE
from fuzzytrack.scan.track_columns import ID, STATUS
from fuzzytrack.scan.track_reports import TrackReports
from fuzzytrack.scan.workspace import LASTING, new_workspace, reported, with_edges, with_room

__all__ = ["ScanSession"]

#: Share of the rows of tracks that must be used, where there are many; else they are put together.
_LEAST_USED, _MANY = 0.25, 4096


class ScanSession:
    """Tracks as they are after some scans; made by `ScanTracker.start`.

    It pickles, and goes on with the same results, to the last bit.

    Parameters
    ----------
    tracker : ScanTracker
    plain : bool
        Run in plain Python, whatever the parts: some hundred times slower, with the same results.
    """

    def __init__(self, tracker: ScanParts, *, plain: bool = False) -> None:
        self.tracker, self._plain = tracker, plain
        self._pass = scan_pass(tracker, plain)
        self._work = new_workspace(tracker)
        self._companion, self._needing_own = tracker.companion(), tracker.needing_own()
        self._work.clock[SCAN_TIME], self._work.clock[SCAN] = -np.inf, -1.0

    def __repr__(self) -> str:
        return summary(self, scans=self.scans, tracks=self.n_tracks)

    @property
    def scans(self) -> int:
        """Number of scans so far."""
        return int(self._work.clock[SCAN]) + 1

    @property
    def time(self) -> float:
        """Time of the last scan (s), -inf before the first one."""
        return float(self._work.clock[SCAN_TIME])

    @property
    def n_tracks(self) -> int:
        """Number of live tracks, tentative ones included."""
        return int(np.count_nonzero(self._status))

    @property
    def companion(self) -> Any:
        """What keeps states beside the array of tracks, see `Update`; None if nothing does."""
        return self._companion

    @property
    def _status(self) -> Any:
        return self._work.tracks[: self._work.counts[ROWS], STATUS]

    def step(self, scan: Scan, *, tentative: bool = False) -> TrackReports:
        """Take in the plots of the next scan.

        Parameters
        ----------
        scan : Scan
        tentative : bool
            Whether all live tracks are returned, not only those that the report chooses.

        Returns
        -------
        TrackReports
            The tracks after the scan, in the order of their identities.

        Raises
        ------
        DataError
            If a plot cannot be used, or times go backwards; names the plot. The session does not
            change.
        PluginError
            If a part in plain Python fails; names it. The session does not change.
        """
        self._take(scan, tentative)
        return reported(self._work)

    def advance(
        self,
        scan: Scan,
        *,
        tentative: bool = False,
        due: ArrayLike | None = None,
        may_start: ArrayLike | None = None,
        new_scan: bool = True,
    ) -> tuple[TrackReports, Mask]:
        """Take in some plots, for some tracks: a part of a scan, as from a sector of a turn.

        Parameters
        ----------
        scan : Scan
            Its time must not be earlier than that of the call before, and be later if a new scan
            begins.
        tentative : bool
            See `step`.
        due : array_like of bool, shape (n_tracks,), optional
            Which tracks the plots are about, in the order of `tracks`; the others stay as they
            are, and no miss counts for them. All, if not given.
        may_start : array_like of bool, shape (n_plots,), optional
            Which plots start a track if none uses them. The others, if unused, leave no trace, and
            can be given again. All, if not given.
        new_scan : bool
            Whether a new scan begins, or this is more of the one before. What is counted in scans
            goes on with each new scan only.

        Returns
        -------
        reports : TrackReports
            Of tracks that are due or new.
        unused : ndarray of bool, shape (n_plots,)
            Plots that no track used and that started none.

        Raises
        ------
        DataError, PluginError
            See `step`.
        """
        self._take(scan, tentative, due, may_start, new_scan)
        work = self._work
        n = int(work.counts[PLOTS])
        unused = np.zeros(len(scan.positions), np.bool_)
        rows = work.plots[:n, PLOT_ROW].astype(np.int64)
        unused[rows] = work.track_of[:n] < 0
        return reported(work), unused

    # ------------------------------------------------------------ one scan

    def _take(
        self,
        scan: Scan,
        tentative: bool,
        due: ArrayLike | None = None,
        may_start: ArrayLike | None = None,
        new_scan: bool = True,
    ) -> None:
        """Run all stages of a scan."""
        clock, last = self._work.clock, self.time
        begins = new_scan or clock[SCAN] < 0.0
        arrays = scan_arrays(scan, last, begins, may_start, self._needing_own)
        n = len(arrays.positions)
        self._tidy()
        rows = int(self._work.counts[ROWS])
        self._work = work = with_room(self._work, self.tracker, rows + n, n, 2 * n)
        counts = work.counts
        if due is not None:
            self._mark_due(due, rows + n)
        before = clock.copy()
        clock[LAST_TIME], clock[SCAN_TIME] = last, scan.time
        clock[OWN_X], clock[OWN_Y] = scan.own
        clock[SCAN] += begins
        counts[NEW_SCAN], counts[PLOTS] = begins, n
        counts[HAS_COVARIANCES] = scan.covariances is not None
        counts[HAS_TIMES] = scan.times is not None
        counts[HAS_ROWS] = scan.rows is not None
        counts[HAS_DUE], counts[HAS_STARTS] = due is not None, may_start is not None
        counts[TENTATIVE_TOO] = tentative
        saved = None if self._pass.compiled else self._saved()
        try:
            beside = () if self._companion is None else (self._companion,)
            answer = self._pass.run(work, *arrays, 0, *beside)
            while answer == MORE_EDGES:
                self._work = work = with_edges(work, self.tracker)
                answer = self._pass.run(work, *arrays, PAIRS, *beside)
        except BaseException:
            if saved is not None:
                self._restore(saved)
            self._work.clock[:] = before
            raise
        if answer != DONE:
            self._work.clock[:] = before
            raise complaint(answer, scan, int(work.counts[WHERE]))

    def _mark_due(self, due: ArrayLike, room: int) -> None:
        mask, live = np.asarray(due, np.bool_), self._live()
        if mask.shape != (len(live),):
            raise DataError(f"due: shape {mask.shape}; expected ({len(live)},)")
        self._work.due[:room] = 0
        self._work.due[live] = mask

    def _tidy(self) -> None:
        """Put the tracks together where most of many rows are free."""
        counts, tracks = self._work.counts, self._work.tracks
        rows = int(counts[ROWS])
        if rows > _MANY and rows - counts[FREE] < _LEAST_USED * rows:
            live = np.flatnonzero(tracks[:rows, STATUS])
            tracks[: len(live)] = tracks[live]
            counts[ROWS], counts[FREE] = len(live), 0

    # ------------------------------------------------------------ state

    def _saved(self) -> dict[str, Any]:
        """What lasts, as it is now."""
        saved = {name: getattr(self._work, name).copy() for name in LASTING}
        beside = None if self._companion is None else self._companion.copy()
        return {**saved, "companion": beside}

    def _restore(self, saved: dict[str, Any]) -> None:
        self._companion = saved.pop("companion")
        self._work = self._work._replace(**saved)

    def __getstate__(self) -> dict[str, Any]:
        work, rows = self._work, int(self._work.counts[ROWS])
        cells = np.flatnonzero(work.cells)
        return {
            "tracker": self.tracker, "plain": self._plain, "companion": self._companion,
            "tracks": work.tracks[:rows].copy(), "clock": work.clock, "counts": work.counts,
            "kept": work.kept, "cells": (cells, work.cells[cells]),
        }  # fmt: skip

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(state["tracker"], plain=state["plain"])  # type: ignore[misc]
        self._companion = state["companion"]
        rows = len(state["tracks"])
        self._work = with_room(self._work, self.tracker, rows, 0, 0)
        work = self._work
        work.tracks[:rows] = state["tracks"]
        for name in ("clock", "counts", "kept"):
            getattr(work, name)[:] = state[name]
        places, values = state["cells"]
        work.cells[places] = values

    # ------------------------------------------------------------ what is known

    def _live(self) -> NDArray[np.int64]:
        """Rows of live tracks, in the order of their identities."""
        rows = np.flatnonzero(self._status)
        return rows[np.argsort(self._work.tracks[rows, ID], kind="stable")]

    def tracks(self) -> TrackReports:
        """All live tracks, tentative ones included, in the order of their identities."""
        self._work.counts[TENTATIVE_TOO], self._work.counts[HAS_DUE] = 1, 0
        self._pass.report(self._work)
        return reported(self._work)

    def clutter_density(self, x: ArrayLike, y: ArrayLike) -> Array:
        """Density of clutter at some places, as the session sees it after the last scan.

        Parameters
        ----------
        x, y : array_like
            Places (m); broadcast against each other.

        Returns
        -------
        ndarray
            Plots/m² and scan.
        """
        xs, ys = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
        clock, cells, density = self._work.clock, self._work.cells, self._pass.density
        found = [density(a, b, clock, cells) for a, b in zip(xs.flat, ys.flat, strict=True)]
        return np.array(found, np.float64).reshape(xs.shape)
