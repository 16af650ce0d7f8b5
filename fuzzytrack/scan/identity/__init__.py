"""Identity: whether a new track is one that was lost."""

from fuzzytrack.scan.identity.base import Identity, IdentityKernels, identities
from fuzzytrack.scan.identity.dormant import Dormant
from fuzzytrack.scan.identity.none import NoIdentity

__all__ = ["Dormant", "Identity", "IdentityKernels", "NoIdentity", "identities"]
