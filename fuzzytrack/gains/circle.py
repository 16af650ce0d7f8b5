"""Best gains for a target on a circle (Llinas et al. 1998, section 2.4.1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.gains.checks import finite, number, positive
from fuzzytrack.gains.cost import TrackingCost
from fuzzytrack.gains.performance import (
    circular_error,
    noise_ratio,
)
from fuzzytrack.gains.search import Region, Search

__all__ = ["CircleOptimum", "optimal_on_circle"]


@dataclass(frozen=True)
class CircleOptimum:
    """Optimal gains for a circle, and whether other gains cost less.

    Attributes
    ----------
    alpha, beta, gamma : float
        The gains, dimensionless: the interior minimum of the cost.
    cost : float
        Its value d² + κ σ² ρ², m².
    error : float
        Steady distance d from the target, m.
    noise_ratio : float
        Variance ratio ρ² of the prediction, dimensionless.
    edge_cost : float
        Least cost on the edge β = 0, where a filter no longer follows the target, m².
    """

    alpha: float
    beta: float
    gamma: float
    cost: float
    error: float
    noise_ratio: float
    edge_cost: float

    @property
    def gains(self) -> tuple[float, float, float]:
        """The three gains."""
        return self.alpha, self.beta, self.gamma

    @property
    def is_global(self) -> bool:
        """Whether no other gains cost less, including those on the edge of stability."""
        return self.cost <= self.edge_cost


def optimal_on_circle(
    angular_rate: float,
    dt: float,
    radius: float,
    sigma: float,
    kappa: float = 1.0,
    gamma: bool = False,
) -> CircleOptimum:
    """Gains that minimize d² + κ σ² ρ² for a target that flies a circle.

    Parameters
    ----------
    angular_rate : float
        Turn rate, rad/s, not 0; less than half a turn in a sampling time.
    dt : float
        Sampling time T, s, > 0.
    radius : float
        Radius of the circle, m, > 0.
    sigma : float
        Standard deviation of the observation noise, m, > 0.
    kappa : float
        Weight of the noise, dimensionless, > 0.
    gamma : bool
        Whether the filter has an acceleration.

    Returns
    -------
    CircleOptimum
        The minimum in the interior of the stability region. Compare its `is_global`: with a large
        weight of the noise, it costs less not to follow the circle.

    Raises
    ------
    ValueError
        If an argument is out of its range, or if there is no minimum in the interior because the
        noise weighs too much or the circle is sampled too coarsely.

    Notes
    -----
    Llinas et al. (1998), section 2.4.1. As the weight of the noise grows, the optimum does not tend
    to α = 0.0032, β = 0. On a circle the error of a filter that does not follow the target is
    bounded (by the radius at α = β = 0). So from some weight on, the edge costs less than the
    interior minimum, and the global optimum jumps there; from a larger weight on, there is no
    interior minimum.

    Examples
    --------
    >>> best = optimal_on_circle(0.034296296, 3, 45, sigma=200**0.5, kappa=0.01)
    >>> print(f"{best.alpha:.4f} {best.beta:.4f} {best.cost:.4f} {best.is_global}")
    0.4517 0.4522 3.6762 True
    """
    rate = abs(number("angular_rate", finite("angular_rate", angular_rate)))
    t = number("dt", positive("dt", dt))
    r = number("radius", positive("radius", radius))
    weight = number("kappa", positive("kappa", kappa)) * (
        number("sigma", positive("sigma", sigma)) ** 2
    )
    if not 0 < rate * t < np.pi:
        raise ValueError(
            f"angular_rate must not be 0, and its size less than pi/dt = {np.pi / t:g} rad/s; "
            f"got {angular_rate:g}"
        )
    cost = TrackingCost(sigma=1.0, kappa=weight, dt=t, radius=r, angular_rate=rate)
    region = Region({}, gamma)
    search = Search(cost, region, finer=2 if gamma else 4)
    # Where the cost falls toward the border of the grid, there may be a minimum beyond it, with
    # hardly any noise.
    begins = search.grid_minima(4, border=False) + search.grid_minima(4)
    found = [search.descend(begin, 0.05) for begin in begins]
    interior = [optimum for optimum, attained in found if attained]
    if not interior:
        raise ValueError(
            f"kappa must leave a minimum in the interior of the stability region; at "
            f"kappa sigma² = {weight:g} m² the noise outweighs a circle of radius {r:g} m: the "
            "cost falls to the edge beta = 0"
        )
    best = min(interior, key=lambda optimum: optimum.cost)
    return CircleOptimum(
        *best.gains,
        cost=best.cost,
        error=float(circular_error(*best.gains, rate, t, r)),
        noise_ratio=float(noise_ratio(*best.gains)),
        edge_cost=_edge_cost(rate * t, r, weight),
    )


def _edge_cost(theta: float, radius: float, weight: float) -> float:
    """Infimum over α of the cost for β → 0, where the noise ratio tends to α/(2 - α)."""
    from scipy.optimize import minimize_scalar

    sine, cosine = np.sin(theta / 2), np.cos(theta / 2)

    def cost(alpha: Any) -> Any:
        error = 2 * radius * sine / np.hypot((2 - alpha) * sine, alpha * cosine)  # Eq. 2.77
        return error**2 + weight * alpha / (2 - alpha)

    alphas = np.linspace(0, 2, 2001)[:-1]
    values = cost(alphas)
    at = int(np.argmin(values))
    if at == 0:
        return float(values[0])
    around = (alphas[at - 1], min(alphas[at] + alphas[1], 2 - 1e-9))
    refined = minimize_scalar(cost, bounds=around, method="bounded", options={"xatol": 1e-12})
    return float(min(refined.fun, values[at]))
