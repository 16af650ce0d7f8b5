"""The a-b-c space: an α-β-γ filter as an α-β filter and one real pole.

The characteristic polynomial is written (z + c)(z² + (a + b - 2)z + 1 - a): a and b are the gains
of the α-β filter with the same pair of poles, -c is the third pole. The stable set, a volume with a
curved face in α, β, γ, becomes a prism: (a, b) in the stability triangle, -1 < c < 1, and the α-β
filter its face c = -1 (Llinas et al. 1998, Eqs. 2.53 and 2.54).
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite
from fuzzytrack.gains.stability import discriminant, factored, pair_distances

__all__ = ["abc_preimages", "from_abc", "to_abc"]

Triple = tuple[Array, Array, Array]
Number = TypeVar("Number", float, NDArray[np.float64])


def from_abc(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> Triple:
    """Gains from the pair of poles (a, b) and the third pole -c.

    Parameters
    ----------
    a, b : array_like
        Gains of the α-β filter with the same pair of poles, finite.
    c : array_like
        Minus the third pole, finite; they all broadcast. c = -1 gives γ = 0, α = a, β = b exactly.

    Returns
    -------
    alpha, beta, gamma : ndarray
        Of the broadcast shape (numbers for numbers). Stable where (a, b) lies in the stability
        triangle and -1 < c < 1 (or c = -1: the α-β filter).

    Raises
    ------
    ValueError
        If an argument is not finite.

    Notes
    -----
    Llinas et al. (1998), Eq. 2.54, in 1 + c, the distance of the third pole from 1.

    Examples
    --------
    >>> print("{:.2f} {:.2f} {:.2f}".format(*from_abc(0.5, 0.3, -0.6)))
    0.70 0.44 0.24
    """
    first, second, third = finite("a", a), finite("b", b), finite("c", c)
    alpha, beta, gamma = gains_from_distance(first, second, 1 + third)
    return alpha[()], beta[()], gamma[()]


def to_abc(alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike) -> Triple:
    """Pair of poles (a, b) and third pole -c of an α-β-γ filter; the inverse of `from_abc`.

    Parameters
    ----------
    alpha, beta, gamma : array_like
        Gains, finite, stable or not; they broadcast.

    Returns
    -------
    a, b, c : ndarray
        Of the broadcast shape (numbers for numbers). The third pole -c is the largest real pole.
        Stable gains lie inside the prism; γ = 0 gives a = α, b = β, c = -1 exactly.

    Raises
    ------
    ValueError
        If a gain is not finite.

    See Also
    --------
    abc_preimages : All of them, where the poles are real.

    Notes
    -----
    The printed remark that the inverse is unique holds only where two poles are complex. With three
    real poles any of them can be the third. `from_abc` returns the gains whatever the choice, to
    rounding; where -c is a multiple pole, a, b and c themselves are only known to a root of it.

    Examples
    --------
    >>> print("{:.6f} {:.6f} {:.6f}".format(*to_abc(0.5, 0.4, 0.1)))
    0.421312 0.367712 -0.864024
    """
    a, b, delta = factored(alpha, beta, gamma)
    return a[()], b[()], (delta - 1)[()]


def abc_preimages(alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike) -> Triple:
    """Every (a, b, c) that gives the same gains: one, or three where all poles are real.

    Parameters
    ----------
    alpha, beta, gamma : array_like
        Gains, finite, stable or not; they broadcast.

    Returns
    -------
    a, b, c : ndarray
        Shape ``(..., 3)``: the preimages along the last axis, the largest third pole -c first,
        which is `to_abc`. The last two are NaN where two poles are complex. A multiple real pole
        counts as often as it occurs.

    Raises
    ------
    ValueError
        If a gain is not finite.

    Notes
    -----
    All preimages are one filter: one transfer function, noise ratio and transient cost.

    Examples
    --------
    >>> abc_preimages(0.85, 0.34, 0.04)[2].round(6)
    array([-0.931662, -0.6     , -0.268338])
    """
    a, b, delta = factored(alpha, beta, gamma)
    low, high, _ = pair_distances(a, b)
    real = discriminant(a, b) >= 0

    def other(third: Array, left: Array) -> Triple:
        """The same filter with `third` as third pole; `left` and the former third are the pair."""
        product = left * delta
        first = left + delta - product
        return tuple(np.where(real, value, np.nan) for value in (first, product, third))  # type: ignore[return-value]

    triples = (a, b, delta), other(low, high), other(high, low)
    a, b, delta = (np.stack(values, axis=-1) for values in zip(*triples, strict=True))
    return a, b, delta - 1


def gains_from_distance(a: Array, b: Array, delta: Array) -> Triple:
    """`with_third_pole` for arrays that broadcast."""
    alpha, beta, gamma = with_third_pole(*np.broadcast_arrays(a, b, delta))
    return np.asarray(alpha), np.asarray(beta), np.asarray(gamma)


def with_third_pole(a: Number, b: Number, delta: Number) -> tuple[Number, Number, Number]:
    """Eq. 2.54 without checks, with δ = 1 + c, which for slow filters has more digits than c."""
    return a + delta * (1.0 - a), a * delta + b * (1.0 - 0.5 * delta), 2.0 * b * delta
