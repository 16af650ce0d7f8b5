"""True targets, as they are drawn: one after the other, in flat arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array

__all__ = ["TruePaths", "Truth"]

#: Times (s), identities and positions (m) of true targets, in any order.
Truth = tuple[ArrayLike, ArrayLike, ArrayLike]


@dataclass(frozen=True, eq=False)
class TruePaths:
    """True targets in flat arrays, one after the other.

    Attributes
    ----------
    names : tuple of str
        Identity of each target.
    edges : ndarray of int, shape (n_targets + 1,)
        Rows at which the targets begin, and at which one more would.
    time : ndarray, shape (n,)
        Times (s), ascending within a target.
    position : ndarray, shape (n, 2)
        Positions (m).
    """

    names: tuple[str, ...]
    edges: NDArray[np.int64]
    time: Array
    position: Array

    @classmethod
    def of(cls, truth: Truth | Any) -> TruePaths:
        """Targets of times, identities and positions in any order.

        Raises
        ------
        ValueError
            If their lengths differ, or positions have more or fewer than two axes.
        """
        if len(truth) != 3:
            raise ValueError(
                f"truth: must be times, identities and positions, got {len(truth)} arrays"
            )
        time, ids = np.asarray(truth[0], np.float64), np.asarray(truth[1])
        position = np.asarray(truth[2], np.float64)
        if time.ndim != 1 or ids.shape != time.shape or position.shape != (len(time), 2):
            raise ValueError(
                "truth: needs times and identities of shape (n,) and positions of shape (n, 2), "
                f"got {time.shape}, {ids.shape} and {position.shape}"
            )
        names, which = np.unique(ids, return_inverse=True)
        order = np.lexsort((time, which))
        edges = np.searchsorted(which[order], np.arange(len(names) + 1))
        return cls(tuple(map(str, names)), edges.astype(np.int64), time[order], position[order])

    def __len__(self) -> int:
        """Number of targets."""
        return len(self.names)

    def rows(self, target: int) -> slice:
        """Rows of a target."""
        return slice(int(self.edges[target]), int(self.edges[target + 1]))

    def at(self, target: int, times: Array) -> Array:
        """Positions of a target, shape (n_times, 2); NaN outside of its times."""
        rows = self.rows(target)
        known = self.time[rows]
        columns = [
            np.interp(times, known, self.position[rows, axis], left=np.nan, right=np.nan)
            for axis in (0, 1)
        ]
        return np.stack(columns, axis=1)
