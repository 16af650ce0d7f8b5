"""Gains that minimise a cost: closed forms for the classical costs, a search for any other.

The costs weigh the noise that a filter passes on against its errors when the target moves
(Llinas et al. 1998, Eqs. 2.92 to 2.106). For a straight line each has one dimensionless index, as
Kalata's gains have: the optimal gains are functions of the index alone. `velocity_index`,
`acceleration_index` and `steady_index` make it from quantities with units.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.gains.checks import finite, inside, nonnegative, positive, stable_gains
from fuzzytrack.gains.performance import (
    circular_error,
    noise_ratio,
    squared_distance,
    straight_cost,
    variance_ratio,
)

__all__ = [
    "CircleOptimum",
    "Optimum",
    "TrackingCost",
    "acceleration_index",
    "optimal_alpha_beta_gamma",
    "optimal_for_acceleration",
    "optimal_for_steady_error",
    "optimal_for_velocity",
    "optimal_gains",
    "optimal_on_circle",
    "steady_index",
    "velocity_index",
]

Array = NDArray[np.float64]

Cost = Callable[..., Any]


# ---------------------------------------------------------------- indices


def velocity_index(
    velocity: ArrayLike, dt: ArrayLike, sigma: ArrayLike, kappa: ArrayLike = 1.0
) -> Array:
    """Index abs(v) T^1.5 / (√κ σ) of the cost J + κ σ² ρ² at constant velocity.

    Parameters
    ----------
    velocity : array_like
        Velocity of the target, m/s.
    dt : array_like
        Sampling time T, s, > 0.
    sigma : array_like
        Standard deviation of the observation noise, m, > 0.
    kappa : array_like
        Weight of the noise that the prediction passes on, s, > 0.

    Returns
    -------
    ndarray
        Dimensionless, >= 0, of the broadcast shape.

    Raises
    ------
    ValueError
        If an argument is out of its range.
    """
    return _index(np.abs(finite("velocity", velocity)), 1.5, dt, sigma, kappa)


def acceleration_index(
    acceleration: ArrayLike, dt: ArrayLike, sigma: ArrayLike, kappa: ArrayLike = 1.0
) -> Array:
    """Index abs(a) T^2.5 / (√κ σ) of the cost J + κ σ² ρ² at constant acceleration.

    Parameters
    ----------
    acceleration : array_like
        Acceleration of the target, m/s².
    dt, sigma, kappa : array_like
        As for `velocity_index`.

    Returns
    -------
    ndarray
        Dimensionless, >= 0, of the broadcast shape.

    Raises
    ------
    ValueError
        If an argument is out of its range.
    """
    return _index(np.abs(finite("acceleration", acceleration)), 2.5, dt, sigma, kappa)


def steady_index(
    acceleration: ArrayLike,
    dt: ArrayLike,
    sigma: ArrayLike,
    kappa: ArrayLike = 1.0,
    kappa_steady: ArrayLike = 1.0,
) -> Array:
    """Index √κₛ abs(a) T² / (√κ σ) of the cost κₛ e² + κ σ² ρ², where e is the lag a T²/β.

    Parameters
    ----------
    acceleration : array_like
        Acceleration of the target, m/s²: on a circle of radius R, about R ω².
    dt, sigma, kappa : array_like
        As for `velocity_index`, but `kappa` has the unit of `kappa_steady`.
    kappa_steady : array_like
        Weight κₛ of the squared lag, > 0.

    Returns
    -------
    ndarray
        Dimensionless, >= 0, of the broadcast shape.

    Raises
    ------
    ValueError
        If an argument is out of its range.
    """
    lag = np.abs(finite("acceleration", acceleration))
    return _index(lag * np.sqrt(positive("kappa_steady", kappa_steady)), 2.0, dt, sigma, kappa)


def _index(motion: Array, power: float, dt: ArrayLike, sigma: ArrayLike, kappa: ArrayLike) -> Array:
    scale = np.sqrt(positive("kappa", kappa)) * positive("sigma", sigma)
    return np.asarray(motion * positive("dt", dt) ** power / scale)[()]


# ---------------------------------------------------------------- closed forms


def optimal_for_velocity(index: ArrayLike) -> tuple[Array, Array]:
    """Gains of an alpha-beta filter for a target that starts to move with constant velocity.

    They minimise J + κ σ² ρ², where J is the transient cost and ρ² the noise ratio of the
    prediction.

    Parameters
    ----------
    index : array_like
        `velocity_index`, dimensionless, > 0.

    Returns
    -------
    alpha, beta : ndarray
        Gains, dimensionless, of the shape of `index`. They satisfy the Benedict-Bordner relation
        β = α²/(2 - α).

    Raises
    ------
    ValueError
        If `index` is not positive and finite.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.95 to 2.99, solved: on the curve β = index √(1 - α).

    Examples
    --------
    >>> print("{:.4f} {:.4f}".format(*optimal_for_velocity(1.0)))
    0.7691 0.4805
    """
    i = positive("index", index)
    excess, apart = _sum_of_roots(i)
    s = 2 / (2 + excess + apart)
    alpha = np.asarray((1 + s) * (excess + apart) / (2 + excess + apart))
    return alpha[()], np.asarray(i * s)[()]


def optimal_for_acceleration(index: ArrayLike) -> tuple[Array, Array]:
    """Gains of an alpha-beta filter for a target that starts to accelerate from rest.

    They minimise J + κ σ² ρ², where J is the transient cost about the steady lag and ρ² the noise
    ratio of the prediction.

    Parameters
    ----------
    index : array_like
        `acceleration_index`, dimensionless, > 0.

    Returns
    -------
    alpha, beta : ndarray
        Gains, dimensionless, of the shape of `index`; β grows with the index from 0 to 3, while α
        grows to 30 - 12√6 = 0.606 and returns to 1/2.

    Raises
    ------
    ValueError
        If `index` is not positive and finite.

    Notes
    -----
    Llinas et al. (1998), Eqs. 2.100 and 2.101, with the missing T⁵. Eq. 2.100 is one curve,
    α = (√(β² + 144β) - 5β)/12.

    Examples
    --------
    >>> print("{:.4f} {:.4f}".format(*optimal_for_acceleration(0.5)))
    0.5416 0.6719
    """
    target = positive("index", index) ** 2

    def along(t: Array) -> tuple[Array, Array, Array]:
        r = np.sqrt(3) * (t / (1 + t))  # √β
        root = np.sqrt(r * r + 144)
        g = (root - 5 * r) / 12  # α/√β
        h = (r / (root + 12) - 5) / 12  # (g - 1)/r
        room = 3 * (1 + 2 * t) / (1 + t) ** 2  # 3 - β
        u = 32 * room / (24 - r * r + r * root)  # 4 - 2α - β
        return r, g, -4 * r**6 * (4 * h * (g + 1) + 4 * g + r) / (h * (g + 1) * u * u)

    r, g, _ = along(_bisect(lambda t: along(t)[2] < target, target.shape))
    return (r * g)[()], (r * r)[()]


def optimal_for_steady_error(index: ArrayLike) -> tuple[Array, Array]:
    """Gains of an alpha-beta filter for a target that accelerates steadily.

    They minimise κₛ e² + κ σ² ρ², where e = a T²/β is the steady lag and ρ² the noise ratio of
    the prediction.

    Parameters
    ----------
    index : array_like
        `steady_index`, dimensionless, > 0.

    Returns
    -------
    alpha, beta : ndarray
        Gains, dimensionless, of the shape of `index`, on the curve α = √β - β/2.

    Raises
    ------
    ValueError
        If `index` is not positive and finite.

    Notes
    -----
    Llinas et al. (1998), Eq. 2.102; the second condition, 2q⁵/(2 - q)³ = index² with q = √β,
    stands in for Eq. 2.103, which only repeats the first.

    Examples
    --------
    >>> print("{:.4f} {:.4f}".format(*optimal_for_steady_error(1.0)))
    0.4963 0.8363
    """
    target = positive("index", index) ** 2

    def q(t: Array) -> Array:
        return 2 * (t / (1 + t))

    # With q = 2t/(1 + t), 2 - q is 2/(1 + t).
    t = _bisect(lambda t: q(t) ** 5 * (1 + t) ** 3 / 4 < target, target.shape)
    return (q(t) / (1 + t))[()], (q(t) ** 2)[()]


def optimal_alpha_beta_gamma(
    velocity_index: ArrayLike, acceleration_index: ArrayLike
) -> tuple[Array, Array, Array]:
    """Gains of an alpha-beta-gamma filter for a target that starts to move and to accelerate.

    They minimise J + κ σ² ρ², where J is the transient cost and ρ² the noise ratio of the
    prediction.

    Parameters
    ----------
    velocity_index, acceleration_index : array_like
        The indices of the same names, dimensionless, >= 0 and not both 0; they broadcast.

    Returns
    -------
    alpha, beta, gamma : ndarray
        Gains, dimensionless, of the broadcast shape. Without acceleration γ is 0 and the others
        are those of `optimal_for_velocity`; without velocity they are Kalata's, for the tracking
        index `acceleration_index`.

    Raises
    ------
    ValueError
        If an index is negative or not finite, or both are 0.

    Notes
    -----
    The optimum satisfies Lv²(1-α) = β² - αγ, La²(1-α) = γ²/4 and β(2-α) = α² + αγ/4, of which
    Llinas et al. (1998) give the last (Eq. 2.105); their Eq. 2.106 is the edge of stability and
    never an optimum. For large La the three have unstable solutions too. With s = √(1 - α) and
    X = s + 1/s, the stable one is the only root X > 2 of 2(X² - X√(16 + Lv²) + 4) = La √(X² - 4)
    that leaves β = s(2X - √(16 + Lv²)) positive.

    Examples
    --------
    >>> print("{:.4f} {:.4f} {:.4f}".format(*optimal_alpha_beta_gamma(1.0, 1.0)))
    0.8874 0.8416 0.6712
    """
    lv, la = np.broadcast_arrays(
        nonnegative("velocity_index", velocity_index),
        nonnegative("acceleration_index", acceleration_index),
    )
    if ((lv == 0) & (la == 0)).any():
        raise ValueError("velocity_index and acceleration_index must not both be 0")

    excess, _ = _sum_of_roots(lv)

    def apart(t: Array) -> Array:
        return np.sqrt((t + excess) * (t + excess + 4))  # 1/s - s

    # X = s + 1/s = 2 + excess + t turns the three equations into one that rises with t > 0.
    t = _bisect(lambda t: 2 * t * (t + lv) < la * apart(t), lv.shape)
    double = 2 + excess + t + apart(t)
    s = 2 / double
    alpha = (1 + s) * (t + excess + apart(t)) / double
    return np.asarray(alpha)[()], np.asarray((lv + 2 * t) * s)[()], np.asarray(2 * la * s)[()]


def _sum_of_roots(index: Array) -> tuple[Array, Array]:
    """Of s = √(1 - α) at constant velocity: s + 1/s - 2 and 1/s - s."""
    root = np.sqrt(index * index + 16)
    return (index + index * index / (root + 4)) / 2, np.sqrt(index * (index + root) / 2)


def _bisect(early: Callable[[Array], NDArray[np.bool_]], shape: tuple[int, ...]) -> Array:
    """The t > 0 up to which `early` holds, sought on a logarithmic scale."""
    low, high = np.full(shape, -100.0), np.full(shape, 100.0)
    for _ in range(61):  # 200/2⁶¹ lies below the spacing of the numbers
        middle = (low + high) / 2
        before = early(np.exp(middle))
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return np.asarray(np.exp((low + high) / 2))


# ---------------------------------------------------------------- any cost


@dataclass(frozen=True, kw_only=True)
class TrackingCost:
    """Weighted sum of what noise and motion cost; call it with gains.

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
    cancels the transient and the lag is great: give `steady` a weight.

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
        """Cost of gains that are known to be stable: of filters without γ where that is None."""
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
        What they cost, in the unit of the cost.
    at_bound : tuple of str
        Gains that a bound holds; ``"gamma"`` too where the best filter has none.
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


def optimal_gains(
    cost: Cost,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    gamma: bool = False,
    start: Sequence[float] | None = None,
) -> Optimum:
    """Stable gains that minimise any cost.

    A search on a grid over all stable gains within the bounds, then downhill from the best few
    of its minima. Every candidate is stable and within the bounds, so the cost is asked nothing
    else.

    Parameters
    ----------
    cost : callable
        ``cost(alpha, beta)``, or ``cost(alpha, beta, gamma)`` if `gamma` is true: called with
        numbers, returns a number (not finite where it does not want the gains). `TrackingCost`
        makes the usual ones.
    bounds : mapping, optional
        Lowest and highest value for any of ``"alpha"``, ``"beta"``, ``"gamma"``; equal ones fix
        the gain.
    gamma : bool
        Whether to search for an alpha-beta-gamma filter.
    start : sequence of float, optional
        Stable gains from which to go downhill too.

    Returns
    -------
    Optimum
        Gains, their cost, and the bounds that hold them.

    Raises
    ------
    ValueError
        If the bounds leave no stable gains, if `start` is not stable or outside the bounds, or
        if the cost has no minimum because it falls all the way to the edge of stability.

    Notes
    -----
    The search runs in the logits of shares: of α in its range, of β in what α leaves of the
    stability region, of γ in what both leave. Costs of this kind are smooth there, also where
    gains are small.

    Examples
    --------
    >>> best = optimal_gains(TrackingCost(sigma=1, velocity=1))
    >>> print(f"{best.alpha:.5f} {best.beta:.5f}")
    0.76909 0.48053
    """
    region = _Region(bounds or {}, gamma)
    starts = [] if start is None else [region.shares(start)]
    search = _Search(cost, region)
    found = [search.descend(begin, 0.3) for begin in [*starts, *search.grid_minima(4)]]
    if not found:
        raise ValueError("cost must be finite for some stable gains within the bounds")
    optimum, attained = min(found, key=lambda candidate: candidate[0].cost)
    if not attained:
        raise ValueError(
            "cost must have a minimum among stable gains; this one falls to the edge of stability, "
            f"towards alpha={optimum.alpha:.3g}, beta={optimum.beta:.3g}, "
            f"gamma={optimum.gamma:.3g}: bound the gains"
        )
    return optimum


@dataclass(frozen=True)
class CircleOptimum:
    """Gains for a circle, and whether anything is better.

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
        """Whether no gains at all cost less, those on the edge of stability included."""
        return self.cost <= self.edge_cost


def optimal_on_circle(
    angular_rate: float,
    dt: float,
    radius: float,
    sigma: float,
    kappa: float = 1.0,
    gamma: bool = False,
) -> CircleOptimum:
    """Gains that minimise d² + κ σ² ρ² for a target that flies a circle.

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
        The minimum in the interior of the stability region. Compare its `is_global`: when noise
        weighs much, it is cheaper to give the circle up.

    Raises
    ------
    ValueError
        If an argument is out of its range, or if there is no minimum in the interior because the
        noise weighs too much or the circle is sampled too coarsely.

    Notes
    -----
    Llinas et al. (1998), section 2.4.1. The optimum does not glide to α = 0.0032, β = 0 as the
    weight of the noise grows. On a circle the error of a filter that does not follow is bounded
    (by the radius at α = β = 0), so the interior minimum is first overtaken by the edge, a jump
    of the global optimum, and later it vanishes altogether.

    Examples
    --------
    >>> best = optimal_on_circle(0.034296296, 3, 45, sigma=200**0.5, kappa=0.01)
    >>> print(f"{best.alpha:.4f} {best.beta:.4f} {best.cost:.4f} {best.is_global}")
    0.4517 0.4522 3.6762 True
    """
    rate = abs(_number("angular_rate", finite("angular_rate", angular_rate)))
    t = _number("dt", positive("dt", dt))
    r = _number("radius", positive("radius", radius))
    weight = _number("kappa", positive("kappa", kappa)) * (
        _number("sigma", positive("sigma", sigma)) ** 2
    )
    if not 0 < rate * t < np.pi:
        raise ValueError(
            f"angular_rate must not be 0, and its size less than pi/dt = {np.pi / t:g} rad/s; "
            f"got {angular_rate:g}"
        )
    cost = TrackingCost(sigma=1.0, kappa=weight, dt=t, radius=r, angular_rate=rate)
    region = _Region({}, gamma)
    search = _Search(cost, region, finer=2 if gamma else 4)
    # Where the grid falls to its border there may be a minimum beyond, with hardly any noise.
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


# ---------------------------------------------------------------- search

NAMES = ("alpha", "beta", "gamma")
LIMIT = 22.0  # of a logit: a share of 3e-10 at either end


class _Region:
    """Stable gains within bounds, as the image of a cube of logits."""

    def __init__(self, bounds: Mapping[str, tuple[float, float]], gamma: bool) -> None:
        self.size = 3 if gamma else 2
        names = NAMES[: self.size]
        unknown = [name for name in bounds if name not in names]
        if unknown:
            raise ValueError(
                f"bounds must be for {', '.join(names)}; got {', '.join(map(repr, unknown))}"
            )
        self.bounds: list[tuple[float, float]] = []
        for name in NAMES:
            low, high = bounds.get(name, (0.0, np.inf))
            if not low <= high:
                raise ValueError(f"bounds of {name} must be low <= high, got ({low:g}, {high:g})")
            self.bounds.append((max(0.0, low), high))
        self.lower, self.upper = self._alpha()
        if not (self.lower <= self.upper and min(self.upper, self.bounds[1][1]) > 0):
            raise ValueError(
                "bounds must leave stable gains: 2 alpha + beta < 4, "
                f"gamma < 4 alpha beta / (2 - alpha); got {dict(bounds)}"
            )

    def _alpha(self) -> tuple[float, float]:
        """Range of α for which the bounds leave anything of the others."""
        (low, high), (beta, top), (gamma, _) = self.bounds
        low = max(low, gamma / 8)
        if gamma > 0:
            low = max(low, 2 * gamma / (4 * min(top, 4.0) + gamma))
        return low, min(high, 2.0, (4 - beta) / 2)

    def gains(self, logits: Array) -> tuple[Array, ...]:
        """Gains for logits of shape (size, ...); shares of -inf and inf are the bounds."""
        with np.errstate(over="ignore"):
            share = 1 / (1 + np.exp(-logits))
        alpha = self.lower + (self.upper - self.lower) * share[0]
        _, (low, high), (least, most) = self.bounds
        with np.errstate(divide="ignore", invalid="ignore"):
            bottom = np.fmax(low, least * (2 - alpha) / (4 * alpha))
            beta = bottom + (np.minimum(high, 4 - 2 * alpha) - bottom) * share[1]
            top = np.fmin(most, 4 * alpha * beta / (2 - alpha))
        if self.size == 2:
            return alpha, beta
        return alpha, beta, least + (top - least) * share[2]

    def shares(self, start: Sequence[float]) -> Array:
        """Logits of given gains."""
        given = np.asarray(start, dtype=np.float64)
        if given.shape != (self.size,):
            raise ValueError(f"start must be {self.size} gains, got {start!r}")
        stable_gains(*given)
        logits = np.zeros(self.size)
        for k in range(self.size):
            logits[k] = -np.inf
            low = self.gains(logits)[k]
            logits[k] = np.inf
            high = self.gains(logits)[k]
            if not low <= given[k] <= high:
                raise ValueError(f"start must be within the bounds, got {NAMES[k]}={given[k]:g}")
            with np.errstate(divide="ignore", invalid="ignore"):
                logit = np.log((given[k] - low) / (high - given[k]))
            logits[k] = 0.0 if np.isnan(logit) else np.clip(logit, -LIMIT + 1, LIMIT - 1)
        return logits


class _Search:
    """Local minima of a cost over a region."""

    def __init__(self, cost: Cost, region: _Region, finer: int = 1) -> None:
        self.cost, self.region, self.finer = cost, region, finer

    def grid_minima(self, most: int, border: bool = True) -> list[Array]:
        """Where to begin: the least minima on a grid, those on its border if wished."""
        from scipy.ndimage import minimum_filter

        # Small gains want a logarithmic mesh; β is about half the square of α.
        counts = (16, 18, 8) if self.region.size == 3 else (32, 36)
        ends = ((-9.0, 6.0), (-15.0, 6.0), (-10.0, 4.0))
        axes = [
            np.linspace(*end, count * self.finer) for count, end in zip(counts, ends, strict=False)
        ]
        logits = np.stack(np.meshgrid(*axes, indexing="ij"))
        values = self._values(logits)
        low = np.isfinite(values) & (values == minimum_filter(values, 3, mode="nearest"))
        if not border:
            inner = np.zeros_like(low)
            inner[(slice(1, -1),) * low.ndim] = True
            low &= inner
        order = np.argsort(values[low], kind="stable")[:most]
        return list(logits[:, low].T[order])

    def descend(self, start: Array, size: float) -> tuple[Optimum, bool]:
        """The minimum downhill from a start, and whether it is attained by stable gains."""
        from scipy.optimize import minimize

        best, level = start, self._value(start)
        scale = abs(level) if np.isfinite(level) else 1.0
        for _ in range(8):  # a simplex can collapse on its way: begin anew where it stopped
            simplex = np.vstack([best, best + size * np.eye(best.size)])
            result = minimize(
                self._value,
                best,
                method="Nelder-Mead",
                bounds=[(-LIMIT, LIMIT)] * best.size,
                options={
                    "initial_simplex": np.clip(simplex, -LIMIT, LIMIT),
                    "xatol": 1e-8,
                    "fatol": 1e-15 * scale,
                    "maxiter": 600,
                },
            )
            gained, size = level - result.fun, 0.02
            if gained > 0:
                best, level = np.asarray(result.x), float(result.fun)
            if not gained > 1e-13 * scale:
                break
        return self._settle(best, level)

    def _settle(self, logits: Array, level: float) -> tuple[Optimum, bool]:
        """Put gains that a bound holds onto it; tell whether the minimum is attained."""
        held: list[str] = []
        attained = np.isfinite(level)
        for k in range(self.region.size):
            near = np.copysign(LIMIT, logits[k])
            for limit in (near, -near):
                pushed = logits.copy()
                pushed[k] += np.copysign(0.05, limit)
                if not self._value(pushed) <= level + 1e-12 * abs(level):
                    continue  # uphill on this side
                pushed[k] = np.copysign(np.inf, limit)
                snapped = self._value(pushed)
                if snapped <= level + 1e-6 * abs(level):
                    held.append(NAMES[k])
                    logits, level = pushed, snapped
                else:
                    attained = False
                break
        gains = [float(gain) for gain in self.region.gains(logits)]
        a, b, g = gains if len(gains) == 3 else (*gains, 0.0)
        return Optimum(a, b, g, level, tuple(held)), bool(attained)

    def _value(self, logits: Array) -> float:
        """Cost of one set of gains; infinite where there is none."""
        gains = [float(gain) for gain in self.region.gains(logits)]
        a, b, g = gains if len(gains) == 3 else (*gains, 0.0)
        # The arithmetic of `inside`, for numbers: they come by the thousand.
        if not (a > 0 and b > 0 and 4 - 2 * a - b > 0 and 0 <= g * (2 - a) < 4 * a * b):
            return np.inf
        if isinstance(self.cost, TrackingCost):
            value = float(self.cost._of(a, b, g or None))
        else:
            value = float(self.cost(*gains))
        return value if np.isfinite(value) else np.inf

    def _values(self, logits: Array) -> Array:
        """Costs of a grid."""
        if not isinstance(self.cost, TrackingCost):
            flat = logits.reshape(self.region.size, -1).T
            return np.array([self._value(each) for each in flat]).reshape(logits.shape[1:])
        a, b, *g = self.region.gains(logits)
        good = inside(a, b, g[0] if g else np.zeros(a.shape))
        values = np.full(a.shape, np.inf)
        third = g[0][good] if g else None
        values[good] = self.cost._of(a[good], b[good], third)
        return np.where(np.isfinite(values), values, np.inf)


def _number(name: str, array: Array) -> float:
    if array.ndim:
        raise ValueError(f"{name} must be one number, got an array of shape {array.shape}")
    return float(array)
