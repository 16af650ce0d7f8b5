"""Times between successive plots of a track: steps within limits, and plots that are missed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fuzzytrack.arrays import Array

__all__ = ["ElapsedTimes", "around_curve"]

_MOST_MISSED = 1000
#: Ratio of the ends of a piece. The triangle around the curve (s, 1/s) there reaches below it by
#: less than a thousandth.
_PIECE = 1.05
_MOST_PIECES = 400
_TRIED = 4


@dataclass(frozen=True)
class ElapsedTimes:
    """Times that may pass between two plots of a track.

    Rows follow each other after any time between `low` and `high`, which may change from row to
    row. A plot may be missing in up to `missed` rows in a row, so the time since the last plot is a
    sum of 1 to `missed` + 1 steps.

    Parameters
    ----------
    low, high : float
        Shortest and longest step, 0 < low <= high.
    missed : int
        Most plots that are missed in a row, 0 to 1000.

    Raises
    ------
    ValueError
        If a limit is out of range; the message begins with ``steps`` or ``missed``.
    """

    low: float = 1.0
    high: float = 1.0
    missed: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "low", float(self.low))
        object.__setattr__(self, "high", float(self.high))
        if not 0 < self.low <= self.high < math.inf:
            raise ValueError(
                f"steps: must be two times with 0 < shortest <= longest, got {self.low:g} and "
                f"{self.high:g}"
            )
        if isinstance(self.missed, bool) or not isinstance(self.missed, int | np.integer):
            raise ValueError(f"missed: must be a whole number, got {self.missed!r}")
        if not 0 <= self.missed <= _MOST_MISSED:
            raise ValueError(f"missed: must be 0 to {_MOST_MISSED}, got {self.missed}")

    @cached_property
    def intervals(self) -> list[tuple[float, float]]:
        """Intervals of the time since the last plot, in ascending order, apart from each other."""
        found = [(self.low, self.high)]
        for steps in range(2, self.missed + 2):
            low, high = steps * self.low, steps * self.high
            if low <= found[-1][1]:
                found[-1] = found[-1][0], high
            else:
                found.append((low, high))
        return found

    def pieces(self) -> Array:
        """Short intervals that together hold every time since the last plot, shape (n, 2)."""
        pieces = []
        for low, high in self.intervals:
            count = math.ceil(math.log(high / low) / math.log(_PIECE))
            knots = np.geomspace(low, high, min(max(count, 1), _MOST_PIECES) + 1)
            pieces.append(np.stack([knots[:-1], knots[1:]], axis=1))
        return np.unique(np.concatenate(pieces), axis=0)

    def around(self) -> Array:
        """Points (s, r) whose convex hull contains (s, 1/s) for every time s since the last plot.

        Returns
        -------
        ndarray, shape (n, 2)
        """
        return np.unique(np.concatenate([around_curve(*piece) for piece in self.pieces()]), axis=0)

    def tried(self) -> Array:
        """A few times since the last plot, the shortest and the longest among them.

        Returns
        -------
        ndarray, shape (n,)
        """
        ends = np.unique(self.intervals)
        count = min(len(ends), _TRIED)
        return np.asarray(ends[np.linspace(0, len(ends) - 1, count).round().astype(int)])

    def missed_within(self, elapsed: float) -> int:
        """How many plots are missed, at least, when so much time has passed since the last one."""
        return max(0, math.ceil(elapsed / self.high * (1 - 1e-12)) - 1)


def around_curve(low: float, high: float) -> Array:
    """Corners of a triangle around the curve (s, 1/s) from s = low to high.

    The curve is convex: it lies between its ends and the point where its tangents there meet.

    Returns
    -------
    ndarray, shape (3, 2)
    """
    total = low + high
    return np.array([(low, 1 / low), (2 * low * high / total, 2 / total), (high, 1 / high)])
