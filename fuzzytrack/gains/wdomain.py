"""The w-domain: gains as natural frequency (stiffness) and damping of a second-order system.

z = (1 + w)/(1 - w) maps the unit disc onto the left half plane, so any positive frequency and
damping give a stable filter (Llinas et al. 1998, Eqs. 3.22 to 3.26). With a sampling time T,
s = 2w/T stands for the Laplace variable, and frequencies are in rad/s.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.gains.abc_space import gains_from_distance
from fuzzytrack.gains.checks import nonnegative, positive, stable_gains, within
from fuzzytrack.gains.stability import critical_curves, factored, has_negative_pole, pair_distances

__all__ = [
    "alpha_beta_from_s",
    "alpha_beta_from_w",
    "alpha_beta_gamma_from_w",
    "bilinear",
    "kalata_damping",
    "s_from_alpha_beta",
    "w_from_alpha_beta",
    "w_from_alpha_beta_gamma",
]

Number = TypeVar("Number", float, NDArray[np.float64])


def bilinear(omega0: Number, zeta: Number) -> tuple[Number, Number]:
    """Eq. 3.26 without checks, for scalars and arrays alike: the arithmetic of a kernel."""
    damping = 2.0 * zeta * omega0
    square = omega0 * omega0
    denominator = 1.0 + damping + square
    return 2.0 * damping / denominator, 4.0 * square / denominator


def alpha_beta_from_w(
    omega0: ArrayLike, zeta: ArrayLike, dt: ArrayLike | None = None
) -> tuple[Array, Array]:
    """Gains from natural frequency and damping ratio in the w-domain.

    Parameters
    ----------
    omega0 : array_like
        Undamped natural frequency ("stiffness"), >= 0; dimensionless, or in rad/s with `dt`.
    zeta : array_like
        Damping ratio, dimensionless, >= 0; broadcasts with `omega0`.
    dt : array_like, optional
        Sampling time T, s, > 0. Without it `omega0` is ω₀T/2, as in the source.

    Returns
    -------
    alpha, beta : ndarray
        Position and velocity gains, of the broadcast shape (numbers for numbers). For positive
        arguments they lie inside the stability triangle, since 4 - 2α - β = 4/(1 + 2ζω₀ + ω₀²) > 0;
        where an argument is 0, on its edge (marginally stable).

    Raises
    ------
    ValueError
        If an argument is out of its range, infinite or NaN.

    See Also
    --------
    alpha_beta_from_s : The same without the warping of frequencies.

    Notes
    -----
    Llinas et al. (1998), Eq. 3.26, with ω₀T/2 for ω₀: it is printed for T = 2 s. Kalata's gains are
    the curve ω₀ = √λ/2, ζ² = 1/2 + ω₀²/4, those of Benedict and Bordner ζ² = (1 + ω₀²)/2, and the
    critically damped ζ = 1.

    Examples
    --------
    >>> alpha, beta = alpha_beta_from_w(0.27224, 0.72539)
    >>> print(f"{alpha:.4f} {beta:.4f}")
    0.5377 0.2018
    """
    frequency, damping = nonnegative("omega0", omega0), nonnegative("zeta", zeta)
    alpha, beta = map(np.asarray, bilinear(frequency * _half(dt), damping))
    return alpha[()], beta[()]


def kalata_damping(omega0: ArrayLike) -> Array:
    """Damping on the curve of the optimal gains, for an eigenfrequency of the w-domain.

    Parameters
    ----------
    omega0 : array_like
        Dimensionless eigenfrequency ω₀, >= 0.

    Returns
    -------
    ndarray
        ζ = √(1/2 + ω₀²/4): with it the gains are those of `fuzzytrack.gains.kalata` at the tracking
        index λ = 4ω₀².

    Raises
    ------
    ValueError
        If ω₀ is negative or not finite.

    Examples
    --------
    >>> from fuzzytrack.gains import kalata_damping
    >>> float(kalata_damping(1.0).round(4))
    0.866
    """
    stiffness = nonnegative("omega0", omega0)
    return np.asarray(np.sqrt(0.5 + 0.25 * stiffness * stiffness))[()]


def w_from_alpha_beta(
    alpha: ArrayLike, beta: ArrayLike, dt: ArrayLike | None = None
) -> tuple[Array, Array]:
    """Natural frequency and damping ratio in the w-domain from stable gains.

    Parameters
    ----------
    alpha, beta : array_like
        Gains inside the stability triangle: α > 0, β > 0, 2α + β < 4; they broadcast.
    dt : array_like, optional
        Sampling time T, s, > 0.

    Returns
    -------
    omega0, zeta : ndarray
        Positive, of the broadcast shape (numbers for numbers); the inverse of `alpha_beta_from_w`:
        `omega0` is dimensionless, or in rad/s with `dt`.

    Raises
    ------
    ValueError
        If a pair lies outside the open stability triangle, or `dt` is not positive.

    Notes
    -----
    ω₀ = √(β/u), ζ = α/√(βu) with u = 4 - 2α - β, the inverse of Llinas et al. (1998), Eq. 3.26.

    Examples
    --------
    >>> print("{:.4f} {:.4f}".format(*w_from_alpha_beta(0.5377, 0.2018)))
    0.2722 0.7254
    """
    half = _half(dt)
    a, b, _ = stable_gains(alpha, beta)
    omega0, zeta = _frequency_and_damping(a, b)
    return np.asarray(omega0 / half)[()], zeta[()]


def alpha_beta_gamma_from_w(
    omega0: ArrayLike, zeta: ArrayLike, omega3: ArrayLike, dt: ArrayLike | None = None
) -> tuple[Array, Array, Array]:
    """Gains of the α-β-γ filter with a pair of poles and a third pole given in the w-domain.

    Parameters
    ----------
    omega0 : array_like
        Undamped natural frequency of the pair, >= 0; dimensionless, or in rad/s with `dt`.
    zeta : array_like
        Damping ratio of the pair, dimensionless, >= 0.
    omega3 : array_like
        Corner frequency of the third pole, w = -ω₃, in the unit of `omega0`, >= 0: how fast the
        filter adapts to an acceleration. 0 gives the α-β filter of `alpha_beta_from_w`, γ = 0.
    dt : array_like, optional
        Sampling time T, s, > 0. All arguments broadcast.

    Returns
    -------
    alpha, beta, gamma : ndarray
        Of the broadcast shape (numbers for numbers). Stable where `omega0` and `zeta` are positive.

    Raises
    ------
    ValueError
        If an argument is out of its range, infinite or NaN.

    Notes
    -----
    `from_abc` of the α-β gains a, b and c = (ω₃ - 1)/(ω₃ + 1), with ω₃T/2 for ω₃ if `dt` is given.

    Examples
    --------
    >>> gains = alpha_beta_gamma_from_w(0.02, 0.7, 0.01, dt=30)
    >>> print("{:.6f} {:.6f} {:.6f}".format(*gains))
    0.672041 0.352433 0.124388
    """
    half = _half(dt)
    frequency, damping = nonnegative("omega0", omega0), nonnegative("zeta", zeta)
    third = nonnegative("omega3", omega3) * half
    a, b = bilinear(frequency * half, damping)
    alpha, beta, gamma = gains_from_distance(a, b, 2 * third / (1 + third))
    return alpha[()], beta[()], gamma[()]


def w_from_alpha_beta_gamma(
    alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike, dt: ArrayLike | None = None
) -> tuple[Array, Array, Array]:
    """Natural frequency, damping ratio and third pole in the w-domain from stable gains.

    Parameters
    ----------
    alpha, beta, gamma : array_like
        Stable gains: α > 0, β > 0, 2α + β < 4, 0 <= γ < 4αβ/(2 - α); they broadcast.
    dt : array_like, optional
        Sampling time T, s, > 0.

    Returns
    -------
    omega0, zeta, omega3 : ndarray
        Of the broadcast shape (numbers for numbers); `omega0` and `omega3` dimensionless, or in
        rad/s with `dt`. `alpha_beta_gamma_from_w` returns the gains. Where all three poles are
        real, the slowest (smallest ω₃) is the third.

    Raises
    ------
    ValueError
        If gains are not stable, or `dt` is not positive.

    Notes
    -----
    By `to_abc`; where the third pole is a multiple one, the frequencies are known less precisely
    than the gains they give back.

    Examples
    --------
    >>> print("{:.3f} {:.3f} {:.3f}".format(*w_from_alpha_beta_gamma(0.5, 0.4, 0.1)))
    0.363 0.416 0.073
    """
    half = _half(dt)
    a, b, delta = factored(*stable_gains(alpha, beta, gamma))
    omega0, zeta = _frequency_and_damping(a, b)
    third = delta / (2 - delta)
    return np.asarray(omega0 / half)[()], zeta[()], np.asarray(third / half)[()]


def alpha_beta_from_s(omega0: ArrayLike, zeta: ArrayLike, dt: ArrayLike) -> tuple[Array, Array]:
    """Gains whose poles are those of a continuous system, sampled: z = exp(sT).

    Where ω₀T is not small, `alpha_beta_from_w` distorts the frequency; here the filter oscillates
    at ω₀√(1 - ζ²) exactly. But only a part of the stable gains can be reached, those with α < 1.

    Parameters
    ----------
    omega0 : array_like
        Undamped natural frequency, rad/s, >= 0.
    zeta : array_like
        Damping ratio, dimensionless, >= 0.
    dt : array_like
        Sampling time T, s, > 0. All arguments broadcast.

    Returns
    -------
    alpha, beta : ndarray
        Of the broadcast shape (numbers for numbers), stable for positive arguments; 0 or on the
        edge of stability where `omega0` or `zeta` is 0.

    Raises
    ------
    ValueError
        If an argument is out of its range, infinite or NaN.

    Notes
    -----
    α = 1 - exp(-2ζω₀T) and β = 1 + exp(-2ζω₀T) - 2 exp(-ζω₀T) cos(ω₀T√(1 - ζ²)), a hyperbolic
    cosine for ζ > 1.

    Examples
    --------
    >>> print("{:.6f} {:.6f}".format(*alpha_beta_from_s(0.02, 0.7, dt=30)))
    0.568289 0.236416
    """
    angle = nonnegative("omega0", omega0) * positive("dt", dt)
    angle, damping = np.broadcast_arrays(angle, nonnegative("zeta", zeta))
    alpha = -np.expm1(-2 * damping * angle)
    # β = (1 - z₁)(1 - z₂), in forms without cancellation for complex and for real poles.
    ringing = angle * np.sqrt(np.maximum((1 - damping) * (1 + damping), 0))
    decay = damping * angle
    complex_ = np.expm1(-decay) ** 2 + 4 * np.exp(-decay) * np.sin(ringing / 2) ** 2
    fast = damping + np.sqrt(np.maximum((damping - 1) * (damping + 1), 0))
    real = np.expm1(-angle * fast) * np.expm1(-angle / np.maximum(fast, 1))
    beta = np.where(damping > 1, real, complex_)
    return alpha[()], beta[()]


def s_from_alpha_beta(alpha: ArrayLike, beta: ArrayLike, dt: ArrayLike) -> tuple[Array, Array]:
    """Continuous system whose poles, sampled with z = exp(sT), are those of the gains.

    Parameters
    ----------
    alpha, beta : array_like
        Stable gains, α < 1, without a negative real pole: β < (1 + √(1 - α))²; they broadcast.
    dt : array_like
        Sampling time T, s, > 0.

    Returns
    -------
    omega0, zeta : ndarray
        Undamped natural frequency, rad/s, and damping ratio, of the broadcast shape (numbers for
        numbers); the inverse of `alpha_beta_from_s`, of whose frequencies it is the lowest.

    Raises
    ------
    ValueError
        If a pair is not stable or has a pole that is 0 or negative: no continuous system has it.

    Notes
    -----
    With s = ln(z)/T: 2ζω₀T = -ln(1 - α) and, of complex poles, ω₀T√(1 - ζ²) is their angle.

    Examples
    --------
    >>> print("{:.6f} {:.6f}".format(*s_from_alpha_beta(0.568289, 0.236416, dt=30)))
    0.020000 0.700000
    """
    step = positive("dt", dt)
    a, b, _ = stable_gains(alpha, beta)
    within("alpha", a, a < 1, "< 1, so that no pole is 0 or negative")
    negative = has_negative_pole(a, b)
    within("beta", b, ~negative, "< (1 + sqrt(1 - alpha))^2, so that no real pole is negative")
    lower, upper = critical_curves(a)
    low, high, _ = pair_distances(a, b)
    angle = 2 * np.arctan2(np.sqrt(np.maximum(b - lower, 0)), np.sqrt(np.maximum(upper - b, 0)))
    decay = -np.log1p(-a) / 2
    real = b <= lower
    slow, fast = (-np.log1p(-np.where(real, distance, 0)) for distance in (low, high))
    frequency = np.where(real, np.sqrt(slow * fast), np.hypot(decay, angle))
    return np.asarray(frequency / step)[()], np.asarray(decay / frequency)[()]


def _frequency_and_damping(a: Array, b: Array) -> tuple[Array, Array]:
    u = 4 - 2 * a - b
    return np.sqrt(b / u), a / np.sqrt(b * u)


def _half(dt: ArrayLike | None) -> Array:
    """T/2, which makes frequencies dimensionless; 1 if they are."""
    return np.asarray(1.0) if dt is None else positive("dt", dt) / 2
