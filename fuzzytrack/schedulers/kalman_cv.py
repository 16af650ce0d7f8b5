"""Decoupled Kalman filters as gain schedulers: the covariance is what they remember."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from fuzzytrack.gains.checks import nonnegative, positive
from fuzzytrack.schedulers.base import GainScheduler, Kernel, Memory, schedulers

__all__ = ["KalmanCA", "KalmanCV"]

# What the first number of the memory says about the track.
_NEW, _ONE_PLOT, _RUNNING = 0.0, 1.0, 2.0


def _check(scheduler: GainScheduler, names: tuple[str, ...], optional: tuple[str, ...]) -> None:
    """Turn parameters into floats: those of `names` >= 0, those of `optional` > 0 or None."""
    for name in names:
        value = float(nonnegative(name, getattr(scheduler, name)))
        object.__setattr__(scheduler, name, value)
    for name in optional:
        value = getattr(scheduler, name)
        if value is not None:
            object.__setattr__(scheduler, name, float(positive(name, value)))


@schedulers.register("kalman-cv")
@dataclass(frozen=True)
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
        Standard deviation of all plots (m), > 0. Unless given, each plot brings its own.
    velocity_sigma : float, optional
        Standard deviation of a new track's velocity (m/s), > 0, about 0: for the tracker's start
        ``one-point``. Unless given, nothing is presumed of the velocity: it comes from the first
        two plots, as also with the start ``two-point``, and both starts give the same track.

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
    unknown (P is then what is known apart from it) and 2 from then on.
    """

    source: ClassVar[str] = "Llinas et al. (1998), Kalman filter decoupled by axes"
    sees_every_step = True
    uses_acceleration = False

    sigma_v: float
    sigma_w: float | None = None
    velocity_sigma: float | None = None

    def __post_init__(self) -> None:
        _check(self, ("sigma_v",), ("sigma_w", "velocity_sigma"))

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation: unless `sigma_w` stands for all."""
        return self.sigma_w is None

    def initial_memory(self, n_axes: int) -> Memory:
        """No plot yet."""
        return (_NEW, 0.0, 0.0, 0.0, 0.0)

    def kernel(self, n_axes: int) -> Kernel:
        """Predict the covariance, take the Kalman gain; see `GainScheduler.kernel`."""
        q = self.sigma_v**2
        fixed = self.sigma_w is not None
        variance = 0.0 if self.sigma_w is None else self.sigma_w**2
        start_phase = _ONE_PLOT if self.velocity_sigma is None else _RUNNING
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
            p11 = p11 + dt * (2.0 * p12 + dt * p22) + q * g * g
            p12 = p12 + dt * p22 + q * g * dt
            p22 = p22 + q * dt * dt

            s = p11 + r
            unknown = phase == _ONE_PLOT
            k1 = 1.0 if unknown else p11 / s
            k2 = 1.0 / span if unknown else p12 / s
            k1 = k1 if seen else 0.0
            k2 = k2 if seen else 0.0
            rest = 1.0 - k1
            n11 = rest * rest * p11 + k1 * k1 * r
            n12 = rest * (p12 - k2 * p11) + k1 * k2 * r
            n22 = p22 - k2 * (2.0 * p12 - k2 * s)

            new = phase == _NEW
            n11 = r if new else n11
            n12 = 0.0 if new else n12
            n22 = start_22 if new else n22
            span = 0.0 if new else span
            after = _RUNNING if seen else phase
            after = start_phase if new else after
            return k1, k2 * dt, 0.0, 1.0, (after, n11, n12, n22, span)

        return kalman_cv


@schedulers.register("kalman-ca")
@dataclass(frozen=True)
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
    sees_every_step = True

    sigma_v: float
    acceleration_sigma: float
    sigma_w: float | None = None
    velocity_sigma: float | None = None

    def __post_init__(self) -> None:
        _check(self, ("sigma_v", "acceleration_sigma"), ("sigma_w", "velocity_sigma"))

    @property
    def needs_sigma(self) -> bool:  # type: ignore[override]
        """Whether plots need a standard deviation: unless `sigma_w` stands for all."""
        return self.sigma_w is None

    def initial_memory(self, n_axes: int) -> Memory:
        """No plot yet."""
        return (_NEW, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def kernel(self, n_axes: int) -> Kernel:
        """Predict the covariance, take the Kalman gain; see `GainScheduler.kernel`."""
        q = self.sigma_v**2
        fixed = self.sigma_w is not None
        variance = 0.0 if self.sigma_w is None else self.sigma_w**2
        start_phase = _ONE_PLOT if self.velocity_sigma is None else _RUNNING
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

            # Rows of ΦP, then ΦPΦᵀ + Q.
            g = 0.5 * dt * dt
            a11 = p11 + dt * p12 + g * p13
            a12 = p12 + dt * p22 + g * p23
            a13 = p13 + dt * p23 + g * p33
            a22 = p22 + dt * p23
            a23 = p23 + dt * p33
            p11 = a11 + dt * a12 + g * a13 + q * g * g
            p12 = a12 + dt * a13 + q * g * dt
            p13 = a13 + q * g
            p22 = a22 + dt * a23 + q * dt * dt
            p23 = a23 + q * dt
            p33 = p33 + q

            s = p11 + r
            unknown = phase == _ONE_PLOT
            k1 = 1.0 if unknown else p11 / s
            k2 = 1.0 / span if unknown else p12 / s
            k3 = 0.0 if unknown else p13 / s
            k1 = k1 if seen else 0.0
            k2 = k2 if seen else 0.0
            k3 = k3 if seen else 0.0
            rest = 1.0 - k1
            n11 = rest * rest * p11 + k1 * k1 * r
            n12 = rest * (p12 - k2 * p11) + k1 * k2 * r
            n13 = rest * (p13 - k3 * p11) + k1 * k3 * r
            n22 = p22 - k2 * (2.0 * p12 - k2 * s)
            n23 = p23 - k2 * p13 - k3 * (p12 - k2 * s)
            n33 = p33 - k3 * (2.0 * p13 - k3 * s)

            new = phase == _NEW
            n11 = r if new else n11
            n12 = 0.0 if new else n12
            n13 = 0.0 if new else n13
            n22 = start_22 if new else n22
            n23 = 0.0 if new else n23
            n33 = start_33 if new else n33
            span = 0.0 if new else span
            after = _RUNNING if seen else phase
            after = start_phase if new else after
            new_memory = (after, n11, n12, n13, n22, n23, n33, span)
            return k1, k2 * dt, 2.0 * k3 * dt * dt, 1.0, new_memory

        return kalman_ca
