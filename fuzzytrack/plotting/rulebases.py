"""A rule base in one picture: its sets, its rules, its surfaces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from fuzzytrack.fuzzy.rulebase import Consequent, Rule, RuleBase, TableLayout
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting.memberships import plot_memberships
from fuzzytrack.plotting.surfaces import STYLES, plot_surface

__all__ = ["plot_rulebase", "plot_rules"]

# Rules that a list shows.
SHOWN = 40
# Panels beside each other.
COLUMNS = 3
# Sizes of a panel in inches; that of a rule is one line of a list.
WIDTH = 5.4
HEIGHTS = {"memberships": 2.5, "table": 3.6, "rule": 0.27, "surface": 4.4, "curve": 3.2}
# A cell: its text, and its color, if it has one.
Cell = tuple[str, Any]


def plot_rulebase(
    rules: shared.Rules,
    points: int = 61,
    style: str = "surface",
    *,
    figure: Figure | None = None,
) -> tuple[Figure, shared.AxesArray]:
    """One picture of a rule base: sets of all variables, rules, and surfaces of all outputs.

    Parameters
    ----------
    rules : RuleBase, FuzzySystem, str or path
        What to draw; a name or path as for `fuzzytrack.load_rulebase`.
    points : int
        As for `plot_surface`.
    style : {"surface", "contour"}
        As for `plot_surface`.
    figure : Figure, optional
        Empty figure to draw into; its size is set.

    Returns
    -------
    figure : Figure
    axes : ndarray of Axes
        Inputs, outputs, rules, surfaces.

    Raises
    ------
    ValueError
        If `style` is unknown.

    Notes
    -----
    A set of an output has one color in all panels: from dark, the smallest center, to light. There
    are no surfaces where the rule base has more than two inputs.
    """
    base = shared.rules_of(rules)
    shared.choice("style", style, STYLES)
    system = rules if isinstance(rules, FuzzySystem) else FuzzySystem(base)
    outputs, layout = base.output_names, base.layout
    in_space = len(base.inputs) == 2 and style == "surface"
    table = HEIGHTS["table"] if layout else _height(base)
    sets, height = HEIGHTS["memberships"], HEIGHTS["surface" if len(base.inputs) > 1 else "curve"]
    parts: list[tuple[int, float, Callable[[list[Axes]], object]]] = [
        (len(base.inputs), sets, lambda axes: plot_memberships(base, base.input_names, axes=axes)),
        (len(outputs), sets, lambda axes: plot_memberships(base, outputs, axes=axes)),
        (len(outputs) if layout else 1, table, lambda axes: plot_rules(base, axes=axes)),
    ]
    if len(base.inputs) <= 2:

        def draw_surfaces(axes: list[Axes]) -> object:
            return plot_surface(system, points=points, style=style, axes=axes)

        parts.append((len(outputs), height, draw_surfaces))
    rows = [
        (k, min(COLUMNS, count - start), height)
        for k, (count, height, _) in enumerate(parts)
        for start in range(0, count, COLUMNS)
    ]
    figure, lines = _rows(rows, figure, in_space)
    for k, (_, _, draw) in enumerate(parts):
        draw([ax for part, axes in lines if part == k for ax in axes])
    figure.suptitle(base.name)
    return figure, np.array([ax for _, axes in lines for ax in axes], dtype=object)


def _rows(
    rows: Sequence[tuple[int, int, float]], figure: Figure | None, in_space: bool
) -> tuple[Figure, list[tuple[int, list[Axes]]]]:
    """Axes in rows, each with the part of the picture that it belongs to."""
    size = (WIDTH * min(2, max(count for _, count, _ in rows)), sum(h for *_, h in rows) + 0.4)
    if figure is None:
        figure = plt.figure()
    figure.set_size_inches(size)
    figure.set_layout_engine("constrained", h_pad=0.08)
    outer = figure.add_gridspec(len(rows), 1, height_ratios=[height for *_, height in rows])
    lines = []
    for number, (part, count, _) in enumerate(rows):
        solid: dict[str, Any] = {"projection": "3d"} if in_space and part == 3 else {}
        # A surface is not wider than high; alone it is in the middle.
        alone = bool(solid) and count == 1
        ratios = (0.5, 1.0, 0.5) if alone else (1.0,) * count
        inner = outer[number].subgridspec(1, len(ratios), width_ratios=ratios)
        places = range(1, 2) if alone else range(count)
        lines.append((part, [figure.add_subplot(inner[0, k], **solid) for k in places]))
    return figure, lines


def plot_rules(
    rules: shared.Rules, *, axes: Axes | Sequence[Axes] | None = None
) -> tuple[Figure, shared.AxesArray]:
    """Rules as a table, in the colors of what they conclude: the larger, the lighter.

    Parameters
    ----------
    rules : RuleBase, FuzzySystem, str or path
        What to draw. Rules that are written as a table of two inputs are drawn as one for each
        output; others as a list, of which the first 40 are shown.
    axes : Axes or sequence of Axes, optional
        Axes to draw into: one for each output of a table, or one for a list.

    Returns
    -------
    figure : Figure
    axes : ndarray of Axes

    Raises
    ------
    ValueError
        If there are more or fewer axes than tables.
    """
    base = shared.rules_of(rules)
    if base.layout is None:
        size = (1.5 * WIDTH, _height(base))
        figure, grid = shared.panels("axes", axes, 1, columns=1, size=size)
        _list(grid[0], base)
        return figure, grid
    names = base.output_names
    size = (WIDTH, HEIGHTS["table"])
    figure, grid = shared.panels("axes", axes, len(names), columns=2, size=size)
    for ax, name in zip(grid, names, strict=True):
        _table(ax, base, base.layout, name)
    return figure, grid


def _table(ax: Axes, base: RuleBase, layout: TableLayout, output: str) -> None:
    across, down = base.input(layout.columns), base.input(layout.rows)
    width = len(across.sets)
    cells = [_cell(base, rule, output) for rule in base.rules]
    _draw(ax, [cells[k : k + width] for k in range(0, len(cells), width)])
    ax.set_xticks(range(width), across.set_names)
    ax.set_yticks(range(len(down.sets)), down.set_names)
    ax.set_xlabel(f"{across.name} is")
    ax.set_ylabel(f"{down.name} is")
    ax.set_title(f"then {output} is")


def _list(ax: Axes, base: RuleBase) -> None:
    shown = base.rules[:SHOWN]
    names = [*base.input_names, *base.output_names]
    rows = [
        [(rule.asks(name, "·"), None) for name in base.input_names]
        + [_cell(base, rule, name) for name in base.output_names]
        for rule in shown
    ]
    left = len(base.rules) - len(shown)
    if left:
        rows.append([(f"and {left} more", None), *[("", None)] * (len(names) - 1)])
    _draw(ax, rows)
    words = ["if", *["and"] * (len(base.inputs) - 1), "then", *["and"] * (len(base.outputs) - 1)]
    ax.set_xticks(
        range(len(names)), [f"{word} {n} is" for word, n in zip(words, names, strict=True)]
    )
    ax.set_yticks(range(len(shown)), [str(k + 1) for k in range(len(shown))])
    ax.set_ylabel("rule")


def _height(base: RuleBase) -> float:
    """Of the list of rules, with its head (inches)."""
    return (min(len(base.rules), SHOWN) + 3) * HEIGHTS["rule"]


def _cell(base: RuleBase, rule: Rule, output: str) -> Cell:
    """Sets that a rule concludes, with confidences other than 1; the color of their mean."""
    mine = [c for c in rule.consequents if c.output == output]
    if not mine:
        return "·", None
    variable = base.output(output)
    colors = shared.set_colors(variable)
    shares = np.array([c.confidence for c in mine])
    parts = np.array([colors[variable.index(c.set_name)] for c in mine])
    color = shares @ parts / shares.sum() if shares.sum() else None
    return "+".join(map(_words, mine)), color


def _words(consequent: Consequent) -> str:
    sure = consequent.confidence
    return consequent.set_name if sure == 1.0 else f"{consequent.set_name}@{sure:g}"


def _draw(ax: Axes, rows: Sequence[Sequence[Cell]]) -> None:
    """Cells as an image with text; the first row is on top."""
    image = np.array([[to_rgb("white" if c is None else tuple(c)) for _, c in row] for row in rows])
    ax.imshow(image, aspect="auto")
    longest = max(len(text) for row in rows for text, _ in row)
    size = 9.0 if longest * len(rows[0]) <= 70 else 7.0
    for down, row in enumerate(rows):
        for across, (text, _) in enumerate(row):
            dark = image[down, across] @ (0.3, 0.59, 0.11) < 0.5
            ax.text(
                across,
                down,
                text,
                ha="center",
                va="center",
                fontsize=size,
                color="white" if dark else shared.INK,
            )
    ax.set_xticks(np.arange(1, len(rows[0])) - 0.5, minor=True)
    ax.set_yticks(np.arange(1, len(rows)) - 0.5, minor=True)
    ax.grid(which="minor", color="white", linewidth=1.5)
    ax.tick_params(which="both", length=0)
    ax.xaxis.tick_top()
    ax.xaxis.set_label_position("top")
    ax.spines[:].set_visible(False)
