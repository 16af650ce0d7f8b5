"""Covariance of a target whose acceleration decays, with noise that may begin before a plot.

Scalar functions, written so that compiled code can inline them: schedulers and interacting models
share them. A covariance is given by the numbers on and above its diagonal, row by row, as in
`fuzzytrack.gains.joseph`.
"""

from __future__ import annotations

import math

from fuzzytrack.gains.joseph import Covariance3, predict_ca

__all__ = ["add_onset", "correct_optimally", "fade", "onset", "predict_singer"]


def fade(x: float) -> float:
    """Part of an acceleration that is left after `x` retention times: 1/(1 + x + x²/2).

    It is used in place of exp(-x), which takes longer to compute. Over a long gap the displacement
    by the acceleration a stays below τ²a, where that of a constant acceleration grows without end.
    """
    return 1.0 / (1.0 + x + 0.5 * x * x)


def predict_singer(
    p11: float, p12: float, p13: float, p22: float, p23: float, p33: float, dt: float, phi: float
) -> Covariance3:
    """FPFᵀ over a time `dt`, without process noise, of a target that keeps φ of its acceleration.

    F = [[1, dt, φ dt²/2], [0, 1, φ dt], [0, 0, φ]]: the acceleration fades first, and then moves
    position and velocity.

    Notes
    -----
    Singer (1970), with `fade` for the decay, and the faded acceleration constant over `dt`.
    """
    return predict_ca(p11, p12, phi * p13, p22, phi * p23, phi * phi * p33, dt, 0.5 * dt * dt)


def onset(dt: float, phi: float, delay: float, gaps: float) -> tuple[float, float, float]:
    """Process noise of an acceleration that began a time `delay` before the last plot.

    Parameters
    ----------
    dt : float
        Time since the last plot (s).
    phi : float
        Part of the acceleration that is kept over `dt`.
    delay : float
        Time by which a maneuver is older than the last plot (s), >= 0.
    gaps : float
        `dt` over the length of gap (1) at which the noise is halved: it is divided by 1 + `gaps`.

    Returns
    -------
    b, g1, g2 : float
        The noise is b·σ²·GGᵀ with G = (g1, g2, 1) = ((dt + delay)²/2, dt + delay, 1) and
        b = (1 - φ²)/(1 + gaps).
    """
    d = dt + delay
    return (1.0 - phi * phi) / (1.0 + gaps), 0.5 * d * d, d


def add_onset(
    p11: float, p12: float, p13: float, p22: float, p23: float, p33: float,
    q: float, g1: float, g2: float,
) -> Covariance3:  # fmt: skip
    """P + q·GGᵀ with G = (g1, g2, 1)."""
    q1, q2 = q * g1, q * g2
    return p11 + q1 * g1, p12 + q1 * g2, p13 + q1, p22 + q2 * g2, p23 + q2, p33 + q


def correct_optimally(
    p11: float, p12: float, p13: float, p22: float, p23: float, p33: float, r: float
) -> tuple[float, float, float, Covariance3]:
    """Kalman gain for a plot of variance `r`, and the covariance after it.

    Parameters
    ----------
    p11, p12, p13, p22, p23, p33 : float
        Covariance before the plot.
    r : float
        Infinity where the plot is missing: the gain is then 0, and the covariance stays.

    Returns
    -------
    k1, k2, k3 : float
        K = P(·, 1)/(P₁₁ + r).
    covariance : tuple of float
        P - KKᵀ(P₁₁ + r), whose first row is P's times r/(P₁₁ + r): a difference of large numbers
        would lose it after a long gap.
    """
    share = 1.0 / (p11 + r)
    k1, k2, k3 = p11 * share, p12 * share, p13 * share
    rest = r * share if r < math.inf else 1.0
    n22, n33 = p22 - k2 * p12, p33 - k3 * p13
    # In single precision, rounding can leave less than 0 after a gap of 10⁵ usual intervals.
    n22 = n22 if n22 > 0.0 else 0.0
    n33 = n33 if n33 > 0.0 else 0.0
    return k1, k2, k3, (rest * p11, rest * p12, rest * p13, n22, p23 - k2 * p13, n33)
