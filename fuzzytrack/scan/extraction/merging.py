"""Plots near one another are one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.extraction.base import Extraction, ExtractionKernels, extractions
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.plot_columns import (
    INNOVATION_X,
    PLOT_TIME,
    PLOT_WIDTH,
    PLOT_X,
    PLOT_Y,
    R11,
    R12,
    R22,
    STARTS,
)
from fuzzytrack.scan.setting import Setting

__all__ = ["Merging"]

#: What is averaged.
_MEANS = (PLOT_X, PLOT_Y, PLOT_TIME, R11, R12, R22)
#: Where the position of the first plot is kept: no innovation is known yet.
_FIRST_X = INNOVATION_X


@extractions.register("merging")
@dataclass(frozen=True, repr=False)
class Merging(Extraction):
    """Merges a plot into an earlier one that is no farther than a distance.

    The plot that results is the mean, as an echo that was cut into pieces needs it: their errors
    are those of one target, so the covariance is the mean as well. Its row is that of the first.
    Distances are those to the first plot of each, so that chains of plots do not grow.
    """

    merges = True
    source: ClassVar[str] = "practice; of no use where a radar clusters its echoes, as measured"

    distance: float = parameter(10.0, "distance within which plots are merged", "m", least=0,
                                above=True)  # fmt: skip

    def kernels(self, setting: Setting) -> ExtractionKernels:
        """Kernels of this part."""
        distance = self.distance

        def place(across: int, up: int, size: int) -> int:
            """Entry of a cell in a table of `size` entries, a power of 2."""
            # Small enough for 64 bits.
            mixed = (across & 0xFFFFF) * 73856093 ^ (up & 0xFFFFF) * 19349663
            return ((mixed >> 13) ^ mixed) & (size - 1)

        def first_near(x: float, y: float, plots: Any, integers: Any, size: int) -> int:
            """First plot that is kept within the distance, or -1."""
            across, up = math.floor(x / distance), math.floor(y / distance)
            best = -1
            for a in range(across - 1, across + 2):
                for b in range(up - 1, up + 2):
                    k = integers[place(a, b, size)]
                    while k >= 0:
                        dx, dy = plots[k, _FIRST_X] - x, plots[k, _FIRST_X + 1] - y
                        near = dx * dx + dy * dy <= distance * distance
                        if near and (best < 0 or k < best):
                            best = k
                        k = integers[size + k]
            return best

        def extract(plots: Any, count: int, integers: Any) -> int:
            size = 1
            while size * 2 <= 2 * count:
                size *= 2
            for k in range(size):
                integers[k] = -1
            kept = 0
            for j in range(count):
                x, y = plots[j, PLOT_X], plots[j, PLOT_Y]
                k = first_near(x, y, plots, integers, size)
                if k < 0:
                    for column in range(PLOT_WIDTH):
                        plots[kept, column] = plots[j, column]
                    plots[kept, _FIRST_X], plots[kept, _FIRST_X + 1] = x, y
                    cell = place(math.floor(x / distance), math.floor(y / distance), size)
                    integers[size + kept], integers[cell] = integers[cell], kept
                    integers[size + count + kept] = 1
                    kept += 1
                    continue
                integers[size + count + k] += 1
                share = 1.0 / integers[size + count + k]
                for c in range(len(_MEANS)):
                    column = _MEANS[c]
                    plots[k, column] += share * (plots[j, column] - plots[k, column])
                plots[k, STARTS] = max(plots[k, STARTS], plots[j, STARTS])
            return kept

        return ExtractionKernels(extract)
