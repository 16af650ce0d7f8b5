"""A track begins at one plot, at rest."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.initiation.base import Initiation, InitiationKernels, initiations
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.plot_columns import NOISE, PLOT_X, PLOT_Y
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import HITS, P11, P12, P22, VX, VY, X, Y

__all__ = ["OnePoint"]


@initiations.register("one-point")
@dataclass(frozen=True, repr=False)
class OnePoint(Initiation):
    """A track begins at one plot, at rest, with the variance of the speeds that targets have.

    Its second plot must not be farther than the greatest speed allows, and three standard
    deviations of a plot.
    """

    source: ClassVar[str] = "second tuning"

    speed: float = parameter(1.85, "standard deviation of the velocity of a new target, on each "
                             "axis", "m/s", least=0)  # fmt: skip
    greatest_speed: float = parameter(7.0, "greatest speed to the second plot", "m/s", least=0)

    def kernels(self, setting: Setting, at: int) -> InitiationKernels:
        """Kernels of this part."""
        variance, greatest = self.speed * self.speed, self.greatest_speed

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, X], tracks[i, Y] = plots[j, PLOT_X], plots[j, PLOT_Y]
            tracks[i, VX], tracks[i, VY] = 0.0, 0.0
            tracks[i, P11], tracks[i, P12], tracks[i, P22] = plots[j, NOISE], 0.0, variance

        def accept(
            tracks: Any, i: int, plots: Any, j: int, dt: float, dx: float, dy: float
        ) -> bool:
            if tracks[i, HITS] > 1.0:
                return True
            limit = greatest * dt + 3.0 * math.sqrt(plots[j, NOISE])
            return dx * dx + dy * dy < limit * limit

        def second(tracks: Any, i: int, plots: Any, j: int, dt: float) -> bool:
            return False

        return InitiationKernels(start, accept, second)
