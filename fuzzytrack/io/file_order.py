"""A whole recording in the order of its file, whose clock starts again: turns from row to row."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.io.cleaning_step import PERIODS
from fuzzytrack.io.piece import Piece

__all__ = ["recognized_period", "turned", "turns_in_file"]

# A clock that has started again goes on within so many usual intervals.
_PLAUSIBLE = 20.0


def turns_in_file(time: Array, period: float) -> Array:
    """How often a clock has started again before each row, from row to row of a file.

    Times that fall by less than a quarter of the period are out of order; so are those that rise by
    more than three quarters.
    """
    turns = np.zeros(len(time))
    turns[1:] = np.cumsum(-np.floor(np.diff(time) / period + 0.25))
    return turns


def recognized_period(piece: Piece) -> float:
    """Period of a clock that starts again in some track; 0 if none is recognized."""
    order = np.argsort(piece.ids.codes, kind="stable")
    steps = np.diff(piece.time[order])[np.diff(piece.ids.codes[order]) == 0]
    falls, usual = -steps[steps < 0], steps[steps > 0]
    if not len(falls) or not len(usual):
        return 0.0
    plausible = _PLAUSIBLE * float(np.median(usual))
    for period in PERIODS:
        if ((falls < period) & (falls >= period - plausible)).any():
            return period
    return 0.0


def turned(codes: NDArray[np.int64], turns: Array) -> int:
    """How often the clock has started again within tracks, together."""
    order = np.lexsort((turns, codes))
    first = np.append(True, np.diff(codes[order]) != 0)
    last = np.append(first[1:], True)
    return int((turns[order[last]] - turns[order[first]]).sum())
