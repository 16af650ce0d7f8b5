"""Confirmation by accumulated evidence."""

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
from fuzzytrack.scan.kind.base import UNDECIDED
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.plot_columns import STRENGTH
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import HITS, KIND, MISSES, MOTION, SCORE, STATUS

__all__ = ["Evidence"]


@confirmations.register("evidence")
@dataclass(frozen=True, repr=False)
class Evidence(Confirmation):
    """Confirms by score, hits, kind, and smoothed strength of the hits with evidence of motion.

    The strength of a hit is ``ln(PD N(ν; 0, S)/λ)``, e its smoothed value from the second plot on.
    A tentative track is confirmed if its kind is decided, its score exceeds `score`, it has `hits`
    plots, and ``e + motion_weight·min(max(motion, 0), 10) > strength``.
    """

    source: ClassVar[str] = "second study, change (e)"

    score: float = parameter(5.1, "score that is needed", "nats")
    hits: int = parameter(3, "plots that are needed", "", least=1, whole=True)
    strength: float = parameter(7.51, "strength that is needed", "nats")
    motion_weight: float = parameter(0.208, "weight of the evidence of motion", "", least=0)
    rate: float = parameter(0.74, "rate of the smoothed strength", "", least=0, most=1, above=True)
    ended: float = parameter(-7.6, "score below which a track ends", "nats")
    tentative_misses: int = parameter(4, "scans without a plot that a tentative track survives",
                                      "scans", least=0, whole=True)  # fmt: skip
    misses: int = parameter(14, "scans without a plot that a confirmed track survives", "scans",
                            least=0, whole=True)  # fmt: skip

    @property
    def memory(self) -> int:
        """Smoothed strength of the hits."""
        return 1

    def kernels(self, setting: Setting, at: int) -> ConfirmationKernels:
        """Kernels of this part."""
        score, hits, strength = self.score, float(self.hits), self.strength
        motion_weight, rate, ended = self.motion_weight, self.rate, self.ended
        few, many = float(self.tentative_misses), float(self.misses)

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            tracks[i, at] = 0.0

        def hit(tracks: Any, i: int, plots: Any, j: int, clock: Any) -> None:
            if tracks[i, HITS] > 2.0:
                tracks[i, at] += rate * (plots[j, STRENGTH] - tracks[i, at])
            else:
                tracks[i, at] = plots[j, STRENGTH]

        def decide(tracks: Any, i: int, clock: Any) -> int:
            tentative = tracks[i, STATUS] == 1.0
            if tracks[i, SCORE] < ended or tracks[i, MISSES] > (few if tentative else many):
                return END
            if not tentative or tracks[i, SCORE] <= score or tracks[i, HITS] < hits:
                return KEEP
            motion = min(max(tracks[i, MOTION], 0.0), 10.0)
            enough = tracks[i, at] + motion_weight * motion > strength
            return CONFIRM if enough and tracks[i, KIND] != UNDECIDED else KEEP

        return ConfirmationKernels(start, hit, decide)
