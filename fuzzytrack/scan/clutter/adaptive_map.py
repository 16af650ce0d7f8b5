"""A map of the clutter, learned from the plots that no target explains."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.scan.clock import SCAN
from fuzzytrack.scan.clutter.base import Clutter, ClutterKernels, clutters
from fuzzytrack.scan.clutter.wrapped_grid import wrapped_grid
from fuzzytrack.scan.kind.base import MOVING
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.plot_columns import PLOT_X, PLOT_Y
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import KIND, SCORE, STATUS

__all__ = ["AdaptiveMap"]

#: Plots of a tentative track whose weight is corrected later.
_REMEMBERED = 8
#: Numbers before the cells: scan at which values are stored as they are, effective number of
#: scans, factor by which values of this scan are stored, and its inverse.
_BASE, _SCANS, _GROWTH, _DECAY, _HEAD = 0, 1, 2, 3, 8
#: Exponent at which stored values are written anew.
_LARGEST = 60.0
#: Change of a weight from which it is corrected.
_CHANGE = 0.1


@clutters.register("adaptive-map")
@dataclass(frozen=True, repr=False)
class AdaptiveMap(Clutter):
    """Clutter by two grids of cells, to which each plot adds as far as it is not that of a target.

    All plots of a scan are put into both grids with the weight `prior` first, each shared by the
    four cells around it. Then the density at a plot is read, without what it added itself:
    ``λ = (level·scans + A/cell²)/(scans + W)``, with A the weight there and W the number of scans,
    both fading by `memory_scans`; of the two grids the larger value counts. After the update, the
    weight of a plot becomes what is known of it: `innocence` for one that starts a track, less by
    ``1/(1 + exp(score - known))`` while its track becomes likely, 1 when the track is deleted, 0
    when it is confirmed as moving. The last 8 plots of a tentative track are corrected in this way
    at each scan.

    The grids repeat after ``side`` cells in x and in y, so that the plane has no border and memory
    is bounded: clutter also counts at places ``side·cell`` meters away.
    """

    source: ClassVar[str] = "second study, changes (a) and (b)"

    level: float = parameter(5.3e-7, "clutter before any is seen", "plots/m² and scan", least=0,
                             above=True)  # fmt: skip
    scans: float = parameter(32.0, "weight of that", "scans", least=0, above=True)
    memory_scans: float = parameter(19.1, "scans after which 1/e is left", "scans", least=1)
    prior: float = parameter(0.353, "weight of a plot before association", "", least=0, most=1)
    cell: float = parameter(31.0, "side of a cell of the fine grid", "m", least=0, above=True)
    coarse_weight: float = parameter(1.0, "weight of the coarse grid, of four times the side", "",
                                     least=0)  # fmt: skip
    innocence: float = parameter(0.479, "weight of a plot that starts a track", "", least=0, most=1)
    known: float = parameter(6.5, "score at which half of that is left", "nats")
    side: int = parameter(1024, "cells after which the grid repeats, a power of 2", "cells",
                          least=16, most=16384, whole=True)  # fmt: skip

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.side & (self.side - 1):
            raise ValueError(f"side must be a power of 2, got {self.side}")

    @property
    def memory(self) -> int:
        """Weight of the plots of a track, how many are remembered, and x, y and scan of each."""
        return 2 + 3 * _REMEMBERED

    @property
    def numbers(self) -> int:
        """Both grids, and what stands before them."""
        return _HEAD + self.side**2 + (self.side // 4) ** 2

    def kernels(self, setting: Setting, at: int) -> ClutterKernels:
        """Kernels of this part."""
        fine, coarse = self.cell, 4.0 * self.cell
        add_fine, read_fine = wrapped_grid(fine, self.side, _HEAD)
        add_coarse, read_coarse = wrapped_grid(coarse, self.side // 4, _HEAD + self.side**2)
        fine_area, coarse_area = fine * fine, coarse * coarse
        coarse_weight, prior, innocence, known = (
            self.coarse_weight, self.prior, self.innocence, self.known,
        )  # fmt: skip
        first, scans, rate = self.level * self.scans, self.scans, 1.0 / self.memory_scans
        weight_at, count_at, places = at, at + 1, at + 2
        # Of scores below, the weight is larger than `nearly`; half a change, so that rounding does
        # not count.
        nearly = innocence - 0.5 * _CHANGE
        unlikely = known + math.log(0.5 * _CHANGE / nearly) if nearly > 0.0 else known

        def add(x: float, y: float, weight: float, cells: Any) -> None:
            add_fine(x, y, weight, cells)
            add_coarse(x, y, weight, cells)

        def begin(clock: Any, cells: Any) -> None:
            cells[_SCANS] = cells[_SCANS] * math.exp(-rate) + 1.0
            if (clock[SCAN] - cells[_BASE]) * rate > _LARGEST:
                shrink = math.exp((cells[_BASE] - clock[SCAN]) * rate)
                for k in range(_HEAD, len(cells)):
                    cells[k] *= shrink
                cells[_BASE] = clock[SCAN]
            age = (clock[SCAN] - cells[_BASE]) * rate
            cells[_GROWTH], cells[_DECAY] = math.exp(age), math.exp(-age)

        def put(plots: Any, j: int, clock: Any, cells: Any) -> None:
            add(plots[j, PLOT_X], plots[j, PLOT_Y], prior * cells[_GROWTH], cells)

        def level(x: float, y: float, own: float, cells: Any) -> float:
            there, share = read_fine(x, y, cells)
            wide, wide_share = read_coarse(x, y, cells)
            there = there * cells[_DECAY] - own * share
            wide = wide * cells[_DECAY] - own * wide_share
            density = first + (there if there > 0.0 else 0.0) / fine_area
            wide_density = coarse_weight * (first + (wide if wide > 0.0 else 0.0) / coarse_area)
            seen: float = scans + cells[_SCANS]
            return (density if density > wide_density else wide_density) / seen

        def read(plots: Any, j: int, clock: Any, cells: Any) -> float:
            return level(plots[j, PLOT_X], plots[j, PLOT_Y], prior, cells)

        def density(x: float, y: float, clock: Any, cells: Any) -> float:
            return level(x, y, 0.0, cells)

        def unexplained(score: float) -> float:
            excess = score - known
            return 1.0 / (1.0 + math.exp(excess)) if excess < 300.0 else 0.0

        def final(plots: Any, j: int, weight: float, cells: Any) -> None:
            change = (weight - prior) * cells[_GROWTH]
            add(plots[j, PLOT_X], plots[j, PLOT_Y], change, cells)

        def correct(tracks: Any, i: int, weight: float, cells: Any) -> None:
            change = weight - tracks[i, weight_at]
            tracks[i, weight_at] = weight
            count = int(tracks[i, count_at])
            for k in range(count if count < _REMEMBERED else _REMEMBERED):
                place = places + 3 * k
                grown = math.exp((tracks[i, place + 2] - cells[_BASE]) * rate)
                add(tracks[i, place], tracks[i, place + 1], change * grown, cells)

        def settle(tracks: Any, i: int, weight: float, cells: Any) -> None:
            change = weight - tracks[i, weight_at]
            if change > _CHANGE or change < -_CHANGE:
                correct(tracks, i, weight, cells)

        def judge(tracks: Any, i: int, cells: Any) -> None:
            if tracks[i, SCORE] < unlikely and tracks[i, weight_at] > nearly:
                # The weight is nearly `innocence`, and would stay so.
                return
            settle(tracks, i, innocence * unexplained(tracks[i, SCORE]), cells)

        def remember(tracks: Any, i: int, plots: Any, j: int, clock: Any, cells: Any) -> None:
            count = int(tracks[i, count_at])
            place = places + 3 * (count % _REMEMBERED)
            tracks[i, place], tracks[i, place + 1] = plots[j, PLOT_X], plots[j, PLOT_Y]
            tracks[i, place + 2] = clock[SCAN]
            tracks[i, count_at] = count + 1.0
            final(plots, j, tracks[i, weight_at], cells)

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any, cells: Any) -> None:
            tracks[i, weight_at], tracks[i, count_at] = innocence, 0.0
            remember(tracks, i, plots, j, clock, cells)

        def hit(
            tracks: Any, i: int, plots: Any, j: int, status: float, clock: Any, cells: Any
        ) -> None:
            if status == 2.0:
                final(plots, j, unexplained(tracks[i, SCORE]), cells)
                return
            remember(tracks, i, plots, j, clock, cells)
            if tracks[i, STATUS] == 2.0 and tracks[i, KIND] == MOVING:
                settle(tracks, i, 0.0, cells)
            else:
                judge(tracks, i, cells)

        def miss(tracks: Any, i: int, clock: Any, cells: Any) -> None:
            if tracks[i, STATUS] == 1.0:
                judge(tracks, i, cells)

        def end(tracks: Any, i: int, clock: Any, cells: Any) -> None:
            if tracks[i, STATUS] == 1.0:
                correct(tracks, i, 1.0, cells)

        def leave(plots: Any, j: int, clock: Any, cells: Any) -> None:
            final(plots, j, 0.0, cells)

        def drop(plots: Any, j: int, clock: Any, cells: Any) -> None:
            final(plots, j, innocence, cells)

        return ClutterKernels(begin, put, read, density, start, hit, miss, end, leave, drop)
