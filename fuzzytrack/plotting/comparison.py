"""Numbers of trackers side by side: points with intervals, for categories that have no order."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import blended_transform_factory
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.plotting import _figures as shared

__all__ = ["plot_comparison", "plot_estimates"]

# Part of a row that its points are spread over.
SPREAD = 0.7
# Letters of a name.
LONGEST = 40
# Points that differ by more than this factor are drawn on a logarithmic scale.
APART = 30.0


def plot_comparison(
    values: Mapping[str, ArrayLike],
    intervals: Mapping[str, tuple[ArrayLike, ArrayLike]] | None = None,
    categories: Sequence[str] | None = None,
    *,
    reference: Mapping[str, float] | None = None,
    what: str = "RMSE of prediction",
    unit: str = "m",
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Numbers of trackers as points with intervals, one row for each tracker or category.

    Parameters
    ----------
    values : mapping of str to array_like, shape (n_categories,)
        Numbers of each tracker, by label; NaN where there is none. One number each without
        `categories`.
    intervals : mapping of str to (low, high), optional
        Limits of the numbers of a tracker, each shaped as its values.
    categories : sequence of str, optional
        Names of what the trackers are compared in, such as scenarios: a row each, with the points
        of all trackers. Without them, a row for each tracker.
    reference : mapping of str to float, optional
        Numbers to compare with, by label: a line each, such as the error of the plots.
    what, unit : str
        The quantity and its unit, for the label.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If there is no tracker, shapes do not fit, or an interval has the label of no tracker.

    Notes
    -----
    Points are not joined, since there is nothing between two categories. In rows of trackers the
    name of the least number is bold. The scale begins at zero where no number is negative; it is
    logarithmic where numbers are far apart.
    """
    if not isinstance(values, Mapping) or not values:
        raise ValueError("values: must be a mapping from labels to arrays, at least one")
    count = 1 if categories is None else len(categories)
    points = {label: _fitting(f"values: {label!r}", v, count) for label, v in values.items()}
    limits = {}
    for label, pair in (intervals or {}).items():
        if label not in points:
            raise ValueError(f"intervals: unknown {label!r}; one of {', '.join(points)}")
        limits[label] = [_fitting(f"intervals: {label!r}", side, count) for side in pair]
    names = list(points) if categories is None else list(categories)
    height = 0.9 + (0.32 if categories is None else 0.16 * len(points) + 0.2) * len(names)
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, height))
    for number, (label, row) in enumerate(points.items()):
        shift = SPREAD * ((number + 0.5) / len(points) - 0.5) if categories is not None else number
        places = np.arange(count) + shift
        color = shared.COLORS[number % len(shared.COLORS)]
        marker = shared.MARKERS[number % len(shared.MARKERS)]
        if label in limits:
            plane.hlines(places, *limits[label], color=color, linewidth=1.6, zorder=2)
        plane.plot(
            row, places, color=color, marker=marker, markersize=6, linestyle="none", label=label
        )
    for label, value in (reference or {}).items():
        _draw_reference(plane, label, value)
    _scale(plane, np.concatenate([*points.values(), list((reference or {}).values())]))
    plane.set_yticks(range(len(names)), list(map(_short, names)))
    if categories is None:
        _mark_least(plane, [float(row[0]) for row in points.values()])
    plane.set_ylim(len(names) - 0.5, -0.5)
    plane.tick_params(axis="y", length=0)
    plane.set_xlabel(f"{what} ({unit})" if unit else what)
    shared.finish(plane)
    plane.grid(visible=False, axis="y")
    for edge in range(1, len(names)):
        plane.axhline(edge - 0.5, color="0.9", linewidth=0.8, zorder=0)
    if categories is not None:
        shared.legend_below(plane)
    return figure, plane


def plot_estimates(
    names: Sequence[str],
    values: ArrayLike,
    errors: ArrayLike,
    *,
    reference: Mapping[str, float] | None = None,
    what: str = "RMSE of prediction",
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Estimates for trackers (m), with two standard errors to either side.

    Parameters
    ----------
    names : sequence of str
        The trackers.
    values, errors : array_like, shape (n_trackers,)
        Estimates and their standard errors (m).
    reference, what, ax
        As for `plot_comparison`.

    Returns
    -------
    figure : Figure
    ax : Axes
    """
    middle, reach = np.asarray(values, np.float64), 2 * np.asarray(errors, np.float64)
    sides = zip(middle - reach, middle + reach, strict=True)
    return plot_comparison(
        dict(zip(names, middle, strict=True)),
        dict(zip(names, sides, strict=True)),
        reference=reference,
        what=what,
        ax=ax,
    )


def _draw_reference(ax: Axes, label: str, value: float) -> None:
    """A line to compare points with, named above the axes."""
    ax.axvline(value, color=shared.GRAY, linestyle="--", linewidth=1.2, zorder=1)
    ax.text(
        value,
        1.01,
        label,
        transform=blended_transform_factory(ax.transData, ax.transAxes),
        ha="center",
        va="bottom",
        fontsize=9,
        color="0.3",
    )


def _short(name: str) -> str:
    """Name that fits beside the axes; its dollars begin no formula, escaped already or not."""
    cut = name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"
    return re.sub(r"(?<!\\)\$", r"\\$", cut)


def _mark_least(ax: Axes, values: Sequence[float]) -> None:
    """Bold name of the row with the least value; none if only one is known."""
    known = [value for value in values if np.isfinite(value)]
    if len(known) > 1:
        ax.get_yticklabels()[values.index(min(known))].set_fontweight("bold")


def _fitting(name: str, values: ArrayLike, count: int) -> Array:
    """Copy of `values` with NaN for whatever cannot be drawn; a number is an array of one."""
    array = np.asarray(values, dtype=np.float64)
    array = array.reshape(1) if array.ndim == 0 and count == 1 else array
    if array.shape != (count,):
        raise ValueError(f"{name}: needs shape ({count},), got {array.shape}")
    return np.where(np.isfinite(array), array, np.nan)


def _scale(ax: Axes, values: Array) -> None:
    known = values[np.isfinite(values)]
    if not len(known) or known.min() < 0:
        return
    if known.min() > 0 and known.max() > APART * known.min():
        shared.log_axis(ax, "x")
    else:
        ax.set_xlim(left=0.0)
