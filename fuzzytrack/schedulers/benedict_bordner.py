"""Fixed gains on the curve of Benedict and Bordner."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fuzzytrack.gains import design
from fuzzytrack.schedulers.base import GainScheduler, Kernel, schedulers
from fuzzytrack.schedulers.constant_gains import checked_period, constant_kernel

__all__ = ["BenedictBordner"]


@schedulers.register("benedict-bordner")
@dataclass(frozen=True, repr=False)
class BenedictBordner(GainScheduler):
    """Fixed gains with β = α²/(2 - α): method M1 of Al-Wagih & Abdulla.

    Parameters
    ----------
    alpha : float
        Position gain, 0 < α < 4 - 2√2 = 1.1716. The authors use 0.05 or 0.01.
    period : float, optional
        Sampling time to which the gains belong (s). At other time steps the tracker uses the gains
        of the same filter in continuous time, see `fuzzytrack.gains.resampled_gains`. Without it
        the gains are the same whatever the time step.

    Raises
    ------
    ValueError
        If `alpha` is out of range (with a `period` it is at most 1), or `period` is not positive.

    Notes
    -----
    Al-Wagih & Abdulla, Eqs. 23a and 23b; Llinas et al. (1998), Eq. 2.98.
    """

    source: ClassVar[str] = "Al-Wagih & Abdulla, M1, Eqs. 23a-23b; Benedict & Bordner (1962)"
    uses_acceleration = False

    alpha: float
    period: float | None = None

    def __post_init__(self) -> None:
        design.benedict_bordner(self.alpha)
        object.__setattr__(self, "alpha", float(self.alpha))
        gains = (self.alpha, self.beta, 0.0)
        object.__setattr__(self, "period", checked_period(self.period, gains))

    @property
    def beta(self) -> float:
        """Velocity gain."""
        return float(design.benedict_bordner(self.alpha))

    def kernel(self, n_axes: int) -> Kernel:
        """Constant gains; see `GainScheduler.kernel`."""
        return constant_kernel((self.alpha, self.beta, 0.0), self.period)
