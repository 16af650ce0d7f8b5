"""Fixed gains on the curve of Benedict and Bordner."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.gains import design
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers

__all__ = ["BenedictBordner"]


@schedulers.register("benedict-bordner")
@dataclass(frozen=True, repr=False)
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
