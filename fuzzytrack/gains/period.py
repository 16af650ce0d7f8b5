"""Gains of a filter at another sampling time, with the same poles in continuous time.

A filter was designed at some sampling time, its *period*, and has poles z there. The same filter at
another sampling time T has the poles z^(T/period), from which its gains follow. `resampled_gains`
works on arrays. The scalar functions are for the kernel of a scheduler, where T differs from plot
to plot. They need no logarithms or exponentials, which differ between compilers in the last bit.

Where the sampling time is halved, each pole becomes its square root. For the gains this means,
for real and complex poles alike,

    α → α/(1 + √(1 - α))        β → β/(1 + √(1 - α) + √((1 + √(1 - α))² - β))

and where it is doubled, α → α(2 - α) and β → β(4 - 2α - β). After enough halvings two terms of a
series give -ln z; it is multiplied by T/period, and turned into gains again.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.gains.abc_space import gains_from_distance
from fuzzytrack.gains.checks import positive, stable_gains
from fuzzytrack.gains.stability import factored, has_negative_pole
from fuzzytrack.gains.wdomain import alpha_beta_from_s, s_from_alpha_beta

__all__ = ["pair_after", "pair_rates", "poles_in_time", "resampled_gains"]

#: What `pair_rates` returns.
Rates = tuple[float, float, bool]

_HALVINGS = 14
_DOUBLINGS = 30
# Beyond it two terms of the series are not enough.
_LONGEST = 2.0 ** (_DOUBLINGS - _HALVINGS)


def resampled_gains(
    alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike = 0.0, *, period: ArrayLike, dt: ArrayLike
) -> tuple[Array, Array, Array]:
    """Gains of a filter at another sampling time, with the same poles in continuous time.

    Parameters
    ----------
    alpha, beta, gamma : array_like
        Stable gains without a negative real pole. A pole 0 is 0 at any sampling time.
    period : array_like
        Sampling time to which they belong (s), > 0.
    dt : array_like
        Sampling time T (s), > 0; all arguments broadcast.

    Returns
    -------
    alpha, beta, gamma : ndarray
        Gains at T, of the broadcast shape (numbers for numbers); stable. The angle of complex poles
        is multiplied by T/period, also where that is more than a turn: samples so far apart do not
        show how the filter oscillates between them.

    Raises
    ------
    ValueError
        If gains are not stable or have a negative real pole, or a time is not positive.

    Notes
    -----
    For γ = 0 and complex poles, with ω₀ and ζ of `s_from_alpha_beta` at the period,
    α = 1 - exp(-2ζω₀T) and β = 1 + exp(-2ζω₀T) - 2 exp(-ζω₀T) cos(ω₀T√(1 - ζ²)). Of an α-β-γ filter
    the pair of poles and the third one (see `to_abc`) are converted one by one.

    Examples
    --------
    >>> print("{:.4f} {:.4f} {:.0f}".format(*resampled_gains(0.5, 0.2, period=4, dt=8)))
    0.7500 0.5600 0
    """
    ratio = positive("dt", dt) / positive("period", period)
    ratio, a, b, delta = np.broadcast_arrays(ratio, *poles_in_time(alpha, beta, gamma))
    # Beside a pole 0 there is a real one, 1 - b.
    zero = a == 1
    first, second = alpha_beta_from_s(
        *s_from_alpha_beta(np.where(zero, 0.5, a), np.where(zero, 0.5, b), 1.0), ratio
    )
    alone = _decayed(b, ratio)
    first, second = np.where(zero, 1.0, first), np.where(zero, alone, second)
    new = gains_from_distance(first, second, _decayed(delta, ratio))
    return new[0][()], new[1][()], new[2][()]


def poles_in_time(
    alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike = 0.0
) -> tuple[Array, Array, Array]:
    """Poles of a filter that exists in continuous time, too: as `to_abc`, with 1 + c for c.

    Raises
    ------
    ValueError
        If gains are not stable, or have a negative real pole: it changes sign from plot to plot,
        which at another sampling time means nothing.
    """
    gains = stable_gains(alpha, beta, gamma)
    a, b, delta = factored(*gains)
    negative = has_negative_pole(a, b) | (delta > 1)
    if negative.any():
        at = tuple(np.argwhere(negative)[0])
        values = dict(zip(("alpha", "beta", "gamma"), (gain[at] for gain in gains), strict=True))
        raise ValueError(
            "gains with a negative real pole belong to one sampling time only; without gamma, "
            "needed are alpha <= 1 and beta < (1 + sqrt(1 - alpha))^2; got "
            + ", ".join(f"{name}={value:g}" for name, value in values.items() if value)
        )
    return a, b, delta


def _decayed(distance: Array, ratio: Array) -> Array:
    """1 - z^ratio of real poles z, from 1 - z."""
    with np.errstate(divide="ignore"):
        rate = np.log1p(-np.minimum(distance, 1.0))
    return np.asarray(-np.expm1(ratio * rate))


# ---------------------------------------------------------------- in a kernel


def pair_rates(alpha: float, beta: float) -> Rates:
    """Poles z of an α-β filter, none of them real and negative, as rates -ln z.

    Parameters
    ----------
    alpha, beta : float
        Gains at the period, with 0 <= α <= 1 and 0 <= β < (1 + √(1 - α))², or α = β = 1.

    Returns
    -------
    total, product : float
        Half the sum of the rates and a quarter of their product, for period/2^14.
    zero : bool
        Whether one pole is 0; its rate is infinite, and the numbers are those of the other pole.
    """
    zero = alpha >= 1.0
    a, b = beta if zero else alpha, 0.0 if zero else beta
    for _ in range(_HALVINGS):
        left = 1.0 - a
        root = 1.0 + math.sqrt(left if left > 0.0 else 0.0)
        left = root * root - b
        b = b / (root + math.sqrt(left if left > 0.0 else 0.0))
        a = a / root
    # w = (1 - z)/(1 + z), and -ln(z)/2 = w + w³/3 + ...
    share = 1.0 / (4.0 - 2.0 * a - b)
    total, product = 2.0 * a * share, b * share
    square = total * total
    return (
        total * (1.0 + (square * (1.0 / 3.0) - product)),
        product * (1.0 + (square - 2.0 * product) * (1.0 / 3.0)),
        zero,
    )


def pair_after(rates: Rates, ratio: float) -> tuple[float, float]:
    """Gains of the same filter at another sampling time.

    Parameters
    ----------
    rates : tuple
        From `pair_rates`.
    ratio : float
        T/period, > 0; more than 2^16 counts as 2^16.

    Returns
    -------
    alpha, beta : float
    """
    total, product, zero = rates
    scale = (ratio if ratio < _LONGEST else _LONGEST) / _LONGEST
    half, quarter = total * scale, product * (scale * scale)
    # w = y - y³/3 + ... of y = -ln(z)/2.
    square = half * half
    w_total = half * (1.0 - (square * (1.0 / 3.0) - quarter))
    w_product = quarter * (1.0 - (square - 2.0 * quarter) * (1.0 / 3.0))
    share = 1.0 / (1.0 + w_total + w_product)
    a, b = 2.0 * w_total * share, 4.0 * w_product * share
    for _ in range(_DOUBLINGS):
        b = b * (4.0 - 2.0 * a - b)
        a = a * (2.0 - a)
    # A pole 0 that is left after one was taken away: no other pole has a rate so large.
    a = 1.0 if total >= 1.0 else a
    return 1.0 if zero else a, a if zero else b
