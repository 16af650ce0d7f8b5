"""An α-β filter whose gains go by the quality factor of the track."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.plot_columns import INNOVATION_X, INNOVATION_Y, NOISE, PLOT_TIME
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import P11, P12, P22, SCORE, TIME, VX, VY, X, Y
from fuzzytrack.scan.update.base import Predicted, Update, UpdateKernels, updates
from fuzzytrack.schedulers.track_quality import quality_gains

__all__ = ["QualityGains"]


@updates.register("quality-gains")
@dataclass(frozen=True, repr=False)
class QualityGains(Update):
    """An α-β filter with the gains of Zhang & Jiang at the quality N of the track.

    N is the score of the quality ``zhang-jiang`` before the plot, 1 if it is lower. α is that of a
    line fitted to N + 2 plots, β Kalata's with it. β is divided by the time since the last plot of
    the track. The variances are those of a target on a straight line, with these gains.
    """

    source: ClassVar[str] = "Zhang & Jiang, track smoothing filter"

    def kernels(self, setting: Setting, at: int) -> UpdateKernels:
        """Kernels of this part."""

        def covariance(tracks: Any, i: int, dt: float) -> tuple[float, float]:
            p12, p22 = tracks[i, P12], tracks[i, P22]
            return tracks[i, P11] + dt * (2.0 * p12 + dt * p22), p12 + dt * p22

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            pass

        def predict(tracks: Any, i: int, dt: float) -> Predicted:
            p11, _ = covariance(tracks, i, dt)
            vx, vy = tracks[i, VX], tracks[i, VY]
            return tracks[i, X] + dt * vx, tracks[i, Y] + dt * vy, vx, vy, p11, 0.0, p11

        def velocity_variance(tracks: Any, i: int, dt: float) -> tuple[float, float]:
            return tracks[i, P22], tracks[i, P22]

        def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            dt = plots[j, PLOT_TIME] - tracks[i, TIME]
            n = tracks[i, SCORE]
            alpha, beta = quality_gains(n if n > 1.0 else 1.0)
            g = beta / dt
            p11, p12 = covariance(tracks, i, dt)
            p22, r = tracks[i, P22], plots[j, NOISE]
            dx, dy = plots[j, INNOVATION_X], plots[j, INNOVATION_Y]
            vx, vy = tracks[i, VX], tracks[i, VY]
            tracks[i, X] = tracks[i, X] + dt * vx + alpha * dx
            tracks[i, Y] = tracks[i, Y] + dt * vy + alpha * dy
            tracks[i, VX], tracks[i, VY] = vx + g * dx, vy + g * dy
            kept = 1.0 - alpha
            tracks[i, P11] = kept * kept * p11 + alpha * alpha * r
            tracks[i, P12] = kept * (p12 - g * p11) + alpha * g * r
            tracks[i, P22] = p22 - 2.0 * g * p12 + g * g * (p11 + r)

        return UpdateKernels(start, predict, velocity_variance, hit)
