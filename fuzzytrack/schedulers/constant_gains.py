"""Kernels of gains that do not depend on the plots: the same ones, or those of the same filter.

Schedulers of constant gains use it. Their gains belong to one sampling time; with a `period` the
kernel converts them to the time step of each plot.
"""

from __future__ import annotations

from typing import Any

from fuzzytrack.gains.abc_space import with_third_pole
from fuzzytrack.gains.checks import number, positive
from fuzzytrack.gains.period import pair_after, pair_rates, poles_in_time
from fuzzytrack.schedulers.base import Kernel, Memory

__all__ = ["checked_period", "constant_kernel"]

Gains = tuple[float, float, float]


def checked_period(period: float | None, gains: Gains) -> float | None:
    """Sampling time to which gains belong, as a float; None without one.

    Raises
    ------
    ValueError
        If it is not one positive number, or the gains have a negative real pole.
    """
    if period is None:
        return None
    value = number("period", positive("period", period))
    try:
        poles_in_time(*gains)
    except ValueError as error:
        raise ValueError(f"period: {error}") from None
    return value


def constant_kernel(gains: Gains, period: float | None) -> Kernel:
    """Kernel of constant gains.

    Parameters
    ----------
    gains : tuple of float
        α, β and γ, stable.
    period : float or None
        Sampling time T₀ to which they belong (s). At another time step T the kernel returns the
        gains whose poles are those of the given ones to the power of T/T₀, see
        `fuzzytrack.gains.resampled_gains`; at T₀ the given ones. Without it the gains are the same
        at any T.
    """
    alpha, beta, gamma = gains

    def constant(
        innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
    ) -> tuple[float, float, float, float, Memory]:
        return alpha, beta, gamma, 1.0, memory

    if period is None:
        return constant

    designed_at = period
    pair_a, pair_b, distance = (float(part) for part in poles_in_time(*gains))
    pair, third = pair_rates(pair_a, pair_b), pair_rates(distance, 0.0)

    def second_order(
        innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
    ) -> tuple[float, float, float, float, Memory]:
        a, b = pair_after(pair, dt / designed_at)
        given = dt == designed_at
        return alpha if given else a, beta if given else b, 0.0, 1.0, memory

    def third_order(
        innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
    ) -> tuple[float, float, float, float, Memory]:
        a, b = pair_after(pair, dt / designed_at)
        delta, _ = pair_after(third, dt / designed_at)
        a, b, c = with_third_pole(a, b, delta)
        given = dt == designed_at
        return alpha if given else a, beta if given else b, gamma if given else c, 1.0, memory

    return third_order if gamma != 0.0 else second_order
