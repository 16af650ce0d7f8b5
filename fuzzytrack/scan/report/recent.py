"""Tracks that were seen lately, and are likely."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.kind.base import UNDECIDED
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.report.base import Report, ReportKernels, reports
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import KIND, MISSES, SCORE

__all__ = ["Recent"]


@reports.register("recent")
@dataclass(frozen=True, repr=False)
class Recent(Report):
    """Reports confirmed tracks of a decided kind that were seen lately, and are likely.

    A track that is not reported lives on, and is reported again, with the same identity, when plots
    return.
    """

    source: ClassVar[str] = "first study, step 15; second tuning"

    misses: int = parameter(8, "scans without a plot until a track is left out", "scans",
                            least=0, whole=True)  # fmt: skip
    score: float = parameter(-2.0, "score above which a track is reported", "nats")

    def kernels(self, setting: Setting, at: int) -> ReportKernels:
        """Kernels of this part."""
        misses, score = float(self.misses), self.score

        def shown(tracks: Any, i: int, clock: Any) -> bool:
            seen = tracks[i, MISSES] <= misses and tracks[i, SCORE] > score
            return bool(seen and tracks[i, KIND] != UNDECIDED)

        return ReportKernels(shown)
