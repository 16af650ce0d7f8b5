"""Where fixed gains are stable: the regions of the α-β plane, and the volume of α, β and γ."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from fuzzytrack.arrays import Array
from fuzzytrack.gains.abc_space import from_abc
from fuzzytrack.gains.stability import critical_curves
from fuzzytrack.plotting import _figures as shared

__all__ = ["plot_stability_regions", "plot_stability_volume"]

Mesh = tuple[Array, Array, Array]
Space = Literal["gains", "abc"]

SPACES = ("gains", "abc")
SURFACES = ("bounds", "critical", "dividing")
LABELS = {
    "gains": ("position gain α", "velocity gain β", "acceleration gain γ"),
    "abc": ("a", "b", "c (third pole at −c)"),
}
# The acceleration gain is steepest near the limit 2 of a or α.
LIMITS = {"gains": ((0, 2), (0, 4), (0, 16)), "abc": ((0, 2), (0, 4), (-1, 1))}


def plot_stability_regions(*, ax: Axes | None = None) -> tuple[Figure, Axes]:
    """Stability triangle of the α-β filter, with its response to a step in each region.

    Parameters
    ----------
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If `ax` is not flat matplotlib Axes.

    Notes
    -----
    Llinas et al. (1998), Fig. 2.2, with its names of the regions. The values of
    `fuzzytrack.gains.region` are those of the legend.
    """
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 6.6))
    alpha = 1.0 - np.linspace(1.0, 0.0, 201) ** 2
    lower, upper = critical_curves(alpha)
    bend = 2.0 - alpha
    regions: list[tuple[Array, Array, Array, str, str, str]] = [
        (alpha, lower, bend, shared.BLUE, "underdamped, real part ≥ 0", "Ia"),
        (alpha, bend, upper, shared.ORANGE, "underdamped, real part < 0", "Ib"),
        (alpha, 0 * alpha, lower, shared.GREEN, "overdamped", "IIa"),
        (alpha, upper, 4 - 2 * alpha, shared.PURPLE, "oscillating at the Nyquist rate", "IIb"),
        (
            np.array([1.0, 2.0]),
            np.zeros(2),
            np.array([2.0, 0.0]),
            "0.6",
            "mixed, poles of both signs",
            "α > 1",
        ),
    ]
    for x, low, high, color, label, name in regions:
        plane.fill_between(
            x,
            low,
            high,
            facecolor=color,
            alpha=0.35,
            edgecolor="none",
            label=f"{name}: {label}",
            zorder=0,
        )
    plane.plot([0, 2, 0, 0], [0, 0, 4, 0], color=shared.INK, lw=1.3, label="edge of stability")
    plane.plot(alpha, lower, color=shared.INK, ls="--", lw=1.2, label="critical damping β₁")
    plane.plot(alpha, upper, color=shared.INK, ls="-.", lw=1.2, label="critical damping β₂")
    plane.plot([0, 1], [2, 1], color=shared.INK, ls=":", lw=1.5, label="β = 2 − α (¼ of the rate)")
    plane.plot([1, 1], [0, 2], color=shared.INK, lw=0.8)
    for right, up, name in (
        (0.3, 0.75, "Ia"),
        (0.3, 2.3, "Ib"),
        (0.82, 0.14, "IIa"),
        (1.3, 0.5, "α > 1"),
        (0.93, 1.82, "IIb"),
    ):
        plane.text(right, up, name, ha="center", va="center", fontsize=11)
    plane.set(
        xlim=(-0.03, 2.06), ylim=(-0.06, 4.12), xlabel=LABELS["gains"][0], ylabel=LABELS["gains"][1]
    )
    plane.spines[["top", "right"]].set_visible(False)
    shared.legend_below(plane)
    return figure, plane


def plot_stability_volume(
    space: Space = "gains",
    surfaces: Literal["bounds", "critical", "dividing"] = "bounds",
    *,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Volume of stable gains of the α-β-γ filter, or the corresponding prism in a, b and c.

    Parameters
    ----------
    space : {"gains", "abc"}
        α, β and γ; or a, b and c, of which a and b are the gains of the α-β filter with the same
        pair of poles and -c is the third pole. See `fuzzytrack.gains.to_abc`.
    surfaces : {"bounds", "critical", "dividing"}
        What to draw inside the edges: the faces; the two surfaces on which the pair of poles is
        critically damped; or those that divide the volume at a = 1 and at b = 2 - a.
    ax : Axes, optional
        Axes to draw into, made with ``projection="3d"``.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If a word is unknown or `ax` is not three-dimensional.

    Notes
    -----
    Llinas et al. (1998), Figs. 2.4 (bounds), 2.5 (bounds, abc), 2.6 (critical) and 2.7 (dividing).
    The volume ends at γ = 0, where it is the triangle of the α-β filter.
    """
    shared.choice("space", space, SPACES)
    shared.choice("surfaces", surfaces, SURFACES)
    figure, (solid,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 5.8), three_d=True)
    handles = []
    for label, color, mesh in _surfaces(surfaces):
        solid.plot_surface(
            *_image(mesh, space),
            color=color,
            alpha=0.45 if surfaces != "bounds" else 0.35,
            linewidth=0.3,
            edgecolor=(0.15, 0.15, 0.15, 0.35),
            rstride=4,
            cstride=4,
            shade=False,
        )
        handles.append(Patch(facecolor=color, alpha=0.5, label=label))
    draw_edges(solid, space)
    finish_space(solid, space)
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    return figure, solid


# ---------------------------------------------------------------- shared with noise surfaces


def draw_edges(ax: Axes, space: str) -> None:
    """Edges of the volume of stable gains."""
    along = np.linspace(0.0, 1.0, 81)
    corners = ((0.0, 0.0), (2.0, 0.0), (0.0, 4.0))
    ends = [
        (a + (d - a) * along, b + (e - b) * along, np.full_like(along, c))
        for (a, b), (d, e) in zip(corners, (*corners[1:], corners[0]), strict=True)
        for c in (-1.0, 1.0)
    ]
    sides = [(np.full_like(along, a), np.full_like(along, b), 2 * along - 1) for a, b in corners]
    for curve in (*ends, *sides):
        ax.plot(*_image(curve, space), color=shared.INK, linewidth=1.1)


def finish_space(ax: Any, space: str) -> None:
    """Labels, limits and viewpoint."""
    x, y, z = LABELS[space]
    ax.set(xlabel=x, ylabel=y, zlabel=z)
    for which, limits in zip("xyz", LIMITS[space], strict=True):
        getattr(ax, f"set_{which}lim")(*limits)
        axis = getattr(ax, f"{which}axis")
        axis.set_ticks(np.linspace(*limits, 5))
        axis.set_major_formatter(shared.PLAIN)
        axis.labelpad = 6
    ax.view_init(elev=22, azim=-52 if space == "abc" else 35)
    # Leaves room for the labels, which matplotlib does not count.
    ax.set_box_aspect((4, 4, 3.4), zoom=0.92)


def _image(mesh: Iterable[Array], space: str) -> Mesh:
    a, b, c = mesh
    return (a, b, c) if space == "abc" else from_abc(a, b, c)


def _surfaces(which: str) -> list[tuple[str, str, Mesh]]:
    """Label, color, and mesh in a, b, c of each surface."""
    share, third = np.meshgrid(np.linspace(0.0, 1.0, 41), np.linspace(-1.0, 1.0, 41))
    zero = np.zeros_like(share)
    if which == "bounds":
        first = 1 + third  # any grid over 0 to 2
        ends = first, (4 - 2 * first) * share
        return [
            ("a = 0: γ = 4αβ/(2 − α)", shared.BLUE, (zero, 4 * share, third)),
            ("2a + b = 4: 2α + β = 4", shared.VERMILION, (2 - 2 * share, 4 * share, third)),
            ("c = −1: γ = 0, the α-β filter", shared.GREEN, (*ends, zero - 1)),
        ]
    if which == "critical":
        a = 1 - (1 - share) ** 2
        lower, upper = critical_curves(a)
        return [
            ("lower critical surface (overdamped below)", shared.GREEN, (a, lower, third)),
            ("upper critical surface", shared.PURPLE, (a, upper, third)),
        ]
    return [
        ("a = 1: real poles of both signs beyond", shared.SKY, (zero + 1, 2 * share, third)),
        ("b = 2 − a: pair at ¼ of the rate", shared.ORANGE, (share, 2 - share, third)),
    ]
