"""Fixed gains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fuzzytrack.gains.checks import finite, stable_gains
from fuzzytrack.schedulers.base import GainScheduler, Kernel, schedulers
from fuzzytrack.schedulers.constant_gains import checked_period, constant_kernel

__all__ = ["FixedGains"]


@schedulers.register("fixed")
@dataclass(frozen=True, repr=False)
class FixedGains(GainScheduler):
    """The same gains at every update, or those of the same filter at the time step of each.

    Parameters
    ----------
    alpha, beta : float
        Position and velocity gains.
    gamma : float
        Acceleration gain, as γ/(2T²) (Llinas, Kalata); 0 gives an α-β filter.
    period : float, optional
        Sampling time to which the gains belong (s). At other time steps the tracker uses the gains
        of the same filter in continuous time, see `fuzzytrack.gains.resampled_gains`. Without it
        the gains are the same whatever the time step.

    Raises
    ------
    ValueError
        If a gain is not finite, or the filter would be unstable: stable are 0 < α < 2, β > 0,
        2α + β < 4 and 0 <= γ < 4αβ/(2 - α). If `period` is not positive, or with it a real pole is
        negative.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.1 to 2.3 and 2.35 to 2.39; stability from Eqs. 2.16 to 2.24 and
    2.52.
    """

    source: ClassVar[str] = "Llinas et al. (1998), Eqs. 2.1-2.3 and 2.35-2.39"

    alpha: float
    beta: float
    gamma: float = 0.0
    period: float | None = None

    def __post_init__(self) -> None:
        for name in ("alpha", "beta", "gamma"):
            object.__setattr__(self, name, float(finite(name, getattr(self, name))))
        stable_gains(*self.gains)
        object.__setattr__(self, "period", checked_period(self.period, self.gains))

    @property
    def gains(self) -> tuple[float, float, float]:
        """α, β, γ."""
        return self.alpha, self.beta, self.gamma

    @property
    def uses_acceleration(self) -> bool:  # type: ignore[override]
        """Whether γ is not 0."""
        return self.gamma != 0.0

    def kernel(self, n_axes: int) -> Kernel:
        """Constant gains; see `GainScheduler.kernel`."""
        return constant_kernel(self.gains, self.period)
