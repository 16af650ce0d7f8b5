"""Gate: whether a plot may be that of a track."""

from fuzzytrack.scan.gate.base import Gate, GateKernels, gates
from fuzzytrack.scan.gate.box import BoxGate
from fuzzytrack.scan.gate.covariance import CovarianceGate
from fuzzytrack.scan.gate.round import RoundGate

__all__ = ["BoxGate", "CovarianceGate", "Gate", "GateKernels", "RoundGate", "gates"]
