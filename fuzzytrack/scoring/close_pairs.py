"""Pairs of a true object and a track that are near each other at an instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.scoring.scored_scene import ScoredScene

__all__ = ["ClosePairs"]

Integers = NDArray[np.int64]

# Distances of an instant that are computed one by one; above, a tree finds the near ones.
_MANY = 40_000


@dataclass(frozen=True, eq=False)
class ClosePairs:
    """Pairs of rows of a scene that are within a reach of each other, instant by instant.

    Attributes
    ----------
    true_row, track_row : ndarray of int, shape (n_pairs,)
        Rows of `ScoredScene.truth` and `ScoredScene.tracks`.
    distance : ndarray, shape (n_pairs,)
        Between the two (m).
    instant : ndarray of int, shape (n_pairs,)
        When, in order.
    """

    true_row: Integers
    track_row: Integers
    distance: Array
    instant: Integers

    def __repr__(self) -> str:
        return summary(self, pairs=len(self))

    def __len__(self) -> int:
        """Number of pairs."""
        return len(self.distance)

    @classmethod
    def of(cls, scene: ScoredScene, reach: float) -> ClosePairs:
        """Find the pairs whose distance is at most a reach (m)."""
        n_true, n_tracks = scene.n_true, scene.n_tracks
        first = np.concatenate([[0], np.cumsum(n_true)])
        start = np.concatenate([[0], np.cumsum(n_tracks)])
        found: list[tuple[Integers, Integers, Array]] = []
        for k in np.flatnonzero((n_true > 0) & (n_tracks > 0)).tolist():
            there = scene.truth.position[first[k] : first[k + 1]]
            here = scene.tracks.position[start[k] : start[k + 1]]
            rows, columns, distances = _near(there, here, reach)
            found.append((rows + first[k], columns + start[k], distances))
        if not found:
            none = np.empty(0, dtype=np.int64)
            return cls(none, none, np.empty(0), none)
        true_row, track_row, distance = (np.concatenate(part) for part in zip(*found, strict=True))
        return cls(true_row, track_row, distance, scene.truth.instant[true_row])

    def within(self, reach: float) -> ClosePairs:
        """Those whose distance is at most a smaller reach (m)."""
        return self.where(self.distance <= reach)

    def where(self, chosen: NDArray[np.generic]) -> ClosePairs:
        """Only some pairs, by a mask or by numbers."""
        return ClosePairs(
            self.true_row[chosen],
            self.track_row[chosen],
            self.distance[chosen],
            self.instant[chosen],
        )


def _near(there: Array, here: Array, reach: float) -> tuple[Integers, Integers, Array]:
    """Rows of two sets of positions that are within a reach, and their distances."""
    if len(there) * len(here) <= _MANY:
        from scipy.spatial.distance import cdist

        # Of the flat table: `nonzero` of two axes takes several times as long.
        table = cdist(there, here).ravel()
        places = np.flatnonzero(table <= reach)
        rows = places // len(here)
        return rows, places - rows * len(here), table[places]
    from scipy.spatial import KDTree

    lists = KDTree(here).query_ball_point(there, reach, return_sorted=True)
    counts = np.array([len(each) for each in lists])
    rows = np.repeat(np.arange(len(there)), counts)
    columns = np.concatenate([np.asarray(each, dtype=np.int64) for each in lists])
    distances = np.sqrt(((there[rows] - here[columns]) ** 2).sum(axis=1))
    # The tree rounds otherwise.
    kept = distances <= reach
    return rows[kept], columns[kept], distances[kept]
