"""Gains of a growing memory, with part of a fixed velocity gain mixed in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.gains import design
from fuzzytrack.gains.checks import finite
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers
from fuzzytrack.schedulers.growing_memory import GrowingMemory, checked_limit

__all__ = ["LinearCombination"]


@schedulers.register("linear-combination")
@dataclass(frozen=True, repr=False)
class LinearCombination(GainScheduler):
    """α of growing memory, β between growing memory and fixed: M3 of Al-Wagih & Abdulla.

    α = α̂ and β = w·β̃ + (1 - w)·β̂, with α̂, β̂ of `GrowingMemory` and β̃ of `BenedictBordner`.

    Parameters
    ----------
    alpha : float
        Position gain from which β̃ follows, 0 < α < 4 - 2√2.
    weight : float
        w, from 0 to 1.
    limit : float, optional
        As for `GrowingMemory`.

    Raises
    ------
    ValueError
        If a parameter is out of range.

    Notes
    -----
    Al-Wagih & Abdulla, Eq. 25 and Algorithm 1. They choose w by an optimization and do not print
    it; α = 0.05 and w = 0.05 come nearest to their tables. Without a limit α falls to 0 while β
    does not: on long tracks the filter is stable, but its damping is very small.
    """

    source: ClassVar[str] = "Al-Wagih & Abdulla, M3, Eq. 25"
    sees_starts = True
    uses_acceleration = False

    alpha: float = 0.05
    weight: float = 0.05
    limit: float | None = None

    def __post_init__(self) -> None:
        design.benedict_bordner(self.alpha)
        weight = float(finite("weight", self.weight))
        if not 0 <= weight <= 1:
            raise ValueError(f"weight must be from 0 to 1, got {weight:g}")
        object.__setattr__(self, "alpha", float(self.alpha))
        object.__setattr__(self, "weight", weight)
        object.__setattr__(self, "limit", checked_limit(self.limit))

    def initial_memory(self, n_axes: int) -> Memory:
        """No plots."""
        return (0.0,)

    def kernel(self, n_axes: int) -> Kernel:
        """Growing memory with another β; see `GainScheduler.kernel`."""
        growing = GrowingMemory(self.limit).kernel(n_axes)
        kept = 1.0 - self.weight
        added = self.weight * float(design.benedict_bordner(self.alpha))

        def linear_combination(
            innovation: Any, change: Any, dt: float, sigma: float, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            alpha, beta, gamma, retention, count = growing(innovation, change, dt, sigma, memory)
            return alpha, added + kept * beta, gamma, retention, count

        return linear_combination
