"""The true targets of a scene, scan by scan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = ["Truth"]

Whole = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Truth:
    """True targets: one row for each target and scan at whose time it was there, scan by scan.

    Attributes
    ----------
    scan : ndarray of int, shape (n,)
        Number of the scan, from 0.
    time : ndarray, shape (n,)
        Time of the scan (s).
    target_id : ndarray of int, shape (n,)
        Identity, from 1 on: group after group, and in a group those first that are there from the
        start on.
    position, velocity : ndarray, shape (n, 2)
        Where it was at this time (m), and how it moved (m/s).
    visible : ndarray of bool, shape (n,)
        Whether it was within reach, not hidden by another target.
    plot : ndarray of int, shape (n,)
        Row of its plot, `Scan.rows`; -1 where it has none. Merged targets share a plot.
    groups : tuple of str
        Name of the group of each target, by identity - 1.
    """

    scan: Whole
    time: Array
    target_id: Whole
    position: Array
    velocity: Array
    visible: NDArray[np.bool_]
    plot: Whole
    groups: tuple[str, ...]

    def __repr__(self) -> str:
        return summary(self, rows=len(self), targets=self.n_targets)

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.scan)

    @property
    def n_targets(self) -> int:
        """Number of targets that were there at the time of a scan."""
        return len(np.unique(self.target_id))
