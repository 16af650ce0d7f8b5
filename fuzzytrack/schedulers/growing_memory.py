"""Gains of least squares over all plots so far, and their mixture with fixed ones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.gains import design
from fuzzytrack.gains.checks import finite
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers

__all__ = ["BenedictBordner", "GrowingMemory", "LinearCombination"]


def least_squares_gains(n: float) -> tuple[float, float]:
    """α and β of the line through n >= 2 plots; see `fuzzytrack.gains.growing_memory`."""
    d = n * (n + 1.0)
    return 2.0 * (2.0 * n - 1.0) / d, 6.0 / d


def _limit(limit: float | None) -> float | None:
    if limit is None:
        return None
    value = float(finite("limit", limit))
    if value < 2:
        raise ValueError(f"limit must be >= 2 plots, got {value:g}")
    return value


@schedulers.register("benedict-bordner")
@dataclass(frozen=True)
class BenedictBordner(GainScheduler):
    """Fixed gains with β = α²/(2 - α): method M1 of Al-Wagih & Abdulla.

    Parameters
    ----------
    alpha : float
        Position gain, 0 < α < 4 - 2√2 = 1.1716. The authors use 0.05 or 0.01.

    Raises
    ------
    ValueError
        If `alpha` is out of range.

    Notes
    -----
    Al-Wagih & Abdulla, Eqs. 23a and 23b; Llinas et al. (1998), Eq. 2.98.
    """

    source: ClassVar[str] = "Al-Wagih & Abdulla, M1, Eqs. 23a-23b; Benedict & Bordner (1962)"
    uses_acceleration = False

    alpha: float

    def __post_init__(self) -> None:
        design.benedict_bordner(self.alpha)
        object.__setattr__(self, "alpha", float(self.alpha))

    @property
    def beta(self) -> float:
        """Velocity gain."""
        return float(design.benedict_bordner(self.alpha))

    def kernel(self, n_axes: int) -> Kernel:
        """Constant gains; see `GainScheduler.kernel`."""
        alpha, beta = self.alpha, self.beta

        def benedict_bordner(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            return alpha, beta, 0.0, 1.0, memory

        return benedict_bordner


@schedulers.register("growing-memory")
@dataclass(frozen=True)
class GrowingMemory(GainScheduler):
    """Line fitted to all plots so far by least squares: method M2 of Al-Wagih & Abdulla.

    At plot n of a track α = 2(2n - 1)/(n(n + 1)) and β = 6/(n(n + 1)). Only plots that were seen
    are counted.

    Parameters
    ----------
    limit : float, optional
        Plots after which the memory no longer grows and the gains stay, >= 2. Unless given, it
        grows for ever: as published, and only for targets that never manoeuvre.

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
    sees_every_step = True
    uses_acceleration = False

    limit: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "limit", _limit(self.limit))

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


@schedulers.register("linear-combination")
@dataclass(frozen=True)
class LinearCombination(GainScheduler):
    """α of growing memory, β between growing memory and fixed: M3 of Al-Wagih & Abdulla.

    α = α̂ and β = w·β̃ + (1 - w)·β̂, with α̂, β̂ of `GrowingMemory` and β̃ of `BenedictBordner`.

    Parameters
    ----------
    alpha : float
        Position gain behind β̃, 0 < α < 4 - 2√2.
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
    Al-Wagih & Abdulla, Eq. 25 and Algorithm 1. They leave w to an optimisation and state no value;
    α = 0.05 and w = 0.05 are the reading that is nearest to their tables. Without a limit α falls
    to 0 while β does not: on long tracks the filter is stable, but hardly damped.
    """

    source: ClassVar[str] = "Al-Wagih & Abdulla, M3, Eq. 25"
    sees_every_step = True
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
        object.__setattr__(self, "limit", _limit(self.limit))

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
            alpha, beta, gamma, phi, count = growing(innovation, change, dt, sigma, memory)
            return alpha, added + kept * beta, gamma, phi, count

        return linear_combination
