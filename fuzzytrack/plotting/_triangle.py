"""The stability triangle as the background of a picture, and contours on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import positive
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting.stability import LABELS

__all__ = ["graded", "increasing", "label_crests", "triangle"]


def triangle(ax: Axes, limits: tuple[float, float] = (2.06, 4.12)) -> None:
    """The stability triangle, as a background."""
    ax.fill([0, 2, 0], [0, 0, 4], facecolor="0.97", edgecolor="none", zorder=0)
    ax.plot([0, 2, 0, 0], [0, 0, 4, 0], color=shared.INK, linewidth=1.1, zorder=1)
    ax.set(xlabel=LABELS["gains"][0], ylabel=LABELS["gains"][1])
    ax.set(xlim=(-0.015 * limits[0], limits[0]), ylim=(-0.015 * limits[1], limits[1]))
    ax.spines[["top", "right"]].set_visible(False)


def graded(levels: Sequence[float] | Array) -> list[Any]:
    """Colors from dark to light, without the yellow that is unreadable on white."""
    return list(colormaps[shared.COLORMAP](np.linspace(0.0, 0.82, len(levels))))


def label_crests(ax: Axes, lines: Any, text: Callable[[float], str], first: int = 0) -> None:
    """Label contours at their highest points, where they are apart, from the `first` one on."""
    curves = [path.vertices for path in lines.get_paths()[first:] if len(path.vertices)]
    places = [curve[np.argmax(curve[:, 1])] for curve in curves]
    ax.clabel(lines, lines.levels[first:], fmt=text, fontsize=9, manual=places)


def increasing(name: str, values: ArrayLike) -> Array:
    array: Array = np.ravel(positive(name, values))
    if not (len(array) and (np.diff(array) > 0).all()):
        raise ValueError(f"{name} must be one or more increasing numbers")
    return array
