"""A gate that is a circle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from fuzzytrack.scan.gate.base import Gate, GateKernels, gates
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.setting import Setting

__all__ = ["RoundGate"]


@gates.register("round")
@dataclass(frozen=True, repr=False)
class RoundGate(Gate):
    """Accepts a plot no farther than a radius from the predicted position."""

    radius: float = parameter(20.0, "radius of the gate", "m", least=0, above=True)

    def kernels(self, setting: Setting, at: int) -> GateKernels:
        """Kernels of this part."""
        radius = self.radius

        def reach(tracks: Any, i: int, x: float, y: float, clock: Any, variance: float) -> float:
            return radius

        def distance(
            tracks: Any, i: int, plots: Any, j: int, clock: Any, dx: float, dy: float, s11: float,
            s12: float, s22: float,
        ) -> float:  # fmt: skip
            away = math.sqrt(dx * dx + dy * dy)
            return away if away <= radius else -1.0

        return GateKernels(reach, distance)
