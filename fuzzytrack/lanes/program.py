"""The arithmetic of a tracker in the form in which it runs over many tracks side by side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fuzzytrack.lanes.layout import Rows
from fuzzytrack.reprs import summary

__all__ = ["LaneProgram"]


@dataclass(frozen=True, eq=False)
class LaneProgram:
    """What a tracker keeps of each lane, and the function that takes a lane one time step on.

    A lane is what gets its own gains: one axis of one track, or a whole track. The functions run in
    plain Python over a list and are compiled over an array; they may contain loops, selections
    (``a if condition else b``), numbers, tuples, `math`, and calls of other such functions.

    Attributes
    ----------
    rows : Rows
        Layout of a lane's numbers.
    memory : tuple of float
        Memory of a lane before its first plot, ``rows.n_memory`` numbers.
    step : callable
        ``step(stride)`` returns a function ``f(buffer, count)``, which takes the first `count`
        lanes (at most `stride`) one time step on, in place. Row `r` of lane `i` is
        ``buffer[r * stride + i]``. Plot, sigma and dt are filled in before the call; the function
        writes the new state and the results.
    steady : callable, optional
        ``steady(stride, results)`` returns a function ``f(buffer, count, dt, plots, predicted)``
        with the same effect on lanes that have all seen two plots and share their time step `dt`.
        It reads plots from `plots` and writes predictions to `predicted`, where the axes of a lane
        are side by side; the other results it writes into the buffer only if `results` is True.
        A tracker without one takes all its steps with `step`.
    """

    rows: Rows
    memory: tuple[float, ...]
    step: Callable[[int], Callable[[Any, int], None]]
    steady: Callable[[int, bool], Callable[[Any, int, float, Any, Any], None]] | None = None

    def __repr__(self) -> str:
        return summary(self, "rows", "memory")
