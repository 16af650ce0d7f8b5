"""Where α-β(-γ) filters are stable, where their poles lie, and how they respond to a step.

Gains are dimensionless, γ in the convention of acceleration gain γ/(2T²), poles in the z plane.
Source: Llinas et al. (1998), section 2.2. The arithmetic works with δ = 1 - z, the distance of a
pole from 1: for small gains all poles are close to 1, and only their distances from it are precise.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.gains.checks import finite, inside

__all__ = ["Region", "eigenfrequency", "in_closed_region", "is_stable", "jury", "poles", "region"]


class Region(StrEnum):
    """How the two poles of an α-β filter lie (Llinas et al. 1998, Fig. 2.2)."""

    UNDERDAMPED = "underdamped"
    """Complex poles, real part >= 0 (region Ia): β <= 2 - α."""
    UNDERDAMPED_NEGATIVE = "underdamped, negative real part"
    """Complex poles, real part < 0 (region Ib): oscillates faster than a quarter of the rate."""
    OVERDAMPED = "overdamped"
    """Real poles >= 0 (region IIa), the critically damped curve included."""
    NYQUIST = "oscillating at the Nyquist rate"
    """Real poles <= 0, one at least below 0 (region IIb), its critical curve included."""
    MIXED = "mixed"
    """α > 1: one positive real pole, one negative."""
    UNSTABLE = "unstable"
    """On or outside the edge of the stability triangle."""


def jury(coefficients: ArrayLike) -> Mask:
    """Jury's test: whether all roots of polynomials lie inside the unit circle.

    Parameters
    ----------
    coefficients : array_like
        Real coefficients a₀, a₁, ..., aₙ of a₀zⁿ + a₁zⁿ⁻¹ + ... + aₙ along the last axis, highest
        power first, n >= 1; a₀ of either sign but not 0. Other axes are batch.

    Returns
    -------
    ndarray of bool
        One result per polynomial, shape ``coefficients.shape[:-1]`` (a bool for one polynomial).
        Stability is strict: with a root on the unit circle the result is false. For roots within
        rounding of the circle it depends on the rounding of the table.

    Raises
    ------
    ValueError
        If coefficients are not finite, fewer than two, or begin with 0.

    Notes
    -----
    Llinas et al. (1998), Table 2.1 and Eqs. 2.9 to 2.15. A polynomial of negative a₀ is tested with
    its sign changed. Each row of the table is divided by its largest element, which changes no
    comparison and keeps high orders from overflowing.

    Examples
    --------
    >>> bool(jury([1, -0.8, 0.5])), bool(jury([1, -2, 1]))
    (True, False)
    """
    polynomial = finite("coefficients", coefficients)
    if polynomial.ndim == 0 or polynomial.shape[-1] < 2:
        raise ValueError(
            "coefficients must hold at least 2 values along the last axis (order >= 1), got shape "
            f"{polynomial.shape}"
        )
    if (polynomial[..., 0] == 0).any():
        raise ValueError("coefficients must begin with a value other than 0, the highest power's")
    row = _scaled(polynomial * np.sign(polynomial[..., :1]))
    signs = (-1.0) ** np.arange(row.shape[-1])  # (-1)^n P(-1): both cases of Eq. 2.14
    stable: Mask = np.abs(row[..., -1]) < row[..., 0]
    stable &= row.sum(axis=-1) > 0
    stable &= (row * signs).sum(axis=-1) > 0
    while row.shape[-1] > 3:
        # r_k = | r_m  r_{m-1-k} ; r_0  r_{k+1} |, k = 0 ... m-1
        row = _scaled(row[..., -1:] * row[..., 1:] - row[..., :1] * row[..., -2::-1])
        stable &= np.abs(row[..., -1]) > np.abs(row[..., 0])
    return stable[()]


def is_stable(alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike = 0.0) -> Mask:
    """Whether an α-β or α-β-γ filter is stable: all its poles inside the unit circle.

    Parameters
    ----------
    alpha, beta : array_like
        Position and velocity gains, finite.
    gamma : array_like, default 0
        Acceleration gain, finite; they all broadcast. γ = 0 is the α-β filter (of two poles, not an
        α-β-γ filter with a pole at 1); γ < 0 is never stable.

    Returns
    -------
    ndarray of bool
        Of the broadcast shape (a bool for numbers). Strict: gains on the edge are not stable.

    Raises
    ------
    ValueError
        If a gain is not finite.

    Notes
    -----
    0 < α < 2, β > 0, 2α + β < 4 and, for γ > 0, γ < 4αβ/(2 - α): Llinas et al. (1998), Eqs. 2.18,
    2.21, 2.24 and 2.52.

    Examples
    --------
    >>> [bool(answer) for answer in is_stable(0.5, 0.7, [0, 0.9, 0.95])]
    [True, True, False]
    """
    gains = np.broadcast_arrays(
        finite("alpha", alpha), finite("beta", beta), finite("gamma", gamma)
    )
    return inside(*gains)[()]


def in_closed_region(
    alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike = 0.0, retention: ArrayLike = 1.0
) -> Mask:
    """Whether no pole of an α-β or α-β-γ filter lies outside of the unit circle.

    Parameters
    ----------
    alpha, beta, gamma : array_like
        Gains, finite; γ = 0 is the α-β filter.
    retention : array_like, default 1
        φ, the share of its acceleration that a filter keeps from plot to plot, finite; they all
        broadcast.

    Returns
    -------
    ndarray of bool
        Of the broadcast shape (a bool for numbers). The stability region with its edge, and within
        rounding (1e-12) of it: gains of 0, with which a plot is ignored, belong to it.

    Raises
    ------
    ValueError
        If a gain is not finite.

    Notes
    -----
    Jury's conditions with equality for z² - (2 - α - β)z + 1 - α, and with γ for
    z³ - (2 - α - β + φ(1 - γ/4))z² + ((1 - α)(1 + φ) + φ(1 - β + γ/4))z - φ(1 - α), the
    characteristic polynomial of φ's filter. With φ = 1 they are 0 <= α <= 2, β >= 0, 2α + β <= 4
    and 0 <= γ <= 4αβ/(2 - α).

    Examples
    --------
    >>> [bool(answer) for answer in in_closed_region(0.5, [0, 0.7, 3.1], [0, 0.9, 0])]
    [True, True, False]
    """
    a, b, c, phi = np.broadcast_arrays(
        finite("alpha", alpha), finite("beta", beta), finite("gamma", gamma),
        finite("retention", retention),
    )  # fmt: skip
    with np.errstate(over="ignore", invalid="ignore"):
        first = 2 - a - b + phi * (1 - c / 4)
        second = (1 - a) * (1 + phi) + phi * (1 - b + c / 4)
        third = phi * (1 - a)
        triangle = (np.minimum(a, 2 - a), b, 4 - 2 * a - b)
        cubic = (
            1 - first + second - third,
            1 + first + second + third,
            1 - np.abs(third),
            1 - third * third - np.abs(second - first * third),
        )
    pair, triple = (np.all([x >= -1e-12 for x in part], axis=0) for part in (triangle, cubic))
    good: Mask = np.where(c == 0, pair, triple)
    return good[()]


def poles(alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike = 0.0) -> NDArray[np.complex128]:
    """Poles of an α-β or α-β-γ filter in the z plane.

    Parameters
    ----------
    alpha, beta : array_like
        Position and velocity gains, finite, stable or not.
    gamma : array_like, default 0
        Acceleration gain, finite; they all broadcast.

    Returns
    -------
    ndarray of complex
        Shape ``(..., 2)`` where γ is 0 everywhere, else ``(..., 3)``. First the pair (positive
        imaginary part first, or the larger of two real poles), then the largest real pole, which is
        1 (exactly) where γ is 0.

    Raises
    ------
    ValueError
        If a gain is not finite.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.26 and 2.53.

    Examples
    --------
    >>> poles(0.5, 0.7).round(6)
    array([0.4+0.583095j, 0.4-0.583095j])
    """
    a, b, delta = factored(alpha, beta, gamma)
    low, high, width = pair_distances(a, b)
    pair = [1 - low + 0.5j * width, 1 - high - 0.5j * width]
    if np.any(np.asarray(gamma) != 0):
        pair.append(1 - delta + 0j)
    return np.stack(pair, axis=-1)


def region(alpha: ArrayLike, beta: ArrayLike) -> NDArray[np.str_]:
    """Name of the region of the α-β plane: how the filter responds to a step.

    Parameters
    ----------
    alpha, beta : array_like
        Position and velocity gains, finite; they broadcast.

    Returns
    -------
    ndarray of str
        Values of `Region`, of the broadcast shape (a string for numbers). They compare equal to its
        members. α = β = 1, both poles at 0, counts as overdamped.

    Raises
    ------
    ValueError
        If a gain is not finite.

    Notes
    -----
    Llinas et al. (1998), Fig. 2.2 and Eqs. 2.27 to 2.34: Ia and Ib between the two critically
    damped curves, divided by β = 2 - α; IIa below both; IIb above both; α > 1. An α-β-γ filter has
    the region of the a and b of its `to_abc`.

    Examples
    --------
    >>> print(region(0.5, 0.7), region(0.5, 0.05), region(1.2, 0.5), sep=" | ")
    underdamped | overdamped | mixed
    """
    a, b = np.broadcast_arrays(finite("alpha", alpha), finite("beta", beta))
    lower, upper = critical_curves(np.minimum(a, 1))
    complex_ = (lower < b) & (b < upper)
    slow = a + b <= 2  # the sum of the poles, 2 - α - β, is not negative
    names = np.select(
        [~inside(a, b, np.zeros_like(a)), a > 1, complex_ & slow, complex_, slow],
        [
            Region.UNSTABLE.value,
            Region.MIXED.value,
            Region.UNDERDAMPED.value,
            Region.UNDERDAMPED_NEGATIVE.value,
            Region.OVERDAMPED.value,
        ],
        Region.NYQUIST.value,
    )
    return names[()]


def eigenfrequency(alpha: ArrayLike, beta: ArrayLike) -> Array:
    """Frequency at which an α-β filter rings.

    Parameters
    ----------
    alpha, beta : array_like
        Position and velocity gains, finite; they broadcast.

    Returns
    -------
    ndarray
        Radians per sample, 0 to π, of the broadcast shape; divided by T it is in rad/s. The angle
        of the complex pair; for two real poles that of the larger in size: 0 where it is positive,
        π (the Nyquist rate) where it is negative.

    Raises
    ------
    ValueError
        If a gain is not finite.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.28 to 2.30, with the arctangent of two arguments: the printed one
    of a quotient is wrong by π where β > 2 - α.

    Examples
    --------
    >>> print(f"{eigenfrequency(0.5, 0.7):.6f} {eigenfrequency(0.5, 2.2):.6f}")
    0.969532 2.088602
    """
    a, b = np.broadcast_arrays(finite("alpha", alpha), finite("beta", beta))
    width = np.sqrt(np.maximum(-discriminant(a, b), 0))
    angle: Array = np.arctan2(width, 2 - a - b)
    return angle[()]


# ---------------------------------------------------------------- arithmetic, without checks


def has_negative_pole(alpha: Array, beta: Array) -> Mask:
    """Whether a real pole of an α-β filter is negative; it has no continuous-time counterpart."""
    negative: Mask = (alpha > 1) | ((discriminant(alpha, beta) >= 0) & (alpha + beta > 2))
    return negative


def critical_curves(alpha: Array) -> tuple[Array, Array]:
    """β of the two critically damped curves, (1 ∓ √(1 - α))², for α <= 1 (Eq. 2.27)."""
    s = np.sqrt(1 - alpha)
    # 1 - s = α/(1 + s) keeps its digits for small α.
    return (alpha / (1 + s)) ** 2, (1 + s) ** 2


def discriminant(a: Array, b: Array) -> Array:
    """(a + b)² - 4b: negative where the poles are complex, 0 on the critical curves exactly."""
    lower, upper = critical_curves(np.minimum(a, 1))
    value: Array = np.where(
        a <= 1, (b - lower) * (b - upper), (2 - a - b) ** 2 + 4 * (np.maximum(a, 1) - 1)
    )
    return value


def pair_distances(a: Array, b: Array) -> tuple[Array, Array, Array]:
    """Real parts δ_low <= δ_high of 1 - z of the two poles, and twice their imaginary part."""
    total, square = a + b, discriminant(a, b)
    root = np.sqrt(np.abs(square))
    large = (total + np.copysign(root, total)) / 2
    small = np.divide(b, large, out=np.zeros_like(large), where=large != 0)
    real = square >= 0
    return (
        np.where(real, np.minimum(small, large), total / 2),
        np.where(real, np.maximum(small, large), total / 2),
        np.where(real, 0, root),
    )


def factored(alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike) -> tuple[Array, Array, Array]:
    """Gains a, b of the pair of poles and the distance δ of the largest real pole, 1 - δ.

    The characteristic polynomial of gains, in δ, is δ³ - s₂δ² + s₁δ - s₀ = (δ - δ₁)(δ² - (a + b)δ +
    b) with s₂ = α + β + γ/4, s₁ = β + 3γ/4 and s₀ = γ/2; δ₁ is its smallest real root.
    """
    al, be, ga = np.broadcast_arrays(
        finite("alpha", alpha), finite("beta", beta), finite("gamma", gamma)
    )
    s2, s1, s0 = al + be + ga / 4, be + 3 * ga / 4, ga / 2
    delta = np.where(ga == 0, 0.0, _smallest_real_root(s2, s1, s0))
    # b = s₀/δ₁ holds every digit of γ, however far apart the poles; without δ₁, a = α and b = β.
    b = np.divide(s0, delta, out=np.array(be), where=delta != 0)
    a = np.where(delta == 0, al, s2 - delta - b)
    return a, b, delta


def _smallest_real_root(s2: Array, s1: Array, s0: Array) -> Array:
    """Smallest real root of p(x) = x³ - s₂x² + s₁x - s₀, accurate to the residual's rounding.

    Left of its inflection p is concave and right of it convex, so Newton's method from beyond the
    outermost root runs toward it without ever passing it: it has converged when it turns back.
    """
    middle = s2 / 3
    slope = s1 - s2 * middle  # p is y³ + slope·y + p(middle) in y = x - middle
    hump = np.sqrt(np.maximum(-slope, 0) / 3)
    # Left of its hump p rises from -∞, so there is a root iff the hump's top is not negative;
    # otherwise the only real root lies right of the valley.
    rising = _cubic(middle - hump, s2, s1, s0)[0] >= 0
    turn = np.where(rising, middle - hump, middle + hump)
    offset = _cubic(middle, s2, s1, s0)[0]
    reach = np.maximum(np.cbrt(2 * np.abs(offset)), np.sqrt(2 * np.maximum(-slope, 0)))
    x = np.where(rising, middle - reach, middle + reach)
    # For stable gains p(0) = -γ/2 < 0 with 0 on the rising part: a sharper start for tiny roots.
    x = np.where(rising & (turn >= 0) & (s0 >= 0), np.maximum(x, 0), x)
    for _ in range(_MOST_STEPS):
        value, derivative = _cubic(x, s2, s1, s0)
        good = derivative > 0
        new = x - np.divide(value, derivative, out=np.zeros_like(x), where=good)
        # Beside a multiple root value and derivative are noise, and so is a step beyond the turn.
        new = np.where(rising, np.minimum(new, turn), np.maximum(new, turn))
        moving = np.where(rising, new > x, new < x)
        if not moving.any():
            break
        x = np.where(moving, new, x)
    return np.asarray(x)


# Each step thins the distance to a triple root by a third, to a double one by a half, and squares
# it otherwise; rounding ends all that within about 30. The bound is there to be sure.
_MOST_STEPS = 200


def _cubic(x: Array, s2: Array, s1: Array, s0: Array) -> tuple[Array, Array]:
    """p(x) = x³ - s₂x² + s₁x - s₀ and its derivative."""
    return ((x - s2) * x + s1) * x - s0, (3 * x - 2 * s2) * x + s1


def _scaled(row: Array) -> Array:
    largest = np.abs(row).max(axis=-1, keepdims=True)
    scaled: Array = row / np.where(largest > 0, largest, 1)
    return scaled
