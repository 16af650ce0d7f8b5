"""Gains by design: steady Kalman filters, least squares, fading memory and critical damping.

Gains are dimensionless, γ in the convention of acceleration gain γ/(2T²). `order` is the number of
states: 2 for α-β, 3 for α-β-γ.
"""

from __future__ import annotations

from typing import Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite, nonnegative, positive, within
from fuzzytrack.gains.stability import critical_curves

__all__ = [
    "benedict_bordner",
    "critically_damped",
    "fading_memory",
    "growing_memory",
    "kalata",
    "quality",
    "tracking_index",
]

Pair = tuple[Array, Array]
Triple = tuple[Array, Array, Array]


def tracking_index(sigma_v: ArrayLike, sigma_w: ArrayLike, dt: ArrayLike) -> Array:
    """Kalata's tracking index λ = σ_v T²/σ_w: displacement by a maneuver over noise.

    Parameters
    ----------
    sigma_v : array_like
        Standard deviation of the target's acceleration (for `kalata` of order 3: of its change from
        one sample to the next), m/s², >= 0.
    sigma_w : array_like
        Standard deviation of a measured position, m, > 0.
    dt : array_like
        Sampling time T, s, > 0.

    Returns
    -------
    ndarray
        Dimensionless, >= 0, of the broadcast shape (a number for numbers).

    Raises
    ------
    ValueError
        If an argument is out of its range, infinite or NaN.

    Notes
    -----
    Kalata (1984); Kim & Lee, Eq. 6.

    Examples
    --------
    >>> float(tracking_index(0.5, 50.0, 10.0))
    1.0
    """
    process, sensor = nonnegative("sigma_v", sigma_v), positive("sigma_w", sigma_w)
    return np.asarray(process * positive("dt", dt) ** 2 / sensor)[()]


@overload
def kalata(tracking_index: ArrayLike, order: Literal[2] = 2) -> Pair: ...
@overload
def kalata(tracking_index: ArrayLike, order: Literal[3]) -> Triple: ...
def kalata(tracking_index: ArrayLike, order: int = 2) -> Pair | Triple:
    """Gains of the steady Kalman filter for a target of random acceleration.

    Parameters
    ----------
    tracking_index : array_like
        λ = σ_v T²/σ_w, dimensionless, >= 0; see `tracking_index`. 0 gives gains of 0: a filter that
        ignores the plots, on the edge of stability.
    order : {2, 3}
        2: nearly constant velocity, a new acceleration in each interval. 3: nearly constant
        acceleration, a new step of it in each interval.

    Returns
    -------
    alpha, beta : ndarray
        For order 2, of the shape of `tracking_index` (numbers for a number).
    alpha, beta, gamma : ndarray
        For order 3.

    Raises
    ------
    ValueError
        If λ is negative, infinite or NaN, or `order` is neither 2 nor 3.

    Notes
    -----
    Order 2: λ² = β²/(1 - α) and β = 2(2 - α) - 4√(1 - α), Kim & Lee, Eqs. 7 and 8; in the w-domain
    ω₀ = √λ/2 and ζ² = 1/2 + ω₀²/4. Order 3: the same β, γ = β²/α and λ² = γ²/(4(1 - α)). Both in
    q = 1 - √(1 - α): α = q(2 - q), β = 2q², γ = 4q³/(2 - q), which keeps the digits of small gains.

    Examples
    --------
    >>> print("{:.4f} {:.4f}".format(*kalata(0.1)))
    0.3600 0.0800
    >>> print("{:.4f} {:.4f} {:.4f}".format(*kalata(0.1, order=3)))
    0.6048 0.2758 0.1257
    """
    index = nonnegative("tracking_index", tracking_index)
    if _order(order) == 2:
        root = np.sqrt(index)
        return _kalata_pair(np.asarray(2 * root / (root + np.sqrt(index + 8))))
    q = _kalata_q(index)
    return *_kalata_pair(q), (4 * q**3 / (2 - q))[()]


def _kalata_pair(q: Array) -> Pair:
    return (q * (2 - q))[()], (2 * q**2)[()]


def _kalata_q(index: Array) -> Array:
    """The q in [0, 1) of λ = 2q³/((2 - q)(1 - q)).

    In t = log(q/(1 - q)) the logarithm of the right side is concave, with slopes from 3 down to 1,
    so Newton's method runs up to the root from below without passing it, for any λ.
    """
    zero = index == 0
    log_index = np.log(np.where(zero, 1.0, index))
    t = np.maximum(log_index / 3, log_index - np.log(2))
    for _ in range(_NEWTON_STEPS):
        decay = np.exp(-t)
        q = 1 / (1 + decay)
        p = q * decay  # 1 - q, without cancellation
        value = 3 * np.log(q) - np.log(p) - np.log1p(p) + np.log(2)
        t = t - (value - log_index) / (3 * p + q + q * p / (1 + p))
    return np.asarray(np.where(zero, 0.0, 1 / (1 + np.exp(-t))))


_NEWTON_STEPS = 8
"""The start has an error below 1 in t, and each step squares it: 5 steps would be enough."""


def benedict_bordner(alpha: ArrayLike) -> Array:
    """β = α²/(2 - α): the least transient error for a given noise ratio, at constant velocity.

    Parameters
    ----------
    alpha : array_like
        Position gain, 0 < α < 4 - 2√2 = 1.1716 (from there on the pair is unstable).

    Returns
    -------
    ndarray
        β, of the shape of `alpha` (a number for a number).

    Raises
    ------
    ValueError
        If α is out of range or NaN.

    Notes
    -----
    Benedict & Bordner (1962); Llinas et al. (1998), Eq. 2.98. In the w-domain ζ² = (1 + ω₀²)/2.

    Examples
    --------
    >>> print(f"{benedict_bordner(0.5377):.6f}")
    0.197717
    """
    a = np.asarray(alpha, dtype=np.float64)
    within("alpha", a, (a > 0) & (a < 4 - np.sqrt(8)), "> 0 and < 4 - 2 sqrt(2) = 1.17157")
    return (a**2 / (2 - a))[()]


def critically_damped(alpha: ArrayLike, branch: Literal["lower", "upper"] = "lower") -> Array:
    """β for which the two poles of an α-β filter coincide.

    Parameters
    ----------
    alpha : array_like
        Position gain, 0 < α <= 1.
    branch : {"lower", "upper"}
        ``"lower"``: double pole √(1 - α), a filter of fading memory. ``"upper"``: double pole
        -√(1 - α), which rings at the Nyquist rate.

    Returns
    -------
    ndarray
        β = 2 - α ∓ 2√(1 - α), of the shape of `alpha` (a number for a number).

    Raises
    ------
    ValueError
        If α is out of range or NaN, or `branch` is unknown.

    See Also
    --------
    fading_memory : The lower branch by its pole, and the α-β-γ filter of triple pole.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.25 to 2.27.

    Examples
    --------
    >>> float(critically_damped(0.75)), float(critically_damped(0.75, "upper"))
    (0.25, 2.25)
    """
    if branch not in ("lower", "upper"):
        raise ValueError(f"branch must be 'lower' or 'upper', got {branch!r}")
    a = np.asarray(alpha, dtype=np.float64)
    within("alpha", a, (a > 0) & (a <= 1), "> 0 and <= 1")
    lower, upper = critical_curves(a)
    return np.asarray(lower if branch == "lower" else upper)[()]


@overload
def fading_memory(xi: ArrayLike, order: Literal[2] = 2) -> Pair: ...
@overload
def fading_memory(xi: ArrayLike, order: Literal[3]) -> Triple: ...
def fading_memory(xi: ArrayLike, order: int = 2) -> Pair | Triple:
    """Gains of the critically damped filter whose poles all lie at ξ.

    It fits a line (order 2) or a parabola (order 3) to all past plots by least squares, with the
    weights 1, ξ, ξ², ... from the newest back.

    Parameters
    ----------
    xi : array_like
        The pole, 0 <= ξ < 1: 0 follows the last plots exactly, toward 1 it smooths more.
    order : {2, 3}
        Number of poles.

    Returns
    -------
    alpha, beta : ndarray
        For order 2, of the shape of `xi` (numbers for a number): α = 1 - ξ², β = (1 - ξ)².
    alpha, beta, gamma : ndarray
        For order 3: α = 1 - ξ³, β = 3(1 - ξ)²(1 + ξ)/2, γ = 2(1 - ξ)³.

    Raises
    ------
    ValueError
        If ξ is out of range or NaN, or `order` is neither 2 nor 3.

    See Also
    --------
    critically_damped : Order 2, from α.

    Notes
    -----
    Known also as the discounted least-squares or exponential filter. Other authors state γ as
    (1 - ξ)³ or half of it, for their conventions of γ: see `convert_gamma`.

    Examples
    --------
    >>> print("{:.3f} {:.3f} {:.3f}".format(*fading_memory(0.5, order=3)))
    0.875 0.562 0.250
    """
    x = np.asarray(xi, dtype=np.float64)
    within("xi", x, (x >= 0) & (x < 1), ">= 0 and < 1")
    rest = 1 - x
    if _order(order) == 2:
        return (rest * (1 + x))[()], (rest**2)[()]
    return (
        (rest * (1 + x + x**2))[()],
        (1.5 * rest**2 * (1 + x))[()],
        (2 * rest**3)[()],
    )


@overload
def growing_memory(n: ArrayLike, order: Literal[2] = 2) -> Pair: ...
@overload
def growing_memory(n: ArrayLike, order: Literal[3]) -> Triple: ...
def growing_memory(n: ArrayLike, order: int = 2) -> Pair | Triple:
    """Gains at plot n of the filter that fits all n plots so far by least squares.

    Parameters
    ----------
    n : array_like
        Number of plots, the current one included, >= `order`: fewer do not determine a line (order
        2) or a parabola (order 3). Fractions stand for memories between two lengths.
    order : {2, 3}
        2 fits a line, 3 a parabola.

    Returns
    -------
    alpha, beta : ndarray
        For order 2, of the shape of `n` (numbers for a number): α = 2(2n - 1)/d, β = 6/d with
        d = n(n + 1).
    alpha, beta, gamma : ndarray
        For order 3: α = 3(3n² - 3n + 2)/d, β = 18(2n - 1)/d, γ = 120/d with d = n(n + 1)(n + 2).

    Raises
    ------
    ValueError
        If n is less than `order`, infinite or NaN, or `order` is neither 2 nor 3.

    Notes
    -----
    Al-Wagih & Abdulla, Eqs. 23 to 25. At n = `order` the fit is exact and the filter follows the
    last plots. At n = 1 the formulas of order 2 would give the unstable pair (1, 3): a scheduler
    that uses them from the first plot on must keep n at 2 or more (these authors: 3).

    Examples
    --------
    >>> print("{:.3f} {:.3f}".format(*growing_memory(5)))
    0.600 0.200
    """
    least = _order(order)
    count = finite("n", n)
    within("n", count, count >= least, f">= {least}, the order")
    if order == 2:
        d = count * (count + 1)
        return (2 * (2 * count - 1) / d)[()], (6 / d)[()]
    d = count * (count + 1) * (count + 2)
    return (
        (3 * (3 * count**2 - 3 * count + 2) / d)[()],
        (18 * (2 * count - 1) / d)[()],
        (120 / d)[()],
    )


def quality(n: ArrayLike) -> Pair:
    """Gains from the quality of a track: the lower it is, the larger the gains.

    Parameters
    ----------
    n : array_like
        Track quality, >= 1: how many plots have confirmed the track, up to the highest quality the
        tracker keeps.

    Returns
    -------
    alpha, beta : ndarray
        Of the shape of `n` (numbers for a number): α is that of `growing_memory` at n + 2 plots, β
        the one `kalata` has with that α.

    Raises
    ------
    ValueError
        If n is less than 1, infinite or NaN.

    Notes
    -----
    Zhang & Jiang; 1 - α = n(n + 1)/((n + 2)(n + 3)) and β = 2(1 - √(1 - α))².

    Examples
    --------
    >>> print("{:.4f} {:.4f}".format(*quality(10)))
    0.2949 0.0514
    """
    count = finite("n", n)
    within("n", count, count >= 1, ">= 1")
    alpha = np.asarray(growing_memory(count + 2)[0])
    rest = np.sqrt(count * (count + 1) / ((count + 2) * (count + 3)))
    return alpha[()], np.asarray(2 * (alpha / (1 + rest)) ** 2)[()]


def _order(order: int) -> int:
    if order not in (2, 3):
        raise ValueError(f"order must be 2 or 3, got {order!r}")
    return order
