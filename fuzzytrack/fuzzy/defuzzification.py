"""Defuzzification: from a fuzzy output on a grid to one crisp value."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array

__all__ = ["DEFUZZIFIERS", "defuzzify"]


# Equal grades may differ by the rounding of the operations that led to them.
_ROUNDING = 1e-12


def centroid(y: Array, membership: Array) -> Array:
    """Center of gravity as a plain sum over the grid (Llinas et al. 1998, Eq. 3.10)."""
    moment = membership @ y if y.ndim == 1 else (membership * y).sum(axis=-1)
    return np.asarray(moment / membership.sum(axis=-1))


def bisector(y: Array, membership: Array) -> Array:
    """First grid point at which the running plain sum reaches half of the total."""
    running = np.cumsum(membership, axis=-1)
    half = running[..., -1:] / 2 * (1 - _ROUNDING)
    return np.asarray(y[np.argmax(running >= half, axis=-1)])


def _at_maximum(membership: Array) -> NDArray[np.bool_]:
    top = membership.max(axis=-1, keepdims=True)
    return np.asarray(membership >= top * (1 - _ROUNDING))


def mean_of_maxima(y: Array, membership: Array) -> Array:
    """Mean of the grid points of largest membership."""
    top = _at_maximum(membership)
    return np.asarray((top @ y) / top.sum(axis=-1))


def smallest_of_maxima(y: Array, membership: Array) -> Array:
    """Smallest grid point of largest membership."""
    return np.asarray(y[np.argmax(_at_maximum(membership), axis=-1)])


def largest_of_maxima(y: Array, membership: Array) -> Array:
    """Largest grid point of largest membership."""
    top = _at_maximum(membership)[..., ::-1]
    return np.asarray(y[::-1][np.argmax(top, axis=-1)])


DEFUZZIFIERS: dict[str, Callable[[Array, Array], Array]] = {
    "centroid": centroid,
    # Over the sets' centers instead of the universe (Eq. 3.13): the grid differs, not the formula.
    "weighted-centers": centroid,
    "bisector": bisector,
    "mom": mean_of_maxima,
    "som": smallest_of_maxima,
    "lom": largest_of_maxima,
}


def defuzzify(method: str, y: Array, membership: Array) -> Array:
    """Crisp value of a fuzzy output.

    Parameters
    ----------
    method : str
        A key of `DEFUZZIFIERS`.
    y : ndarray, shape (n,)
        Grid of the output; for a centroid also one for each fuzzy output, shape (..., n).
    membership : ndarray, shape (..., n)
        Fuzzy outputs on that grid, nonnegative.

    Returns
    -------
    ndarray, shape (...)
        Crisp values; NaN where the fuzzy output is empty.
    """
    peak = membership.max(axis=-1, keepdims=True)
    empty = ~(peak > 0)
    # Scaled to a peak of one, grades near the smallest float keep their ratios in the sums. None is
    # above its peak; but NumPy 1.26 also divides ones that fill up its registers, whose results it
    # drops, and warns of an overflow there.
    with np.errstate(over="ignore"):
        scaled = membership / np.where(empty, 1.0, peak)
    filled = np.where(empty, 1.0, scaled)
    return np.where(empty[..., 0], np.nan, DEFUZZIFIERS[method](y, filled))
