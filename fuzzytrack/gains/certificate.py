"""Certified stability of scheduled gains that switch in any order.

A filter whose gains are stable one by one may still diverge when they change from step to step.
At each step the error of an α-β filter is multiplied by a matrix that is affine in the gains. So a
quadratic function that decreases for the gains at the corners of a set decreases for all gains
inside, in any order: a common Lyapunov function. If none is found, the search is for a sequence of
gains with which the error grows.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = [
    "Certificate",
    "box",
    "certify",
    "certify_region",
    "convex_hull",
    "error_matrix",
    "polygon_in_gains",
]


#: Rates this close to 1 cannot be distinguished from 1 in floating point.
_MARGIN = 1e-9
_SEARCH_VERTICES = 24
_BEAM = 400


@dataclass(frozen=True, eq=False)
class Certificate:
    """Result of the stability check of a set of gains under arbitrary switching.

    Attributes
    ----------
    verdict : {"certified", "refuted", "not decided"}
        ``certified``: the error contracts for any gains in the set, in any order. ``refuted``: a
        sequence of gains was found with which it grows. ``not decided``: neither was shown.
    rate : float
        Contraction of the Lyapunov function's root per step, the best one found; below 1 if and
        only if certified.
    lyapunov : ndarray, shape (2, 2)
        Its matrix P, in coordinates (position error, T times velocity error), with P[0, 0] = 1.
    vertices : ndarray, shape (n, 2)
        Gains (α, β) whose convex hull holds the set.
    sequence : ndarray, shape (length, 2)
        Gains which, repeated in this order, make the error grow; empty unless refuted.
    growth : float
        Growth of the error per step with that sequence; NaN unless refuted.
    """

    verdict: str
    rate: float
    lyapunov: Array
    vertices: Array
    sequence: Array
    growth: float

    def __repr__(self) -> str:
        return summary(self, "verdict", "rate", "growth", "vertices", "sequence")


def error_matrix(alpha: ArrayLike, beta: ArrayLike) -> Array:
    """Matrix by which one update multiplies the prediction error (x, T v) of an α-β filter.

    Parameters
    ----------
    alpha, beta : array_like
        Gains; they broadcast.

    Returns
    -------
    ndarray, shape (..., 2, 2)
        [[1 - α - β, 1], [-β, 1]].
    """
    a, b = np.broadcast_arrays(np.asarray(alpha, float), np.asarray(beta, float))
    one = np.ones_like(a)
    return np.stack([np.stack([1 - a - b, one], -1), np.stack([-b, one], -1)], -2)


def box(stiffness: tuple[float, float], damping: tuple[float, float]) -> Array:
    """Corners of a box of stiffness and damping, in order.

    Parameters
    ----------
    stiffness, damping : (float, float)
        Smallest and largest natural frequency and damping ratio in the w-domain, low <= high,
        stiffness positive, damping not negative.

    Returns
    -------
    ndarray, shape (4, 2)
        (stiffness, damping).

    Raises
    ------
    ValueError
        If an interval is empty, or reaches impossible values.
    """
    (w1, w2), (z1, z2) = stiffness, damping
    if not (0 < w1 <= w2 < np.inf):
        raise ValueError(f"stiffness must be 0 < low <= high, got {stiffness}")
    if not (0 <= z1 <= z2 < np.inf):
        raise ValueError(f"damping must be 0 <= low <= high, got {damping}")
    return np.array([(w1, z1), (w2, z1), (w2, z2), (w1, z2)])


def polygon_in_gains(corners: ArrayLike, pieces: int = 32) -> tuple[Array, Array]:
    """Image of a polygon of (stiffness, damping) in the gains, from outside and from inside.

    In p = 2ζω₀ and q = ω₀² an edge of the polygon becomes a parabola, whose hull is inside that of
    its three control points; the map from there to (α, β) keeps straight lines straight. So the
    hull of `around` contains the whole image, not only a sample of it.

    Parameters
    ----------
    corners : array_like, shape (n, 2)
        Corners of a convex polygon, in order.
    pieces : int
        Pieces into which each edge is divided; with more pieces the result is closer to the image.

    Returns
    -------
    around : ndarray, shape (n, 2)
        (α, β) whose convex hull contains the image; not all of them belong to the image.
    reached : ndarray, shape (m, 2)
        (α, β) on the edge of the image.
    """
    ends = np.asarray(corners, dtype=np.float64)
    following = np.roll(ends, -1, axis=0)
    share = np.linspace(0.0, 1.0, pieces + 1)[:, None, None]
    knots = ends + share * (following - ends)
    (w_a, z_a), (w_b, z_b) = (np.moveaxis(k, -1, 0) for k in (knots[:-1], knots[1:]))
    # Control points of the quadratic curve between two knots: ends, and the mixed product.
    p = np.stack([2 * z_a * w_a, z_a * w_b + z_b * w_a, 2 * z_b * w_b])
    q = np.stack([w_a * w_a, w_a * w_b, w_b * w_b])
    scale = 1 + p + q
    points = np.stack([2 * p / scale, 4 * q / scale], axis=-1)
    around = np.unique(points.reshape(-1, 2), axis=0)
    return around, np.unique(points[[0, 2]].reshape(-1, 2), axis=0)


def certify_region(corners: ArrayLike, max_length: int = 8) -> Certificate:
    """Certify all gains of a convex polygon of stiffness and damping; see `certify`.

    Parameters
    ----------
    corners : array_like, shape (n, 2)
        (stiffness, damping), in order; `box` returns those of a box.
    max_length : int
        Longest sequence of gains tried as a counter-example.

    Returns
    -------
    Certificate

    Examples
    --------
    >>> found = certify_region(box((0.25, 0.35), (0.54, 0.89)))
    >>> found.verdict, round(found.rate, 3)
    ('certified', 0.816)
    """
    around, reached = polygon_in_gains(corners)
    return certify(around, max_length, reached=reached)


def certify(
    gains: ArrayLike, max_length: int = 8, *, reached: ArrayLike | None = None
) -> Certificate:
    """Certify a set of α-β gains that may switch arbitrarily from step to step.

    Parameters
    ----------
    gains : array_like, shape (n, 2)
        (α, β) pairs; the set is inside their convex hull. See `certify_region` for stiffness and
        damping.
    max_length : int
        Longest sequence of gains tried as a counter-example.
    reached : array_like, shape (m, 2), optional
        Gains that certainly belong to the set; counter-examples are made of them. `gains` unless
        given.

    Returns
    -------
    Certificate

    Raises
    ------
    ValueError
        If there is no pair, one is not finite, or `max_length` is below 1.

    Notes
    -----
    The rate minimizes the largest eigenvalue of P⁻¹FᵀPF over the vertices, a quasi-convex problem
    in two unknowns. The counter-example is a product of vertex matrices with spectral radius above
    1, found by a beam search, and is an explicit proof; if the search finds none, nothing is
    proved. Missed plots (α = β = 0) lie outside of every certificate.

    Examples
    --------
    >>> certify([[0.5377, 0.2018], [0.7, 0.28]]).verdict
    'certified'
    """
    points = np.asarray(gains, dtype=np.float64)
    if points.ndim != 2 or points.shape[-1] != 2 or not len(points):
        raise ValueError(f"gains must be pairs (alpha, beta), shape (n, 2); got {points.shape}")
    if not np.isfinite(points).all():
        raise ValueError("gains must be finite numbers")
    if max_length < 1:
        raise ValueError(f"max_length must be at least 1, got {max_length}")
    vertices = convex_hull(points)
    matrices = error_matrix(vertices[:, 0], vertices[:, 1])
    rate, lyapunov = _best_lyapunov(matrices)
    nothing = np.empty((0, 2))
    if rate < 1 - _MARGIN:
        return Certificate("certified", rate, lyapunov, vertices, nothing, np.nan)
    candidates = vertices
    if reached is not None:
        candidates = convex_hull(np.asarray(reached, dtype=np.float64))
    candidates = candidates[_spread(candidates)]
    order, growth = _growing_sequence(error_matrix(*candidates.T), lyapunov, max_length)
    if growth > 1 + _MARGIN:
        sequence = candidates[list(order)]
        return Certificate("refuted", rate, lyapunov, vertices, sequence, growth)
    return Certificate("not decided", rate, lyapunov, vertices, nothing, np.nan)


def convex_hull(points: Array) -> Array:
    """Vertices of the convex hull, in order; the two ends where the points lie on a line."""
    unique = np.unique(points, axis=0)
    if len(unique) < 3:
        return unique
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(unique[ConvexHull(unique).vertices])
    except QhullError:
        return unique[[0, -1]]


def _largest_rate(matrices: Array, p: Array) -> float:
    """√ of the largest eigenvalue of P⁻¹FᵀPF over all F: the contraction that P proves."""
    factor = np.linalg.cholesky(p).T  # P = RᵀR
    similar = factor @ matrices @ np.linalg.inv(factor)
    return float(np.linalg.norm(similar, ord=2, axis=(-2, -1)).max())


def _lyapunov_matrix(shape: Array) -> Array:
    """P = [[1, -x], [-x, y]] from unconstrained numbers: x, and the logarithm of y - x²."""
    x, log_excess = shape
    return np.array([[1.0, -x], [-x, x * x + np.exp(log_excess)]])


def _best_lyapunov(matrices: Array) -> tuple[float, Array]:
    from scipy.optimize import minimize

    def rate(shape: Array) -> float:
        return _largest_rate(matrices, _lyapunov_matrix(shape))

    best = None
    for start in ((0.5, 0.0), (1.5, 1.0)):
        # Not differentiable where two vertices are equally bad, hence a simplex method. It is
        # restarted where it stopped, since a simplex may collapse on such a ridge.
        found = minimize(rate, start, method="Nelder-Mead", options=_PRECISE)
        found = minimize(rate, found.x, method="Nelder-Mead", options=_PRECISE)
        if best is None or found.fun < best.fun:
            best = found
    assert best is not None
    return float(best.fun), _lyapunov_matrix(best.x)


_PRECISE = {"xatol": 1e-10, "fatol": 1e-13, "maxiter": 2000, "maxfev": 4000}


def _spread(vertices: Array) -> NDArray[np.intp]:
    """Indices of a few vertices, far apart: a search over sequences cannot use hundreds."""
    if len(vertices) <= _SEARCH_VERTICES:
        return np.arange(len(vertices))
    chosen = [int(np.argmin(vertices[:, 0]))]
    distance = np.full(len(vertices), np.inf)
    while len(chosen) < _SEARCH_VERTICES:
        step = np.linalg.norm(vertices - vertices[chosen[-1]], axis=1)
        distance = np.minimum(distance, step)
        chosen.append(int(np.argmax(distance)))
    return np.array(chosen)


def _growing_sequence(
    matrices: Array, lyapunov: Array, max_length: int
) -> tuple[tuple[int, ...], float]:
    """Sequence of matrices with the largest growth per step that a beam search finds."""
    best: tuple[tuple[int, ...], float] = ((), 0.0)
    for orders, products in _beam(matrices, lyapunov, max_length):
        radius = np.abs(np.linalg.eigvals(products)).max(axis=-1) ** (1 / len(orders[0]))
        top = int(np.argmax(radius))
        if radius[top] > best[1] * (1 + _MARGIN):
            best = orders[top], float(radius[top])
    return best


def _beam(
    matrices: Array, lyapunov: Array, max_length: int
) -> Iterator[tuple[list[tuple[int, ...]], Array]]:
    """For each length the sequences kept, with the products of their matrices, last one leftmost.

    Kept are the largest products; how large is measured in the norm of the best Lyapunov function
    for the set, which treats all directions of the error alike.
    """
    root = np.linalg.cholesky(lyapunov).T
    back = np.linalg.inv(root)
    orders: list[tuple[int, ...]] = [(k,) for k in range(len(matrices))]
    products = matrices
    yield orders, products
    for _ in range(max_length - 1):
        orders = [(*order, k) for order in orders for k in range(len(matrices))]
        products = (matrices[None] @ products[:, None]).reshape(-1, 2, 2)
        if len(orders) > _BEAM:
            size = np.linalg.norm(root @ products @ back, ord=2, axis=(-2, -1))
            keep = np.argsort(-size, kind="stable")[:_BEAM]
            orders, products = [orders[k] for k in keep], products[keep]
        yield orders, products
