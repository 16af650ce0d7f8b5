"""A grid of cells that repeats over the plane, and shares what is put between cells."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

__all__ = ["wrapped_grid"]


def wrapped_grid(
    cell: float, side: int, at: int
) -> tuple[
    Callable[[float, float, float, Any], None],
    Callable[[float, float, Any], tuple[float, float]],
]:
    """Kernels that add to a grid and read it, both bilinear.

    Parameters
    ----------
    cell : float
        Side of a cell (m).
    side : int
        Cells after which it repeats, a power of 2.
    at : int
        Where the grid begins in the array of cells.

    Returns
    -------
    add : callable
        ``add(x, y, weight, cells)``.
    read : callable
        ``read(x, y, cells) -> (weight, share)``; `share` is what is read of a weight of 1 that was
        added at the same place.
    """
    mask = side - 1

    def add(x: float, y: float, weight: float, cells: Any) -> None:
        across, up = math.floor(x / cell), math.floor(y / cell)
        a, b = x / cell - across, y / cell - up
        left, right = across & mask, (across + 1) & mask
        low, high = at + (up & mask) * side, at + ((up + 1) & mask) * side
        below, above = weight * (1.0 - b), weight * b
        cells[low + left] += below * (1.0 - a)
        cells[low + right] += below * a
        cells[high + left] += above * (1.0 - a)
        cells[high + right] += above * a

    def read(x: float, y: float, cells: Any) -> tuple[float, float]:
        across, up = math.floor(x / cell), math.floor(y / cell)
        a, b = x / cell - across, y / cell - up
        left, right = across & mask, (across + 1) & mask
        low, high = at + (up & mask) * side, at + ((up + 1) & mask) * side
        below = (1.0 - a) * cells[low + left] + a * cells[low + right]
        above = (1.0 - a) * cells[high + left] + a * cells[high + right]
        share = ((1.0 - a) * (1.0 - a) + a * a) * ((1.0 - b) * (1.0 - b) + b * b)
        return (1.0 - b) * below + b * above, share

    return add, read
