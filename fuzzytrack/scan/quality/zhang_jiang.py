"""The quality factor N of a track, which plots raise and missed plots lower."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.quality.base import Quality, QualityKernels, qualities
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import HITS, SCORE

__all__ = ["QualityFactor"]


@qualities.register("zhang-jiang")
@dataclass(frozen=True, repr=False)
class QualityFactor(Quality):
    """The quality factor N: 1 after two plots, 1 more with each plot, less with each miss.

    It never falls below 1, and is 0 while there is one plot. The gate ``box`` and the update
    ``quality-gains`` go by it. The probability of existence is not known.
    """

    source: ClassVar[str] = "Zhang & Jiang, quality factor; cap 10 (published: 30)"

    cap: float = parameter(10.0, "highest quality", "", least=1)
    drop: float = parameter(3.0, "loss of quality by a miss", "", least=0)

    def kernels(self, setting: Setting, at: int) -> QualityKernels:
        """Kernels of this part."""
        cap, drop = self.cap, self.drop

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, SCORE] = 0.0

        def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            n = tracks[i, SCORE] + 1.0
            tracks[i, SCORE] = n if n < cap else cap

        def miss(tracks: Any, i: int, clock: Any) -> None:
            if tracks[i, HITS] > 1.0:
                n = tracks[i, SCORE] - drop
                tracks[i, SCORE] = n if n > 1.0 else 1.0

        def existence(tracks: Any, i: int) -> float:
            return math.nan

        return QualityKernels(start, hit, miss, existence)
