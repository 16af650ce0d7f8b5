"""Gains of a line fitted by least squares to all plots of a track so far."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.gains.checks import finite
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers

__all__ = ["GrowingMemory"]


def least_squares_gains(n: float) -> tuple[float, float]:
    """α and β of the line through n >= 2 plots; see `fuzzytrack.gains.growing_memory`."""
    d = n * (n + 1.0)
    return 2.0 * (2.0 * n - 1.0) / d, 6.0 / d


def checked_limit(limit: float | None) -> float | None:
    """Number of plots from which on a memory does not grow, as a float; None without a limit."""
    if limit is None:
        return None
    value = float(finite("limit", limit))
    if value < 2:
        raise ValueError(f"limit must be >= 2 plots, got {value:g}")
    return value


@schedulers.register("growing-memory")
@dataclass(frozen=True, repr=False)
class GrowingMemory(GainScheduler):
    """Line fitted to all plots so far by least squares: method M2 of Al-Wagih & Abdulla.

    At plot n of a track α = 2(2n - 1)/(n(n + 1)) and β = 6/(n(n + 1)). Only plots that were seen
    are counted.

    Parameters
    ----------
    limit : float, optional
        Number of plots, >= 2, from which on the memory does not grow and the gains stay as they
        are. Without it the memory has no limit, as published; this suits only targets that never
        maneuver.

    Raises
    ------
    ValueError
        If `limit` is out of range.

    Notes
    -----
    Al-Wagih & Abdulla, Eqs. 24a and 24b. Least squares exactly at constant T without missed plots,
    with either start of the tracker. The memory is the number of plots.
    """

    source: ClassVar[str] = "Al-Wagih & Abdulla, M2, Eqs. 24a-24b"
    sees_starts = True
    uses_acceleration = False

    limit: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "limit", checked_limit(self.limit))

    def initial_memory(self, n_axes: int) -> Memory:
        """No plots."""
        return (0.0,)

    def kernel(self, n_axes: int) -> Kernel:
        """Count, and fit; see `GainScheduler.kernel`."""
        limit = math.inf if self.limit is None else self.limit

        def growing_memory(
            innovation: Any, change: Any, dt: float, sigma: float, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            count = memory[0] + 1.0 if sigma != math.inf else memory[0]
            n = count if count < limit else limit
            alpha, beta = least_squares_gains(n if n > 2.0 else 2.0)
            return alpha, beta, 0.0, 1.0, (count,)

        return growing_memory
