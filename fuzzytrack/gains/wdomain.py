"""The w-domain: gains as natural frequency (stiffness) and damping of a second-order system.

z = (1 + w)/(1 - w) maps the unit disc onto the left half plane, so any positive frequency and
damping give a stable filter (Llinas et al. 1998, Eqs. 3.22 to 3.26).
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["alpha_beta_from_w", "bilinear", "w_from_alpha_beta"]

Number = TypeVar("Number", float, NDArray[np.float64])


def bilinear(omega0: Number, zeta: Number) -> tuple[Number, Number]:
    """Eq. 3.26 without checks, for scalars and arrays alike: the arithmetic of a kernel."""
    damping = 2.0 * zeta * omega0
    square = omega0 * omega0
    denominator = 1.0 + damping + square
    return 2.0 * damping / denominator, 4.0 * square / denominator


def alpha_beta_from_w(
    omega0: ArrayLike, zeta: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gains from natural frequency and damping ratio in the w-domain.

    Parameters
    ----------
    omega0 : array_like
        Undamped natural frequency ("stiffness"), dimensionless, >= 0.
    zeta : array_like
        Damping ratio, dimensionless, >= 0; broadcasts with `omega0`.

    Returns
    -------
    alpha, beta : ndarray
        Position and velocity gains, of the broadcast shape (numbers for numbers). For positive
        arguments they lie inside the stability triangle, since 4 - 2α - β = 4/(1 + 2ζω₀ + ω₀²) > 0;
        where an argument is 0, on its edge (marginally stable).

    Raises
    ------
    ValueError
        If an argument is negative, infinite or NaN.

    Notes
    -----
    Llinas et al. (1998), Eq. 3.26.

    Examples
    --------
    >>> alpha, beta = alpha_beta_from_w(0.27224, 0.72539)
    >>> print(f"{alpha:.4f} {beta:.4f}")
    0.5377 0.2018
    """
    frequency = _nonnegative("omega0", omega0)
    damping = _nonnegative("zeta", zeta)
    alpha, beta = map(np.asarray, bilinear(frequency, damping))
    return alpha[()], beta[()]


def w_from_alpha_beta(
    alpha: ArrayLike, beta: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Natural frequency and damping ratio in the w-domain from stable gains.

    Parameters
    ----------
    alpha, beta : array_like
        Gains inside the stability triangle: α > 0, β > 0, 2α + β < 4; they broadcast.

    Returns
    -------
    omega0, zeta : ndarray
        Positive, of the broadcast shape; the inverse of `alpha_beta_from_w`.

    Raises
    ------
    ValueError
        If a pair lies outside the open stability triangle.

    Notes
    -----
    ω₀ = √(β/u), ζ = α/√(βu) with u = 4 - 2α - β, the inverse of Llinas et al. (1998), Eq. 3.26.
    """
    a, b = np.broadcast_arrays(
        np.asarray(alpha, dtype=np.float64), np.asarray(beta, dtype=np.float64)
    )
    stable = (a > 0) & (b > 0) & (2 * a + b < 4) & np.isfinite(a) & np.isfinite(b)
    if not stable.all():
        first = np.argmin(stable.ravel())
        raise ValueError(
            f"alpha, beta must lie in the stability triangle alpha > 0, beta > 0, "
            f"2 alpha + beta < 4; got alpha={a.ravel()[first]:g}, beta={b.ravel()[first]:g}"
        )
    u = 4 - 2 * a - b
    return np.sqrt(b / u)[()], (a / np.sqrt(b * u))[()]


def _nonnegative(name: str, value: ArrayLike) -> NDArray[np.float64]:
    array = np.asarray(value, dtype=np.float64)
    good = np.isfinite(array) & (array >= 0)
    if not good.all():
        raise ValueError(f"{name} must be finite and >= 0, got {array[~good].ravel()[0]:g}")
    return array
