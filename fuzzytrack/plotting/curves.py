"""Curves over one axis, as papers print them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from fuzzytrack.gains.checks import finite
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._track_styles import STYLES

__all__ = ["plot_curves"]

_REFERENCES: dict[str, dict[str, Any]] = {
    "true": STYLES["true"],
    "plots": {"color": shared.GRAY, "linewidth": 1.2, "zorder": 1.5},
}


def plot_curves(
    x: ArrayLike,
    curves: Mapping[str, ArrayLike],
    *,
    xlabel: str,
    ylabel: str,
    title: str = "",
    xlog: bool = False,
    ylog: bool = False,
    marks: Mapping[str, tuple[float, float]] | None = None,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Curves over one axis.

    Parameters
    ----------
    x : array_like, shape (n,)
        Common abscissa.
    curves : mapping of str to array_like, shape (n,)
        By label; at least one. Those with the labels ``true`` and ``plots`` look as in pictures of
        tracks.
    xlabel, ylabel : str
        Quantity and unit of the axes.
    title : str
        Above the axes.
    xlog, ylog : bool
        Whether an axis is logarithmic.
    marks : mapping of str to (x, y), optional
        Points to mark, by label, such as published values.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If there is no curve, or shapes do not fit.
    """
    if not curves:
        raise ValueError("curves: needs at least one")
    abscissa = finite("x", x)
    figure, (axes,) = shared.panels(
        "ax", None if ax is None else [ax], 1, columns=1, size=(6.8, 4.2)
    )
    trackers = [label for label in curves if label not in _REFERENCES]
    for label, values in curves.items():
        number = 0 if label in _REFERENCES else trackers.index(label)
        own = {
            "color": shared.COLORS[number % len(shared.COLORS)],
            "linestyle": shared.STYLES[number % len(shared.STYLES)],
        }
        axes.plot(abscissa, values, label=label, **_REFERENCES.get(label, own))
    for number, (label, (at, value)) in enumerate((marks or {}).items()):
        marker = shared.MARKERS[number % len(shared.MARKERS)]
        axes.plot(at, value, marker, color=shared.INK, markerfacecolor="none", label=label)
    shared.log_axis(axes, *("x" if xlog else ""), *("y" if ylog else ""))
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    if title:
        axes.set_title(title)
    shared.finish(axes)
    shared.legend_below(axes)
    return figure, axes
