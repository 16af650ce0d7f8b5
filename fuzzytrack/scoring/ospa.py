"""OSPA: the distance between the set of true positions and that of the tracks, at each instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.scoring.assignment import best_assignment
from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.scored_scene import ScoredScene

__all__ = ["Ospa", "SetAssignment", "ospa"]

Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SetAssignment:
    """The best assignment between the two sets of each instant, with distances cut off.

    Attributes
    ----------
    cutoff, order : float
        Cut-off c (m) and order p.
    n_true, n_tracks : ndarray of int, shape (n_instants,)
        Sizes of the sets.
    n_assigned : ndarray of int, shape (n_instants,)
        Pairs that are nearer than the cut-off.
    powers : ndarray, shape (n_instants,)
        Sum of the p-th powers of their distances.

    Notes
    -----
    A pair changes the sum of OSPA, and that of GOSPA with α = 2, by dᵖ - cᵖ against leaving both
    members alone. So one assignment serves both: that with the greatest sum of cᵖ - dᵖ.
    """

    cutoff: float
    order: float
    n_true: Integers
    n_tracks: Integers
    n_assigned: Integers
    powers: Array

    def __repr__(self) -> str:
        return summary(self, "cutoff", "order", "n_assigned")

    @classmethod
    def of(
        cls, scene: ScoredScene, pairs: ClosePairs, cutoff: float, order: float
    ) -> SetAssignment:
        """Assign tracks to true objects; `pairs` must reach as far as the cut-off."""
        power = pairs.distance**order
        gain = cutoff**order - power
        chosen = best_assignment(pairs.true_row, pairs.track_row, gain, pairs.instant)
        count, where = len(scene.time), pairs.instant[chosen]
        sums = np.bincount(where, power[chosen], minlength=count).astype(np.float64)
        assigned = np.bincount(where, minlength=count).astype(np.int64)
        return cls(cutoff, order, scene.n_true, scene.n_tracks, assigned, sums)


@dataclass(frozen=True, eq=False)
class Ospa:
    """OSPA at each instant (m), shape (n_instants,), and its parts.

    Attributes
    ----------
    distance : ndarray
        The metric; 0 where both sets are empty.
    localization, cardinality : ndarray
        Parts by the distances of pairs and by the difference of the numbers; the sum of their p-th
        powers is that of `distance`.
    """

    distance: Array
    localization: Array
    cardinality: Array

    def __repr__(self) -> str:
        return summary(self, "distance")


def ospa(assigned: SetAssignment) -> Ospa:
    """Optimal subpattern assignment metric, with n the size of the larger set, m of the other.

    OSPAᵖ = (1/n) (min Σ min(d, c)ᵖ + cᵖ (n - m)), the sum over the m pairs of an assignment.

    Parameters
    ----------
    assigned : SetAssignment

    Returns
    -------
    Ospa

    References
    ----------
    D. Schuhmacher, B.-T. Vo, B.-N. Vo: A consistent metric for performance evaluation of
    multi-object filters. IEEE Transactions on Signal Processing 56 (2008), equations 1 to 5.
    """
    whole = assigned.cutoff**assigned.order
    most = np.maximum(assigned.n_true, assigned.n_tracks)
    least = np.minimum(assigned.n_true, assigned.n_tracks)
    size = np.maximum(most, 1)
    near = (assigned.powers + whole * (least - assigned.n_assigned)) / size
    many = whole * (most - least) / size
    root = 1 / assigned.order
    return Ospa((near + many) ** root, near**root, many**root)
