"""Plots in cells of a grid, found by the cells that a gate touches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.candidates.base import Candidates, CandidatesKernels, candidates
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.plot_columns import PLOT_X, PLOT_Y
from fuzzytrack.scan.setting import Setting

__all__ = ["GridCandidates"]

# Whole numbers before the table: columns and rows less 1, both powers of 2, and columns.
_ACROSS, _UP, _COLUMNS, _HEAD = 0, 1, 2, 3
#: Smallest table; cells that a track looks into at most; plots it looks at, in a cell and in all.
_LEAST, _MOST_CELLS, _MOST_IN_CELL, _MOST = 64, 4096, 64, 4096
#: Plots that the cell of a plot holds on average, from which cells are halved; how often.
_CROWDED, _HALVINGS = 16.0, 12
#: Share of that which may be left, or cells are not halved.
_WORTH = 0.8


def _table(plots: int) -> int:
    """Number of cells for so many plots: a power of 2."""
    size = _LEAST
    while size < plots:
        size *= 2
    return size


@candidates.register("grid")
@dataclass(frozen=True, repr=False)
class GridCandidates(Candidates):
    """Plots are sorted into the cells of a table, about one a cell; a track looks into few cells.

    The table repeats over the plane, so it has no border; a track that looks into cells may find
    plots of others that share their place in the table, which its gate refuses. Where plots crowd,
    cells are halved, up to 12 times.

    No scan takes more than time in proportion to tracks and plots: a track looks at no more than 64
    plots of a cell and 4,096 in all, others at others. Both are far above what a radar gives; they
    are reached by thousands of plots at one spot.
    """

    source: ClassVar[str] = "second study, section 6"

    side: float = parameter(32.0, "least side of a cell before cells are halved", "m", least=0,
                            above=True)  # fmt: skip

    def integers(self, plots: int) -> int:
        """Table: the first plot of each cell."""
        return _HEAD + _table(plots) + 1

    def numbers(self, plots: int) -> int:
        """Cells in a meter."""
        return 1

    def kernels(self, setting: Setting) -> CandidatesKernels:
        """Kernels of this part."""
        least_side = self.side

        def first_side(plots: Any, count: int) -> float:
            left, low = plots[0, PLOT_X], plots[0, PLOT_Y]
            right, high = left, low
            for j in range(count):
                x, y = plots[j, PLOT_X], plots[j, PLOT_Y]
                left, right = x if x < left else left, x if x > right else right
                low, high = y if y < low else low, y if y > high else high
            side = math.sqrt((right - left) * (high - low) / count)
            return side if side > least_side else least_side

        def place(x: float, y: float, scale: float, integers: Any) -> int:
            across, up = math.floor(x * scale), math.floor(y * scale)
            row: int = (up & integers[_UP]) * integers[_COLUMNS]
            column: int = across & integers[_ACROSS]
            return row + column

        def fill(plots: Any, count: int, side: float, integers: Any, size: int) -> float:
            """Count the plots of each cell; how many the cell of a plot holds on average."""
            for k in range(size + 1):
                integers[_HEAD + k] = 0
            crowd = 0.0
            for j in range(count):
                k = _HEAD + place(plots[j, PLOT_X], plots[j, PLOT_Y], 1.0 / side, integers)
                crowd += 2.0 * integers[k] + 1.0
                integers[k] += 1
            return crowd / count

        def arrange(
            plots: Any, count: int, clock: Any, order: Any, integers: Any, numbers: Any
        ) -> None:
            if count == 0:
                return
            size, columns = _LEAST, 8
            while size < count:
                size *= 2
                if columns * columns < size:
                    columns *= 2
            integers[_ACROSS], integers[_UP], integers[_COLUMNS] = (
                columns - 1, size // columns - 1, columns,
            )  # fmt: skip
            side = first_side(plots, count)
            crowd, halvings = fill(plots, count, side, integers, size), 0
            while crowd > _CROWDED and halvings < _HALVINGS:
                less = fill(plots, count, 0.5 * side, integers, size)
                if less > _WORTH * crowd:
                    # Plots at one spot, which no cells can part.
                    fill(plots, count, side, integers, size)
                    break
                crowd, side, halvings = less, 0.5 * side, halvings + 1
            scale = 1.0 / side
            numbers[0] = scale
            begin = 0
            for k in range(size + 1):
                here = integers[_HEAD + k]
                integers[_HEAD + k] = begin
                begin += here
            for j in range(count):
                k = _HEAD + place(plots[j, PLOT_X], plots[j, PLOT_Y], scale, integers)
                order[integers[k]] = j
                integers[k] += 1
            # Each entry is now where its cell ends, which is where the next one begins.
            for k in range(size, 0, -1):
                integers[_HEAD + k] = integers[_HEAD + k - 1]
            integers[_HEAD] = 0

        def some(count: int, track: int, found: Any) -> int:
            """As many of all plots as a track may look at, others for each track."""
            n = count if count < _MOST else _MOST
            begin = (track * 61) % count
            for k in range(n):
                row = begin + k
                found[k] = row if row < count else row - count
            return n

        def near(
            x: float, y: float, reach: float, plots: Any, count: int, clock: Any, integers: Any,
            numbers: Any, found: Any,
        ) -> int:  # fmt: skip
            if count == 0:
                return 0
            scale, track = numbers[0], found[0]
            width = 2.0 * reach * scale + 2.0
            columns, rows = integers[_COLUMNS], integers[_UP] + 1
            # No cell is looked into twice, and no more cells than there are plots.
            few = width < columns and width < rows and width * width < count + 32.0
            if not (few and width * width < _MOST_CELLS):
                return some(count, track, found)
            left, right = math.floor((x - reach) * scale), math.floor((x + reach) * scale)
            low, high = math.floor((y - reach) * scale), math.floor((y + reach) * scale)
            n = 0
            for up in range(low, high + 1):
                start = _HEAD + (up & integers[_UP]) * columns
                # Cells of a strip follow each other, so a few plots are one range.
                first, last = left & integers[_ACROSS], right & integers[_ACROSS]
                begin, end = integers[start + first], integers[start + last + 1]
                if first <= last and end - begin <= _MOST_IN_CELL and end - begin <= _MOST - n:
                    for row in range(begin, end):
                        found[n] = row
                        n += 1
                    continue
                for across in range(left, right + 1):
                    k = start + (across & integers[_ACROSS])
                    begin, end = integers[k], integers[k + 1]
                    if end - begin > _MOST_IN_CELL:
                        begin += (track * 61) % (end - begin - _MOST_IN_CELL + 1)
                        end = begin + _MOST_IN_CELL
                    for row in range(begin, min(end, begin + _MOST - n)):
                        found[n] = row
                        n += 1
            return n

        return CandidatesKernels(arrange, near)
