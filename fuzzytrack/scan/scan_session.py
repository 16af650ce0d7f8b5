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
    HAS_STARTS,
    HAS_TIMES,
    LAST_TIME,
    NEW_SCAN,
    OWN_X,
    OWN_Y,
    PLOTS,
    REPORTS,
    ROWS,
    SCAN,
    SCAN_TIME,
    TENTATIVE_TOO,
    WHERE,
)
from fuzzytrack.scan.plot_columns import PLOT_ROW
from fuzzytrack.scan.report_columns import (
    REPORT_DEVIATION,
    REPORT_EXISTENCE,
    REPORT_ID,
    REPORT_KIND,
    REPORT_PLOT,
    REPORT_POSITION,
    REPORT_SINCE,
    REPORT_STATUS,
    REPORT_TIME,
    REPORT_VELOCITY,
)
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_parts import ScanParts
from fuzzytrack.scan.scan_pass import PAIRS, scan_pass
from fuzzytrack.scan.stages.pairs import MORE_EDGES
from fuzzytrack.scan.stages.plots import (
    BAD_COVARIANCE,
    BAD_POSITION,
    BAD_TIME,
    DONE,
    LARGEST,
    NO_NOISE,
)
from fuzzytrack.scan.track_columns import ID, PLOT, STATUS
from fuzzytrack.scan.track_reports import TrackReports
from fuzzytrack.scan.workspace import LASTING, Workspace, new_workspace, with_room

__all__ = ["ScanSession"]

_NO_COVARIANCES, _NO_TIMES, _NO_STARTS = np.empty((0, 3)), np.empty(0), np.empty(0, np.bool_)
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
        self._rows: NDArray[np.int64] | None = None
        self._waiting = np.empty(0, np.int64)
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
        return self.advance(scan, tentative=tentative)[0]

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
        self._prepare(scan, due, may_start, new_scan)
        work = self._work
        work.counts[TENTATIVE_TOO] = tentative
        saved = None if self._pass.compiled else self._saved()
        try:
            self._run(scan, may_start)
        except BaseException:
            if saved is not None:
                self._restore(saved)
            raise
        work = self._work
        if due is not None:
            # The plots of the others are those of an earlier call.
            work.tracks[self._waiting, PLOT] = -1
        n = int(work.counts[PLOTS])
        unused = np.zeros(len(scan.positions), np.bool_)
        rows = work.plots[:n, PLOT_ROW].astype(np.int64)
        unused[rows] = work.track_of[:n] < 0
        self._rows = scan.rows
        reports = self._reports(scan.rows)
        self._tidy()
        return reports, unused

    # ------------------------------------------------------------ one scan

    def _prepare(
        self, scan: Scan, due: ArrayLike | None, may_start: ArrayLike | None, new_scan: bool
    ) -> None:
        """Check what can be checked without a look at each plot, and make room."""
        clock, time, last = self._work.clock, float(scan.time), self.time
        first = self.scans == 0
        later = time > last if new_scan or first else time >= last
        if not (later and abs(time) <= LARGEST):
            raise DataError(
                f"time: {time!r} s does not follow {last!r} s; scans need finite times that grow"
            )
        positions = scan.positions
        n = len(positions)
        for name, array, shape in (
            ("positions", positions, (n, 2)),
            ("covariances", scan.covariances, (n, 3)),
            ("times", scan.times, (n,)),
            ("may_start", may_start, (n,)),
        ):
            if array is not None and np.shape(array) != shape:
                raise DataError(f"{name}: shape {np.shape(array)}; expected {shape}")
        if not (abs(scan.own[0]) <= LARGEST and abs(scan.own[1]) <= LARGEST):
            raise DataError(f"own: {scan.own!r} is no position in meters")
        self._work = with_room(self._work, self.tracker, int(self._work.counts[ROWS]) + n, n, 2 * n)
        counts = self._work.counts
        clock = self._work.clock
        if due is not None:
            mask = np.asarray(due, np.bool_)
            live = self._live()
            if mask.shape != (len(live),):
                raise DataError(f"due: shape {mask.shape}; expected ({len(live)},)")
            self._work.due[: counts[ROWS] + n] = 0
            self._work.due[live] = mask
            self._waiting = live[~mask]
        self._before = clock.copy()
        clock[LAST_TIME], clock[SCAN_TIME] = last, time
        clock[OWN_X], clock[OWN_Y] = scan.own
        begins = new_scan or first
        clock[SCAN] += begins
        counts[NEW_SCAN] = begins
        counts[PLOTS] = n
        counts[HAS_COVARIANCES] = scan.covariances is not None
        counts[HAS_TIMES] = scan.times is not None
        counts[HAS_DUE], counts[HAS_STARTS] = due is not None, may_start is not None

    def _run(self, scan: Scan, may_start: ArrayLike | None) -> None:
        """Run all stages."""
        positions = np.ascontiguousarray(scan.positions, np.float64)
        covariances = (
            _NO_COVARIANCES
            if scan.covariances is None
            else np.ascontiguousarray(scan.covariances, np.float64)
        )
        times = _NO_TIMES if scan.times is None else np.ascontiguousarray(scan.times, np.float64)
        starts = _NO_STARTS if may_start is None else np.ascontiguousarray(may_start, np.bool_)
        answer = self._pass.run(self._work, positions, covariances, times, starts, 0)
        while answer == MORE_EDGES:
            work = self._work
            self._work = _with_edges(work, self.tracker)
            answer = self._pass.run(self._work, positions, covariances, times, starts, PAIRS)
        if answer != DONE:
            self._work.clock[:] = self._before
            raise _complaint(answer, scan, int(self._work.counts[WHERE]))

    def _reports(self, given: NDArray[np.int64] | None) -> TrackReports:
        """What the stage of reports has written; `given` are the rows of the plots."""
        work = self._work
        rows = work.report[: work.counts[REPORTS]]
        whole = rows[:, REPORT_ID : REPORT_PLOT + 1].astype(np.int64)
        ids = whole[:, 0]
        if len(ids) > 1 and (ids[1:] < ids[:-1]).any():
            order = np.argsort(ids, kind="stable")
            rows, whole = rows[order], whole[order]
        else:
            rows = rows.copy()
        plot = whole[:, REPORT_PLOT - REPORT_ID]
        if given is not None and len(given):
            plot = np.where(plot >= 0, np.asarray(given)[np.maximum(plot, 0)], -1)
        words = whole[:, REPORT_STATUS - REPORT_ID : REPORT_KIND - REPORT_ID + 1].astype(np.uint8)
        return TrackReports(
            np.full(len(rows), self.scans - 1, np.int64),
            rows[:, REPORT_TIME],
            whole[:, 0],
            rows[:, REPORT_POSITION : REPORT_POSITION + 2],
            rows[:, REPORT_VELOCITY : REPORT_VELOCITY + 2],
            rows[:, REPORT_DEVIATION : REPORT_DEVIATION + 4],
            words[:, 0],
            words[:, 1],
            rows[:, REPORT_EXISTENCE],
            rows[:, REPORT_SINCE],
            plot,
        )

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
        return {name: getattr(self._work, name).copy() for name in LASTING}

    def _restore(self, saved: dict[str, Any]) -> None:
        saved["clock"] = self._before
        self._work = self._work._replace(**saved)
        counts = self._work.counts
        self._work = with_room(self._work, self.tracker, int(counts[ROWS]), 0, 0)

    def __getstate__(self) -> dict[str, Any]:
        work, rows = self._work, int(self._work.counts[ROWS])
        cells = np.flatnonzero(work.cells)
        return {
            "tracker": self.tracker, "plain": self._plain, "rows": self._rows,
            "tracks": work.tracks[:rows].copy(), "clock": work.clock, "counts": work.counts,
            "kept": work.kept, "cells": (cells, work.cells[cells]),
        }  # fmt: skip

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(state["tracker"], plain=state["plain"])  # type: ignore[misc]
        self._rows = state["rows"]
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
        return self._reports(self._rows)

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


def _with_edges(work: Workspace, tracker: ScanParts) -> Workspace:
    """The same arrays with room for more edges; what was found of the plots stays."""
    edges = 2 * len(work.edge_plot)
    rows, plots = len(work.tracks), len(work.plots)
    more = with_room(work, tracker, rows, plots, edges)
    for name in ("plots", "order", "track_of", "due"):
        getattr(more, name)[:] = getattr(work, name)
    # The index of the candidates is in the scratch of the parts.
    more.integers[: len(work.integers)] = work.integers
    more.numbers[: len(work.numbers)] = work.numbers
    return more


def _complaint(answer: int, scan: Scan, j: int) -> DataError:
    """What is wrong with a plot."""
    row = j if scan.rows is None else int(scan.rows[j])
    plot = f"plot {row} of the scan at {scan.time:g} s"
    if answer == BAD_POSITION:
        x, y = scan.positions[j]
        return DataError(f"{plot}: position ({x:g}, {y:g}) m; needs numbers below {LARGEST:g}")
    if answer == BAD_TIME and scan.times is not None:
        return DataError(f"{plot}: time {scan.times[j]:g} s; none may be later than the scan")
    if answer == NO_NOISE:
        distance = float(np.hypot(*(scan.positions[j] - np.asarray(scan.own))))
        return DataError(
            f"{plot}: {distance:g} m from the radar, where its noise across the line of sight is "
            "too large for the numbers here; are the positions in meters?"
        )
    assert answer == BAD_COVARIANCE
    assert scan.covariances is not None
    values = ", ".join(f"{value:g}" for value in scan.covariances[j])
    return DataError(f"{plot}: covariance ({values}) m²; needs xx > 0, yy > 0, xy² < xx·yy")
