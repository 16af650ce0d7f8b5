"""Evidence for a target that is added up without a limit below."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.plot_columns import LOG_DENSITY, STRENGTH
from fuzzytrack.scan.quality.base import Quality, QualityKernels, qualities
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import SCORE

__all__ = ["LogLikelihoodRatio"]


@qualities.register("log-likelihood-ratio")
@dataclass(frozen=True, repr=False)
class LogLikelihoodRatio(Quality):
    """The score of a sequential probability ratio test of a target against clutter.

    It begins at ``ln(birth/λ)``; a plot adds ``ln(PD N(ν; 0, S)/λ)``, a scan without one
    ``ln(1 - PD)``. A target does not end, unlike with ``existence``; so a track that has been seen
    for long keeps its score. Its probability is ``1/(1 + exp(-score))``.
    """

    source: ClassVar[str] = "Sittler 1964; Blackman & Popoli 1999, track score"

    birth: float = parameter(1.5e-5, "density of new targets", "1/m² and scan", least=0, above=True)
    most: float = parameter(22.0, "largest score", "nats", most=500)

    def kernels(self, setting: Setting, at: int) -> QualityKernels:
        """Kernels of this part."""
        missed = math.log(1.0 - setting.sensor.detection)
        log_birth, most = math.log(self.birth), self.most

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, SCORE] = min(log_birth - plots[j, LOG_DENSITY], most)

        def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, SCORE] = min(tracks[i, SCORE] + plots[j, STRENGTH], most)

        def miss(tracks: Any, i: int, clock: Any) -> None:
            tracks[i, SCORE] += missed

        def existence(tracks: Any, i: int) -> float:
            score = tracks[i, SCORE]
            return 1.0 / (1.0 + math.exp(-score)) if score > -300.0 else 0.0

        return QualityKernels(start, hit, miss, existence)
