"""Lines of several trackers: how each looks, how many are drawn, and on what scale."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from fuzzytrack.arrays import Array
from fuzzytrack.plotting import _figures as shared

__all__ = ["draw_rest", "scale_axis", "tracker_look", "with_a_line"]

# Trackers up to which each has a line.
_LINES = 6
# Curves that differ by more than this factor are drawn on a logarithmic scale.
_APART = 30.0


def tracker_look(number: int) -> dict[str, Any]:
    """Color and dashes of a tracker, by its place: the same in every picture."""
    return {
        "color": shared.COLORS[number % len(shared.COLORS)],
        "linestyle": shared.STYLES[number % len(shared.STYLES)],
    }


def with_a_line(errors: Sequence[Array]) -> list[int]:
    """Places of the trackers that are drawn as lines, in their order.

    All if they are few; otherwise the first, and those with the smallest median errors: so many
    that one more can stand for the rest.

    Parameters
    ----------
    errors : sequence of ndarray
        Errors of each, NaN where there is none.
    """
    if len(errors) <= _LINES:
        return list(range(len(errors)))
    middles = [float(np.nanmedian(e)) if np.isfinite(e).any() else np.inf for e in errors[1:]]
    best = np.argsort(middles, kind="stable")[: _LINES - 2] + 1
    return [0, *sorted(best.tolist())]


def draw_rest(ax: Axes, time: Array, errors: Sequence[Array]) -> None:
    """Draw the median and the quartiles of trackers that have no line of their own.

    Parameters
    ----------
    time : ndarray, shape (n_steps,)
    errors : sequence of ndarray, shape (n_steps,)
        None, one or more.
    """
    if not errors:
        return
    together = np.array(errors)
    known = np.isfinite(together).any(axis=0)
    low, median, high = np.nanquantile(together[:, known], [0.25, 0.5, 0.75], axis=0)
    label = f"{len(errors)} more: median and quartiles"
    ax.plot(time[known], median, color=shared.GRAY, linewidth=1.2, label=label, zorder=1.9)
    ax.fill_between(time[known], low, high, color=shared.GRAY, alpha=0.25, linewidth=0, zorder=1.8)


def scale_axis(ax: Axes, which: str, curves: Sequence[Array]) -> None:
    """Linear from zero; logarithmic where the medians of curves are far apart."""
    middles = [float(np.median(curve[curve > 0])) for curve in curves if (curve > 0).any()]
    if middles and max(middles) > _APART * min(middles):
        shared.log_axis(ax, which)
    else:
        high = getattr(ax.dataLim, f"{which}1")
        getattr(ax, f"set_{which}lim")(0.0, 1.05 * high if middles else None)
