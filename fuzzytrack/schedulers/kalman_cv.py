"""The Kalman filter of nearly constant velocity, axis by axis, as a gain scheduler."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fuzzytrack.gains.checks import nonnegative_deviation, positive_deviation
from fuzzytrack.gains.joseph import NEW, ONE_PLOT, RUNNING, correct_cv, predict_cv
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers

__all__ = ["KalmanCV"]


def check_parameters(
    scheduler: GainScheduler, names: tuple[str, ...], optional: tuple[str, ...]
) -> None:
    """Turn parameters into floats: those of `names` >= 0, those of `optional` > 0 or None."""
    for name in names:
        value = float(nonnegative_deviation(name, getattr(scheduler, name)))
        object.__setattr__(scheduler, name, value)
    for name in optional:
        value = getattr(scheduler, name)
        if value is not None:
            object.__setattr__(scheduler, name, float(positive_deviation(name, value)))


@schedulers.register("kalman-cv")
@dataclass(frozen=True, repr=False)
class KalmanCV(GainScheduler):
    """Kalman filter of each axis for a target of nearly constant velocity.

    Between two times the target has a constant acceleration, drawn anew for each step with standard
    deviation σ_v: with G = (T²/2, T), the process noise is Q = GGᵀσ_v². Gains are α = K₁ and
    β = K₂T. Irregular times, missed plots and a noise that varies from plot to plot are followed
    exactly.

    Parameters
    ----------
    sigma_v : float
        Standard deviation of the acceleration (m/s²), >= 0.
    sigma_w : float, optional
        Standard deviation of all plots (m), > 0. Without it, that of each plot is used.
    velocity_sigma : float, optional
        Standard deviation of a new track's velocity (m/s), > 0, about 0: for the tracker's start
        ``one-point``. Without it nothing is assumed about the velocity: it comes from the first two
        plots, as with the start ``two-point``, and both starts give the same track.

    Raises
    ------
    ValueError
        If a parameter is out of its range.

    Notes
    -----
    Llinas et al. (1998), section 5.2, tracker 5, with the variance of each scan (section 4.1.2).
    At constant T and noise the gains settle at those of `fuzzytrack.gains.kalata` with
    λ = σ_v T²/σ_w. Joseph form.
    The memory is (phase, P₁₁, P₁₂, P₂₂, time since the first plot (s)), with P the covariance of
    the filtered position and velocity, and a phase of 0 before the first plot, 1 while velocity is
    unknown (P is then the part that is known) and 2 from then on.
    """

    source: ClassVar[str] = "Llinas et al. (1998), Kalman filter decoupled by axes"
    sees_starts = True
    uses_acceleration = False

    sigma_v: float
    sigma_w: float | None = None
    velocity_sigma: float | None = None

    def __post_init__(self) -> None:
        check_parameters(self, ("sigma_v",), ("sigma_w", "velocity_sigma"))

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation: unless `sigma_w` stands for all."""
        return self.sigma_w is None

    @property
    def variance_start(self) -> str | None:  # type: ignore[override]
        """Start after which the covariance is that of the track: with `velocity_sigma`, one."""
        return None if self.velocity_sigma is None else "one-point"

    def initial_memory(self, n_axes: int) -> Memory:
        """No plot yet."""
        return (NEW, 0.0, 0.0, 0.0, 0.0)

    def kernel(self, n_axes: int) -> Kernel:
        """Predict the covariance, take the Kalman gain; see `GainScheduler.kernel`."""
        q = self.sigma_v**2
        fixed = self.sigma_w is not None
        variance = 0.0 if self.sigma_w is None else self.sigma_w**2
        start_phase = ONE_PLOT if self.velocity_sigma is None else RUNNING
        start_22 = 0.0 if self.velocity_sigma is None else self.velocity_sigma**2

        def kalman_cv(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            phase, p11, p12, p22, span = memory
            seen = sigma != math.inf
            r = variance if fixed else sigma * sigma
            r = r if seen else 1.0
            span = span + dt

            g = 0.5 * dt * dt
            p11, p12, p22 = predict_cv(p11, p12, p22, dt, g, q)

            s = p11 + r
            unknown = phase == ONE_PLOT
            k1 = 1.0 if unknown else p11 / s
            k2 = 1.0 / span if unknown else p12 / s
            k1 = k1 if seen else 0.0
            k2 = k2 if seen else 0.0
            n11, n12, n22 = correct_cv(p11, p12, p22, k1, k2, s, r)

            new = phase == NEW
            n11 = r if new else n11
            n12 = 0.0 if new else n12
            n22 = start_22 if new else n22
            span = 0.0 if new else span
            after = RUNNING if seen else phase
            after = start_phase if new else after
            return k1, k2 * dt, 0.0, 1.0, (after, n11, n12, n22, span)

        return kalman_cv

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of a predicted position; see `GainScheduler.prediction_variance`."""
        phase, p11, p12, p22, _ = memory
        p11, _, _ = predict_cv(p11, p12, p22, dt, 0.5 * dt * dt, self.sigma_v**2)
        return np.where(phase == RUNNING, p11, np.nan)
