"""Gains of a covariance that shrinks from the start of a track to its steady state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.plot_columns import INNOVATION_X, INNOVATION_Y, NOISE, PLOT_TIME
from fuzzytrack.scan.process_noise import process_noise
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import P11, P12, P22, TIME, VX, VY, X, Y
from fuzzytrack.scan.update.base import Predicted, Update, UpdateKernels, updates

__all__ = ["Transient"]


@updates.register("transient")
@dataclass(frozen=True, repr=False)
class Transient(Update):
    """An α-β filter whose gains are those of one covariance for both axes.

    With P predicted and r the variance of the plot, ``α = P11/(P11 + r)`` and
    ``β/T = P12/(P11 + r)``; the covariance is corrected in the Joseph form.
    """

    source: ClassVar[str] = "Kalata's filter before its steady state; second tuning"

    acceleration: float = parameter(
        0.117, "standard deviation of the acceleration of a target", "m/s²", least=0, above=True
    )

    def kernels(self, setting: Setting, at: int) -> UpdateKernels:
        """Kernels of this part."""
        noise = process_noise(self.acceleration, setting.sensor.period)

        def covariance(tracks: Any, i: int, dt: float) -> tuple[float, float, float]:
            q11, q12, q22 = noise(dt)
            p12, p22 = tracks[i, P12], tracks[i, P22]
            p11 = tracks[i, P11] + dt * (2.0 * p12 + dt * p22) + q11
            return p11, p12 + dt * p22 + q12, p22 + q22

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            pass

        def predict(tracks: Any, i: int, dt: float) -> Predicted:
            p11, _, _ = covariance(tracks, i, dt)
            vx, vy = tracks[i, VX], tracks[i, VY]
            return tracks[i, X] + dt * vx, tracks[i, Y] + dt * vy, vx, vy, p11, 0.0, p11

        def velocity_variance(tracks: Any, i: int, dt: float) -> tuple[float, float]:
            _, _, p22 = covariance(tracks, i, dt)
            return p22, p22

        def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            dt = plots[j, PLOT_TIME] - tracks[i, TIME]
            p11, p12, p22 = covariance(tracks, i, dt)
            r = plots[j, NOISE]
            alpha, g = p11 / (p11 + r), p12 / (p11 + r)
            dx, dy = plots[j, INNOVATION_X], plots[j, INNOVATION_Y]
            vx, vy = tracks[i, VX], tracks[i, VY]
            tracks[i, X] = tracks[i, X] + dt * vx + alpha * dx
            tracks[i, Y] = tracks[i, Y] + dt * vy + alpha * dy
            tracks[i, VX] = vx + g * dx
            tracks[i, VY] = vy + g * dy
            kept = 1.0 - alpha
            tracks[i, P11] = kept * kept * p11 + alpha * alpha * r
            tracks[i, P12] = kept * (p12 - g * p11) + alpha * g * r
            tracks[i, P22] = p22 - 2.0 * g * p12 + g * g * (p11 + r)

        return UpdateKernels(start, predict, velocity_variance, hit)
