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
        writes the new state and the results, where a plot is missing those of a track that coasts.
    steady : callable, optional
        ``steady(stride, results, common)`` returns a function ``f(buffer, count, dt, plots,
        predicted)`` with the same effect on lanes that have all seen two plots. They share their
        time step `dt` if `common` is True; otherwise each has its own in the buffer. The function
        reads plots from `plots` and writes predictions to `predicted`, where the axes of a lane are
        side by side; the other results it writes into the buffer only if `results` is True. A
        tracker without one takes all its steps with `step`.
    keeps_state : bool
        Whether the functions themselves leave the state as it is where a plot is missing, except
        for memory that counts misses, and write position, velocity and acceleration that are to be
        shown to the rows from ``rows.now`` on. Otherwise they may write what a track that coasts
        has: it is shown, and a runner that counts time from plot to plot then restores the state.
    """

    rows: Rows
    memory: tuple[float, ...]
    step: Callable[[int], Callable[[Any, int], None]]
    steady: Callable[[int, bool, bool], Callable[[Any, int, float, Any, Any], None]] | None = None
    keeps_state: bool = False

    def __repr__(self) -> str:
        return summary(self, "rows", "memory")
