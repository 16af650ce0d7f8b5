"""Convex polygons of the plane: their corners, their parts and their centers."""

from __future__ import annotations

import numpy as np

from fuzzytrack.arrays import Array

__all__ = ["center_of_gravity", "convex_hull", "part_below"]


def convex_hull(points: Array) -> Array:
    """Corners of the convex hull, in order; the two ends where the points lie on a line.

    Parameters
    ----------
    points : ndarray, shape (n, 2)

    Returns
    -------
    ndarray, shape (m, 2)
    """
    unique = np.unique(points, axis=0)
    if len(unique) < 3:
        return unique
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(unique[ConvexHull(unique).vertices])
    except QhullError:
        return unique[[0, -1]]


def part_below(corners: Array, side: Array) -> Array:
    """Part of a convex polygon where a·x + b·y + c is not positive.

    Parameters
    ----------
    corners : ndarray, shape (n, 2)
        In order; also one point or the two ends of a line.
    side : ndarray, shape (3,)
        The numbers a, b and c.

    Returns
    -------
    ndarray, shape (m, 2)
    """
    values = corners @ side[:2] + side[2]
    kept = []
    for k in range(len(corners)):
        here, there = values[k - 1], values[k]
        if (here > 0) != (there > 0):
            kept.append(corners[k - 1] + here / (here - there) * (corners[k] - corners[k - 1]))
        if there <= 0:
            kept.append(corners[k])
    return np.array(kept).reshape(-1, 2)


def center_of_gravity(corners: Array) -> Array:
    """Center of gravity of the area of a convex polygon; the mean of the corners where it has none.

    Parameters
    ----------
    corners : ndarray, shape (n, 2)
        Counterclockwise.

    Returns
    -------
    ndarray, shape (2,)
    """
    first = corners[0]
    one, other = corners[1:-1] - first, corners[2:] - first
    areas = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    total = areas.sum()
    if not total > 0:
        return np.asarray(corners.mean(axis=0))
    return np.asarray(first + (areas @ (one + other)) / (3 * total))
