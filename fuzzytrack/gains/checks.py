"""Checks of arguments for all functions on gains; each returns the checked value."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array

__all__ = [
    "SQUARES", "finite", "inside", "nonnegative", "nonnegative_deviation", "number", "positive",
    "positive_deviation", "stable_gains", "within",
]  # fmt: skip

#: Limits between which the square of a standard deviation is a number to calculate with.
SQUARES = (1e-150, 1e150)


def finite(name: str, value: ArrayLike) -> Array:
    """`value` as an array of floats, all finite, or a ValueError that names it."""
    array = _floats(name, value)
    return _all(name, array, np.isfinite(array), "finite")


def nonnegative(name: str, value: ArrayLike) -> Array:
    """`value` as an array of floats, all finite and >= 0, or a ValueError that names it."""
    array = _floats(name, value)
    return _all(name, array, np.isfinite(array) & (array >= 0), "finite and >= 0")


def positive(name: str, value: ArrayLike) -> Array:
    """`value` as an array of floats, all finite and > 0, or a ValueError that names it."""
    array = _floats(name, value)
    return _all(name, array, np.isfinite(array) & (array > 0), "finite and > 0")


def _floats(name: str, value: ArrayLike) -> Array:
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be a number, got {value!r}") from None


def positive_deviation(name: str, value: ArrayLike) -> Array:
    """As `positive`, for numbers that are squared: from 1e-150 to 1e150."""
    array = positive(name, value)
    return _all(name, array, _squarable(array), _SQUARABLE)


def nonnegative_deviation(name: str, value: ArrayLike) -> Array:
    """As `nonnegative`, for numbers that are squared: 0, or from 1e-150 to 1e150."""
    array = nonnegative(name, value)
    return _all(name, array, (array == 0) | _squarable(array), f"0 or {_SQUARABLE}")


_SQUARABLE = f"from {SQUARES[0]:g} to {SQUARES[1]:g}, since it is squared"


def _squarable(array: Array) -> NDArray[np.bool_]:
    return np.asarray((array >= SQUARES[0]) & (array <= SQUARES[1]))


def within(name: str, value: ArrayLike, good: NDArray[np.bool_], range_: str) -> Array:
    """`value` as an array of floats where `good` holds, or a ValueError that names it."""
    return _all(name, _floats(name, value), good, range_)


def inside(alpha: Array, beta: Array, gamma: Array) -> NDArray[np.bool_]:
    """Whether gains lie in the open stability region; false for NaN and infinity."""
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        triangle = (alpha > 0) & (alpha < 2) & (beta > 0) & (4 - 2 * alpha - beta > 0)
        # γ = 0 is tested separately: there the filter has two states, and the product may
        # underflow.
        below = (gamma == 0) | ((gamma > 0) & (gamma * (2 - alpha) < 4 * alpha * beta))
    good: NDArray[np.bool_] = triangle & below
    return good


def stable_gains(
    alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike = 0.0
) -> tuple[Array, Array, Array]:
    """Gains of one common shape (views, not to be written to), all of them stable.

    Raises
    ------
    ValueError
        If gains lie outside the stability region (strictly: its edge is outside); names the
        first such gains and the region.
    """
    a, b, c = np.broadcast_arrays(
        *(np.asarray(gain, dtype=np.float64) for gain in (alpha, beta, gamma))
    )
    bad = ~inside(a, b, c)
    if bad.any():
        at = tuple(np.argwhere(bad)[0])
        where = f" at index {_index(at)}" if at else ""
        names, region, values = "alpha, beta", "", f"alpha={a[at]:g}, beta={b[at]:g}"
        if (c != 0).any():
            names += ", gamma"
            region = " and to 0 <= gamma < 4 alpha beta / (2 - alpha)"
            values += f", gamma={c[at]:g}"
        raise ValueError(
            f"{names} must keep to the stability triangle alpha > 0, beta > 0, "
            f"2 alpha + beta < 4{region}; got {values}{where}"
        )
    return a, b, c


def _all(name: str, array: Array, good: NDArray[np.bool_], range_: str) -> Array:
    if not good.all():
        at = tuple(np.argwhere(~good)[0])
        where = f" at index {_index(at)}" if at else ""
        raise ValueError(f"{name} must be {range_}, got {array[at]:g}{where}")
    return array


def _index(at: tuple[np.intp, ...]) -> str:
    return str(tuple(map(int, at)) if len(at) > 1 else int(at[0]))


def number(name: str, array: Array) -> float:
    """The number in an array without axes, or a ValueError that names it."""
    if array.ndim:
        raise ValueError(f"{name} must be one number, got an array of shape {array.shape}")
    return float(array)
