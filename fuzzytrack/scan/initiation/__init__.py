"""Track initiation: how tracks begin."""

from fuzzytrack.scan.initiation.base import Initiation, InitiationKernels, initiations
from fuzzytrack.scan.initiation.one_point import OnePoint

__all__ = ["Initiation", "InitiationKernels", "OnePoint", "initiations"]
