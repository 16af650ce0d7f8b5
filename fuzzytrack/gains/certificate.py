"""Certified stability of scheduled gains that switch in any order, at any of a range of times.

A filter whose gains are stable one by one may still diverge when they change from plot to plot, or
when the time between plots changes. At each plot the error of an α-β filter is multiplied by a
matrix that is affine in the gains, and affine in s and 1/s, s the time since the last plot. So a
norm of the error that decreases for the gains at the corners of a set, at the corners of a polygon
around the curve (s, 1/s), decreases for all gains and times inside, in any order. Such a norm is a
certificate: one of an ellipse (a common quadratic Lyapunov function) or else of a polygon. If none
is found, the search is for a sequence of gains and times with which the error grows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.gains.elapsed_times import ElapsedTimes, around_curve
from fuzzytrack.gains.growing_sequence import growing_sequence
from fuzzytrack.gains.lyapunov import common_lyapunov
from fuzzytrack.gains.period import poles_in_time, resampled_gains
from fuzzytrack.gains.polygon_norm import ellipse, polygon_norm, reducing_polygon
from fuzzytrack.gains.polygons import convex_hull
from fuzzytrack.gains.resampled_region import resampled_region
from fuzzytrack.gains.stability import is_stable
from fuzzytrack.html_reprs import as_text, block, facts, paragraph, table
from fuzzytrack.plurals import counted
from fuzzytrack.reprs import summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "Certificate",
    "box",
    "certify",
    "certify_region",
    "error_matrix",
    "polygon_in_gains",
]


#: Rates this close to 1 cannot be distinguished from 1 in floating point.
_MARGIN = 1e-9
_SEARCH_VERTICES = 24


@dataclass(frozen=True, eq=False)
class Certificate:
    """Result of the stability check of a set of gains under arbitrary switching.

    The error is (position error, U times velocity error), as predicted for a time U after a plot. U
    is the shortest step.

    Attributes
    ----------
    verdict : {"certified", "refuted", "not decided"}
        ``certified``: the error contracts for any gains in the set and any times, in any order.
        ``refuted``: a sequence of gains and times was found with which it grows. ``not decided``:
        neither was shown.
    rate : float
        Largest factor by which a plot multiplies `norm` of the error, for the best norm found;
        below 1 if and only if certified.
    lyapunov : ndarray, shape (2, 2)
        The P of the best norm of the form √(eᵀPe), with P[0, 0] = 1.
    vertices : ndarray, shape (n, 2)
        Gains (α, β) whose convex hull holds the set.
    times : ElapsedTimes
        Times between plots that are covered.
    period : float or None
        Sampling time to which the gains belong; None if they are used at any.
    polygon : ndarray, shape (k, 2)
        Corners of the unit ball of `norm` where an ellipse does not do; otherwise empty.
    sequence : ndarray, shape (length, 2)
        Gains which, repeated in this order, make the error grow, as used after the times `elapsed`;
        empty unless refuted.
    elapsed : ndarray, shape (length,)
        Times since the last plot that go with them.
    growth : float
        Growth of the error per plot with that sequence; NaN unless refuted.
    """

    verdict: str
    rate: float
    lyapunov: Array
    vertices: Array
    times: ElapsedTimes
    period: float | None = None
    polygon: Array = field(default_factory=lambda: np.empty((0, 2)))
    sequence: Array = field(default_factory=lambda: np.empty((0, 2)))
    elapsed: Array = field(default_factory=lambda: np.empty(0))
    growth: float = math.nan

    def __repr__(self) -> str:
        return summary(self, "verdict", "rate", "growth", "vertices", "times", "sequence")

    @property
    def covered(self) -> str:
        """The times and plots that the verdict is about, in words."""
        low, high, missed = self.times.low, self.times.high, self.times.missed
        if low < high:
            time = f"time between rows in [{low:g}, {high:g}] s, changing in any way"
        else:
            time = "constant T" if self.period is None else f"constant T = {low:g} s"
        plots = f"up to {counted(missed, 'missed plot')} in a row" if missed else "no missed plots"
        belongs = "" if self.period is None else f"; gains of a period of {self.period:g} s"
        return f"{time}, {plots}{belongs}"

    def plot(self) -> Figure:
        """Picture of the gains, and of how the error shrinks or grows."""
        from fuzzytrack.plotting import plot_certificate

        return plot_certificate(self)[0]

    def _repr_html_(self) -> str:
        """The verdict, and the norm or the sequence that shows it, for notebooks."""
        title = f"Stability: {self.verdict}"
        covered = paragraph(f"Covered: {self.covered}.")
        if self.verdict == "refuted":
            said = (
                "Gains of the set that, repeated in this order, make the error grow by a factor of "
                f"{self.growth:.4f} a plot:"
            )
            pairs = zip(self.elapsed.tolist(), self.sequence.tolist(), strict=True)
            rows = [
                [f"{k}", as_text(time), *map(as_text, gains)]
                for k, (time, gains) in enumerate(pairs, 1)
            ]
            heads = ["plot", "time since the last plot (s)", "α", "β"]
            return block(title, covered, paragraph(said), table(heads, rows, what="plots"))
        if self.verdict == "certified":
            said = (
                "For all gains of the set, in any order, the error shrinks at every plot to "
                f"{self.rate:.4f} of what it was, or less."
            )
            corners = len(self.polygon)
            norm = f"on a polygon of {corners} corners" if corners else "√(eᵀPe)"
            (a, b), (_, d) = self.lyapunov.tolist()
            matrix = "" if corners else f"P = [[{a:.4g}, {b:.4g}], [{b:.4g}, {d:.4g}]]"
            return block(title, covered, paragraph(said), facts({"measure": norm, "": matrix}))
        said = (
            "No measure of the error was found that always shrinks (the best one may grow by a "
            f"factor of {self.rate:.4f} a plot), nor a sequence of gains that makes the error grow."
        )
        return block(title, covered, paragraph(said))

    def norm(self, error: ArrayLike) -> Array:
        """Norm of the error that the certificate is about.

        Parameters
        ----------
        error : array_like, shape (..., 2)

        Returns
        -------
        ndarray, shape (...)
        """
        e = np.asarray(error, dtype=np.float64)
        if len(self.polygon):
            return polygon_norm(e, self.polygon)
        return np.asarray(np.sqrt(np.einsum("...i,ij,...j", e, self.lyapunov, e)))


def error_matrix(alpha: ArrayLike, beta: ArrayLike, elapsed: ArrayLike = 1.0) -> Array:
    """Matrix by which a plot multiplies the error (x, U v) of an α-β filter.

    It is the error as predicted for a time U after a plot: with constant T = U, the prediction
    error.

    Parameters
    ----------
    alpha, beta : array_like
        Gains.
    elapsed : array_like
        Time since the last plot, in units of U. All arguments broadcast.

    Returns
    -------
    ndarray, shape (..., 2, 2)
        F(1) (I - K H) F(s) F(1)⁻¹ with K = (α, β/s); [[1 - α - β, 1], [-β, 1]] at s = 1.
    """
    s = np.asarray(elapsed, dtype=np.float64)
    return _error_matrix(np.asarray(alpha, float), np.asarray(beta, float), s, 1 / s)


def _error_matrix(alpha: Array, beta: Array, s: Array, inverse: Array) -> Array:
    """The same with 1/s as an argument of its own, in which the matrix is affine."""
    a, b, s, r = np.broadcast_arrays(alpha, beta, s, inverse)
    top = np.stack([1 - a - b * r, (1 - a) * (s - 1) + 1 - b * (1 - r)], -1)
    return np.stack([top, np.stack([-b * r, 1 - b * (1 - r)], -1)], -2)


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


def certify_region(
    corners: ArrayLike, max_length: int = 48, *, times: ElapsedTimes | None = None
) -> Certificate:
    """Certify all gains of a convex polygon of stiffness and damping; see `certify`.

    Parameters
    ----------
    corners : array_like, shape (n, 2)
        (stiffness, damping), in order; `box` returns those of a box.
    max_length : int
        Longest sequence of gains tried as a counter-example.
    times : ElapsedTimes, optional
        Times between plots; constant, and no plot missed, unless given.

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
    return certify(around, max_length, reached=reached, times=times)


def certify(
    gains: ArrayLike,
    max_length: int = 48,
    *,
    reached: ArrayLike | None = None,
    times: ElapsedTimes | None = None,
    period: float | None = None,
) -> Certificate:
    """Certify a set of α-β gains that may switch arbitrarily from plot to plot.

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
    times : ElapsedTimes, optional
        Times between plots; constant, and no plot missed, unless given.
    period : float, optional
        Sampling time to which the gains belong (s). They are then converted to the time since the
        last plot, see `fuzzytrack.gains.period`.

    Returns
    -------
    Certificate

    Raises
    ------
    ValueError
        If there is no pair, one is not finite, `max_length` is below 1, or gains with a period are
        not stable or have a negative real pole.

    Notes
    -----
    The matrix of a plot is affine in (α, β) for a fixed (s, 1/s), and affine in (s, 1/s) for fixed
    gains. So it is a convex combination of the matrices of the corners of both sets, and a norm of
    it is at most the largest norm of those: finitely many matrices prove the bound for all, without
    a grid. The curve (s, 1/s) is enclosed in a polygon, see `ElapsedTimes.around`. With a period
    this is done for each of many short intervals of s, with a polygon around all gains that are
    used at these times (`fuzzytrack.gains.resampled_region`).

    First the best quadratic norm is sought (`fuzzytrack.gains.lyapunov`). If it does not decrease,
    a beam search looks for a product of matrices with a spectral radius above 1, which is an
    explicit proof of the contrary. If there is none either, a polygon is sought that all matrices
    reduce (`fuzzytrack.gains.polygon_norm`), which exists wherever all products of them go to zero.

    Examples
    --------
    >>> certify([[0.5377, 0.2018], [0.7, 0.28]]).verdict
    'certified'
    >>> certify([[0.5377, 0.2018]], times=ElapsedTimes(1, 10)).verdict
    'refuted'
    >>> certify([[0.5377, 0.2018]], times=ElapsedTimes(1, 10), period=4).verdict
    'certified'
    """
    points = np.asarray(gains, dtype=np.float64)
    if points.ndim != 2 or points.shape[-1] != 2 or not len(points):
        raise ValueError(f"gains must be pairs (alpha, beta), shape (n, 2); got {points.shape}")
    if not np.isfinite(points).all():
        raise ValueError("gains must be finite numbers")
    if max_length < 1:
        raise ValueError(f"max_length must be at least 1, got {max_length}")
    if period is not None and reached is None:
        poles_in_time(*points.T)
    times = times or ElapsedTimes(period or 1.0, period or 1.0)
    vertices = convex_hull(points)
    matrices = _covering(vertices, times, period)
    rate, lyapunov = common_lyapunov(matrices)
    found = partial(Certificate, lyapunov=lyapunov, vertices=vertices, times=times, period=period)
    if rate < 1 - _MARGIN:
        return found("certified", rate)
    known = vertices if reached is None else convex_hull(np.asarray(reached, dtype=np.float64))
    gains_tried, times_tried = _tried(known[_spread(known)], times, period)
    tried = error_matrix(gains_tried[:, 0], gains_tried[:, 1], times_tried / times.low)
    order, growth = growing_sequence(tried, lyapunov, max_length)
    if growth > 1 + _MARGIN:
        sequence, elapsed = gains_tried[order], times_tried[order]
        return found("refuted", rate, sequence=sequence, elapsed=elapsed, growth=growth)
    # The rate, if there is one below 1, is between the growth that was found and 1.
    for share in (0.5, 0.05):
        aim = 1 - share * (1 - growth)
        polygon_rate, polygon = reducing_polygon(matrices, ellipse(lyapunov), aim)
        if polygon_rate < 1 - _MARGIN:
            return found("certified", polygon_rate, polygon=polygon)
    return found("not decided", rate)


def _covering(vertices: Array, times: ElapsedTimes, period: float | None) -> Array:
    """Matrices whose convex hull contains those of all gains at all times, shape (n, 2, 2)."""
    parts = [(vertices, times.around())]
    if period is not None:
        parts = [
            (resampled_region(vertices, low / period, high / period), around_curve(low, high))
            for low, high in times.pieces().tolist()
        ]
    found = []
    for gains, curve in parts:
        (alpha, beta), (s, inverse) = gains.T[..., None], curve.T
        matrices = _error_matrix(alpha, beta, s / times.low, inverse * times.low)
        found.append(matrices.reshape(-1, 2, 2))
    return np.concatenate(found)


def _tried(known: Array, times: ElapsedTimes, period: float | None) -> tuple[Array, Array]:
    """Gains for counter-examples, as they are used, and the time since the last plot of each."""
    elapsed = times.tried()
    gains, elapsed = np.repeat(known, len(elapsed), axis=0), np.tile(elapsed, len(known))
    if period is None:
        return gains, elapsed
    # Those on the edge of stability cannot be converted.
    stable = is_stable(gains[:, 0], gains[:, 1])
    gains, elapsed = gains[stable], elapsed[stable]
    alpha, beta, _ = resampled_gains(gains[:, 0], gains[:, 1], period=period, dt=elapsed)
    return np.stack([alpha, beta], axis=1), elapsed


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
