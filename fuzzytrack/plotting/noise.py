"""Noise in the outputs of filters, over their gains."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from fuzzytrack.arrays import Array
from fuzzytrack.gains import (
    design,
    optimal_for_steady_error,
    optimal_for_velocity,
)
from fuzzytrack.gains.abc_space import from_abc
from fuzzytrack.gains.performance import noise_ratio, steady_error, variance_ratio
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._triangle import graded, increasing, label_crests, triangle
from fuzzytrack.plotting.stability import SPACES, Space, draw_edges, finish_space

__all__ = ["plot_noise_against_lag", "plot_noise_ratio", "plot_noise_surfaces"]


def plot_noise_ratio(
    levels: Sequence[float] = (0.5, 1.0, 2.0, 5.0, 10.0, 50.0),
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
    values = increasing("levels", levels)
    share = np.linspace(0.0, 1.0, 303)[1:-1]
    alpha, part = np.meshgrid(2 * share, share**2)
    beta = (4 - 2 * alpha) * part
    ratio = noise_ratio(alpha, beta, of=of)  # type: ignore[arg-type]
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 5.6))
    triangle(plane)
    lines = plane.contour(
        alpha, beta, np.log(ratio), levels=np.log(values), colors=graded(values), linewidths=1.5
    )
    label_crests(plane, lines, lambda level: f"{np.exp(level):.4g}")
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
    values = increasing("levels", levels)
    figure, (solid,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 5.8), three_d=True)
    # Smaller surfaces are inside of larger ones, and would be hidden by them.
    solid.computed_zorder = False
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
            zorder=len(values) - number,
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
    """Trade-off of all gains between noise of the prediction and lag in a maneuver.

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
            linestyle=shared.STYLES[number],
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
        xlim=(0.5, 300),
        ylim=(0.05, 20),
        xlabel="steady lag behind an acceleration a (a T²)",
        ylabel="variance ratio ρ² of the prediction",
    )
    shared.log_axis(plane, "x", "y")
    shared.finish(plane)
    shared.legend_below(plane)
    return figure, plane
