"""The innovation over the standard deviation of the plot, exponentially smoothed."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.gains.checks import finite
from fuzzytrack.kernels.language import Memory
from fuzzytrack.normalizations.base import Normalization, Normalize, normalizations

__all__ = ["Smoothed", "SmoothedMagnitude"]

RHO = {"rho": "Part of the smoothed innovation that stays at a plot."}


def _check_rho(rho: float) -> float:
    value = float(finite("rho", rho))
    if not 0 <= value < 1:
        raise ValueError(f"rho must be >= 0 and < 1, got {value:g}")
    return value


@normalizations.register("smoothed")
@dataclass(frozen=True, repr=False)
class Smoothed(Normalization):
    """Exponentially smoothed innovation over the standard deviation of the plot, axis by axis.

    s = ρs′ + (1 - ρ)e/σ, with s′ the s of the update before (0 at first), and e/σ itself as the
    second signal. Smoothing reduces the noise in s, but not a lag behind the target. So s separates
    a maneuver from noise, which a single innovation does not. Unbounded: a rule base takes values
    outside its universe at the nearest end.

    Parameters
    ----------
    rho : float
        ρ, from 0 (no smoothing) to below 1.

    Raises
    ------
    ValueError
        If `rho` is out of range.
    """

    source: ClassVar[str] = "innovation scaled by measurement noise, exponentially smoothed"
    signals: ClassVar[tuple[str, ...]] = ("smoothed scaled innovation", "scaled innovation")
    numbers: ClassVar[Mapping[str, str]] = RHO
    needs_sigma: ClassVar[bool] = True

    rho: float = 0.774

    def __post_init__(self) -> None:
        object.__setattr__(self, "rho", _check_rho(self.rho))

    def initial_memory(self, n_axes: int) -> Memory:
        """Smoothed innovation, 0."""
        return (0.0,)

    def kernel(self, n_axes: int) -> Normalize:
        """See `Normalization.kernel`."""
        rho, new = self.rho, 1.0 - self.rho

        def smoothed(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            error = innovation / sigma
            mean = rho * memory[0] + new * error
            return (mean, error), (mean,)

        return smoothed


Squares = Callable[[Any, Any, Memory], tuple[float, float, Memory]]


def _sum_of_smoothed(n_axes: int, rho: float) -> Squares:
    """Σs² and Σ(e/σ)² over the first axes, with the new s.

    Built up axis by axis, since compiled code cannot fill a tuple in a loop.
    """
    if n_axes == 0:

        def nothing(innovation: Any, sigma: Any, memory: Memory) -> tuple[float, float, Memory]:
            return 0.0, 0.0, ()

        return nothing

    before = _sum_of_smoothed(n_axes - 1, rho)
    last, new = n_axes - 1, 1.0 - rho

    def one_more(innovation: Any, sigma: Any, memory: Memory) -> tuple[float, float, Memory]:
        means, errors, means_so_far = before(innovation, sigma, memory)
        error = innovation[last] / sigma[last]
        mean = rho * memory[last] + new * error
        return means + mean * mean, errors + error * error, (*means_so_far, mean)

    return one_more


@normalizations.register("smoothed-magnitude")
@dataclass(frozen=True, repr=False)
class SmoothedMagnitude(Normalization):
    """Root mean square of the smoothed scaled innovations over the axes of a track.

    The root of Σsᵢ²/n, with sᵢ as in `Smoothed`, and that of Σ(eᵢ/σᵢ)²/n. Coupled: one set of gains
    for all axes.

    Parameters
    ----------
    rho : float
        As for `Smoothed`.

    Raises
    ------
    ValueError
        If `rho` is out of range.
    """

    source: ClassVar[str] = "innovation scaled by measurement noise, exponentially smoothed"
    signals: ClassVar[tuple[str, ...]] = (
        "magnitude of smoothed scaled innovation",
        "magnitude of scaled innovation",
    )
    numbers: ClassVar[Mapping[str, str]] = RHO
    coupled: ClassVar[bool] = True
    needs_sigma: ClassVar[bool] = True

    rho: float = 0.774

    def __post_init__(self) -> None:
        object.__setattr__(self, "rho", _check_rho(self.rho))

    def initial_memory(self, n_axes: int) -> Memory:
        """Smoothed innovation of each axis, 0."""
        return (0.0,) * n_axes

    def kernel(self, n_axes: int) -> Normalize:
        """See `Normalization.kernel`."""
        sum_of_smoothed = _sum_of_smoothed(n_axes, self.rho)

        def smoothed_magnitude(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            means, errors, new_memory = sum_of_smoothed(innovation, sigma, memory)
            return (math.sqrt(means / n_axes), math.sqrt(errors / n_axes)), new_memory

        return smoothed_magnitude
