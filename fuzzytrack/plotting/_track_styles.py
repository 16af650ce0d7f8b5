"""Styles of what is drawn of tracks: one for each meaning, the same in every picture."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from fuzzytrack.plotting import _figures as shared

__all__ = ["STYLES", "darken_plots", "darker", "track_colors"]


def _marks(marker: str, size: float, **more: Any) -> dict[str, Any]:
    return {"linestyle": "none", "marker": marker, "markersize": size, **more}


#: Properties of `matplotlib.lines.Line2D`, by what is drawn.
STYLES: dict[str, dict[str, Any]] = {
    "true": {"color": shared.BLACK, "linewidth": 1.2, "zorder": 2.4},
    "plots": _marks("s", 4.5, markerfacecolor="none", color=shared.GRAY, zorder=1.5),
    "predicted": _marks("x", 4.5, color=shared.VERMILION, zorder=2.6),
    "filtered": {"color": shared.BLUE, "linewidth": 1.2, "zorder": 2.8},
    "coasted": _marks(
        "o", 7.0, markerfacecolor="none", markeredgewidth=1.3, color=shared.ORANGE, zorder=3.0
    ),
    "rejected": _marks(
        "s", 6.5, markerfacecolor="none", markeredgewidth=1.4, color=shared.PURPLE, zorder=1.6
    ),
    "start": _marks(
        "D", 6.0, markerfacecolor="white", markeredgewidth=1.3, color=shared.INK, zorder=3.2
    ),
    "end": _marks("D", 6.0, color=shared.INK, zorder=3.1),
    "sensor": _marks("^", 8.0, color=shared.INK, zorder=3.3),
    "alpha": {"color": shared.GREEN, "linewidth": 1.3},
    "beta": {"color": shared.PURPLE, "linewidth": 1.3},
    "gamma": {"color": shared.SKY, "linewidth": 1.3},
    "maneuver": {"color": "0.91", "linewidth": 0.0, "zorder": 0.1},
}

# Steps along the colormap from track to track: those of the golden ratio keep neighbors apart.
_GOLDEN = 0.5 * (5**0.5 - 1)


def track_colors(count: int) -> list[Any]:
    """A color of its own for each track: blue for one, those of `_figures.COLORS` for a few."""
    if count <= len(shared.COLORS):
        return list(shared.COLORS[:count])
    places = 0.05 + 0.9 * (_GOLDEN * np.arange(count) % 1.0)
    # Yellow and light green are too pale for lines on white.
    rgba = mpl.colormaps["turbo"](places) * [0.85, 0.85, 0.85, 1.0]
    return [tuple(color) for color in rgba.tolist()]


def darker(color: Any) -> tuple[float, ...]:
    """A color for letters on white, which need more contrast than lines."""
    return tuple(0.7 * part for part in mpl.colors.to_rgb(color))


def darken_plots(ax: Axes) -> None:
    """Plots in the legend as they are where there are few: faint ones could not be seen in it."""
    legend = ax.get_legend()
    assert legend is not None
    for text, handle in zip(legend.get_texts(), legend.legend_handles, strict=True):
        if text.get_text() == "plots" and isinstance(handle, Line2D):
            handle.set(markersize=STYLES["plots"]["markersize"], markeredgewidth=1.0, alpha=1.0)
