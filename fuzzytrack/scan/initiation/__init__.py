"""Track initiation: how tracks begin."""

from fuzzytrack.scan.initiation.base import Initiation, InitiationKernels, initiations
from fuzzytrack.scan.initiation.one_point import OnePoint
from fuzzytrack.scan.initiation.two_point import TwoPoint

__all__ = ["Initiation", "InitiationKernels", "OnePoint", "TwoPoint", "initiations"]
