"""Which track belongs to which true object, kept from instant to instant as long as it can be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.scoring.assignment import best_assignment
from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.scored_scene import ScoredScene

__all__ = ["Correspondences"]

Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Correspondences:
    """Pairs of a true object and a track, one for each of them and each instant at most.

    Attributes
    ----------
    reach : float
        Largest distance of a pair (m).
    pairs : ClosePairs
        The pairs.
    switched : ndarray of bool, shape (n_pairs,)
        Whether the true object had another track the last time that it had one.
    """

    reach: float
    pairs: ClosePairs
    switched: NDArray[np.bool_]

    def __repr__(self) -> str:
        return summary(self, "reach", pairs=len(self.pairs))

    @classmethod
    def of(cls, scene: ScoredScene, pairs: ClosePairs, reach: float) -> Correspondences:
        """Find them instant by instant.

        Parameters
        ----------
        scene : ScoredScene
        pairs : ClosePairs
            Must go as far as `reach`.
        reach : float
            Largest distance of a pair (m).

        Notes
        -----
        A true object keeps the track that it had last as long as that is within reach. The others
        are assigned so that there are as many pairs as possible, and among these ways the sum of
        distances is the least.

        References
        ----------
        K. Bernardin, R. Stiefelhagen: Evaluating multiple object tracking performance: the CLEAR
        MOT metrics. EURASIP Journal on Image and Video Processing 2008, section 2.1.
        """
        near = pairs.within(reach)
        true_id, track_id = scene.truth.id[near.true_row], scene.tracks.id[near.track_row]
        bounds = np.searchsorted(near.instant, np.arange(len(scene.time) + 1))
        last = np.full(len(scene.truth.names), -1, dtype=np.int64)
        chosen: list[Integers] = []
        switched: list[NDArray[np.bool_]] = []
        for first, end in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
            if first == end:
                continue
            objects, tracks = true_id[first:end], track_id[first:end]
            found = _of_instant(objects, tracks, near.distance[first:end], last, reach)
            before = last[objects[found]]
            switched.append((before >= 0) & (before != tracks[found]))
            last[objects[found]] = tracks[found]
            chosen.append(first + found)
        if not chosen:
            return cls(reach, near.where(np.empty(0, np.int64)), np.empty(0, np.bool_))
        return cls(reach, near.where(np.concatenate(chosen)), np.concatenate(switched))

    def gaps(self, scene: ScoredScene) -> tuple[Integers, Integers]:
        """How many times each true object lost its track and got one again, and pairs of each.

        Returns
        -------
        breaks : ndarray of int, shape (n_objects,)
            Times that it was without a track between two instants at which it had one; instants at
            which the object is not there do not count.
        counts : ndarray of int, shape (n_objects,)
            Instants at which it had a track.
        """
        objects = len(scene.truth.names)
        has = np.zeros(len(scene.truth), dtype=np.bool_)
        has[self.pairs.true_row] = True
        order = np.lexsort((scene.truth.instant, scene.truth.id))
        id, has = scene.truth.id[order], has[order]
        counts = np.bincount(id[has], minlength=objects).astype(np.int64)
        held = np.flatnonzero(has)
        again = (id[held[1:]] == id[held[:-1]]) & (np.diff(held) > 1)
        breaks = np.bincount(id[held[1:]][again], minlength=objects).astype(np.int64)
        return breaks, counts


def _of_instant(
    objects: Integers, tracks: Integers, distance: Array, last: Integers, reach: float
) -> Integers:
    """Chosen pairs of an instant."""
    kept = last[objects] == tracks
    if kept.any():
        # Two objects may have had the same track at different times: the first one keeps it.
        places = np.flatnonzero(kept)
        kept[:] = False
        kept[places[np.unique(tracks[places], return_index=True)[1]]] = True
    free = ~(np.isin(objects, objects[kept]) | np.isin(tracks, tracks[kept]))
    rest = np.flatnonzero(free)
    if not len(rest):
        return np.flatnonzero(kept)
    # Worth more than all distances together, so that one more pair is always better.
    pair = (reach + 1) * (len(rest) + 1)
    more = best_assignment(objects[rest], tracks[rest], pair - distance[rest])
    return np.sort(np.concatenate([np.flatnonzero(kept), rest[more]]))
