"""Control surfaces, and the relational matrix behind them."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.inference import output_grid
from fuzzytrack.fuzzy.system import METHODS, FuzzySystem
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.schedulers.gain_outputs import choices, find_gain_outputs

__all__ = ["plot_gain_surfaces", "plot_relation", "plot_surface"]


STYLES = ("surface", "contour")
# Where the light of surfaces comes from, of length 1.
_LIGHT = (0.36, -0.48, 0.8)
GAIN_LABELS = {
    "alpha": "position gain α",
    "beta": "velocity gain β",
    "gamma": "acceleration gain γ",
}


@dataclass(frozen=True, eq=False)
class _Picture:
    """One panel: values over one input, or over two as ``values[i, j]`` at ``x[i], y[j]``."""

    label: str
    inputs: tuple[Variable, ...]
    grid: tuple[Array, ...]
    values: Array


def plot_surface(
    rules: shared.Rules,
    output: str | None = None,
    points: int = 101,
    method: str | None = None,
    style: str = "surface",
    *,
    inputs: tuple[str, str] | None = None,
    at: Mapping[str, float] | None = None,
    axes: Axes | Sequence[Axes] | None = None,
) -> tuple[Figure, shared.AxesArray]:
    """Control surface of one output, or of all outputs side by side.

    Parameters
    ----------
    rules : RuleBase, FuzzySystem, str or path
        What to draw; a name or path as for `fuzzytrack.load_rulebase`. With one
        input the surface is a curve.
    output : str, optional
        Name of one output; all unless given.
    points : int
        Evenly spaced points on each axis, at least 2; the corners of the sets are added to them.
    method : {"exact", "relation", "table"}, optional
        As for `fuzzytrack.fuzzy.system.FuzzySystem`; that of the system, ``exact`` for a rule base.
    style : {"surface", "contour"}
        In perspective, or as a contour map.
    inputs : (str, str), optional
        The two inputs to draw over; the first two unless given.
    at : mapping, optional
        Values of the other inputs, where there are more than two.
    axes : Axes or sequence of Axes, optional
        Axes to draw into, one for each output; made with ``projection="3d"`` for
        ``style="surface"``.

    Returns
    -------
    figure : Figure
    axes : ndarray of Axes
        One for each output.

    Raises
    ------
    ValueError
        If an argument is not one of the allowed ones.

    Notes
    -----
    Llinas et al. (1998), Fig. 3.12.
    """
    system = _system(rules, method)
    shared.choice("style", style, STYLES)
    names = system.rules.output_names
    if output is not None:
        shared.choice("output", output, names)
        names = (output,)
    pictures = []
    for name in names:
        chosen, grid, values = _values(system, name, points, inputs, at)
        label = system.rules.output(name).axis_label
        pictures.append(_Picture(label, chosen, grid, values))
    return _draw(pictures, style, axes)


def plot_gain_surfaces(
    rules: shared.Rules,
    points: int = 101,
    method: str | None = None,
    style: str = "surface",
    *,
    axes: Axes | Sequence[Axes] | None = None,
) -> tuple[Figure, shared.AxesArray]:
    """Surfaces of the gains of a tracker, over the inputs of its rule base.

    Parameters
    ----------
    rules : RuleBase, FuzzySystem, str or path
        With outputs ``stiffness`` and ``damping``, or ``stiffness`` alone with the damping of
        Kalata's gains, converted to α and β in the w-domain; or with outputs ``alpha`` and
        ``beta``, and maybe ``gamma``, drawn as they are.
    points : int
        Evenly spaced points on each axis, at least 2; the corners of the sets are added to them.
    method : {"exact", "relation", "table"}, optional
        As for `plot_surface`.
    style : {"surface", "contour"}
        As for `plot_surface`.
    axes : Axes or sequence of Axes, optional
        Axes to draw into, one for each gain; as for `plot_surface`.

    Returns
    -------
    figure : Figure
    axes : ndarray of Axes
        One for each gain.

    Raises
    ------
    ValueError
        If the outputs are not gains, or an argument is not one of the allowed ones.

    Notes
    -----
    Llinas et al. (1998), Eq. 3.26 and Fig. 3.13.
    """
    system = _system(rules, method)
    shared.choice("style", style, STYLES)
    outputs = find_gain_outputs(system.rules.output_names)
    if outputs is None:
        raise ValueError(
            f"rules: {system.rules.name} has outputs {', '.join(system.rules.output_names)}; "
            f"gains need {choices()}"
        )
    surfaces = {name: _values(system, name, points, None, None) for name in outputs.names}
    chosen, grid, _ = surfaces[outputs.names[0]]
    gains = outputs.gains({name: values for name, (_, _, values) in surfaces.items()})
    pictures = [_Picture(GAIN_LABELS[name], chosen, grid, values) for name, values in gains.items()]
    return _draw(pictures, style, axes)


def _system(rules: shared.Rules, method: str | None) -> FuzzySystem:
    base = shared.rules_of(rules)
    if method is not None:
        shared.choice("method", method, METHODS)
    if isinstance(rules, FuzzySystem):
        if method in (None, rules.method):
            return rules
        return FuzzySystem(
            base,
            str(method),
            fuzzification=rules.fuzzification,
            table_nodes=rules.table_nodes,
        )
    return FuzzySystem(base, method or "exact")


def _values(
    system: FuzzySystem,
    output: str,
    points: int,
    inputs: tuple[str, str] | None,
    at: Mapping[str, float] | None,
) -> tuple[tuple[Variable, ...], tuple[Array, ...], Array]:
    """Find the inputs to draw over, their points, and the output there."""
    rules = system.rules
    if len(rules.inputs) > 1:
        data = system.surface(output, points, inputs=inputs, at=at, corners=True)
        return (rules.input(data.x_name), rules.input(data.y_name)), (data.x, data.y), data.values
    if points < 2:
        raise ValueError(f"points: must be at least 2, got {points}")
    if inputs or at:
        raise ValueError(f"inputs, at: only for several inputs; {rules.name} has one")
    variable = rules.inputs[0]
    x = variable.nodes(points)
    return (variable,), (x,), np.asarray(system(**{variable.name: x})[output])


def _draw(
    pictures: list[_Picture], style: str, axes: Axes | Sequence[Axes] | None
) -> tuple[Figure, shared.AxesArray]:
    draw: Callable[[Axes, _Picture], None]
    if len(pictures[0].inputs) == 1:
        draw, size = _curve, (4.8, 3.6)
    elif style == "contour":
        draw, size = _map, (5.0, 4.2)
    else:
        draw, size = _perspective, (5.6, 4.6)
    figure, grid = shared.panels(
        "axes",
        axes,
        len(pictures),
        columns=3 if len(pictures) == 3 else 2,
        size=size,
        three_d=draw is _perspective,
    )
    for ax, picture in zip(grid, pictures, strict=True):
        draw(ax, picture)
    return figure, grid


def _curve(ax: Axes, picture: _Picture) -> None:
    (variable,), (x,) = picture.inputs, picture.grid
    ax.plot(x, picture.values, color=shared.BLUE, linewidth=2)
    shared.span_axis(ax, "x", variable.universe.low, variable.universe.high)
    ax.set(xlabel=variable.axis_label, ylabel=picture.label)
    shared.finish(ax)


def _map(ax: Axes, picture: _Picture) -> None:
    x, y = picture.grid
    # contourf wants values[row, column], and y runs along the rows
    values = np.ma.masked_invalid(picture.values.T)
    low, high = _range(picture.values)
    round_numbers = MaxNLocator(12).tick_values(low, high)
    apart = 1e-6 * (high - low)
    inside = [float(n) for n in round_numbers if low + apart < n < high - apart]
    levels = [low, *inside, high]
    filled = ax.contourf(x, y, values, levels=levels, cmap=shared.COLORMAP)
    between = [level for level in inside if values.min() < level < values.max()]
    if between:
        ax.contour(x, y, values, levels=between, colors="white", linewidths=0.5, alpha=0.6)
    _colorbar(ax, filled, low, high, label=picture.label)
    _name_inputs(ax, picture, 5)


def _perspective(ax: Any, picture: _Picture) -> None:
    x, y = np.meshgrid(*picture.grid, indexing="ij")
    low, high = _range(picture.values)
    colors = ScalarMappable(Normalize(low, high), shared.COLORMAP)
    # Without lines, which would hide the surface where nodes are dense.
    ax.plot_surface(
        x,
        y,
        picture.values,
        rstride=1,
        cstride=1,
        facecolors=_shaded(colors.to_rgba(picture.values), picture, high - low),
        shade=False,
        linewidth=0,
        antialiased=False,
    )
    ax.set_zlim(low, high)
    ax.locator_params(axis="z", nbins=5)
    ax.set_zlabel(textwrap.fill(picture.label, 30))
    _colorbar(ax, colors, low, high, shrink=0.62, pad=0.03)
    _name_inputs(ax, picture, 4, width=22)
    # The labels run beside the ticks' numbers; those of two lines need more room.
    for axis, pad in ((ax.xaxis, 7), (ax.yaxis, 7), (ax.zaxis, 11)):
        axis.labelpad = pad + 11 if "\n" in axis.get_label_text() else pad
    # At the front corner the numbers of both axes would touch.
    ax.tick_params(axis="x", pad=6)
    ax.tick_params(axis="y", pad=-1)
    ax.view_init(elev=32, azim=-125)
    # Leaves room for the labels, which matplotlib does not count.
    ax.set_box_aspect(None, zoom=0.82)


def _shaded(colors: Array, picture: _Picture, height: float) -> Array:
    """Colors of faces, a little darker the further they turn from the light.

    Slopes are those in a box of equal sides.
    """
    x, y = (nodes / np.ptp(nodes) for nodes in picture.grid)
    z = picture.values / height
    # Faces have the color of their corner of the lowest indices; those at the far edges are none.
    right, up = np.zeros_like(z), np.zeros_like(z)
    right[:-1] = np.diff(z, axis=0) / np.diff(x)[:, None]
    up[:, :-1] = np.diff(z, axis=1) / np.diff(y)
    toward = (_LIGHT[2] - _LIGHT[0] * right - _LIGHT[1] * up) / np.sqrt(1 + right**2 + up**2)
    shaded = colors.copy()
    shaded[..., :3] *= (0.7 + 0.3 * np.clip(np.nan_to_num(toward), 0.0, 1.0))[..., None]
    return shaded


def _colorbar(ax: Axes, colors: Any, low: float, high: float, **where: Any) -> Colorbar:
    """Color scale with both ends named."""
    three_digits = FuncFormatter(lambda value, _: f"{value:.3g}".replace("-", "\N{MINUS SIGN}"))
    ticks = shared.ticks(low, high, 6)
    return shared.figure_of(ax).colorbar(colors, ax=ax, ticks=ticks, format=three_digits, **where)


def _range(values: Array) -> tuple[float, float]:
    """Range of the finite values; a little wider if they are all the same."""
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        margin = 0.01 * max(abs(low), 1e-6)
        low, high = low - margin, high + margin
    return low, high


def _name_inputs(ax: Axes, picture: _Picture, ticks: int, width: int = 60) -> None:
    for which, variable in zip("xy", picture.inputs, strict=True):
        shared.span_axis(ax, which, variable.universe.low, variable.universe.high, ticks)
        getattr(ax, f"set_{which}label")(textwrap.fill(variable.axis_label, width))


def plot_relation(
    rules: shared.Rules,
    output: str | None = None,
    *,
    at: float | None = None,
    axes: Axes | Sequence[Axes] | None = None,
) -> tuple[Figure, shared.AxesArray]:
    """Relational matrix of a system with one input, as an image, and a slice through it.

    Parameters
    ----------
    rules : RuleBase, FuzzySystem, str or path
        With one input.
    output : str, optional
        Name of the output; the first unless given.
    at : float, optional
        Input at which to draw the slice: the fuzzy output there.
    axes : Axes or sequence of Axes, optional
        Axes to draw into: one, or two with `at`.

    Returns
    -------
    figure : Figure
    axes : ndarray of Axes
        The image, and the slice if there is one.

    Raises
    ------
    ValueError
        If there are more inputs than one, the output is unknown, or `at` lies outside the universe.

    Notes
    -----
    Llinas et al. (1998), Eqs. 3.3 to 3.5 and Figs. 3.4 and 3.5. The slice is the column of the
    nearest grid point. With weighted centers the matrix has one row for each set of the output.
    """
    base = shared.rules_of(rules)
    if len(base.inputs) != 1:
        raise ValueError(
            f"rules: {base.name} has inputs {', '.join(base.input_names)}; "
            "a relational matrix can be drawn for one input"
        )
    name = base.output_names[0] if output is None else output
    shared.choice("output", name, base.output_names)
    variable, target = base.inputs[0], base.output(name)
    universe = variable.universe
    if at is not None and not universe.low <= at <= universe.high:
        raise ValueError(f"at: must be within [{universe.low:g}, {universe.high:g}], got {at:g}")
    system = rules if isinstance(rules, FuzzySystem) else FuzzySystem(base)
    matrix = system.relation(name)

    figure, grid = shared.panels("axes", axes, 1 if at is None else 2, columns=2, size=(4.8, 4.0))
    operators = base.operators_of(target)
    y, _ = output_grid(operators, target)
    by_set = operators.defuzzification == "weighted-centers"
    _image(grid[0], figure, matrix, variable, target, None if by_set else y)
    if at is not None:
        column = int(universe.nearest(np.asarray(at)))
        point = float(universe.values[column])
        grid[0].axvline(point, color="white", linestyle="--", linewidth=1.5)
        value = float(system.evaluate(np.array([[at]]))[name][0])
        _slice(grid[1], y, matrix[column], target, f"{variable.name} = {point:g}", value, by_set)
    return figure, grid


def _image(
    ax: Axes, figure: Figure, matrix: Array, variable: Variable, target: Variable, y: Array | None
) -> None:
    """Draw the matrix; `y` are the points of the output, None for one row for each of its sets."""
    x, by_set = _edges(variable.universe), y is None
    if y is None:
        edges = np.arange(matrix.shape[1] + 1) - 0.5
    else:
        edges = _edges(target.universe)
        # With points for singletons between those of the grid.
        edges = np.concatenate([edges[:1], (y[1:] + y[:-1]) / 2, edges[-1:]])
    mesh = ax.pcolormesh(x, edges, matrix.T, cmap=shared.COLORMAP, vmin=0.0)
    figure.colorbar(mesh, ax=ax, label="membership in the relation")
    shared.span_axis(ax, "x", variable.universe.low, variable.universe.high)
    if by_set:
        ax.set_yticks(range(len(target.sets)), target.set_names)
    else:
        shared.span_axis(ax, "y", target.universe.low, target.universe.high)
    ax.set(xlabel=variable.axis_label, ylabel=target.axis_label)


def _edges(universe: Universe) -> Array:
    """Edges of the cells around the grid points."""
    first = universe.first - universe.step / 2
    return np.asarray(first + universe.step * np.arange(universe.points + 1))


def _slice(
    ax: Axes, y: Array, grades: Array, target: Variable, where: str, value: float, by_set: bool
) -> None:
    if by_set:
        ax.vlines(y, 0.0, grades, color=shared.BLUE, linewidth=3, label=f"fuzzy output, {where}")
    else:
        ax.plot(y, grades, color=shared.BLUE, linewidth=2, label=f"fuzzy output, {where}")
        ax.fill_between(y, grades, color=shared.BLUE, alpha=0.15, linewidth=0)
    if np.isfinite(value):
        ax.axvline(
            value,
            color=shared.VERMILION,
            linestyle="--",
            linewidth=1.5,
            label=f"crisp output {value:.3g}",
        )
    ax.set_ylim(0.0, max(1.05 * float(grades.max()), 0.05))
    shared.span_axis(ax, "x", target.universe.low, target.universe.high)
    ax.set(xlabel=target.axis_label, ylabel="membership")
    shared.finish(ax)
    shared.legend_below(ax)
