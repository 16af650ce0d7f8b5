"""Association: which plot is that of which track."""

from fuzzytrack.scan.association.base import Association, AssociationKernels, associations
from fuzzytrack.scan.association.optimal import OptimalAssociation

__all__ = ["Association", "AssociationKernels", "OptimalAssociation", "associations"]
