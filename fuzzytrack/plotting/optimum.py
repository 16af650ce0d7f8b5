"""Best gains for targets on a straight line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.gains import (
    TrackingCost,
    acceleration_index,
    optimal_alpha_beta_gamma,
    optimal_for_acceleration,
    optimal_for_steady_error,
    optimal_for_velocity,
    optimal_gains,
    velocity_index,
)
from fuzzytrack.gains.checks import finite, nonnegative, positive
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._triangle import triangle
from fuzzytrack.plotting.stability import LABELS

__all__ = ["plot_motion_gains", "plot_optimal_curves", "plot_optimal_gains"]

Order = Literal[2, 3]


def plot_optimal_curves(*, ax: Axes | None = None) -> tuple[Figure, Axes]:
    """Curves in the plane of α and β on which optimal gains lie, for any weights.

    Parameters
    ----------
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Notes
    -----
    Llinas et al. (1998), Fig. 2.17, Eqs. 2.98, 2.100 and 2.102. The dots are the indices 0.2, 1 and
    5 of `velocity_index`, `acceleration_index` and `steady_index`.
    """
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 5.8))
    triangle(plane)
    index, dots = np.geomspace(1e-4, 1e4, 401), np.array([0.2, 1.0, 5.0])
    for number, (label, optimal) in enumerate(_STRAIGHT.items()):
        color = shared.COLORS[number]
        plane.plot(
            *optimal(index),
            color=color,
            linestyle=shared.STYLES[number],
            linewidth=1.8,
            label=label,
        )
        plane.plot(*optimal(dots), color=color, linestyle="none", marker="o", markersize=5)
        for value, alpha, beta in zip(dots, *optimal(dots), strict=True):
            plane.annotate(
                f"{value:g}",
                (alpha, beta),
                ((8, -4), (8, 2), (-8, 4))[number],
                textcoords="offset points",
                fontsize=9,
                color=color,
                ha="right" if number == 2 else "left",
                va="center",
            )
    plane.plot([1], [1], color=shared.INK, marker="*", markersize=11, linestyle="none")
    plane.annotate("fastest", (1, 1), (8, 4), textcoords="offset points", fontsize=9)
    shared.legend_below(plane)
    return figure, plane


_STRAIGHT: dict[str, Any] = {
    "transient, constant velocity": optimal_for_velocity,
    "transient, constant acceleration": optimal_for_acceleration,
    "steady lag, constant acceleration": optimal_for_steady_error,
}


def plot_optimal_gains(
    order: Order = 2,
    ratio: float = 1.0,
    *,
    axes: Sequence[Axes] | None = None,
) -> tuple[Figure, NDArray[np.object_]]:
    """Optimal gains on a straight line against the index of the motion.

    Parameters
    ----------
    order : {2, 3}
        2: α and β for a velocity, an acceleration, and the steady lag. 3: α, β and γ for an
        acceleration alone, and with a velocity.
    ratio : float
        For order 3 the index of the velocity in units of that of the acceleration, v/(a T), >= 0.
    axes : sequence of Axes, optional
        Axes to draw into, 3 for order 2, 2 for order 3.

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
    Llinas et al. (1998), Figs. 2.18 and 2.19 (order 3). The indices combine velocity, acceleration,
    sampling time, noise and its weight: `fuzzytrack.gains.velocity_index` and so on. More weight on
    the noise is a smaller index.
    """
    if order not in (2, 3):
        raise ValueError(f"order must be 2 or 3, got {order!r}")
    times = float(nonnegative("ratio", ratio))
    index = np.geomspace(1e-3, 1e2, 201)
    panels: list[tuple[str, str, tuple[Array, ...]]]
    if order == 2:
        names = (
            r"$v\,T^{1.5} / (\sqrt{\kappa}\,\sigma)$",
            r"$a\,T^{2.5} / (\sqrt{\kappa}\,\sigma)$",
            r"$\sqrt{\kappa_s}\,a\,T^2 / (\sqrt{\kappa}\,\sigma)$",
        )
        panels = [
            (title, f"index {name}", optimal(index))
            for name, (title, optimal) in zip(names, _STRAIGHT.items(), strict=True)
        ]
    else:
        label = r"index $a\,T^{2.5} / (\sqrt{\kappa}\,\sigma)$"
        panels = [
            ("constant acceleration", label, optimal_alpha_beta_gamma(0.0, index)),
            (
                f"initial velocity v = {times:g} a T",
                label,
                optimal_alpha_beta_gamma(times * index, index),
            ),
        ]
    count = len(panels)
    figure, grid = shared.panels(
        "axes", axes, count, columns=count, size=(4.2 if count == 3 else 5.0, 4.2)
    )
    for ax, (title, label, gains) in zip(grid, panels, strict=True):
        for number, values in enumerate(gains):
            ax.plot(
                index,
                values,
                color=shared.COLORS[number],
                linestyle=shared.STYLES[number],
                linewidth=1.7,
                label="αβγ"[number],
            )
        ax.set(ylim=(0, None), title=title, xlabel=label, ylabel="optimal gains")
        shared.log_axis(ax, "x")
        shared.finish(ax)
        shared.legend_below(ax)
    return figure, grid


def plot_motion_gains(
    velocities: Sequence[float] = (0.514444, 1.543333, 10.28889),
    accelerations: ArrayLike | None = None,
    dt: float = 3.0,
    sigma: float = 200**0.5,
    kappa: float = 1.0,
    order: Order = 2,
    *,
    axes: Sequence[Axes] | None = None,
) -> tuple[Figure, NDArray[np.object_]]:
    """Optimal gains for targets of some velocities, as their acceleration grows.

    Parameters
    ----------
    velocities : sequence of float
        Initial velocities, m/s, > 0; unless given, 1, 3 and 20 knots.
    accelerations : array_like, optional
        Accelerations, m/s², increasing, of either sign; unless given, -4 to 4 m/s².
    dt, sigma, kappa : float
        Sampling time in s, standard deviation of the noise in m, and weight of the noise in s.
    order : {2, 3}
        2 for α-β filters, 3 for α-β-γ filters.
    axes : sequence of Axes, optional
        Axes to draw into, one for order 2 (the plane of α and β), three for order 3 (a gain each,
        against the acceleration).

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
    Llinas et al. (1998), Figs. 2.20 and 2.21 (order 3). The cost is that of transient and noise.
    Without γ the transient does not include the steady lag: at the smallest acceleration in the
    direction of the velocity, the best α-β filter jumps to one without transient but with a large
    lag. For a decelerating target there is no jump. With γ the signs do not matter.
    """
    if order not in (2, 3):
        raise ValueError(f"order must be 2 or 3, got {order!r}")
    speeds = positive("velocities", velocities).ravel().tolist()
    bent = np.sign(steps := np.linspace(-1, 1, 31)) * steps**2 * 4
    values = finite("accelerations", bent if accelerations is None else accelerations).ravel()
    if not (np.diff(values) > 0).all():
        raise ValueError("accelerations must be increasing")
    rule = optimal_for_velocity(np.geomspace(1e-3, 1e3, 201))
    if order == 2:
        figure, grid = shared.panels("axes", axes, 1, columns=1, size=(6.4, 5.8))
        triangle(grid[0])
        grid[0].plot(*rule, color=shared.GRAY, ls="-.", lw=1.5, label="no acceleration (Eq. 2.98)")
    else:
        figure, grid = shared.panels("axes", axes, 3, columns=3, size=(4.2, 4.2))
    for number, speed in enumerate(speeds):
        color, label = shared.COLORS[number % len(shared.COLORS)], f"v = {speed:.3g} m/s"
        if order == 2:
            _motion_curve(grid[0], speed, values, (dt, sigma, kappa), color, label)
            continue
        gains = optimal_alpha_beta_gamma(
            velocity_index(speed, dt, sigma, kappa), acceleration_index(values, dt, sigma, kappa)
        )
        for ax, row, name in zip(grid, gains, LABELS["gains"], strict=True):
            ax.plot(values, row, color=color, ls=shared.STYLES[number % 4], lw=1.7, label=label)
            ax.set(xlabel="acceleration (m/s²)", ylabel=name, ylim=(0, None))
    for ax in grid:
        if order == 3:
            shared.finish(ax)
        shared.legend_below(ax)
    return figure, grid


def _motion_curve(
    ax: Axes,
    speed: float,
    accelerations: Array,
    setting: tuple[float, float, float],
    color: str,
    label: str,
) -> None:
    """Optimal α and β as the acceleration grows, from none in both directions."""
    dt, sigma, kappa = setting
    start = optimal_for_velocity(velocity_index(speed, dt, sigma, kappa))
    for style, text, chosen in (
        ("--", "decelerating", accelerations[accelerations < 0]),
        ("-", "accelerating", accelerations[accelerations > 0]),
    ):
        pairs = [
            optimal_gains(
                TrackingCost(
                    sigma=sigma, kappa=kappa, dt=dt, velocity=speed, acceleration=acceleration
                )
            ).gains[:2]
            for acceleration in chosen.tolist()
        ]
        if style == "--":  # without a jump, from the circle on
            pairs.append((float(start[0]), float(start[1])))
        ax.plot(
            *np.reshape(pairs, (-1, 2)).T, color=color, ls=style, lw=1.6, label=f"{label}, {text}"
        )
    ax.plot(*start, color=color, linestyle="none", marker="o", markersize=6, zorder=4)
