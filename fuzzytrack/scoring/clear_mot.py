"""CLEAR MOT: misses, false tracks and switches of identity, and the mean distance of the rest."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fuzzytrack.scoring.correspondences import Correspondences
from fuzzytrack.scoring.scored_scene import ScoredScene

__all__ = ["ClearMot", "clear_mot"]


@dataclass(frozen=True)
class ClearMot:
    """CLEAR MOT over all instants.

    Attributes
    ----------
    mota : float
        1 - (misses + false positives + switches) / true positions; may be negative. NaN if there
        are no true positions.
    motp : float
        Mean distance of the pairs (m); NaN if there are none.
    misses, false_positives : int
        True positions without a track, and positions of tracks without a true object.
    switches : int
        Times that a true object had another track than the last time that it had one.
    fragmentations : int
        Times that a true object was without a track between two instants at which it had one.
    matches : int
        Number of pairs.
    """

    mota: float
    motp: float
    misses: int
    false_positives: int
    switches: int
    fragmentations: int
    matches: int


def clear_mot(scene: ScoredScene, found: Correspondences) -> ClearMot:
    """Accuracy and precision of multiple object tracking.

    Parameters
    ----------
    scene : ScoredScene
    found : Correspondences

    Returns
    -------
    ClearMot

    References
    ----------
    K. Bernardin, R. Stiefelhagen: Evaluating multiple object tracking performance: the CLEAR MOT
    metrics. EURASIP Journal on Image and Video Processing 2008, section 2.2.
    """
    matches, truth = len(found.pairs), len(scene.truth)
    misses, false = truth - matches, len(scene.tracks) - matches
    switches = int(found.switched.sum())
    fragmentations = int(found.gaps(scene)[0].sum())
    accuracy = 1 - (misses + false + switches) / truth if truth else math.nan
    precision = float(np.mean(found.pairs.distance)) if matches else math.nan
    return ClearMot(accuracy, precision, misses, false, switches, fragmentations, matches)
