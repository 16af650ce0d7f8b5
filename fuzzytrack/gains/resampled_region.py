"""Where the gains of a set lie after they were converted to other sampling times."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains.polygons import convex_hull, part_below

__all__ = ["resampled_region"]

_SLICES = 128
_PARTS = 12


def resampled_region(gains: Array, shortest: float, longest: float) -> Array:
    """Corners of a polygon around the gains of a set at any of a range of sampling times.

    Gains are converted as by `fuzzytrack.gains.period.resampled_gains`: poles z become z^τ, τ the
    sampling time over the period.

    Parameters
    ----------
    gains : ndarray, shape (n, 2)
        Corners of a convex polygon of (α, β), in order. Gains in it with a negative real pole or
        outside of the stability region are left out, since they cannot be converted.
    shortest, longest : float
        Least and largest τ.

    Returns
    -------
    ndarray, shape (m, 2)

    Notes
    -----
    The sum p = 2 - α - β and the product q = 1 - α of the poles have intervals in each piece of the
    polygon. Poles, their powers, and then α = 1 - q^τ and β = (1 - z₁^τ)(1 - z₂^τ) are monotone in
    these, or have their extrema where a cosine has, so the bounds of each piece are exact: the
    polygon contains all gains, not only a sample.
    """
    if shortest == longest == 1:
        return gains
    q, p = _pieces(np.stack([1 - gains[:, 0], 2 - gains.sum(axis=1)], axis=1))
    alphas = -np.expm1(np.log(np.maximum(q, 1e-300)) * np.array([longest, shortest]))[:, ::-1]
    real = _beta_of_real_poles(q, p, shortest, longest)
    spiral = _beta_of_complex_poles(q, p, shortest, longest)
    corners = [
        np.stack([alphas[:, i], betas[:, j]], axis=1)
        for betas in (real, spiral)
        for i in (0, 1)
        for j in (0, 1)
    ]
    points = np.concatenate(corners)
    return convex_hull(points[np.isfinite(points).all(axis=1)])


def _pieces(polygon: Array) -> tuple[Array, Array]:
    """Intervals of q and of p that together cover the polygon, shape (n, 2) each."""
    knots = np.linspace(polygon[:, 0].min(), polygon[:, 0].max(), _SLICES + 1)
    # Short pieces at both ends: what they reach beyond their part reaches beyond the whole.
    shares = 0.5 - 0.5 * np.cos(np.pi * np.arange(_PARTS + 1) / _PARTS)
    q, p = [], []
    for low, high in pairwise(knots):
        part = part_below(polygon, np.array([-1.0, 0.0, low]))
        part = part_below(part, np.array([1.0, 0.0, -high])) if len(part) else part
        if len(part):
            ends = part[:, 1].min() + shares * np.ptp(part[:, 1])
            q += [(low, high)] * _PARTS
            p += [*pairwise(ends)]
    return np.clip(np.array(q), 0.0, 1.0), np.array(p)


def _beta_of_real_poles(q: Array, p: Array, shortest: float, longest: float) -> Array:
    """Interval of β for the pairs of positive real poles in each piece; NaN where there are none.

    The larger pole grows with p and falls with q; the smaller one the other way round.
    """
    (q_low, q_high), (p_low, p_high) = q.T, p.T
    root = np.sqrt(np.maximum(p_high**2 - 4 * q_low, 0.0))
    slowest, fastest = 0.5 * (p_high + root), 0.5 * (p_high - root)
    apart = p_low**2 - 4 * q_high >= 0
    root = np.sqrt(np.where(apart, p_low**2 - 4 * q_high, 0.0))
    slow = np.where(apart, 0.5 * (p_low + root), np.sqrt(q_low))
    fast = np.where(apart, 0.5 * (p_low - root), np.sqrt(q_high))
    low = _left(np.minimum(slowest, 1.0), shortest) * _left(fast, shortest)
    high = _left(slow, longest) * _left(fastest, longest)
    none = (p_high**2 < 4 * q_low) | (p_high < 0)
    return np.where(none[:, None], np.nan, np.stack([low, high], axis=1))


def _left(pole: Array, power: float) -> Array:
    """1 - z^τ of real poles."""
    return np.asarray(-np.expm1(power * np.log(np.clip(pole, 1e-300, 1.0))))


def _beta_of_complex_poles(q: Array, p: Array, shortest: float, longest: float) -> Array:
    """Interval of β = (1 - r)² + 2r(1 - cos φτ) for complex poles of modulus r^(1/τ), angle φ."""
    (q_low, q_high), (p_low, p_high) = q.T, p.T
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine_high = np.fmax(p_high / (2 * np.sqrt(q_low)), p_high / (2 * np.sqrt(q_high)))
        cosine_low = np.fmin(p_low / (2 * np.sqrt(q_high)), p_low / (2 * np.sqrt(q_low)))
        first = shortest * np.arccos(np.clip(cosine_high, -1.0, 1.0))
        last = longest * np.arccos(np.clip(cosine_low, -1.0, 1.0))
    r_low, r_high = q_low ** (longest / 2), q_high ** (shortest / 2)
    none = ~(cosine_low <= 1.0) | (q_high <= 0)
    versine = _versine(first, last)
    low = (1 - r_high) ** 2 + 2 * r_low * versine[0]
    high = (1 - r_low) ** 2 + 2 * r_high * versine[1]
    return np.where(none[:, None], np.nan, np.stack([low, high], axis=1))


def _versine(first: Array, last: Array) -> tuple[Array, Array]:
    """Least and largest 1 - cos x for x in [first, last]."""
    ends = 2 * np.sin(first / 2) ** 2, 2 * np.sin(last / 2) ** 2
    with np.errstate(invalid="ignore"):
        whole = np.floor(last / (2 * np.pi)) > np.floor(first / (2 * np.pi))
        half = np.floor(last / (2 * np.pi) + 0.5) > np.floor(first / (2 * np.pi) + 0.5)
    return np.where(whole, 0.0, np.minimum(*ends)), np.where(half, 2.0, np.maximum(*ends))
