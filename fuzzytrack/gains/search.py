"""Gains that minimize any cost, searched among stable gains within bounds only."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import inside, stable_gains
from fuzzytrack.gains.cost import Optimum, TrackingCost

__all__ = ["Region", "Search", "optimal_gains"]


Cost = Callable[..., Any]

NAMES = ("alpha", "beta", "gamma")
LIMIT = 22.0  # of a logit: a share of 3e-10 at either end


def optimal_gains(
    cost: Cost,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    gamma: bool = False,
    start: Sequence[float] | None = None,
) -> Optimum:
    """Stable gains that minimize any cost.

    A search on a grid over all stable gains within the bounds, then downhill from the best few of
    its minima. The cost is called only with stable gains within the bounds.

    Parameters
    ----------
    cost : callable
        ``cost(alpha, beta)``, or ``cost(alpha, beta, gamma)`` if `gamma` is true: called with
        numbers, returns a number (not finite to exclude these gains). `TrackingCost` is the usual
        one.
    bounds : mapping, optional
        Lowest and highest value for any of ``"alpha"``, ``"beta"``, ``"gamma"``; equal ones fix
        the gain.
    gamma : bool
        Whether to search for an alpha-beta-gamma filter.
    start : sequence of float, optional
        Stable gains as a further start of the search downhill.

    Returns
    -------
    Optimum
        Gains, their cost, and which of them are at a bound.

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
    region = Region(bounds or {}, gamma)
    starts = [] if start is None else [region.shares(start)]
    search = Search(cost, region)
    found = [search.descend(begin, 0.3) for begin in [*starts, *search.grid_minima(4)]]
    if not found:
        raise ValueError("cost must be finite for some stable gains within the bounds")
    optimum, attained = min(found, key=lambda candidate: candidate[0].cost)
    if not attained:
        raise ValueError(
            "cost must have a minimum among stable gains; this one falls to the edge of stability, "
            f"toward alpha={optimum.alpha:.3g}, beta={optimum.beta:.3g}, "
            f"gamma={optimum.gamma:.3g}: bound the gains"
        )
    return optimum


class Region:
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


class Search:
    """Local minima of a cost over a region."""

    def __init__(self, cost: Cost, region: Region, finer: int = 1) -> None:
        self.cost, self.region, self.finer = cost, region, finer

    def grid_minima(self, most: int, border: bool = True) -> list[Array]:
        """Starting points: the least minima on a grid, those on its border if wished."""
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
        for _ in range(8):  # a simplex can collapse: restart where it stopped
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
        """Set gains that are at a bound to it exactly; return whether the minimum is attained."""
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
        # The arithmetic of `inside`, for numbers: called thousands of times.
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
