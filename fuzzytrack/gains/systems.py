"""Filters as systems of scipy.signal, for its tools: step responses, Bode plots, conversions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from fuzzytrack.gains.checks import finite, positive

if TYPE_CHECKING:
    from scipy.signal import dlti

__all__ = ["transfer_function"]


def transfer_function(
    alpha: float,
    beta: float,
    gamma: float = 0.0,
    dt: float = 1.0,
    *,
    of: Literal["predicted", "filtered"] = "predicted",
) -> dlti:
    """A filter with fixed gains as a discrete linear system.

    Parameters
    ----------
    alpha, beta, gamma : float
        Gains, dimensionless. They need not be stable. At zero `gamma` the system is of second
        order, else of third.
    dt : float
        Sampling time, s, > 0.
    of : str
        ``"predicted"``, the position predicted for an observation from those before it (the
        system delays by one step); or ``"filtered"``, with the observation taken in.

    Returns
    -------
    scipy.signal.dlti
        System from observation to position.

    Raises
    ------
    ValueError
        If a gain is not a finite number, all are 0, `dt` is not positive, or `of` names no
        output.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.7 and 2.45.

    Examples
    --------
    >>> system = transfer_function(0.5, 0.7, dt=3)
    >>> print(system.num.round(4), system.den.round(4))
    [ 1.2 -0.5] [ 1.  -0.8  0.5]
    """
    from scipy.signal import dlti

    a, b, g = (_number(n, v) for n, v in (("alpha", alpha), ("beta", beta), ("gamma", gamma)))
    t = float(positive("dt", _number("dt", dt)))
    if a == b == g == 0:
        raise ValueError("alpha, beta, gamma must not all be 0: scipy has no system without output")
    if of not in ("predicted", "filtered"):
        raise ValueError(f"of must be one of 'predicted', 'filtered'; got {of!r}")
    q = g / 4
    if g == 0:
        denominator = [1, a + b - 2, 1 - a]
        numerator = [a + b, -a] if of == "predicted" else [a, b - a, 0]
    else:
        denominator = [1, a + b + q - 3, 3 - 2 * a - b + q, a - 1]
        if of == "predicted":
            numerator = [a + b + q, q - 2 * a - b, a]
        else:
            numerator = [a, b + q - 2 * a, a - b + q, 0]
    # scipy warns of leading zeros.
    return dlti(np.trim_zeros(numerator[:-1], "f") + numerator[-1:], denominator, dt=t)


def _number(name: str, value: float) -> float:
    array = finite(name, value)
    if array.ndim:
        raise ValueError(f"{name} must be one number, got an array of shape {array.shape}")
    return float(array)
