"""Tracks that a scan tracker reported, as they are drawn: one after the other, in flat arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.track_reports import KINDS, STATUSES, TrackReports

__all__ = [
    "COASTING",
    "KIND_COLORS",
    "MOVING",
    "STATIC",
    "TENTATIVE",
    "ReportedTracks",
    "plots_of",
    "runs",
]

MOVING, STATIC = KINDS.index("moving"), KINDS.index("static")
TENTATIVE, COASTING = STATUSES.index("tentative"), STATUSES.index("coasting")


#: Colors by kind, where tracks have none of their own.
KIND_COLORS = {"undecided": shared.ORANGE, "moving": shared.BLUE, "static": shared.GRAY}


class _Reported(Protocol):
    """A result with reports, such as that of a scan tracker."""

    @property
    def reports(self) -> TrackReports: ...


@dataclass(frozen=True, eq=False)
class ReportedTracks:
    """Rows of reports by track, and in the order of the scans within each.

    Attributes
    ----------
    reports : TrackReports
        The rows.
    edges : ndarray of int, shape (n_tracks + 1,)
        Rows at which the tracks begin, and at which one more would.
    """

    reports: TrackReports
    edges: NDArray[np.int64]

    @classmethod
    def of(cls, result: TrackReports | _Reported) -> ReportedTracks:
        """Tracks of reports, or of a result that has some.

        Raises
        ------
        ValueError
            If there are no reports in it.
        """
        reports = result if isinstance(result, TrackReports) else getattr(result, "reports", None)
        if not isinstance(reports, TrackReports):
            raise ValueError(
                "result: must be the result of a scan tracker, or TrackReports; "
                f"got {type(result).__name__}"
            )
        rows = reports.where(np.lexsort((reports.scan, reports.track_id)))
        begins = np.flatnonzero(np.diff(rows.track_id, prepend=rows.track_id[:1] - 1))
        return cls(rows, np.append(begins, len(rows)).astype(np.int64))

    def __len__(self) -> int:
        """Number of tracks."""
        return len(self.edges) - 1

    @property
    def ids(self) -> NDArray[np.int64]:
        """Identity of each track."""
        return self.reports.track_id[self.edges[:-1]]

    @property
    def track(self) -> NDArray[np.int64]:
        """Number of the track of each row."""
        return np.repeat(np.arange(len(self)), np.diff(self.edges))

    @property
    def first(self) -> NDArray[np.int64]:
        """First row of each track."""
        return self.edges[:-1]

    @property
    def last(self) -> NDArray[np.int64]:
        """Last row of each track."""
        return self.edges[1:] - 1

    @property
    def kind(self) -> NDArray[np.uint8]:
        """Kind of each track, as it was reported last."""
        return self.reports.kind[self.last]

    @property
    def confirmed(self) -> Mask:
        """Whether each track was more than tentative in some scan."""
        late = np.concatenate([[0], np.cumsum(self.reports.status != TENTATIVE)])
        return np.asarray(late[self.edges[1:]] > late[self.edges[:-1]])

    @property
    def joined(self) -> Mask:
        """Whether each row and the next are of one track in scans that follow one another."""
        rows = self.reports
        return np.asarray((np.diff(rows.track_id) == 0) & (np.diff(rows.scan) <= 1))

    def where(self, tracks: Mask) -> ReportedTracks:
        """Only some tracks."""
        return ReportedTracks.of(self.reports.where(tracks[self.track]))


def runs(steps: Mask) -> NDArray[np.int64]:
    """Unbroken runs of steps, each from one row to the next.

    Parameters
    ----------
    steps : ndarray of bool, shape (n_rows - 1,)

    Returns
    -------
    ndarray of int, shape (n_runs, 2)
        First and last row of each run.
    """
    sides = np.flatnonzero(np.diff(np.concatenate([[False], steps, [False]])))
    return sides.reshape(-1, 2).astype(np.int64)


def plots_of(scans: Sequence[Scan] | None) -> Array:
    """Plots of all scans, shape (n, 2)."""
    if scans is None:
        return np.empty((0, 2))
    found = [np.asarray(scan.positions, np.float64).reshape(-1, 2) for scan in scans]
    return np.concatenate([np.empty((0, 2)), *found])
