"""How the covariance of a state grows while nothing is seen."""

from __future__ import annotations

from collections.abc import Callable

__all__ = ["process_noise"]


def process_noise(
    acceleration: float, period: float
) -> Callable[[float], tuple[float, float, float]]:
    """Covariance of position and velocity by an unknown acceleration, as a kernel.

    The acceleration is drawn anew each period and held, so that over n periods the covariance is
    that of n steps; in between it is its polynomial in time, and within one period that of one
    acceleration that is held.

    Parameters
    ----------
    acceleration : float
        Its standard deviation (m/s²).
    period : float
        Time for which it is held (s).

    Returns
    -------
    callable
        ``noise(dt) -> (q11, q12, q22)``, in m², m²/s and m²/s².
    """
    square = acceleration * acceleration
    lasting = square * period
    twelfth = period * period / 12.0

    def noise(dt: float) -> tuple[float, float, float]:
        squared = dt * dt
        if dt < period:
            half = 0.5 * square * squared
            return 0.5 * half * squared, half * dt, square * squared
        return lasting * dt * (squared / 3.0 - twelfth), 0.5 * lasting * squared, lasting * dt

    return noise
