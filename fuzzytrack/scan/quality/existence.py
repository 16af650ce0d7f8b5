"""Log-odds that there is a target."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.clock import SCAN_TIME
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.plot_columns import LOG_DENSITY, PLOT_TIME, STRENGTH
from fuzzytrack.scan.quality.base import Quality, QualityKernels, qualities
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import LOOKED, SCORE

__all__ = ["Existence"]


@qualities.register("existence")
@dataclass(frozen=True, repr=False)
class Existence(Quality):
    """Log-odds L of the existence of a target, by integrated probabilistic data association.

    With one plot: between scans a target survives with a probability, ``r = survival·σ(L)``; a plot
    adds ``ln(1 - PD + PD N(ν; 0, S)/λ)``, a scan without one ``ln(1 - PD)``. PD is the detection
    probability of the sensor, λ the density of clutter at the plot.
    """

    source: ClassVar[str] = "Musicki, Evans & Stankovic 1994, IPDA; second tuning"

    survival: float = parameter(0.998, "probability that a target is still there a period of the "
                                "sensor later", least=0, most=1, above=True)  # fmt: skip
    birth: float = parameter(1.5e-5, "density of new targets", "1/m² and scan", least=0, above=True)
    most: float = parameter(22.0, "largest log-odds", "nats", most=500)

    def kernels(self, setting: Setting, at: int) -> QualityKernels:
        """Kernels of this part."""
        rate = math.log(self.survival) / setting.sensor.period
        missed, birth, most = math.log(1.0 - setting.sensor.detection), self.birth, self.most
        undetected, log_birth = 1.0 - setting.sensor.detection, math.log(birth)

        def survived(score: float, dt: float) -> float:
            # logit(p σ(L)) with p = exp(lasting); its series where that is as exact.
            lasting = rate * dt
            ended = -lasting * (1.0 + lasting * (1 / 2 + lasting * (1 / 6 + lasting / 24)))
            if lasting < -0.005:
                ended = -math.expm1(lasting)
            return lasting + score - math.log(1.0 + ended * math.exp(score))

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            score = log_birth - plots[j, LOG_DENSITY]
            tracks[i, SCORE] = score if score < most else most

        def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            strength = plots[j, STRENGTH]
            # Beyond 40, 1 - PD is less than the last bit.
            gain = strength if strength > 40.0 else math.log(undetected + math.exp(strength))
            score = survived(tracks[i, SCORE], plots[j, PLOT_TIME] - tracks[i, LOOKED]) + gain
            tracks[i, SCORE] = score if score < most else most

        def miss(tracks: Any, i: int, clock: Any) -> None:
            dt = clock[SCAN_TIME] - tracks[i, LOOKED]
            tracks[i, SCORE] = survived(tracks[i, SCORE], dt) + missed

        def existence(tracks: Any, i: int) -> float:
            score = tracks[i, SCORE]
            if score < -300.0:
                return 0.0
            return 1.0 / (1.0 + math.exp(-score))

        return QualityKernels(start, hit, miss, existence)
