"""The velocity of a track begins as that between its first two plots."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.initiation.base import Initiation, InitiationKernels, initiations
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.plot_columns import NOISE, PLOT_X, PLOT_Y
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import HITS, P11, P12, P22, VX, VY, X, Y

__all__ = ["TwoPoint"]


@initiations.register("two-point")
@dataclass(frozen=True, repr=False)
class TwoPoint(Initiation):
    """A track begins at one plot, at rest; its second plot gives its velocity and its position.

    The second plot must not be farther than the greatest speed allows, and three standard
    deviations of the difference of two plots.
    """

    source: ClassVar[str] = "Bar-Shalom, Li & Kirubarajan 2001, section 5.5.3"

    greatest_speed: float = parameter(
        20.0, "greatest speed to the second plot; 0 leaves this to the gate", "m/s", least=0
    )

    def kernels(self, setting: Setting, at: int) -> InitiationKernels:
        """Kernels of this part."""
        greatest = self.greatest_speed
        # Two standard deviations on each axis are the greatest speed.
        variance = 0.25 * greatest * greatest

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, X], tracks[i, Y] = plots[j, PLOT_X], plots[j, PLOT_Y]
            tracks[i, VX], tracks[i, VY] = 0.0, 0.0
            tracks[i, P11], tracks[i, P12], tracks[i, P22] = plots[j, NOISE], 0.0, variance

        def accept(
            tracks: Any, i: int, plots: Any, j: int, dt: float, dx: float, dy: float
        ) -> bool:
            if greatest == 0.0 or tracks[i, HITS] > 1.0:
                return True
            limit = greatest * dt + 3.0 * math.sqrt(tracks[i, P11] + plots[j, NOISE])
            return bool(dx * dx + dy * dy < limit * limit)

        def second(tracks: Any, i: int, plots: Any, j: int, dt: float) -> bool:
            x, y, before, now = tracks[i, X], tracks[i, Y], tracks[i, P11], plots[j, NOISE]
            tracks[i, X], tracks[i, Y] = plots[j, PLOT_X], plots[j, PLOT_Y]
            tracks[i, VX], tracks[i, VY] = (tracks[i, X] - x) / dt, (tracks[i, Y] - y) / dt
            tracks[i, P11], tracks[i, P12] = now, now / dt
            tracks[i, P22] = (before + now) / (dt * dt)
            return True

        return InitiationKernels(start, accept, second)
