"""Confirmation by the number of plots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.confirmation.base import (
    CONFIRM,
    END,
    KEEP,
    Confirmation,
    ConfirmationKernels,
    confirmations,
)
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import HITS, MISSES, SCORE, STATUS

__all__ = ["Count"]


@confirmations.register("count")
@dataclass(frozen=True, repr=False)
class Count(Confirmation):
    """Confirms a track by its number of plots and a least score; ends it by misses in a row.

    With the quality ``m-of-n``, whose score is the number of plots in the last n scans, `score` is
    the m of "m of n".
    """

    source: ClassVar[str] = "practice; misses as in the reconstruction of Zhang & Jiang"

    hits: int = parameter(3, "plots that are needed", "", least=1, whole=True)
    score: float = parameter(0.0, "score that is needed", "")
    tentative_misses: int = parameter(1, "scans without a plot in a row that a tentative track "
                                      "survives", "scans", least=0, whole=True)  # fmt: skip
    misses: int = parameter(4, "scans without a plot in a row that a confirmed track survives",
                            "scans", least=0, whole=True)  # fmt: skip

    def kernels(self, setting: Setting, at: int) -> ConfirmationKernels:
        """Kernels of this part."""
        hits, score = float(self.hits), self.score
        few, many = float(self.tentative_misses), float(self.misses)

        def nothing(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            pass

        def decide(tracks: Any, i: int, clock: Any) -> int:
            tentative = tracks[i, STATUS] == 1.0
            if tracks[i, MISSES] > (few if tentative else many):
                return END
            enough = tracks[i, HITS] >= hits and tracks[i, SCORE] >= score
            return CONFIRM if tentative and enough else KEEP

        return ConfirmationKernels(nothing, nothing, decide)
