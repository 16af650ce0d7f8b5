"""A scan tracker: from scans to tracks."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_parts import ScanParts
from fuzzytrack.scan.scan_result import ScanResult
from fuzzytrack.scan.scan_session import ScanSession
from fuzzytrack.scan.track_reports import TrackReports

__all__ = ["ScanTracker"]


@dataclass(frozen=True, repr=False)
class ScanTracker(ScanParts):
    """Makes tracks from the plots of a radar, which have no identities.

    A value: it does not change, and pickles and hashes. What it knows of a recording is in a
    session, see `start`.

    Attributes
    ----------
    sensor : Sensor
        Noise, detection probability and period of the radar.
    extraction, clutter, candidates, gate, association, update : Part
        How plots are taken, how dense clutter is, which plots may be those of a track, and are,
        and what they do to it.
    quality, kind, initiation, confirmation, identity, report : Part
        How good a track is, whether it moves, how it begins, is confirmed and ends, which identity
        it has, and when it is reported.
    name : str
        Name of the configuration, for tables and messages.

    Raises
    ------
    TypeError
        If a part is not one of its role.

    Examples
    --------
    >>> import numpy as np
    >>> from fuzzytrack.scan import Scan, ScanTracker
    >>> session = ScanTracker().start()
    >>> for k in range(12):
    ...     plots = np.array([[3.0 * k, 50.0], [-80.0, 4.0 * k]])
    ...     reports = session.step(Scan(1.7 * k, plots))
    >>> reports.track_id
    array([1, 2])
    """

    def start(self) -> ScanSession:
        """Begin a session that has seen nothing."""
        return ScanSession(self)

    def run(
        self,
        scans: Iterable[Scan],
        *,
        tentative: bool = False,
        progress: Callable[[int], None] | None = None,
    ) -> ScanResult:
        """Track all scans of a recording.

        Parameters
        ----------
        scans : iterable of Scan
            In the order of their times.
        tentative : bool
            Whether tentative tracks, and confirmed ones that the report leaves out, are returned
            too.
        progress : callable, optional
            Called after each scan with the number of scans so far.

        Raises
        ------
        DataError
            If a plot cannot be used, or times go backwards.
        """
        session = self.start()
        found: list[TrackReports] = []
        times, own, plots = [], [], []
        for scan in scans:
            found.append(session.step(scan, tentative=tentative))
            times.append(scan.time)
            own.append(scan.own)
            plots.append(len(scan))
            if progress is not None:
                progress(session.scans)
        return ScanResult.of(TrackReports.joined(found), times, own, plots, self.name)
