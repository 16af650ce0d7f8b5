"""Errors of several trackers beside one another, as points with their uncertainty."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fuzzytrack.plotting import _figures as shared

__all__ = ["plot_tracker_errors"]

# Characters of a name.
_NAME = 32


def plot_tracker_errors(
    errors: Mapping[str, tuple[float, float]],
    *,
    measured: float | None = None,
    what: str = "RMSE of prediction (m)",
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Error of each tracker, with twice its standard error; the first one on top.

    Parameters
    ----------
    errors : mapping of str to (float, float)
        Error of each tracker and its standard error; NaN where it is not known.
    measured : float, optional
        Error of the plots themselves, drawn as a line.
    what : str
        Label of the errors.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If there is no tracker.
    """
    if not errors:
        raise ValueError("errors: at least one tracker is needed")
    size = (6.4, 1.5 + 0.32 * len(errors))
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=size)
    values, deviations = np.array([*errors.values()], dtype=np.float64).T
    places = np.arange(len(errors))
    known = np.isfinite(values)
    best = int(np.argmin(np.where(known, values, np.inf))) if known.any() else -1
    for place in places[known].tolist():
        is_best = place == best and len(errors) > 1
        plane.errorbar(
            values[place],
            place,
            xerr=2 * np.nan_to_num(deviations[place]),
            fmt="o",
            color=shared.GREEN if is_best else shared.BLUE,
            capsize=3,
        )
    if measured is not None:
        plane.axvline(measured, color=shared.GRAY, linestyle="--", label="the plots themselves")
    names = [name if len(name) <= _NAME else f"{name[: _NAME - 1]}…" for name in errors]
    plane.set_yticks(places, [name.replace("$", r"\$") for name in names])
    plane.set_ylim(len(errors) - 0.5, -0.5)
    seen = values[known & (values > 0)]
    if len(seen) and seen.max() > _FAR * seen.min():
        shared.log_axis(plane, "x")
    plane.set_xlabel(what)
    shared.finish(plane)
    if measured is not None:
        shared.legend_below(plane)
    return figure, plane


# From this ratio on between the errors the axis is logarithmic.
_FAR = 20.0
