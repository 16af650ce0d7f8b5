"""How many of the last scans had a plot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.quality.base import Quality, QualityKernels, qualities
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import SCORE

__all__ = ["MOfN"]


@qualities.register("m-of-n")
@dataclass(frozen=True, repr=False)
class MOfN(Quality):
    """The score is the number of plots in the last n scans; it says no probability.

    The confirmation ``count`` with this score as its m is the rule "m of n".
    """

    source: ClassVar[str] = "practice"

    scans: int = parameter(5, "n: scans that count", "scans", least=1, most=50, whole=True)

    @property
    def memory(self) -> int:
        """The last scans as bits of a whole number, the last one lowest."""
        return 1

    def kernels(self, setting: Setting, at: int) -> QualityKernels:
        """Kernels of this part."""
        scans = self.scans
        oldest = 1 << (scans - 1)

        def add(tracks: Any, i: int, bit: int) -> None:
            history = int(tracks[i, at])
            history = (history - oldest if history >= oldest else history) * 2 + bit
            tracks[i, at] = history
            score = 0.0
            for _ in range(scans):
                score += history & 1
                history >>= 1
            tracks[i, SCORE] = score

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, at], tracks[i, SCORE] = 1.0, 1.0

        def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            add(tracks, i, 1)

        def miss(tracks: Any, i: int, clock: Any) -> None:
            add(tracks, i, 0)

        def existence(tracks: Any, i: int) -> float:
            return math.nan

        return QualityKernels(start, hit, miss, existence)
