"""Fixed gains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fuzzytrack.gains.checks import finite, stable_gains
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers

__all__ = ["FixedGains"]


@schedulers.register("fixed")
@dataclass(frozen=True, repr=False)
class FixedGains(GainScheduler):
    """The same gains at every update.

    Parameters
    ----------
    alpha, beta : float
        Position and velocity gains.
    gamma : float
        Acceleration gain, as γ/(2T²) (Llinas, Kalata); 0 gives an α-β filter.

    Raises
    ------
    ValueError
        If a gain is not finite, or the filter would be unstable: stable are 0 < α < 2, β > 0,
        2α + β < 4 and 0 <= γ < 4αβ/(2 - α).

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.1 to 2.3 and 2.35 to 2.39; stability from Eqs. 2.16 to 2.24 and
    2.52.
    """

    source: ClassVar[str] = "Llinas et al. (1998), Eqs. 2.1-2.3 and 2.35-2.39"

    alpha: float
    beta: float
    gamma: float = 0.0

    def __post_init__(self) -> None:
        for name in ("alpha", "beta", "gamma"):
            object.__setattr__(self, name, float(finite(name, getattr(self, name))))
        stable_gains(self.alpha, self.beta, self.gamma)

    @property
    def uses_acceleration(self) -> bool:  # type: ignore[override]
        """Whether γ is not 0."""
        return self.gamma != 0.0

    def kernel(self, n_axes: int) -> Kernel:
        """Constant gains; see `GainScheduler.kernel`."""
        alpha, beta, gamma = self.alpha, self.beta, self.gamma

        def fixed(
            innovation: Any, change: Any, dt: float, sigma: Any, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            return alpha, beta, gamma, 1.0, memory

        return fixed
