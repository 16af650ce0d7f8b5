"""Gains that minimize a cost: closed forms for the classical costs, a search for any other.

The costs weigh the noise that a filter passes on against its errors when the target moves
(Llinas et al. 1998, Eqs. 2.92 to 2.106). For a straight line each has one dimensionless index, as
Kalata's gains have: the optimal gains are functions of the index alone. `velocity_index`,
`acceleration_index` and `steady_index` make it from quantities with units.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite, nonnegative, positive

__all__ = [
    "acceleration_index",
    "optimal_alpha_beta_gamma",
    "optimal_for_acceleration",
    "optimal_for_steady_error",
    "optimal_for_velocity",
    "steady_index",
    "velocity_index",
]


# ---------------------------------------------------------------- indices


def velocity_index(
    velocity: ArrayLike, dt: ArrayLike, sigma: ArrayLike, kappa: ArrayLike = 1.0
) -> Array:
    """Index abs(v) T^1.5 / (√κ σ) of the cost J + κ σ² ρ² at constant velocity.

    Parameters
    ----------
    velocity : array_like
        Velocity of the target, m/s.
    dt : array_like
        Sampling time T, s, > 0.
    sigma : array_like
        Standard deviation of the observation noise, m, > 0.
    kappa : array_like
        Weight of the noise that the prediction passes on, s, > 0.

    Returns
    -------
    ndarray
        Dimensionless, >= 0, of the broadcast shape.

    Raises
    ------
    ValueError
        If an argument is out of its range.
    """
    return _index(np.abs(finite("velocity", velocity)), 1.5, dt, sigma, kappa)


def acceleration_index(
    acceleration: ArrayLike, dt: ArrayLike, sigma: ArrayLike, kappa: ArrayLike = 1.0
) -> Array:
    """Index abs(a) T^2.5 / (√κ σ) of the cost J + κ σ² ρ² at constant acceleration.

    Parameters
    ----------
    acceleration : array_like
        Acceleration of the target, m/s².
    dt, sigma, kappa : array_like
        As for `velocity_index`.

    Returns
    -------
    ndarray
        Dimensionless, >= 0, of the broadcast shape.

    Raises
    ------
    ValueError
        If an argument is out of its range.
    """
    return _index(np.abs(finite("acceleration", acceleration)), 2.5, dt, sigma, kappa)


def steady_index(
    acceleration: ArrayLike,
    dt: ArrayLike,
    sigma: ArrayLike,
    kappa: ArrayLike = 1.0,
    kappa_steady: ArrayLike = 1.0,
) -> Array:
    """Index √κₛ abs(a) T² / (√κ σ) of the cost κₛ e² + κ σ² ρ², where e is the lag a T²/β.

    Parameters
    ----------
    acceleration : array_like
        Acceleration of the target, m/s²: on a circle of radius R, about R ω².
    dt, sigma, kappa : array_like
        As for `velocity_index`, but `kappa` has the unit of `kappa_steady`.
    kappa_steady : array_like
        Weight κₛ of the squared lag, > 0.

    Returns
    -------
    ndarray
        Dimensionless, >= 0, of the broadcast shape.

    Raises
    ------
    ValueError
        If an argument is out of its range.
    """
    lag = np.abs(finite("acceleration", acceleration))
    return _index(lag * np.sqrt(positive("kappa_steady", kappa_steady)), 2.0, dt, sigma, kappa)


def _index(motion: Array, power: float, dt: ArrayLike, sigma: ArrayLike, kappa: ArrayLike) -> Array:
    scale = np.sqrt(positive("kappa", kappa)) * positive("sigma", sigma)
    return np.asarray(motion * positive("dt", dt) ** power / scale)[()]


# ---------------------------------------------------------------- closed forms


def optimal_for_velocity(index: ArrayLike) -> tuple[Array, Array]:
    """Gains of an alpha-beta filter for a target that starts to move with constant velocity.

    They minimize J + κ σ² ρ², where J is the transient cost and ρ² the noise ratio of the
    prediction.

    Parameters
    ----------
    index : array_like
        `velocity_index`, dimensionless, > 0.

    Returns
    -------
    alpha, beta : ndarray
        Gains, dimensionless, of the shape of `index`. They satisfy the Benedict-Bordner relation
        β = α²/(2 - α).

    Raises
    ------
    ValueError
        If `index` is not positive and finite.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.95 to 2.99, solved: on the curve β = index √(1 - α).

    Examples
    --------
    >>> print("{:.4f} {:.4f}".format(*optimal_for_velocity(1.0)))
    0.7691 0.4805
    """
    i = positive("index", index)
    excess, apart = _sum_of_roots(i)
    s = 2 / (2 + excess + apart)
    alpha = np.asarray((1 + s) * (excess + apart) / (2 + excess + apart))
    return alpha[()], np.asarray(i * s)[()]


def optimal_for_acceleration(index: ArrayLike) -> tuple[Array, Array]:
    """Gains of an alpha-beta filter for a target that starts to accelerate from rest.

    They minimize J + κ σ² ρ², where J is the transient cost about the steady lag and ρ² the noise
    ratio of the prediction.

    Parameters
    ----------
    index : array_like
        `acceleration_index`, dimensionless, > 0.

    Returns
    -------
    alpha, beta : ndarray
        Gains, dimensionless, of the shape of `index`; β grows with the index from 0 to 3, while α
        grows to 30 - 12√6 = 0.606 and returns to 1/2.

    Raises
    ------
    ValueError
        If `index` is not positive and finite.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.100 and 2.101, with the missing T⁵. Eq. 2.100 is one curve,
    α = (√(β² + 144β) - 5β)/12.

    Examples
    --------
    >>> print("{:.4f} {:.4f}".format(*optimal_for_acceleration(0.5)))
    0.5416 0.6719
    """
    target = positive("index", index) ** 2

    def along(t: Array) -> tuple[Array, Array, Array]:
        r = np.sqrt(3) * (t / (1 + t))  # √β
        root = np.sqrt(r * r + 144)
        g = (root - 5 * r) / 12  # α/√β
        h = (r / (root + 12) - 5) / 12  # (g - 1)/r
        room = 3 * (1 + 2 * t) / (1 + t) ** 2  # 3 - β
        u = 32 * room / (24 - r * r + r * root)  # 4 - 2α - β
        return r, g, -4 * r**6 * (4 * h * (g + 1) + 4 * g + r) / (h * (g + 1) * u * u)

    r, g, _ = along(_bisect(lambda t: along(t)[2] < target, target.shape))
    return (r * g)[()], (r * r)[()]


def optimal_for_steady_error(index: ArrayLike) -> tuple[Array, Array]:
    """Gains of an alpha-beta filter for a target that accelerates steadily.

    They minimize κₛ e² + κ σ² ρ², where e = a T²/β is the steady lag and ρ² the noise ratio of
    the prediction.

    Parameters
    ----------
    index : array_like
        `steady_index`, dimensionless, > 0.

    Returns
    -------
    alpha, beta : ndarray
        Gains, dimensionless, of the shape of `index`, on the curve α = √β - β/2.

    Raises
    ------
    ValueError
        If `index` is not positive and finite.

    Notes
    -----
    Llinas et al. (1998), Eq. 2.102; the second condition, 2q⁵/(2 - q)³ = index² with q = √β,
    replaces Eq. 2.103, which only repeats the first.

    Examples
    --------
    >>> print("{:.4f} {:.4f}".format(*optimal_for_steady_error(1.0)))
    0.4963 0.8363
    """
    target = positive("index", index) ** 2

    def q(t: Array) -> Array:
        return 2 * (t / (1 + t))

    # With q = 2t/(1 + t), 2 - q is 2/(1 + t).
    t = _bisect(lambda t: q(t) ** 5 * (1 + t) ** 3 / 4 < target, target.shape)
    return (q(t) / (1 + t))[()], (q(t) ** 2)[()]


def optimal_alpha_beta_gamma(
    velocity_index: ArrayLike, acceleration_index: ArrayLike
) -> tuple[Array, Array, Array]:
    """Gains of an alpha-beta-gamma filter for a target that starts to move and to accelerate.

    They minimize J + κ σ² ρ², where J is the transient cost and ρ² the noise ratio of the
    prediction.

    Parameters
    ----------
    velocity_index, acceleration_index : array_like
        The indices of the same names, dimensionless, >= 0 and not both 0; they broadcast.

    Returns
    -------
    alpha, beta, gamma : ndarray
        Gains, dimensionless, of the broadcast shape. Without acceleration γ is 0 and the others
        are those of `optimal_for_velocity`; without velocity they are Kalata's, for the tracking
        index `acceleration_index`.

    Raises
    ------
    ValueError
        If an index is negative or not finite, or both are 0.

    Notes
    -----
    The optimum satisfies Lv²(1-α) = β² - αγ, La²(1-α) = γ²/4 and β(2-α) = α² + αγ/4, of which
    Llinas et al. (1998) give the last (Eq. 2.105); their Eq. 2.106 is the edge of stability and
    never an optimum. For large La the three have unstable solutions too. With s = √(1 - α) and
    X = s + 1/s, the stable one is the only root X > 2 of 2(X² - X√(16 + Lv²) + 4) = La √(X² - 4)
    that leaves β = s(2X - √(16 + Lv²)) positive.

    Examples
    --------
    >>> print("{:.4f} {:.4f} {:.4f}".format(*optimal_alpha_beta_gamma(1.0, 1.0)))
    0.8874 0.8416 0.6712
    """
    lv, la = np.broadcast_arrays(
        nonnegative("velocity_index", velocity_index),
        nonnegative("acceleration_index", acceleration_index),
    )
    if ((lv == 0) & (la == 0)).any():
        raise ValueError("velocity_index and acceleration_index must not both be 0")

    excess, _ = _sum_of_roots(lv)

    def apart(t: Array) -> Array:
        return np.sqrt((t + excess) * (t + excess + 4))  # 1/s - s

    # X = s + 1/s = 2 + excess + t turns the three equations into one that rises with t > 0.
    t = _bisect(lambda t: 2 * t * (t + lv) < la * apart(t), lv.shape)
    double = 2 + excess + t + apart(t)
    s = 2 / double
    alpha = (1 + s) * (t + excess + apart(t)) / double
    return np.asarray(alpha)[()], np.asarray((lv + 2 * t) * s)[()], np.asarray(2 * la * s)[()]


def _sum_of_roots(index: Array) -> tuple[Array, Array]:
    """Of s = √(1 - α) at constant velocity: s + 1/s - 2 and 1/s - s."""
    root = np.sqrt(index * index + 16)
    return (index + index * index / (root + 4)) / 2, np.sqrt(index * (index + root) / 2)


def _bisect(early: Callable[[Array], NDArray[np.bool_]], shape: tuple[int, ...]) -> Array:
    """The t > 0 up to which `early` holds, sought on a logarithmic scale."""
    low, high = np.full(shape, -100.0), np.full(shape, 100.0)
    for _ in range(61):  # 200/2⁶¹ lies below the spacing of the numbers
        middle = (low + high) / 2
        before = early(np.exp(middle))
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return np.asarray(np.exp((low + high) / 2))
