"""Norms of the plane whose unit ball is a polygon, and one that all matrices of a set reduce."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array

__all__ = ["ellipse", "polygon_norm", "reducing_polygon"]

_CHECKS = 40
_ROUNDS = 60
_ADDED = 40
_TOLERANCE = 1e-6
#: A polygon whose corners are so much farther out than at first does not come to an end.
_LARGEST = 1e4
_MOST_CORNERS = 200


def ellipse(p: Array, corners: int = 64) -> Array:
    """Corners of a polygon in the ellipse xᵀPx = 1, counterclockwise.

    Parameters
    ----------
    p : ndarray, shape (2, 2)
        Symmetric and positive definite.
    corners : int
        How many.

    Returns
    -------
    ndarray, shape (corners, 2)
    """
    angles = 2 * np.pi * np.arange(corners) / corners
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return circle @ np.linalg.inv(np.linalg.cholesky(p))


def polygon_norm(points: Array, corners: Array) -> Array:
    """Size of points, measured by a polygon around the origin: 1 on its edge, 2 at twice that.

    Parameters
    ----------
    points : ndarray, shape (..., 2)
    corners : ndarray, shape (n, 2)
        Corners of a convex polygon that contains the origin, counterclockwise.

    Returns
    -------
    ndarray, shape (...)
    """
    following = np.roll(corners, -1, axis=0)
    doubled_areas = corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]
    edges = following - corners
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / doubled_areas[:, None]
    angles = np.arctan2(corners[:, 1], corners[:, 0])
    first = int(np.argmin(angles))
    directions = np.arctan2(points[..., 1], points[..., 0])
    sectors = np.searchsorted(np.roll(angles, -first), directions, side="right") - 1 + first
    return np.asarray((points * normals[sectors % len(corners)]).sum(axis=-1))


def reducing_polygon(matrices: Array, start: Array, rate: float) -> tuple[float, Array]:
    """Polygon that every matrix of a set maps into a smaller copy of itself, if one is found.

    A polygon grows by the images of its corners, enlarged by 1/rate, until they are all inside. It
    stays bounded if no product of the matrices grows faster than the rate.

    Parameters
    ----------
    matrices : ndarray, shape (n, 2, 2)
        A polygon that these reduce is reduced by the matrices of their convex hull as well.
    start : ndarray, shape (m, 2)
        Corners of the polygon to begin with; see `ellipse`.
    rate : float
        Size of the smaller copy that is aimed at.

    Returns
    -------
    rate : float
        Size of the smallest copy that holds all images, for the best polygon met; below 1 it is a
        proof that all products of the matrices go to zero, however the polygon was found.
    corners : ndarray, shape (k, 2)
        The polygon, counterclockwise.

    Notes
    -----
    The polytope algorithm of Guglielmi & Protasov (2013), with its answer checked for all matrices.
    In between only those count that were among the worst in such a check.
    """
    corners = start
    best, best_corners = np.inf, corners
    worst: NDArray[np.intp] = np.empty(0, dtype=np.intp)
    for _ in range(_CHECKS):
        sizes = _image_sizes(matrices, corners)
        reached = float(sizes.max())
        if reached < best:
            best, best_corners = reached, corners
        outside = np.flatnonzero(sizes > rate * (1 + _TOLERANCE))
        if not len(outside):
            break
        worst = np.union1d(worst, outside[np.argsort(-sizes[outside])[:_ADDED]])
        grown = _grown(matrices[worst], corners, rate)
        if grown is None:
            break
        corners = grown
    return best, best_corners


def _image_sizes(matrices: Array, corners: Array) -> Array:
    """For each matrix the size of the largest image of a corner."""
    sizes = polygon_norm(corners @ np.swapaxes(matrices, -1, -2), corners)
    return np.asarray(sizes.max(axis=1))


def _grown(matrices: Array, corners: Array, rate: float) -> Array | None:
    """Polygon around the corners that holds its images, enlarged by 1/rate; None if too large."""
    from scipy.spatial import ConvexHull

    largest = _LARGEST * np.abs(corners).max()
    for _ in range(_ROUNDS):
        images = (corners @ np.swapaxes(matrices, -1, -2)).reshape(-1, 2)
        outside = images[polygon_norm(images, corners) > rate * (1 + _TOLERANCE)] / rate
        if not len(outside):
            return corners
        points = np.concatenate([corners, outside, -outside])
        corners = points[ConvexHull(points).vertices]
        if np.abs(corners).max() > largest or len(corners) > _MOST_CORNERS:
            return None
    return None
