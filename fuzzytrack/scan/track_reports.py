"""What a scan tracker reports: one row for each track and scan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = ["KINDS", "STATUSES", "TrackReports"]

#: Words for `TrackReports.status`, in the order of its numbers.
STATUSES = ("tentative", "confirmed", "coasting")
#: Words for `TrackReports.kind`, in the order of its numbers.
KINDS = ("undecided", "moving", "static")


@dataclass(frozen=True, eq=False)
class TrackReports:
    """Tracks as they were after each scan, scan after scan.

    Attributes
    ----------
    scan : ndarray of int, shape (n,)
        Number of the scan, from 0 on.
    time : ndarray, shape (n,)
        Time for which the row holds (s): that of its plot, or of the scan where it has none.
    track_id : ndarray of int, shape (n,)
        Identity of the track, from 1 on, never used again in a run.
    position, velocity : ndarray, shape (n, 2)
        Where it is (m) and how it moves (m/s).
    deviation : ndarray, shape (n, 4)
        Standard deviations of x, y (m) and of their velocities (m/s).
    status, kind : ndarray of uint8, shape (n,)
        Numbers of the words of `STATUSES` and `KINDS`.
    existence : ndarray, shape (n,)
        Probability that there is a target, as far as the quality of the tracker is one; else NaN.
    since_last : ndarray, shape (n,)
        Time since the last plot of the track (s).
    plot : ndarray of int, shape (n,)
        Row of its plot in the recording; -1 where it has none in this scan.
    """

    scan: NDArray[np.int64]
    time: Array
    track_id: NDArray[np.int64]
    position: Array
    velocity: Array
    deviation: Array
    status: NDArray[np.uint8]
    kind: NDArray[np.uint8]
    existence: Array
    since_last: Array
    plot: NDArray[np.int64]

    def __repr__(self) -> str:
        return summary(self, rows=len(self), tracks=len(np.unique(self.track_id)))

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.time)

    def where(self, rows: NDArray[np.generic]) -> TrackReports:
        """Only some rows, by a mask or by numbers."""
        return TrackReports(*(getattr(self, each.name)[rows] for each in fields(self)))

    @classmethod
    def joined(cls, parts: Sequence[TrackReports]) -> TrackReports:
        """Several of them as one, in this order."""
        if not parts:
            return cls.none()
        columns = ([getattr(part, each.name) for part in parts] for each in fields(cls))
        return cls(*(np.concatenate(column) for column in columns))

    @classmethod
    def none(cls) -> TrackReports:
        """Without a row."""
        whole, words, numbers = np.empty(0, np.int64), np.empty(0, np.uint8), np.empty(0)
        two = np.empty((0, 2))
        return cls(
            whole, numbers, whole, two, two, np.empty((0, 4)), words, words, numbers, numbers, whole
        )
