"""GOSPA: errors of position, missed objects and false tracks in one distance, at each instant."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.scoring.ospa import SetAssignment

__all__ = ["Gospa", "gospa"]


@dataclass(frozen=True, eq=False)
class Gospa:
    """GOSPA at each instant, shape (n_instants,), and its parts.

    Attributes
    ----------
    distance : ndarray
        The metric (m).
    localization : ndarray
        Root of the sum of p-th powers of the distances of pairs (m).
    missed, false : ndarray
        Number of true objects without a track, and of tracks without a true object. Each adds
        cᵖ/2 to the p-th power of `distance`.
    """

    distance: Array
    localization: Array
    missed: Array
    false: Array

    def __repr__(self) -> str:
        return summary(self, "distance")


def gospa(assigned: SetAssignment) -> Gospa:
    """Generalized optimal subpattern assignment metric with α = 2.

    GOSPAᵖ = min (Σ dᵖ + (missed + false) cᵖ/2), over all ways to assign some of the tracks to some
    of the true objects; the sum is over the pairs.

    Parameters
    ----------
    assigned : SetAssignment

    Returns
    -------
    Gospa

    References
    ----------
    A. S. Rahmathullah, Á. F. García-Fernández, L. Svensson: Generalized optimal sub-pattern
    assignment metric. 20th International Conference on Information Fusion (2017), proposition 1.
    """
    missed = assigned.n_true - assigned.n_assigned
    false = assigned.n_tracks - assigned.n_assigned
    root = 1 / assigned.order
    total = assigned.powers + (missed + false) * assigned.cutoff**assigned.order / 2
    return Gospa(total**root, assigned.powers**root, missed.astype(float), false.astype(float))
