"""Membership functions of the variables of a rule base."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.plotting import _figures as shared

__all__ = ["plot_memberships"]

POINTS = 1_001
FONT_SIZE = 9.0


def plot_memberships(
    rules: shared.Rules | Variable,
    variables: str | Sequence[str] | None = None,
    *,
    axes: Axes | Sequence[Axes] | None = None,
) -> tuple[Figure, shared.AxesArray]:
    """Membership functions, one panel for each variable.

    Parameters
    ----------
    rules : RuleBase, FuzzySystem, Variable, str or path
        What to draw; a name or path as for `fuzzytrack.load_rulebase`.
    variables : str or sequence of str, optional
        Names of inputs and outputs; all, inputs first, unless given.
    axes : Axes or sequence of Axes, optional
        Axes to draw into, one for each variable.

    Returns
    -------
    figure : Figure
    axes : ndarray of Axes
        One for each variable.

    Raises
    ------
    ValueError
        If a variable is unknown, or there are more or fewer axes than variables.

    Notes
    -----
    Llinas et al. (1998), Fig. 3.8.
    """
    parts = _parts(rules)
    known = {variable.name: variable for some in parts.values() for variable in some}
    roles = {variable.name: role for role, some in parts.items() for variable in some}
    names = [variables] if isinstance(variables, str) else list(variables or known)
    for name in names:
        shared.choice("variables", name, tuple(known))
    figure, grid = shared.panels("axes", axes, len(names), columns=2, size=(5.0, 2.9))
    for ax, name in zip(grid, names, strict=True):
        role = roles[name]
        _draw(ax, known[name], f"{role} {name}", evenly=role != "output")
    return figure, grid


def _parts(rules: shared.Rules | Variable) -> dict[str, tuple[Variable, ...]]:
    """Variables by what they are: inputs and outputs of a rule base, or one variable by itself."""
    if isinstance(rules, Variable):
        return {"variable": (rules,)}
    base = shared.rules_of(rules)
    return {"input": base.inputs, "output": base.outputs}


def _draw(ax: Axes, variable: Variable, title: str, *, evenly: bool) -> None:
    low, high = variable.universe.low, variable.universe.high
    colors = shared.set_colors(variable, evenly=evenly)
    for number, fuzzy_set in enumerate(variable.sets):
        x, grades = _outline(fuzzy_set, variable.universe)
        # Not along the axis, where the set that is drawn last would hide the others.
        zero = np.pad(grades == 0.0, 1, constant_values=True)
        shown = np.where(zero[:-2] & zero[1:-1] & zero[2:], np.nan, grades)
        ax.plot(x, shown, color=colors[number], linewidth=1.8, label=fuzzy_set.name)
    shared.finish(ax)
    levels = _label_sets(ax, variable)
    shared.span_axis(ax, "x", low, high)
    margin = 0.01 * (high - low)
    ax.set_xlim(low - margin, high + margin)
    ax.set_ylim(0.0, 1.13 + 0.12 * levels)
    ax.set_yticks([0.0, 0.5, 1.0])
    ax.set(xlabel=variable.axis_label, ylabel="membership", title=title)


def _outline(
    fuzzy_set: FuzzySet, universe: Universe
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points of the curve: dense, with every corner among them; a singleton is a spike."""
    low, high = universe.low, universe.high
    if fuzzy_set.shape == "singleton":
        (value,) = fuzzy_set.parameters
        return np.array([value, value]), np.array([0.0, 1.0])
    corners = [p for p in fuzzy_set.breakpoints() if low <= p <= high]
    # A vertical flank needs a point at its lower end beside that at its upper end.
    beside = [q for p in corners for q in (np.nextafter(p, low), np.nextafter(p, high))]
    x = np.unique([*np.linspace(low, high, POINTS), *corners, *beside])
    return x, fuzzy_set.membership(x)


def _label_sets(ax: Axes, variable: Variable) -> int:
    """Name every set above its peak, on as few lines as keep the names apart.

    Returns
    -------
    int
        Lines used beyond the first.
    """
    low, high = variable.universe.low, variable.universe.high
    width = ax.get_position().width * shared.figure_of(ax).get_figwidth() * 72
    ends: list[float] = []
    centers = variable.centers()
    for number in np.argsort(centers, kind="stable"):
        name, center = variable.sets[number].name, float(np.clip(centers[number], low, high))
        half = (0.34 * len(name) * FONT_SIZE + 2) / width * (high - low)
        middle = min(max(center, low + half), high - half) if 2 * half < high - low else center
        level = next((k for k, end in enumerate(ends) if middle - half >= end), len(ends))
        ends[level : level + 1] = [middle + half]
        height = 1.04 + 0.12 * level
        if level:
            ax.plot([center, center], [1.0, height], color="0.7", linewidth=0.7, zorder=1)
        ax.text(
            middle,
            height,
            name,
            ha="center",
            va="bottom",
            fontsize=FONT_SIZE,
            color=shared.INK,
        )
    return len(ends) - 1
