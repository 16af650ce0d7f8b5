"""Every plot is a candidate of every track."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fuzzytrack.scan.candidates.base import Candidates, CandidatesKernels, candidates
from fuzzytrack.scan.setting import Setting

__all__ = ["AllPairs"]


@candidates.register("all-pairs")
@dataclass(frozen=True, repr=False)
class AllPairs(Candidates):
    """Every plot is a candidate of every track: simple, and slow from some hundred plots on."""

    def kernels(self, setting: Setting) -> CandidatesKernels:
        """Kernels of this part."""

        def arrange(
            plots: Any, count: int, clock: Any, order: Any, integers: Any, numbers: Any
        ) -> None:
            for j in range(count):
                order[j] = j

        def near(
            x: float, y: float, reach: float, plots: Any, count: int, clock: Any, integers: Any,
            numbers: Any, found: Any,
        ) -> int:  # fmt: skip
            for j in range(count):
                found[j] = j
            return count

        return CandidatesKernels(arrange, near)
