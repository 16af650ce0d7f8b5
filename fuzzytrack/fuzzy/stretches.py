"""Stretches of a line: where the membership of a set is above zero, or exactly 1."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

__all__ = ["EVERYWHERE", "Stretch", "complement"]


class Stretch(NamedTuple):
    """An interval, each end of which may belong to it or not.

    Parameters
    ----------
    low, high : float
        Ends; may be infinite.
    with_low, with_high : bool
        Whether the end itself is in it.
    """

    low: float
    high: float
    with_low: bool
    with_high: bool

    def __contains__(self, x: object) -> bool:
        if not isinstance(x, float | int):
            return False
        inside = self.low < x < self.high
        return inside or (x == self.low and self.with_low) or (x == self.high and self.with_high)


EVERYWHERE = Stretch(-math.inf, math.inf, True, True)


def complement(stretches: Iterable[Stretch]) -> tuple[Stretch, ...]:
    """What is left of the line, in ascending order.

    Parameters
    ----------
    stretches : iterable of Stretch
        In ascending order, none overlapping.
    """
    left = []
    low, with_low = -math.inf, True
    for stretch in stretches:
        with_high = not stretch.with_low
        if low < stretch.low or (low == stretch.low and with_low and with_high):
            left.append(Stretch(low, stretch.low, with_low, with_high))
        low, with_low = stretch.high, not stretch.with_high
    if low < math.inf:
        left.append(Stretch(low, math.inf, with_low, True))
    return tuple(left)
