"""Plots in sectors around the radar, found by the sector of a track."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.candidates.base import Candidates, CandidatesKernels, candidates
from fuzzytrack.scan.clock import OWN_X, OWN_Y
from fuzzytrack.scan.part import parameter, word
from fuzzytrack.scan.plot_columns import PLOT_X, PLOT_Y
from fuzzytrack.scan.setting import Setting

__all__ = ["SectorCandidates"]


@candidates.register("sectors")
@dataclass(frozen=True, repr=False)
class SectorCandidates(Candidates):
    """The plots around the radar are sorted into sectors; a track looks into those next to it.

    Plot sector k is ``[kd, (k + 1)d)`` with ``d = 2π/sectors``; a track in
    ``[(k - ½)d, (k + ½)d)`` looks into the plot sectors k - 1 and k, so there is half a sector
    left on either side of it. As published that is all, and plots are missed where half a gate is
    wider, which is so for tracks near the radar and for narrow sectors: of 360 sectors, 0.2 %.
    The other way, ``spanned``, looks into all the sectors that the gate spans, and misses none.
    """

    needs_own = True
    source: ClassVar[str] = "Zhang & Jiang, division of sectors"

    sectors: int = parameter(32, "number of sectors", "", least=2, most=4096, whole=True)
    search: str = word(
        "spanned", "adjacent: two sectors as published; spanned: all that the gate spans",
        "spanned", "adjacent",
    )  # fmt: skip

    @property
    def may_miss(self) -> bool:
        """As published, plots beyond the sectors next to a track are not found."""
        return self.search == "adjacent"

    def integers(self, plots: int) -> int:
        """Where each sector begins, and the sector of each plot."""
        return self.sectors + 1 + plots

    def kernels(self, setting: Setting) -> CandidatesKernels:
        """Kernels of this part."""
        sectors, spanned = self.sectors, self.search == "spanned"
        width = 2.0 * math.pi / sectors

        def sector_of(x: float, y: float, clock: Any) -> int:
            k = math.floor(math.atan2(y - clock[OWN_Y], x - clock[OWN_X]) / width)
            return k % sectors

        def arrange(
            plots: Any, count: int, clock: Any, order: Any, integers: Any, numbers: Any
        ) -> None:
            for k in range(sectors + 1):
                integers[k] = 0
            for j in range(count):
                k = sector_of(plots[j, PLOT_X], plots[j, PLOT_Y], clock)
                integers[sectors + 1 + j] = k
                integers[k] += 1
            begin = 0
            for k in range(sectors + 1):
                here = integers[k]
                integers[k] = begin
                begin += here
            for j in range(count):
                k = integers[sectors + 1 + j]
                order[integers[k]] = j
                integers[k] += 1
            # Each entry is now where its sector ends, which is where the next one begins.
            for k in range(sectors, 0, -1):
                integers[k] = integers[k - 1]
            integers[0] = 0

        def near(
            x: float, y: float, reach: float, plots: Any, count: int, clock: Any, integers: Any,
            numbers: Any, found: Any,
        ) -> int:  # fmt: skip
            dx, dy = x - clock[OWN_X], y - clock[OWN_Y]
            bearing = math.atan2(dy, dx) / width
            last = math.floor(bearing + 0.5)
            first = last - 1
            if spanned:
                r = math.sqrt(dx * dx + dy * dy)
                half = math.asin(reach / r) / width if reach < r else 0.5 * sectors
                if half >= 0.5:
                    first, last = math.floor(bearing - half), math.floor(bearing + half)
            if last - first >= sectors:
                first, last = 0, sectors - 1
            n = 0
            for sector in range(first, last + 1):
                k = sector % sectors
                for row in range(integers[k], integers[k + 1]):
                    found[n] = row
                    n += 1
            return n

        return CandidatesKernels(arrange, near)
