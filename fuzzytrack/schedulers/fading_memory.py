"""Gains of a filter with fading memory, by its one parameter ξ."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fuzzytrack.gains import convert_gamma, design
from fuzzytrack.schedulers.base import GainScheduler, Kernel, schedulers
from fuzzytrack.schedulers.constant_gains import checked_period, constant_kernel

__all__ = ["FadingMemory"]

CONVENTIONS = ("mahafza", "njonjo")


@schedulers.register("fading-memory")
@dataclass(frozen=True, repr=False)
class FadingMemory(GainScheduler):
    """Fixed gains of the α-β-γ filter that forgets old plots by a factor of ξ a step.

    α = 1 - ξ³, β = 3(1 - ξ)²(1 + ξ)/2 and γ = (1 - ξ)³, or of order 2 α = 1 - ξ² and β = (1 - ξ)².

    Parameters
    ----------
    xi : float
        Damping parameter, 0 <= ξ < 1: with 0 the filter follows the last plots, with
        values near 1 it smooths more.
    convention : {"mahafza", "njonjo"}
        What γ = (1 - ξ)³ means. ``mahafza``: acceleration gain γ/T², the least-squares filter with
        all poles at ξ. ``njonjo``: acceleration gain 2γ/T², as Njonjo et al. print it; it is
        stable, but not critically damped.
    order : {2, 3}
        2: α-β. 3: α-β-γ.
    period : float, optional
        Sampling time to which the gains belong (s). At other time steps the tracker uses the gains
        of the same filter in continuous time, see `fuzzytrack.gains.resampled_gains`. Without it
        the gains are the same whatever the time step.

    Raises
    ------
    ValueError
        If a parameter is out of range or unknown, or with a `period` a real pole is negative.

    Notes
    -----
    Njonjo et al. (2017), Eqs. 4 to 9, with ξ = 0.64 for their warship; see
    `fuzzytrack.gains.fading_memory`.

    Examples
    --------
    >>> from fuzzytrack.schedulers.fading_memory import FadingMemory
    >>> print("{:.6f} {:.6f} {:.6f}".format(*FadingMemory(0.64, "njonjo").gains))
    0.737856 0.318816 0.186624
    """

    source: ClassVar[str] = "Njonjo et al. (2017), Eqs. 7-9"

    xi: float
    convention: str = "mahafza"
    order: int = 3
    period: float | None = None

    def __post_init__(self) -> None:
        if self.convention not in CONVENTIONS:
            raise ValueError(
                f"convention must be one of {', '.join(CONVENTIONS)}, got {self.convention!r}"
            )
        if self.order not in (2, 3):
            raise ValueError(f"order must be 2 or 3, got {self.order!r}")
        design.fading_memory(self.xi)
        object.__setattr__(self, "xi", float(self.xi))
        object.__setattr__(self, "period", checked_period(self.period, self.gains))

    @property
    def gains(self) -> tuple[float, float, float]:
        """α, β, γ, the last in the convention of acceleration gain γ/(2T²)."""
        if self.order == 2:
            alpha, beta = map(float, design.fading_memory(self.xi))
            return alpha, beta, 0.0
        alpha, beta, gamma = map(float, design.fading_memory(self.xi, 3))
        printed = float(convert_gamma(gamma, "llinas", "mahafza"))
        return alpha, beta, float(convert_gamma(printed, self.convention, "llinas"))

    def kernel(self, n_axes: int) -> Kernel:
        """Constant gains; see `GainScheduler.kernel`."""
        return constant_kernel(self.gains, self.period)
