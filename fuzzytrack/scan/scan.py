"""The plots of one scan."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = ["UNKNOWN_PLACE", "Scan"]

#: Position of a radar that is not known.
UNKNOWN_PLACE = (math.nan, math.nan)


@dataclass(frozen=True, eq=False)
class Scan:
    """The plots of one turn of an antenna, or of one picture of a sensor.

    Attributes
    ----------
    time : float
        Time of the scan (s); later than that of the scan before.
    positions : ndarray, shape (n, 2)
        Plots in a frame that does not move (m). There may be none.
    covariances : ndarray, shape (n, 3), or None
        Variance of x, covariance, and variance of y of each plot (m²). None: by the noise of the
        scan tracker, in range and bearing from `own`.
    times : ndarray, shape (n,), or None
        Times of the plots (s), none later than `time`; None if all were made at `time`.
    own : tuple of float
        Position of the radar in the same frame (m); `UNKNOWN_PLACE` if it is not known: then the
        noise of plots without covariances is the same everywhere, and parts of a scan tracker that
        need ranges or bearings refuse the scan.
    rows : ndarray of int, shape (n,), or None
        Row of each plot in its recording; None numbers the plots of this scan from 0.
    """

    time: float
    positions: Array
    covariances: Array | None = None
    times: Array | None = None
    own: tuple[float, float] = (0.0, 0.0)
    rows: NDArray[np.int64] | None = None

    def __repr__(self) -> str:
        return summary(self, "time", plots=len(self.positions))

    def __len__(self) -> int:
        """Number of plots."""
        return len(self.positions)
