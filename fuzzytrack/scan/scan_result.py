"""The tracks of a whole recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.html_reprs import as_text, block, facts, paragraph, table
from fuzzytrack.reprs import summary
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.track_reports import KINDS, TrackReports

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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

    def plot(
        self, scans: Sequence[Scan] | None = None, truth: Any = None, **options: Any
    ) -> Figure:
        """Picture of the tracks.

        Parameters
        ----------
        scans : sequence of Scan, optional
            The scans, for the plots.
        truth : tuple, mapping or Positions, optional
            True positions as `fuzzytrack.score` takes them: (time, id, position), for example.
        **options
            As for `fuzzytrack.plotting.plot_scan`.
        """
        from fuzzytrack.plotting import plot_scan

        return plot_scan(self, scans, truth, **options)[0]

    def _repr_html_(self) -> str:
        """Scans, plots, and a row for each track, for notebooks."""
        told = {"scans": f"{len(self.times):,}", "plots": f"{int(self.n_plots.sum()):,}"}
        if len(self.times):
            told["time (s)"] = f"{as_text(self.times[0])} to {as_text(self.times[-1])}"
        rows = self.reports
        ids, first = np.unique(rows.track_id, return_index=True)
        last = len(rows) - 1 - np.unique(rows.track_id[::-1], return_index=True)[1]
        speed = np.hypot(*rows.velocity[last].T)
        table_rows = [
            [str(id), KINDS[rows.kind[z]], as_text(rows.time[a]), as_text(rows.time[z]), as_text(v)]
            for id, a, z, v in zip(ids.tolist(), first, last, speed, strict=True)
        ]
        heads = ["track", "kind", "from (s)", "to (s)", "last speed (m/s)"]
        tracks = table(heads, table_rows) if table_rows else paragraph("No track was reported.")
        return block(f"Scan tracker {self.tracker}", facts(told), tracks)
