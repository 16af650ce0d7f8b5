"""Which track follows which true object, scan by scan, as bars over time show it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.scan.track_reports import TrackReports
from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.correspondences import Correspondences
from fuzzytrack.scoring.instants import Timing, make_scene
from fuzzytrack.scoring.positions import Positions

__all__ = ["FollowedObjects"]


@dataclass(frozen=True, eq=False)
class FollowedObjects:
    """True objects at the scans, and the tracks that follow them.

    Attributes
    ----------
    names : tuple of str
        Identity of each object.
    time : ndarray, shape (n_instants,)
        Times of the scans (s).
    there : ndarray of bool, shape (n_objects, n_instants)
        When each object is there.
    track : ndarray of int, shape (n_objects, n_instants)
        Identity of the track that follows it; 0 if none does.
    switched : ndarray of bool, shape (n_objects, n_instants)
        Whether another track begins to follow it than the one that did before.
    """

    names: tuple[str, ...]
    time: Array
    there: Mask
    track: NDArray[np.int64]
    switched: Mask

    @classmethod
    def of(
        cls, reports: TrackReports, truth: Any, times: Array, within: float, lag: float
    ) -> FollowedObjects:
        """Find them as the metrics do (`fuzzytrack.scoring.correspondences`).

        Raises
        ------
        DataError
            If the truth is empty, or has no time in common with the scans.
        """
        scene = make_scene(
            Positions.of(reports, "result"),
            Positions.of(truth, "truth"),
            Timing(times=times, lag=lag),
        )
        held = Correspondences.of(scene, ClosePairs.of(scene, within), within)
        shape = (len(scene.truth.names), len(scene.time))
        there = np.zeros(shape, bool)
        there[scene.truth.id, scene.truth.instant] = True
        track, switched = np.zeros(shape, np.int64), np.zeros(shape, bool)
        rows = scene.truth.id[held.pairs.true_row], held.pairs.instant
        ids = np.asarray(scene.tracks.names, np.int64)
        track[rows] = ids[scene.tracks.id[held.pairs.track_row]]
        switched[rows] = held.switched
        return cls(tuple(map(str, scene.truth.names.tolist())), scene.time, there, track, switched)
