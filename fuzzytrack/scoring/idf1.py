"""IDF1: how much of the truth and of the tracks has the right identity throughout."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fuzzytrack.scoring.assignment import best_assignment
from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.scored_scene import ScoredScene

__all__ = ["Idf1", "idf1"]


@dataclass(frozen=True)
class Idf1:
    """Identification over all instants; NaN where there is nothing to count.

    Attributes
    ----------
    idf1 : float
        Share of all positions, true ones and those of tracks, that are identified.
    idp, idr : float
        Share of the positions of tracks, and of the true ones, that are.
    """

    idf1: float
    idp: float
    idr: float


def idf1(scene: ScoredScene, pairs: ClosePairs, reach: float) -> Idf1:
    """Identification precision, recall and F1.

    One track at most is given to each true object for all time, so that the number N of instants at
    which the two are within reach is greatest. IDF1 = 2N / (true positions + positions of tracks),
    IDP = N / positions of tracks, IDR = N / true positions.

    Parameters
    ----------
    scene : ScoredScene
    pairs : ClosePairs
        Must go as far as `reach`.
    reach : float
        Largest distance of a pair (m).

    Returns
    -------
    Idf1

    References
    ----------
    E. Ristani, F. Solera, R. Zou, R. Cucchiara, C. Tomasi: Performance measures and a data set for
    multi-target, multi-camera tracking. ECCV workshops 2016, equations 1 to 3.
    """
    near = pairs.within(reach)
    tracks = max(1, len(scene.tracks.names))
    code = scene.truth.id[near.true_row] * tracks + scene.tracks.id[near.track_row]
    both, counts = np.unique(code, return_counts=True)
    chosen = best_assignment(both // tracks, both % tracks, counts.astype(float))
    identified = int(counts[chosen].sum())

    def share(part: int, whole: int) -> float:
        return part / whole if whole else math.nan

    n_true, n_tracks = len(scene.truth), len(scene.tracks)
    return Idf1(
        share(2 * identified, n_true + n_tracks),
        share(identified, n_tracks),
        share(identified, n_true),
    )
