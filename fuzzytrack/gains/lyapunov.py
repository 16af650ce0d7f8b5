"""Common quadratic Lyapunov functions: one norm that all matrices of a set reduce."""

from __future__ import annotations

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains.polygons import center_of_gravity, part_below

__all__ = ["common_lyapunov", "largest_rate"]

_CUTS = 300
#: Points of the disc farther out are matrices that are singular in floating point.
_RIM = 1 - 1e-12


def largest_rate(matrices: Array, p: Array) -> float:
    """Largest factor by which a matrix of the set multiplies √(eᵀPe).

    Parameters
    ----------
    matrices : ndarray, shape (n, 2, 2)
    p : ndarray, shape (2, 2)
        Symmetric and positive definite.

    Returns
    -------
    float
    """
    return float(_rates(matrices, p).max())


def common_lyapunov(matrices: Array) -> tuple[float, Array]:
    """Quadratic function that all matrices of a set reduce most, and its rate.

    Parameters
    ----------
    matrices : ndarray, shape (n, 2, 2)
        A function that reduces these reduces the matrices of their convex hull as well.

    Returns
    -------
    rate : float
        Largest factor by which one of the matrices multiplies √(eᵀPe); if it is below 1, all
        products of them, in any order, go to zero.
    p : ndarray, shape (2, 2)
        Symmetric and positive definite, with P[0, 0] = 1.

    Notes
    -----
    The rate is quasi-convex in P: FᵀPF - r²P is linear in P, so the P with rates below r are a
    convex set. With trace 1 the candidates are a disc. In each step the rate is computed at the
    center of gravity of what is left of it. The direction in which the worst matrix grows most
    divides the disc into a half with larger rates, which is dropped, and one that holds all better
    ones: the method of centers of gravity (Levin 1965, Newman 1965), where at most 1 - 1/e of the
    area is left after a step.
    """
    polygon = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    best, best_p = np.inf, np.eye(2)
    for _ in range(_CUTS):
        center = center_of_gravity(polygon)
        p = _from_disc(center)
        distance = np.hypot(*center)
        if distance < _RIM:
            rates = _rates(matrices, p)
            worst = int(np.argmax(rates))
            rate = float(rates[worst])
            if rate < best:
                best, best_p = rate, p
            side = _grows(matrices[worst], rate, p)
        else:
            side = np.array([*(center / distance), -_RIM])
        polygon = part_below(polygon, side)
        if len(polygon) < 3 or np.ptp(polygon, axis=0).max() < 1e-14:
            break
    return best, best_p / best_p[0, 0]


def _from_disc(point: Array) -> Array:
    """P with trace 1 for a point of the unit disc; on the circle it is singular."""
    c, s = point
    return 0.5 * np.array([[1 + c, s], [s, 1 - c]])


def _rates(matrices: Array, p: Array) -> Array:
    """√ of the largest eigenvalue of P⁻¹FᵀPF for each F."""
    root = np.linalg.cholesky(p).T  # P = RᵀR
    (a, b), (c, d) = np.moveaxis(root @ matrices @ np.linalg.inv(root), 0, -1)
    # Largest singular value, without the difference of squares that would lose digits.
    return np.asarray(0.5 * (np.hypot(a + d, b - c) + np.hypot(a - d, b + c)))


def _grows(matrix: Array, rate: float, p: Array) -> Array:
    """Coefficients (of c, s, and 1) of vᵀ(FᵀPF - r²P)v, for the v that F multiplies most."""
    root = np.linalg.cholesky(p).T
    back = np.linalg.inv(root)
    v = back @ np.linalg.svd(root @ matrix @ back)[2][0]
    after = matrix @ v

    def form(e: Array) -> Array:
        return np.array([e[0] ** 2 - e[1] ** 2, 2 * e[0] * e[1], e[0] ** 2 + e[1] ** 2])

    return np.asarray(form(after) - rate**2 * form(v))
