"""What gains do and which are best: noise, lag, circles and straight lines, as curves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.gains import design
from fuzzytrack.gains.abc_space import from_abc
from fuzzytrack.gains.checks import finite, nonnegative, positive
from fuzzytrack.gains.optimal import (
    TrackingCost,
    acceleration_index,
    optimal_alpha_beta_gamma,
    optimal_for_acceleration,
    optimal_for_steady_error,
    optimal_for_velocity,
    optimal_gains,
    optimal_on_circle,
    velocity_index,
)
from fuzzytrack.gains.performance import noise_ratio, steady_error, variance_ratio
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting.stability import LABELS, SPACES, Space, draw_edges, finish_space

__all__ = [
    "plot_circle_cost",
    "plot_circle_gains",
    "plot_motion_gains",
    "plot_noise_against_lag",
    "plot_noise_ratio",
    "plot_noise_surfaces",
    "plot_optimal_curves",
    "plot_optimal_gains",
]

Array = NDArray[np.float64]
Order = Literal[2, 3]

STYLES = ("-", "--", "-.", ":")


# ---------------------------------------------------------------- noise


def plot_noise_ratio(
    levels: Sequence[float] = (0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 50.0),
    of: str = "predicted",
    *,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Curves of constant noise ratio in the plane of α and β.

    Parameters
    ----------
    levels : sequence of float
        Variance ratios ρ², increasing, > 0.
    of : str
        Output whose variance it is, see `fuzzytrack.gains.noise_ratio`.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If levels are not positive and increasing, or `of` names no output.

    Notes
    -----
    Llinas et al. (1998), Fig. 2.10 (predicted).
    """
    values = _increasing("levels", levels)
    share = np.linspace(0.0, 1.0, 303)[1:-1]
    alpha, part = np.meshgrid(2 * share, share**2)
    beta = (4 - 2 * alpha) * part
    ratio = noise_ratio(alpha, beta, of=of)  # type: ignore[arg-type]
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 5.6))
    _triangle(plane)
    lines = plane.contour(
        alpha, beta, np.log(ratio), levels=np.log(values), colors=_graded(values), linewidths=1.5
    )
    _label_crests(plane, lines, lambda level: f"{np.exp(level):.4g}")
    plane.plot([], [], color="0.4", label=f"constant ρ² of the {of} output")
    shared.legend_below(plane)
    return figure, plane


def plot_noise_surfaces(
    levels: Sequence[float] = (1.0, 5.0, 50.0), space: Space = "gains", *, ax: Axes | None = None
) -> tuple[Figure, Axes]:
    """Surfaces of constant noise ratio of the prediction of α-β-γ filters.

    Parameters
    ----------
    levels : sequence of float
        Variance ratios ρ², increasing, > 0.
    space : {"gains", "abc"}
        Axes, see `plot_stability_volume`.
    ax : Axes, optional
        Axes to draw into, made with ``projection="3d"``.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If levels are not positive and increasing, `space` is unknown, or `ax` is flat.

    Notes
    -----
    Llinas et al. (1998), Figs. 2.8 and 2.9 (``levels=[10]``) and 2.11.
    """
    shared.choice("space", space, SPACES)
    values = _increasing("levels", levels)
    figure, (solid,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 5.8), three_d=True)
    handles = []
    for number, level in enumerate(values.tolist()):
        mesh = _noise_surface(level)
        color = shared.COLORS[number % len(shared.COLORS)]
        solid.plot_surface(
            *(mesh if space == "abc" else from_abc(*mesh)),
            color=color,
            alpha=0.7 - 0.4 * number / max(1, len(values) - 1),
            linewidth=0.3,
            edgecolor=(0.15, 0.15, 0.15, 0.35),
            rstride=4,
            cstride=4,
            shade=False,
        )
        handles.append(Patch(facecolor=color, alpha=0.5, label=f"ρ² = {level:g}"))
    draw_edges(solid, space)
    finish_space(solid, space)
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False)
    return figure, solid


def _noise_surface(level: float) -> tuple[Array, Array, Array]:
    """Mesh of a, b and c on which ρ² has a value: for each a and c there is one b, or none."""
    share = np.linspace(0.0, 1.0, 41)
    # Without b, the filter has α and β alone; without a too, ρ² = δ/(2 - δ) with δ = 1 + c.
    delta = (2 * level / (1 + level) * (1 - (1 - share) ** 2) * (1 - 1e-9))[:, None]

    def ratio(a: Array, b: Array) -> Array:
        alpha, beta, gamma = from_abc(a, b, delta - 1)
        return np.asarray(variance_ratio(alpha, beta, gamma))

    def without(a: Array) -> Array:
        alpha, beta = a + delta * (1 - a), a * delta
        u = 4 - 2 * alpha - beta
        return np.asarray((alpha * (2 * alpha + beta) + 2 * beta) / (alpha * u))

    most = _rising_root(without, level, np.full_like(delta, 2.0))
    a = most * np.sin(np.pi / 2 * (1e-4 + (1 - 2e-4) * share)) ** 2
    b = _rising_root(lambda b: ratio(a, b), level, 4 - 2 * a)
    return a, b, np.broadcast_to(delta - 1, a.shape)


def _rising_root(function: Any, level: float, top: Array) -> Array:
    """The x in 0 to `top` up to which a function stays below a level."""
    low, high = np.zeros_like(top), top.copy()
    with np.errstate(all="ignore"):
        for _ in range(50):
            middle = (low + high) / 2
            below = function(middle) < level
            low, high = np.where(below, middle, low), np.where(below, high, middle)
    return low


def plot_noise_against_lag(
    mark: dict[str, tuple[float, float]] | None = None, *, ax: Axes | None = None
) -> tuple[Figure, Axes]:
    """What every choice of gains trades: noise of the prediction against lag in a manoeuvre.

    Parameters
    ----------
    mark : mapping of str to (alpha, beta), optional
        Stable gains to mark, by label.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If gains to mark are not stable.

    Notes
    -----
    The lag is that of Llinas et al. (1998), Eq. 2.82, in units of a T², the noise ratio that of
    Eq. 2.69. No filter lies below the curve of least noise for its lag (their Eq. 2.102).
    """
    points = {
        label: (steady_error(*gains, acceleration=1.0), noise_ratio(*gains))
        for label, gains in (mark or {}).items()
    }
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 5.2))
    xi = 1 - np.geomspace(0.03, 0.999, 201)
    families = {
        "least noise for the lag": optimal_for_steady_error(np.geomspace(1e-6, 30, 201)),
        "Kalata": design.kalata(np.geomspace(1e-3, 30, 201)),
        "Benedict–Bordner": optimal_for_velocity(np.geomspace(1e-3, 30, 201)),
        "critically damped": design.fading_memory(xi),
    }
    for number, (label, (alpha, beta)) in enumerate(families.items()):
        plane.plot(
            steady_error(alpha, beta, acceleration=1.0),
            noise_ratio(alpha, beta),
            color=shared.COLORS[number],
            linestyle=STYLES[number],
            linewidth=1.6,
            label=label,
        )
    for number, (label, point) in enumerate(points.items()):
        plane.plot(
            *point,
            linestyle="none",
            marker="*+x"[number % 3],
            markersize=11,
            color="black",
            markerfacecolor="white",
            label=label,
        )
    plane.set(
        xscale="log",
        yscale="log",
        xlim=(0.5, 300),
        ylim=(0.05, 20),
        xlabel="steady lag behind an acceleration a (a T²)",
        ylabel="variance ratio ρ² of the prediction",
    )
    shared.finish(plane)
    shared.legend_below(plane)
    return figure, plane


# ---------------------------------------------------------------- circles


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
    _triangle(plane)
    levels = [1.02, 1.1, 1.25, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0]
    lines = plane.contour(alpha, beta, ratio, levels=levels, colors=_graded(levels), linewidths=1.3)
    _label_crests(plane, lines, lambda level: f"{level:g}", first=2)
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
    """Optimal gains for a circle against the weight of the noise, and their way in the plane.

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
    is no minimum in the interior. The report's limit α = 0.0032, β = 0 is none.
    """
    if order not in (2, 3):
        raise ValueError(f"order must be 2 or 3, got {order!r}")
    weights = _increasing("kappas", 10 ** np.linspace(-2, 3.6, 29) if kappas is None else kappas)
    rows = np.full((len(weights), 3), np.nan)
    best = np.zeros(len(weights), dtype=bool)
    # Says what is wrong, if it is not the weight.
    optimal_on_circle(angular_rate, dt, radius, float(weights[0]) ** 0.5, gamma=order == 3)
    for k, weight in enumerate(weights.tolist()):
        try:
            found = optimal_on_circle(angular_rate, dt, radius, weight**0.5, gamma=order == 3)
        except ValueError:  # the minimum has vanished
            continue
        rows[k], best[k] = found.gains, found.is_global
    # The thick line ends where the minimum stops to be the least.
    thick = np.where(best[:, None], rows, np.nan)
    figure, (left, right) = shared.panels("axes", axes, 2, columns=2, size=(5.2, 4.6))
    for number, name in enumerate(("α", "β", "γ")[:order]):
        style: dict[str, Any] = {"color": shared.COLORS[number], "linestyle": STYLES[number]}
        left.plot(weights, rows[:, number], linewidth=0.9, **style)
        left.plot(weights, thick[:, number], linewidth=2.2, label=name, **style)
    left.set(
        xscale="log", ylim=(0, None), xlabel="weight of the noise κσ² (m²)", ylabel="optimal gains"
    )
    shared.finish(left)
    shared.legend_below(left)
    _triangle(right, limits=(1.05, 2.1))
    right.plot(rows[:, 0], rows[:, 1], color=shared.BLUE, lw=0.9, label="a minimum, not the least")
    right.plot(thick[:, 0], thick[:, 1], color=shared.BLUE, linewidth=2.2, label="optimal gains")
    for weight in (0.1, 1.0, 10.0, 100.0, 1000.0):
        if weights[0] <= weight <= weights[-1]:
            near = int(np.argmin(np.abs(np.log(weights / weight))))
            if not np.isnan(rows[near, 0]):
                right.plot(*rows[near, :2], marker="o", markersize=4, color=shared.INK)
                right.annotate(
                    f"{weights[near]:.4g} m²",
                    rows[near, :2],
                    (9, -3),
                    textcoords="offset points",
                    fontsize=8,
                    va="center",
                )
    shared.legend_below(right)
    return figure, np.array([left, right], dtype=object)


# ---------------------------------------------------------------- straight lines


def plot_optimal_curves(*, ax: Axes | None = None) -> tuple[Figure, Axes]:
    """Curves in the plane of α and β on which optimal gains lie, whatever the weights.

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
    Llinas et al. (1998), Fig. 2.17, Eqs. 2.98, 2.100 and 2.102. The dots are the indices 0.1, 1 and
    10 of `velocity_index`, `acceleration_index` and `steady_index`.
    """
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 5.8))
    _triangle(plane)
    index, dots = np.geomspace(1e-4, 1e4, 401), np.array([0.1, 1.0, 10.0])
    for number, (label, optimal) in enumerate(_STRAIGHT.items()):
        color = shared.COLORS[number]
        plane.plot(
            *optimal(index), color=color, linestyle=STYLES[number], linewidth=1.8, label=label
        )
        plane.plot(*optimal(dots), color=color, linestyle="none", marker="o", markersize=5)
        for value, alpha, beta in zip(dots, *optimal(dots), strict=True):
            right = number == 0
            plane.annotate(
                f"{value:g}",
                (alpha, beta),
                (7, -3) if right else (-7, 3) if number == 2 else (7, 0),
                textcoords="offset points",
                fontsize=8,
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
    Llinas et al. (1998), Figs. 2.18 and 2.19 (order 3). The indices hold all of velocity,
    acceleration, sampling time, noise and its weight: `fuzzytrack.gains.velocity_index` and so on.
    More weight on the noise is a smaller index.
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
                linestyle=STYLES[number],
                linewidth=1.7,
                label="αβγ"[number],
            )
        ax.set(xscale="log", ylim=(0, None), title=title, xlabel=label, ylabel="optimal gains")
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
    Without γ the transient leaves out the steady lag: with the smallest acceleration in the
    direction of the velocity the best α-β filter jumps to one that has no transient but a great
    lag; a decelerating target knows no jump. With γ neither sign matters.
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
        _triangle(grid[0])
        grid[0].plot(*rule, color=shared.GREY, ls="-.", lw=1.5, label="no acceleration (Eq. 2.98)")
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
            ax.plot(values, row, color=color, ls=STYLES[number % 4], lw=1.7, label=label)
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
        if style == "--":  # without a jump from the circle on
            pairs.append((float(start[0]), float(start[1])))
        ax.plot(
            *np.reshape(pairs, (-1, 2)).T, color=color, ls=style, lw=1.6, label=f"{label}, {text}"
        )
    ax.plot(*start, color=color, linestyle="none", marker="o", markersize=6, zorder=4)


# ---------------------------------------------------------------- shared


def _triangle(ax: Axes, limits: tuple[float, float] = (2.06, 4.12)) -> None:
    """The stability triangle, as a background."""
    ax.fill([0, 2, 0], [0, 0, 4], facecolor="0.97", edgecolor="none", zorder=0)
    ax.plot([0, 2, 0, 0], [0, 0, 4, 0], color=shared.INK, linewidth=1.1, zorder=1)
    ax.set(xlabel=LABELS["gains"][0], ylabel=LABELS["gains"][1])
    ax.set(xlim=(-0.015 * limits[0], limits[0]), ylim=(-0.015 * limits[1], limits[1]))
    ax.spines[["top", "right"]].set_visible(False)


def _graded(levels: Sequence[float] | Array) -> list[Any]:
    """Colours from dark to light, short of the yellow that nobody can read on white."""
    return list(colormaps[shared.COLORMAP](np.linspace(0.0, 0.82, len(levels))))


def _label_crests(ax: Axes, lines: Any, text: Callable[[float], str], first: int = 0) -> None:
    """Label contours at their highest points, where they are apart, from the `first` one on."""
    curves = [path.vertices for path in lines.get_paths()[first:] if len(path.vertices)]
    places = [curve[np.argmax(curve[:, 1])] for curve in curves]
    ax.clabel(lines, lines.levels[first:], fmt=text, fontsize=9, manual=places)


def _increasing(name: str, values: ArrayLike) -> Array:
    array: Array = np.ravel(positive(name, values))
    if not (len(array) and (np.diff(array) > 0).all()):
        raise ValueError(f"{name} must be one or more increasing numbers")
    return array
