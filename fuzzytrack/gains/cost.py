"""Weighted cost of gains: noise passed on against errors of a moving target (Eq. 2.92)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite, nonnegative, positive, stable_gains
from fuzzytrack.gains.performance import (
    squared_distance,
    straight_cost,
    variance_ratio,
)

__all__ = ["Optimum", "TrackingCost"]


Cost = Callable[..., Any]


@dataclass(frozen=True, kw_only=True)
class TrackingCost:
    """Weighted sum of the costs of noise and motion, as a function of the gains.

    f = transient J + steady e² + circle d² + kappa σ² ρ², where J is the `transient_cost` of the
    straight line with `velocity` and `acceleration`, e the `steady_error` under `acceleration`
    and `jerk`, d the `circular_error` and ρ² the `noise_ratio` of the prediction.

    Parameters
    ----------
    sigma : float
        Standard deviation of the observation noise, m, >= 0.
    dt : float
        Sampling time, s, > 0.
    velocity, acceleration, jerk : float
        Motion of the target on a straight line, m/s, m/s², m/s³.
    radius, angular_rate : float
        Its motion on a circle, m and rad/s.
    kappa, transient, steady, circle : float
        Weights, >= 0. The transient cost has the unit m² s, the others m².

    Raises
    ------
    ValueError
        If a parameter is out of its range; when called, if gains are not stable.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.92 to 2.95. With an acceleration and without γ, the transient
    cost leaves out the steady lag. For small positive accelerations it is then least where β
    cancels the transient, although the lag is large there: set a weight `steady`.

    Examples
    --------
    >>> cost = TrackingCost(sigma=10, dt=2, velocity=3)
    >>> print(f"{cost(0.5, 0.2):.3f}")
    457.143
    """

    sigma: float
    dt: float = 1.0
    velocity: float = 0.0
    acceleration: float = 0.0
    jerk: float = 0.0
    radius: float = 0.0
    angular_rate: float = 0.0
    kappa: float = 1.0
    transient: float = 1.0
    steady: float = 0.0
    circle: float = 1.0

    def __post_init__(self) -> None:
        signed = ("velocity", "acceleration", "jerk", "angular_rate")
        for field in fields(self):
            check = (
                positive if field.name == "dt" else finite if field.name in signed else nonnegative
            )
            if check(field.name, getattr(self, field.name)).ndim:
                raise ValueError(f"{field.name} must be one number, got an array")

    def __call__(self, alpha: ArrayLike, beta: ArrayLike, gamma: ArrayLike = 0.0) -> Array:
        """Cost of stable gains, which broadcast."""
        a, b, g = stable_gains(alpha, beta, gamma)
        cost = np.empty(a.shape)
        with_gamma = g > 0
        for chosen, third in ((~with_gamma, None), (with_gamma, g[with_gamma])):
            cost[chosen] = self._of(a[chosen], b[chosen], third)
        return cost[()]

    def _of(self, alpha: Any, beta: Any, gamma: Any = None) -> Any:
        """Cost of gains that are known to be stable; filters have no γ where it is None."""
        g = 0.0 if gamma is None else gamma
        total = self.kappa * self.sigma**2 * variance_ratio(alpha, beta, g)
        if self.transient and (self.velocity or self.acceleration):
            total = total + self.transient * straight_cost(
                alpha, beta, gamma, self.dt, self.velocity, self.acceleration
            )
        if self.steady and gamma is not None:
            total = total + self.steady * (2 * self.jerk * self.dt**3 / gamma) ** 2
        elif self.steady:
            lag = np.inf if self.jerk else self.acceleration * self.dt**2 / beta
            total = total + self.steady * lag**2
        half = self.angular_rate * self.dt / 2
        if self.circle and self.radius and half:
            away = squared_distance(alpha, beta, g, np.sin(half), np.cos(half))
            total = total + self.circle * self.radius**2 * away
        return total


@dataclass(frozen=True)
class Optimum:
    """Gains found by a search.

    Attributes
    ----------
    alpha, beta, gamma : float
        The gains, dimensionless.
    cost : float
        Their cost, in the unit of the cost function.
    at_bound : tuple of str
        Names of the gains that are at a bound; also ``"gamma"`` where the best filter has γ = 0.
    """

    alpha: float
    beta: float
    gamma: float
    cost: float
    at_bound: tuple[str, ...] = ()

    @property
    def gains(self) -> tuple[float, float, float]:
        """The three gains."""
        return self.alpha, self.beta, self.gamma
