"""The tracks of a whole recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.scan.track_reports import TrackReports

__all__ = ["ScanResult"]


@dataclass(frozen=True, eq=False)
class ScanResult:
    """What a scan tracker made of a recording.

    Attributes
    ----------
    reports : TrackReports
        One row for each reported track and scan.
    times : ndarray, shape (n_scans,)
        Times of the scans (s).
    own : ndarray, shape (n_scans, 2)
        Positions of the radar (m).
    n_plots : ndarray of int, shape (n_scans,)
        How many plots each scan had.
    tracker : str
        Name of the configuration.
    """

    reports: TrackReports
    times: Array
    own: Array
    n_plots: NDArray[np.int64]
    tracker: str

    @classmethod
    def of(
        cls,
        reports: TrackReports,
        times: Sequence[float],
        own: Sequence[tuple[float, float]],
        n_plots: Sequence[int],
        tracker: str,
    ) -> ScanResult:
        """From lists with one entry a scan."""
        return cls(
            reports,
            np.array(times, np.float64),
            np.array(own, np.float64).reshape(-1, 2),
            np.array(n_plots, np.int64),
            tracker,
        )

    def __repr__(self) -> str:
        return summary(self, "tracker", scans=len(self.times), reports=len(self.reports))

    @property
    def track_ids(self) -> NDArray[np.int64]:
        """Identities of all tracks that are in the reports, sorted."""
        return np.unique(self.reports.track_id)

    def of_track(self, track_id: int) -> TrackReports:
        """Reports of one track.

        Raises
        ------
        ValueError
            If there is none of this identity.
        """
        rows = self.reports.track_id == track_id
        if not rows.any():
            raise ValueError(f"track_id: no track {track_id} was reported")
        return self.reports.where(rows)
