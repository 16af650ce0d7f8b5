"""The position of a moving radar from scan to scan, and what is wrong with it."""

from __future__ import annotations

import math
from collections import deque
from statistics import median

from fuzzytrack.arrays import Array
from fuzzytrack.recordings.scan_findings import ScanFindings
from fuzzytrack.scan.scan import UNKNOWN_PLACE

__all__ = ["RadarPlace"]

# A radar jumps if it is so many times as fast as usual, and faster than this (m/s); what is usual
# is known by so many scans, and the last ones of them.
_FASTER, _LEAST = 10.0, 50.0
_FEWEST, _LATEST = 3, 16


class RadarPlace:
    """Position of the radar; where a scan has none, that of the one before is kept.

    Parameters
    ----------
    findings : ScanFindings
        Counts scans without a position, and jumps.
    place : tuple of float
        Position before one is known (m).
    told : bool
        Whether each scan should have one.

    Attributes
    ----------
    findings : ScanFindings
    place : tuple of float
        The position now (m).
    """

    def __init__(
        self,
        findings: ScanFindings,
        place: tuple[float, float] = UNKNOWN_PLACE,
        *,
        told: bool = False,
    ) -> None:
        self.findings, self._told = findings, told
        self.place = place
        self._time = math.nan
        self._speeds: deque[float] = deque(maxlen=_LATEST)

    def move(self, place: Array, time: float) -> tuple[float, float]:
        """Take the position of a scan, NaN where there is none.

        Parameters
        ----------
        place : ndarray, shape (2,)
            Position (m).
        time : float
            Time of the scan (s).

        Returns
        -------
        (float, float)
            The position that counts.
        """
        x, y = map(float, place)
        if not math.isfinite(x + y):
            self.findings.own_missing += self._told
            return self.place
        if time > self._time:
            self._look(math.hypot(x - self.place[0], y - self.place[1]), time - self._time)
        self.findings.own_known += 1
        self.place, self._time = (x, y), time
        return self.place

    def _look(self, way: float, wait: float) -> None:
        """Count a jump."""
        speed = way / wait
        usual = median(self._speeds) if len(self._speeds) >= _FEWEST else math.inf
        if speed > _LEAST and speed > _FASTER * usual:
            self.findings.own_jumps += 1
        elif speed < math.inf:
            self._speeds.append(speed)
