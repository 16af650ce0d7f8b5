"""The sensor: noise of its plots, detection probability, and period of its scans."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

from fuzzytrack.scan.part import Part, parameter

__all__ = ["Sensor"]

#: ``noise(x, y, own_x, own_y) -> (r11, r12, r22)``: covariance of a plot (m²).
NoiseKernel = Callable[[float, float, float, float], tuple[float, float, float]]


@dataclass(frozen=True, repr=False)
class Sensor(Part):
    """A radar: how exact its plots are, how often it sees a target, how long a scan takes.

    With u the unit vector from the radar to a plot at range r, and w perpendicular to it, the
    covariance of a plot is ``R = range_noise² uuᵀ + (bearing_noise r)² wwᵀ + extra_noise² I``; it
    is ``(range_noise² + extra_noise²) I`` where the position of the radar is not known.
    """

    source: ClassVar[str] = "measured on harbor radar, second tuning"

    range_noise: float = parameter(0.702, "standard deviation along the range", "m", least=0)
    bearing_noise: float = parameter(
        0.006, "standard deviation of the bearing", "rad", least=0, most=0.2
    )
    extra_noise: float = parameter(
        0.7, "standard deviation of what is left, in any direction", "m", least=0, above=True
    )
    detection: float = parameter(
        0.624, "probability that a target is detected in a scan", least=0, most=1, above=True,
        below=True,
    )  # fmt: skip
    period: float = parameter(
        1.678, "duration of a scan to which probabilities and random walks belong", "s", least=0,
        above=True,
    )  # fmt: skip

    def noise(self) -> NoiseKernel:
        """Covariance of a plot by its place and that of the radar, as a kernel."""
        along = self.range_noise * self.range_noise
        bearing = self.bearing_noise * self.bearing_noise
        extra = self.extra_noise * self.extra_noise

        def noise(x: float, y: float, own_x: float, own_y: float) -> tuple[float, float, float]:
            dx = x - own_x
            dy = y - own_y
            square = dx * dx + dy * dy
            # At the radar, or NaN where its position is not known.
            if not square > 0.0:
                return along + extra, 0.0, along + extra
            # (along - bearing r²) uuᵀ + (bearing r² + extra) I, as uuᵀ + wwᵀ = I.
            across = bearing * square
            share = (along - across) / square
            both = across + extra
            return share * dx * dx + both, share * dx * dy, share * dy * dy + both

        return noise
