"""HOTA: detection, association and localization in one number, over all thresholds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.scoring.assignment import best_assignment
from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.scored_scene import ScoredScene

__all__ = ["THRESHOLDS", "Hota", "hota"]

Integers = NDArray[np.int64]

#: Thresholds of the similarity, as in the paper.
THRESHOLDS = np.arange(0.05, 0.99, 0.05)


@dataclass(frozen=True, eq=False)
class Hota:
    """Higher order tracking accuracy.

    Attributes
    ----------
    hota, det_a, ass_a, loc_a : float
        Means over the thresholds; NaN if there are neither true positions nor tracks.
    curves : ndarray, shape (4, n_thresholds)
        The four at each of `THRESHOLDS`.
    """

    hota: float
    det_a: float
    ass_a: float
    loc_a: float
    curves: Array

    def __repr__(self) -> str:
        return summary(self, "hota", "det_a", "ass_a", "loc_a")


def hota(scene: ScoredScene, pairs: ClosePairs, cutoff: float) -> Hota:
    """Higher order tracking accuracy with the similarity 1 - distance/cut-off.

    At a threshold, TP pairs are at least so similar, FN true positions and FP positions of tracks
    are left. DetA = TP/(TP + FN + FP); AssA = the mean over the pairs of A = TPA/(TPA + FNA + FPA),
    which counts the instants at which this object and this track are paired, and those at which
    only one of the two is there, or both with others; HOTA = √(DetA · AssA); LocA = mean similarity
    of the pairs.

    Parameters
    ----------
    scene : ScoredScene
    pairs : ClosePairs
        Must reach as far as the cut-off.
    cutoff : float
        Distance at which the similarity is 0 (m).

    Returns
    -------
    Hota

    Notes
    -----
    Pairs of an instant are assigned with the greatest sum of similarity times global alignment: the
    share of all instants at which this object and this track may belong together. One assignment
    serves all thresholds.

    References
    ----------
    J. Luiten, A. Ošep, P. Dendorfer, P. Torr, A. Geiger, L. Leal-Taixé, B. Leibe: HOTA: a higher
    order metric for evaluating multi-object tracking. International Journal of Computer Vision 129
    (2021), equations 10 to 16.
    """
    n_true, n_tracks = len(scene.truth), len(scene.tracks)
    if not n_true + n_tracks:
        nothing = np.full((4, len(THRESHOLDS)), np.nan)
        return Hota(np.nan, np.nan, np.nan, np.nan, nothing)
    near = pairs.where(pairs.distance < cutoff)
    similarity = 1 - near.distance / cutoff
    tracks = max(1, len(scene.tracks.names))
    code = scene.truth.id[near.true_row] * tracks + scene.tracks.id[near.track_row]
    both, which = np.unique(code, return_inverse=True)
    # Instants of the true object, and of the track, of each pair of identities.
    objects = np.bincount(scene.truth.id, minlength=len(scene.truth.names))[both // tracks]
    lives = np.bincount(scene.tracks.id, minlength=tracks)[both % tracks]
    possible = np.bincount(which, _shares(near, similarity), minlength=len(both))
    alignment = possible / (objects + lives - possible)
    worth = alignment[which] * similarity
    chosen = best_assignment(near.true_row, near.track_row, worth, near.instant)
    similarity, which = similarity[chosen], which[chosen]
    curves = np.array(
        [_at(each, similarity, which, objects, lives, n_true + n_tracks) for each in THRESHOLDS]
    ).T
    whole, detection, association, place = curves.mean(axis=1).tolist()
    return Hota(whole, detection, association, place, curves)


def _shares(near: ClosePairs, similarity: Array) -> Array:
    """Similarity of each pair over that of its members with all others at the instant."""
    if not len(near):
        return similarity
    rows = np.bincount(near.true_row, similarity)[near.true_row]
    columns = np.bincount(near.track_row, similarity)[near.track_row]
    return np.asarray(similarity / (rows + columns - similarity))


def _at(
    threshold: float,
    similarity: Array,
    which: Integers,
    objects: Integers,
    lives: Integers,
    rows: int,
) -> tuple[float, float, float, float]:
    """HOTA, DetA, AssA and LocA at a threshold."""
    matched = similarity >= threshold - np.finfo(float).eps
    count = int(matched.sum())
    detection = count / (rows - count)
    if not count:
        # No pair is wrong in its place.
        return 0.0, detection, 0.0, 1.0
    together = np.bincount(which[matched], minlength=len(objects))
    association = float((together**2 / (objects + lives - together)).sum()) / count
    place = float(similarity[matched].mean())
    return float(np.sqrt(detection * association)), detection, association, place
