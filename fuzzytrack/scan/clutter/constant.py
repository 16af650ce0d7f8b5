"""Clutter that is equally dense everywhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fuzzytrack.scan.clutter.base import Clutter, ClutterKernels, clutters
from fuzzytrack.scan.part import parameter
from fuzzytrack.scan.setting import Setting

__all__ = ["ConstantClutter"]


@clutters.register("constant")
@dataclass(frozen=True, repr=False)
class ConstantClutter(Clutter):
    """Clutter that is equally dense everywhere."""

    level: float = parameter(1e-5, "clutter", "plots/m² and scan", least=0, above=True)

    def kernels(self, setting: Setting, at: int) -> ClutterKernels:
        """Kernels of this part."""
        level = self.level

        def begin(clock: Any, cells: Any) -> None:
            pass

        def put(plots: Any, j: int, clock: Any, cells: Any) -> None:
            pass

        def read(plots: Any, j: int, clock: Any, cells: Any) -> float:
            return level

        def density(x: float, y: float, clock: Any, cells: Any) -> float:
            return level

        def start(tracks: Any, i: int, plots: Any, j: int, clock: Any, cells: Any) -> None:
            pass

        def hit(
            tracks: Any, i: int, plots: Any, j: int, status: float, clock: Any, cells: Any
        ) -> None:
            pass

        def no_plot(tracks: Any, i: int, clock: Any, cells: Any) -> None:
            pass

        def no_track(plots: Any, j: int, clock: Any, cells: Any) -> None:
            pass

        return ClutterKernels(
            begin, put, read, density, start, hit, no_plot, no_plot, no_track, no_track
        )
