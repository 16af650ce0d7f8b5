"""The innovation over the standard deviation of the plot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fuzzytrack.kernels.language import Memory
from fuzzytrack.normalizations.base import Normalization, Normalize, normalizations

__all__ = ["Scale"]


@normalizations.register("scale")
@dataclass(frozen=True, repr=False)
class Scale(Normalization):
    """Innovation over the standard deviation of the plot, and its change since the last update.

    E = e/σ and ΔE = E - E′ (E′ = 0 at first). Unbounded: a rule base takes values outside its
    universe at the nearest end.
    """

    source: ClassVar[str] = "innovation scaled by measurement noise"
    signals: ClassVar[tuple[str, ...]] = ("scaled innovation", "change of scaled innovation")
    needs_sigma: ClassVar[bool] = True

    def initial_memory(self, n_axes: int) -> Memory:
        """Previous scaled innovation, 0."""
        return (0.0,)

    def kernel(self, n_axes: int) -> Normalize:
        """See `Normalization.kernel`."""

        def scale(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[tuple[float, ...], Memory]:
            error = innovation / sigma
            return (error, error - memory[0]), (error,)

        return scale
