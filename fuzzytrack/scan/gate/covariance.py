"""A gate by the covariance of the innovation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.gate.base import Gate, GateKernels, gates
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.setting import Setting

__all__ = ["CovarianceGate"]


@gates.register("covariance")
@dataclass(frozen=True, repr=False)
class CovarianceGate(Gate):
    """Accepts a plot whose innovation ν has ``νᵀS⁻¹ν`` below a limit.

    S is the covariance of the prediction and of the plot together, so the gate is an ellipse that
    is wide across the line of sight.
    """

    source: ClassVar[str] = "second tuning"

    limit: float = parameter(16.0, "largest squared distance", "", least=0, above=True)

    def kernels(self, setting: Setting, at: int) -> GateKernels:
        """Kernels of this part."""
        limit = self.limit

        def reach(tracks: Any, i: int, x: float, y: float, clock: Any, variance: float) -> float:
            return math.sqrt(limit * variance)

        def distance(
            tracks: Any, i: int, plots: Any, j: int, clock: Any, dx: float, dy: float, s11: float,
            s12: float, s22: float,
        ) -> float:  # fmt: skip
            square = (s22 * dx * dx - 2.0 * s12 * dx * dy + s11 * dy * dy) / (s11 * s22 - s12 * s12)
            return square if square < limit else -1.0

        return GateKernels(reach, distance)
