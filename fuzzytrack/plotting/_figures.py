"""Figures and axes, colors, legends and ticks of all pictures."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import (
    FixedLocator,
    Formatter,
    FuncFormatter,
    LogLocator,
    MaxNLocator,
    NullFormatter,
)
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.loading import as_rulebase
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.variable import Variable

#: A rule base, or a name or path of one, or a system that has one.
Rules = RuleBase | FuzzySystem | str | os.PathLike[str]
AxesArray = NDArray[np.object_]

# Okabe and Ito (2008): can be distinguished with any color vision; without yellow.
BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
)
BLACK = "black"
COLORS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK)
MARKERS = ("o", "s", "^", "D", "v", "P")
INK, GRAY = "0.15", "0.55"
# Perceptually uniform, readable in gray and with any color vision.
COLORMAP = "viridis"
# With the minus sign of matplotlib's own labels.
PLAIN = FuncFormatter(lambda value, _: f"{value:.4g}".replace("-", "\N{MINUS SIGN}"))
# Dashes of curves, by their number.
STYLES = ("-", "--", "-.", ":")


def choice(name: str, value: object, allowed: Sequence[str]) -> None:
    """Raise ValueError unless `value` is one of the words allowed for the parameter `name`."""
    if value not in allowed:
        raise ValueError(f"{name}: unknown {value!r}; one of {', '.join(allowed)}")


def rules_of(rules: Rules, name: str = "rules") -> RuleBase:
    """Rule base of a fuzzy system, or as `fuzzytrack.fuzzy.loading.as_rulebase` takes it."""
    return rules.rules if isinstance(rules, FuzzySystem) else as_rulebase(rules, name)


def panels(
    name: str,
    given: Axes | Sequence[Axes] | AxesArray | None,
    count: int,
    *,
    columns: int,
    size: tuple[float, float],
    three_d: bool = False,
    **subplots: Any,
) -> tuple[Figure, AxesArray]:
    """Figure and `count` axes: the `given` ones, or new ones with `columns` in a row.

    `size` is that of one panel, in inches.
    """
    if given is None:
        columns = min(columns, count)
        rows = -(-count // columns)
        figure, grid = plt.subplots(
            rows,
            columns,
            figsize=(size[0] * columns, size[1] * rows),
            layout="constrained",
            squeeze=False,
            subplot_kw={"projection": "3d"} if three_d else None,
            **subplots,
        )
        if rows > 1:
            # Else titles are read as the labels of the axes above them.
            figure.get_layout_engine().set(h_pad=0.1)
        for spare in grid.ravel()[count:]:
            spare.remove()
        return figure, grid.ravel()[:count]
    axes = np.atleast_1d(np.asarray(given, dtype=object)).ravel()
    if len(axes) != count or not all(isinstance(a, Axes) for a in axes):
        kinds = ", ".join(type(a).__name__ for a in axes) or "nothing"
        raise ValueError(f"{name}: needs {count} matplotlib Axes, got {kinds}")
    if three_d and not all(a.name == "3d" for a in axes):
        raise ValueError(
            f"{name}: style='surface' needs axes made with projection='3d', got flat ones; "
            "style='contour' takes flat ones"
        )
    if not three_d and any(a.name == "3d" for a in axes):
        raise ValueError(f"{name}: needs flat axes, got ones made with projection='3d'")
    return figure_of(axes[0]), axes


def figure_of(ax: Axes) -> Figure:
    """Topmost figure that holds `ax`."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure


def legend_below(ax: Axes) -> None:
    """Legend under the x axis, where it covers nothing, in as many columns as there is room for."""
    handles, labels = ax.get_legend_handles_labels()
    figure = figure_of(ax)
    width = ax.get_position().width * figure.get_figwidth() * 72
    # Widths in points: of a letter, and of the line before the words. The legend may be wider
    # than the axes, since there is room under the labels of the y axis.
    columns = max(1, int(1.3 * width / (5.0 * max(map(len, labels)) + 42)))
    rows = -(-len(handles) // columns)
    ax.legend(
        loc="upper center",
        # Clears the axis label however high the panel is, also once a long legend shortens it.
        bbox_to_anchor=(0.5, 0.0),
        bbox_transform=ax.transAxes + ScaledTranslation(0.0, -42 / 72, figure.dpi_scale_trans),
        ncols=-(-len(handles) // rows),
        frameon=False,
        borderaxespad=0.0,
    )


def set_colors(variable: Variable, *, evenly: bool = False) -> Array:
    """Color of each set of a variable by its center, from dark to light, shape (n_sets, 3).

    With `evenly` neighbors are equally different in color, however near their centers are.
    """
    centers = variable.centers()
    places = np.searchsorted(np.unique(centers), centers) if evenly else centers - centers.min()
    # Without the yellow that is unreadable on white.
    shares = 0.88 * places / (places.max() or 1)
    return np.asarray(colormaps[COLORMAP](shares))[:, :3]


def ticks(low: float, high: float, count: int) -> list[float]:
    """About `count` round numbers, and both ends."""
    inside = MaxNLocator(count, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
    apart = 0.12 * (high - low)
    # Exactly zero, without the rounding error of a sum of steps.
    tiny = 1e-9 * (high - low)
    between = [0.0 if abs(t) < tiny else float(t) for t in inside if low + apart < t < high - apart]
    return [low, *between, high]


def span_axis(ax: Axes, which: str, low: float, high: float, count: int = 6) -> None:
    """Limits of an axis at the ends of a universe, and ticks that name both ends."""
    axis = getattr(ax, f"{which}axis")
    getattr(ax, f"set_{which}lim")(low, high)
    axis.set_major_locator(FixedLocator(ticks(low, high, count)))
    axis.set_major_formatter(PLAIN)


class _Decades(LogLocator):
    """Ticks at powers of ten; at 1, 2 and 5 times these where there are few."""

    def tick_values(self, vmin: float, vmax: float) -> Any:
        self.set_params(subs=(1.0, 2.0, 5.0) if vmax < 30 * vmin else (1.0,))
        return super().tick_values(vmin, vmax)


class _Decade(Formatter):
    """Plain numbers, if all on the axis are short; else powers of ten."""

    def __call__(self, value: float, pos: int | None = None) -> str:
        assert self.axis is not None
        low, high = sorted(self.axis.get_view_interval())
        if low >= 0.9e-4 and high < 1e6:
            return f"{value:.10g}"
        # With room for the rounding error of a logarithm.
        exponent = int(np.floor(np.log10(value) + 1e-9)) if value > 0 else 0
        digit = value / 10.0**exponent
        return rf"${'' if abs(digit - 1) < 1e-9 else f'{digit:.3g}·'}10^{{{exponent}}}$"


def log_axis(ax: Axes, *which: str) -> None:
    """Logarithmic axes with plain numbers: 0.1, 1, 10; none between powers of ten if many."""
    for name in which:
        getattr(ax, f"set_{name}scale")("log")
        axis = getattr(ax, f"{name}axis")
        axis.set_major_locator(_Decades())
        axis.set_major_formatter(_Decade())
        axis.set_minor_formatter(NullFormatter())


def finish(ax: Axes) -> None:
    """Light grid behind the data, and no frame on top and right."""
    ax.set_axisbelow(True)
    ax.grid(True, color="0.9", linewidth=0.8)
    ax.spines[["top", "right"]].set_visible(False)
