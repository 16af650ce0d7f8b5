"""Costs of gains for a target on a circle, and the best gains."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.gains import (
    TrackingCost,
    optimal_on_circle,
)
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._triangle import graded, increasing, label_crests, triangle

__all__ = ["plot_circle_cost", "plot_circle_gains"]

Order = Literal[2, 3]


def plot_circle_cost(
    angular_rate: float = 0.034296296,
    dt: float = 3.0,
    radius: float = 45.0,
    sigma: float = 200**0.5,
    kappa: float = 0.01,
    *,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Cost of tracking a circle over α and β, with its minimum.

    Parameters
    ----------
    angular_rate, dt, radius, sigma, kappa : float
        As for `fuzzytrack.gains.optimal_on_circle`; unless given, the submarine of the report:
        3 knots on the smallest circle.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If an argument is out of its range or there is no minimum.

    Notes
    -----
    Llinas et al. (1998), Figs. 2.12 and 2.13. The contours are at equal ratios above the minimum.
    """
    best = optimal_on_circle(angular_rate, dt, radius, sigma, kappa)
    share = np.linspace(0.0, 1.0, 253)[1:-1]
    alpha, part = np.meshgrid(2 * share, share)
    beta = (4 - 2 * alpha) * part
    cost = TrackingCost(sigma=sigma, kappa=kappa, dt=dt, radius=radius, angular_rate=angular_rate)
    ratio = cost(alpha, beta) / best.cost
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 5.6))
    triangle(plane)
    levels = [1.02, 1.1, 1.25, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0]
    lines = plane.contour(alpha, beta, ratio, levels=levels, colors=graded(levels), linewidths=1.3)
    label_crests(plane, lines, lambda level: f"{level:g}", first=2)
    plane.plot([], [], color="0.4", label=f"cost relative to the least, {best.cost:.4g} m²")
    plane.plot(
        best.alpha,
        best.beta,
        linestyle="none",
        marker="*",
        markersize=12,
        color="black",
        markerfacecolor="white",
        label=f"minimum: α = {best.alpha:.4f}, β = {best.beta:.4f}",
    )
    shared.legend_below(plane)
    return figure, plane


def plot_circle_gains(
    angular_rate: float = 0.034296296,
    dt: float = 3.0,
    radius: float = 45.0,
    kappas: ArrayLike | None = None,
    order: Order = 2,
    *,
    axes: Sequence[Axes] | None = None,
) -> tuple[Figure, NDArray[np.object_]]:
    """Optimal gains for a circle against the weight of the noise, also as a curve in the α-β plane.

    Parameters
    ----------
    angular_rate, dt, radius : float
        As for `fuzzytrack.gains.optimal_on_circle`.
    kappas : array_like, optional
        Weights κσ², m², increasing, > 0.
    order : {2, 3}
        2 for α-β filters, 3 for α-β-γ filters.
    axes : sequence of Axes, optional
        Two axes to draw into.

    Returns
    -------
    figure : Figure
    axes : ndarray of Axes

    Raises
    ------
    ValueError
        If an argument is out of its range.

    Notes
    -----
    Llinas et al. (1998), Figs. 2.14, 2.15 and 2.16 (order 3). A thin line is a minimum that is no
    longer the least cost: it is then cheaper not to follow the circle at all. Further right there
    is no minimum in the interior. The report's limit α = 0.0032, β = 0 does not exist.
    """
    if order not in (2, 3):
        raise ValueError(f"order must be 2 or 3, got {order!r}")
    weights = increasing("kappas", 10 ** np.linspace(-2, 3.6, 29) if kappas is None else kappas)
    rows = np.full((len(weights), 3), np.nan)
    best = np.zeros(len(weights), dtype=bool)
    # Raises an error if something other than the weight is wrong.
    optimal_on_circle(angular_rate, dt, radius, float(weights[0]) ** 0.5, gamma=order == 3)
    for k, weight in enumerate(weights.tolist()):
        try:
            found = optimal_on_circle(angular_rate, dt, radius, weight**0.5, gamma=order == 3)
        except ValueError:  # the minimum has vanished
            continue
        rows[k], best[k] = found.gains, found.is_global
    # Lines have a gap where the best gains jump from some γ to none.
    jumps = np.flatnonzero(np.diff(rows[:, 2] > 0)) + 1
    weights, best = np.insert(weights, jumps, weights[jumps]), np.insert(best, jumps, False)
    rows = np.insert(rows, jumps, np.nan, axis=0)
    # The thick line ends where the minimum is no longer the least cost.
    thick = np.where(best[:, None], rows, np.nan)
    figure, (left, right) = shared.panels("axes", axes, 2, columns=2, size=(5.2, 4.6))
    for number, name in enumerate(("α", "β", "γ")[:order]):
        style: dict[str, Any] = {"color": shared.COLORS[number], "linestyle": shared.STYLES[number]}
        left.plot(weights, rows[:, number], linewidth=0.9, **style)
        left.plot(weights, thick[:, number], linewidth=2.2, label=name, **style)
    left.set(ylim=(0, None), xlabel="weight of the noise κσ² (m²)", ylabel="optimal gains")
    shared.log_axis(left, "x")
    shared.finish(left)
    shared.legend_below(left)
    known = rows[~np.isnan(rows[:, 0])]
    reach = (1.1 * float(known[:, 0].max()), 1.3 * float(known[:, 1].max()))
    triangle(right, limits=(min(2.06, reach[0]), min(4.12, reach[1])))
    right.plot(rows[:, 0], rows[:, 1], color=shared.BLUE, lw=0.9, label="a minimum, not the least")
    right.plot(thick[:, 0], thick[:, 1], color=shared.BLUE, linewidth=2.2, label="optimal gains")
    for weight in (0.1, 1.0, 10.0, 100.0, 1000.0):
        if weights[0] <= weight <= weights[-1]:
            distance = np.abs(np.log(weights / weight))
            near = int(np.argmin(np.where(np.isnan(rows[:, 0]), np.inf, distance)))
            if distance[near] < 0.5 * np.log(10):
                right.plot(*rows[near, :2], marker="o", markersize=4, color=shared.INK)
                right.annotate(
                    f"{weights[near]:.4g} m²",
                    rows[near, :2],
                    (-4, 7),
                    textcoords="offset points",
                    fontsize=9,
                    ha="right",
                )
    shared.legend_below(right)
    return figure, np.array([left, right], dtype=object)
