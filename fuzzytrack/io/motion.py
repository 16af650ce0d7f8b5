"""Speed and course of velocities, as the files of tracks have them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.io.angles import wrapped

__all__ = ["course", "speed"]


def course(velocity: ArrayLike) -> Array:
    """Course over ground of velocities to the east and north.

    Parameters
    ----------
    velocity : array_like, shape (..., n_axes)
        Velocities; the first two axes point east and north, others do not count.

    Returns
    -------
    ndarray, shape (...)
        Degrees clockwise from north in [0, 360); NaN where the target stands still on the
        ground, or a velocity is NaN.

    Raises
    ------
    ValueError
        If there are fewer than two axes.
    """
    components = _components(velocity)
    if components.shape[-1] < 2:
        raise ValueError(
            f"`velocity`: shape {components.shape}; a course needs at least two axes, east and "
            "north, in the last dimension"
        )
    east, north = components[..., 0], components[..., 1]
    degrees = wrapped(np.degrees(np.arctan2(east, north)), 360.0)
    return np.asarray(np.where((east == 0) & (north == 0), np.nan, degrees))


def speed(velocity: ArrayLike) -> Array:
    """Size of velocities, over all their axes.

    Parameters
    ----------
    velocity : array_like, shape (..., n_axes)
        Velocities.

    Returns
    -------
    ndarray, shape (...)
        Speeds, in the unit of the velocities; NaN where a component is NaN.

    Raises
    ------
    ValueError
        If there is no axis.
    """
    components = _components(velocity)
    if components.shape[-1] == 0:
        raise ValueError(f"`velocity`: shape {components.shape}; a speed needs at least one axis")
    largest = np.max(np.abs(components), axis=-1)
    # Squares of large or tiny components leave the range of numbers.
    scale = np.where((largest > 0) & np.isfinite(largest), largest, 1.0)
    size: Array = np.sqrt(np.sum((components / scale[..., None]) ** 2, axis=-1)) * scale
    return size


def _components(velocity: ArrayLike) -> Array:
    components = np.asarray(velocity, dtype=np.float64)
    if components.ndim == 0:
        raise ValueError("`velocity`: a single number; expected the axes in the last dimension")
    return components
