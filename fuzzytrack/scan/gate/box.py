"""A gate in range and bearing, with a size that goes by the quality of the track."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.clock import LATEST, OWN_X, OWN_Y
from fuzzytrack.scan.gate.base import Gate, GateKernels, gates
from fuzzytrack.scan.part import parameter, word
from fuzzytrack.scan.plot_columns import PLOT_TIME, PLOT_X, PLOT_Y
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import HITS, MISSES, SCORE, TIME

__all__ = ["BoxGate"]


def gate_factor(n: float) -> float:
    """Standard deviation of a position predicted from n > 1 plots on a line, in that of a plot."""
    return math.sqrt(2.0 * (2.0 * n + 1.0) / (n * (n - 1.0)))


@gates.register("box")
@dataclass(frozen=True, repr=False)
class BoxGate(Gate):
    """Accepts a plot that is near the predicted position in range and in bearing.

    With the quality N of the track (see the quality ``zhang-jiang``), the factor
    ``F(N) = √(2(2N + 1)/(N(N - 1)))``, and the noise σ and plot size L in range or in bearing, the
    distance from the center to either end is

    * ``published``: ``F(N)(2σ + L)/2``, where F is `largest` at most, as at N = 1. It has no room
      for the noise of the plot itself, and holds its plots only where L is large against σ.
    * ``safe``: ``deviations·σ√(1 + F²(N + 1)) + L/2``, and `growth` more for each miss. A track of
      quality N has N + 1 plots.

    A track with one plot has no quality yet: ``speed·dt + 3σ + L/2``.
    """

    needs_own = True
    source: ClassVar[str] = "Zhang & Jiang, gate calculation; safe form measured on simulations"

    form: str = word(
        "safe", "published: F(N)(2σ + L) is the whole length; safe: with room for the plot's noise",
        "safe", "published",
    )  # fmt: skip
    length: float = parameter(100.0, "size of a plot along the range", "m", least=0)
    angle: float = parameter(0.0175, "size of a plot in bearing", "rad", least=0, most=1)
    largest: float = parameter(3.0, "largest factor of the published form", "", least=0, above=True)
    deviations: float = parameter(4.0, "standard deviations of the safe form", "", least=0,
                                  above=True)  # fmt: skip
    growth: float = parameter(10.0, "what the safe form grows by with each miss", "m", least=0)
    speed: float = parameter(20.0, "greatest speed to the second plot", "m/s", least=0)

    def kernels(self, setting: Setting, at: int) -> GateKernels:
        """Kernels of this part."""
        size = self._size(setting.sensor.range_noise, setting.sensor.bearing_noise)

        def reach(tracks: Any, i: int, x: float, y: float, clock: Any, variance: float) -> float:
            dx, dy = x - clock[OWN_X], y - clock[OWN_Y]
            r = math.sqrt(dx * dx + dy * dy)
            along, across = size(tracks, i, clock[LATEST] - tracks[i, TIME], r)
            return along + r * (across if across < math.pi else math.pi)

        def distance(
            tracks: Any, i: int, plots: Any, j: int, clock: Any, dx: float, dy: float, s11: float,
            s12: float, s22: float,
        ) -> float:  # fmt: skip
            zx, zy = plots[j, PLOT_X] - clock[OWN_X], plots[j, PLOT_Y] - clock[OWN_Y]
            x, y = zx - dx, zy - dy
            r = math.sqrt(x * x + y * y)
            along, across = size(tracks, i, plots[j, PLOT_TIME] - tracks[i, TIME], r)
            if abs(math.sqrt(zx * zx + zy * zy) - r) > along:
                return -1.0
            if abs(math.atan2(x * zy - y * zx, x * zx + y * zy)) > across:
                return -1.0
            return math.sqrt(dx * dx + dy * dy)

        return GateKernels(reach, distance)

    def _size(
        self, range_noise: float, bearing_noise: float
    ) -> Callable[[Any, int, float, float], tuple[float, float]]:
        """Half of the length (m) and of the angle (rad), as a kernel."""
        published = self.form == "published"
        half_length, half_angle = 0.5 * self.length, 0.5 * self.angle
        largest, deviations, growth, speed = (
            self.largest, self.deviations, self.growth, self.speed,
        )  # fmt: skip

        def size(tracks: Any, i: int, dt: float, r: float) -> tuple[float, float]:
            r = r if r > 1.0 else 1.0
            if tracks[i, HITS] < 2.0:
                along = speed * dt + 3.0 * range_noise + half_length
                return along, speed * dt / r + 3.0 * bearing_noise + half_angle
            n = tracks[i, SCORE] if tracks[i, SCORE] > 1.0 else 1.0
            if published:
                factor = largest
                if n > 1.0 and gate_factor(n) < largest:
                    factor = gate_factor(n)
                return factor * (range_noise + half_length), factor * (bearing_noise + half_angle)
            factor = gate_factor(n + 1.0)
            wide = deviations * math.sqrt(1.0 + factor * factor)
            more = growth * tracks[i, MISSES]
            return wide * range_noise + half_length + more, (
                wide * bearing_noise + half_angle + more / r
            )

        return size
