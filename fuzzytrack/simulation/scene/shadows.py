"""Targets that other targets hide."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array

__all__ = ["hidden"]


def hidden(distance: Array, bearing: Array, size: Array, margin: float) -> NDArray[np.bool_]:
    """Which targets of one scan lie in the shadow of another.

    A target of diameter D at range r hides what is more than D/2 farther away and within
    asin(D / 2r) + `margin` of its bearing.

    Parameters
    ----------
    distance, bearing : ndarray, shape (n,)
        Range (m) and bearing (rad).
    size : ndarray, shape (n,)
        Diameters (m); 0 hides nothing.
    margin : float
        Further half width of the shadows (rad).
    """
    found = np.zeros(len(distance), bool)
    blockers = np.flatnonzero((size > 0) & (distance > 0))
    if not len(blockers):
        return found
    half = np.minimum(
        np.arcsin(np.minimum(size[blockers] / 2 / distance[blockers], 1.0)) + margin, math.pi
    )
    turn = 2 * math.pi
    bearings = np.mod(bearing, turn)
    order = np.argsort(bearings)
    # Once around and half a turn more to either side, so that shadows may lie across north.
    around = np.concatenate([bearings[order] - turn, bearings[order], bearings[order] + turn])
    low = np.searchsorted(around, bearings[blockers] - half, side="left")
    high = np.searchsorted(around, bearings[blockers] + half, side="right")
    counts = high - low
    blocker = np.repeat(blockers, counts)
    step = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    other = order[(np.repeat(low, counts) + step) % len(order)]
    behind = distance[other] > distance[blocker] + size[blocker] / 2
    found[other[behind]] = True
    return found
