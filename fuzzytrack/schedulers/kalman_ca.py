"""The Kalman filter of nearly constant acceleration, axis by axis, as a gain scheduler."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fuzzytrack.gains.joseph import NEW, ONE_PLOT, RUNNING, correct_ca, predict_ca
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers
from fuzzytrack.schedulers.kalman_cv import check_parameters

__all__ = ["KalmanCA"]


@schedulers.register("kalman-ca")
@dataclass(frozen=True, repr=False)
class KalmanCA(GainScheduler):
    """Kalman filter of each axis for a target of nearly constant acceleration.

    The acceleration is constant between two times and changes by a random step of standard
    deviation σ_v at each: with G = (T²/2, T, 1), the process noise is Q = GGᵀσ_v². Gains are
    α = K₁, β = K₂T and γ = 2K₃T². Irregular times, missed plots and a noise that varies from plot
    to plot are followed exactly.

    Parameters
    ----------
    sigma_v : float
        Standard deviation of the change of acceleration at a step (m/s²), >= 0.
    acceleration_sigma : float
        Standard deviation of a new track's acceleration (m/s²), >= 0, about 0.
    sigma_w, velocity_sigma : float, optional
        As for `KalmanCV`.

    Raises
    ------
    ValueError
        If a parameter is out of its range.

    Notes
    -----
    Njonjo et al. (2017) compare their filter with it, at σ_w = 1, σ_v² = 0.001 and initial standard
    deviations of 1. At constant T and noise the gains settle at those of `fuzzytrack.gains.kalata`
    of order 3 with λ = σ_v T²/σ_w. Joseph form. The memory is (phase, P₁₁, P₁₂, P₁₃, P₂₂, P₂₃, P₃₃,
    time since the first plot (s)), as for `KalmanCV`.
    """

    source: ClassVar[str] = "Njonjo et al. (2017), the Kalman filter compared with"
    sees_starts = True

    sigma_v: float
    acceleration_sigma: float
    sigma_w: float | None = None
    velocity_sigma: float | None = None

    def __post_init__(self) -> None:
        check_parameters(self, ("sigma_v", "acceleration_sigma"), ("sigma_w", "velocity_sigma"))

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
        return (NEW, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def kernel(self, n_axes: int) -> Kernel:
        """Predict the covariance, take the Kalman gain; see `GainScheduler.kernel`."""
        q = self.sigma_v**2
        fixed = self.sigma_w is not None
        variance = 0.0 if self.sigma_w is None else self.sigma_w**2
        start_phase = ONE_PLOT if self.velocity_sigma is None else RUNNING
        start_22 = 0.0 if self.velocity_sigma is None else self.velocity_sigma**2
        start_33 = self.acceleration_sigma**2

        def kalman_ca(
            innovation: float, change: float, dt: float, sigma: float, memory: Memory
        ) -> tuple[float, float, float, float, Memory]:
            phase, p11, p12, p13, p22, p23, p33, span = memory
            seen = sigma != math.inf
            r = variance if fixed else sigma * sigma
            r = r if seen else 1.0
            span = span + dt

            g = 0.5 * dt * dt
            p11, p12, p13, p22, p23, p33 = predict_ca(p11, p12, p13, p22, p23, p33, dt, g)
            p11 = p11 + q * g * g
            p12 = p12 + q * g * dt
            p13 = p13 + q * g
            p22 = p22 + q * dt * dt
            p23 = p23 + q * dt
            p33 = p33 + q

            s = p11 + r
            unknown = phase == ONE_PLOT
            k1 = 1.0 if unknown else p11 / s
            k2 = 1.0 / span if unknown else p12 / s
            k3 = 0.0 if unknown else p13 / s
            k1 = k1 if seen else 0.0
            k2 = k2 if seen else 0.0
            k3 = k3 if seen else 0.0
            n11, n12, n13, n22, n23, n33 = correct_ca(
                p11, p12, p13, p22, p23, p33, k1, k2, k3, s, r
            )

            new = phase == NEW
            n11 = r if new else n11
            n12 = 0.0 if new else n12
            n13 = 0.0 if new else n13
            n22 = start_22 if new else n22
            n23 = 0.0 if new else n23
            n33 = start_33 if new else n33
            span = 0.0 if new else span
            after = RUNNING if seen else phase
            after = start_phase if new else after
            new_memory = (after, n11, n12, n13, n22, n23, n33, span)
            return k1, k2 * dt, 2.0 * k3 * dt * dt, 1.0, new_memory

        return kalman_ca

    def prediction_variance(self, memory: Any, dt: Any) -> Any:
        """Variance of a predicted position; see `GainScheduler.prediction_variance`."""
        phase, p11, p12, p13, p22, p23, p33, _ = memory
        g = 0.5 * dt * dt
        p11 = predict_ca(p11, p12, p13, p22, p23, p33, dt, g)[0] + self.sigma_v**2 * g * g
        return np.where(phase == RUNNING, p11, np.nan)
