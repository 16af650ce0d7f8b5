"""Association: which plot is that of which track."""

from fuzzytrack.scan.association.base import Association, AssociationKernels, associations
from fuzzytrack.scan.association.greedy import GreedyAssociation
from fuzzytrack.scan.association.nearest import NearestAssociation
from fuzzytrack.scan.association.optimal import OptimalAssociation

__all__ = [
    "Association",
    "AssociationKernels",
    "GreedyAssociation",
    "NearestAssociation",
    "OptimalAssociation",
    "associations",
]
