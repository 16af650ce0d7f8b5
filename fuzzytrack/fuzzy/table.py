"""Interpolated look-up table of a fuzzy system, with an error bound measured when it is built."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress

__all__ = ["InterpolationTable", "build_table", "default_nodes"]


MAX_NODES = 4_000_000
# With three, a kink is met at 3/4 of its height or more on each axis: twice the largest difference
# covers it on two axes.
PROBES_PER_CELL = 3
#: Probes to a net at the most.
_NET = 4_096
#: How far beside a jump its sides are probed, as a part of the universe; and most inputs of rule
#: bases whose jumps are all probed.
_BESIDE = 1e-9
_ALL_KNOTS = 2


@dataclass(frozen=True, eq=False)
class InterpolationTable:
    """Values of every output at the nodes of a regular grid over the inputs.

    Attributes
    ----------
    axes : tuple of ndarray
        Equally spaced nodes of each input, both ends included.
    values : dict of ndarray
        For each output its values at the nodes, in the order of `axes`.
    bounds : dict of float
        For each output twice the largest difference from the tabulated function met at build,
        over a net of probes inside the cells, and with one or two inputs on both sides of the ends
        and cores of all sets. A bound for functions that are smooth between the probes; where an
        output jumps (``mom``, a default), it is of the size of the jump, once or twice, and
        infinite where the table has cells in which a rule fires at some points only.
    """

    axes: tuple[Array, ...]
    values: dict[str, Array]
    bounds: dict[str, float]

    def __repr__(self) -> str:
        return summary(self, "values", "bounds", shape=tuple(map(len, self.axes)))

    def __call__(self, points: Array) -> dict[str, Array]:
        """Multilinear interpolation at `points`, shape (n, n_inputs), all within the axes."""
        from scipy.interpolate import RegularGridInterpolator

        return {
            name: np.asarray(RegularGridInterpolator(self.axes, values)(points))
            for name, values in self.values.items()
        }


def default_nodes(n_inputs: int) -> int:
    """Nodes on each input that keep a table to about 40,000 in all."""
    return 2001 if n_inputs == 1 else max(2, round(40_401 ** (1 / n_inputs)))


def build_table(
    rulebase: RuleBase,
    evaluate: Callable[[Array], dict[str, Array]],
    nodes: int,
    progress: Progress | None = None,
) -> InterpolationTable:
    """Tabulate `evaluate` on `nodes` points on each input and measure the interpolation error.

    Parameters
    ----------
    rulebase : RuleBase
        Gives the inputs' universes.
    evaluate : callable
        ``evaluate(points)``, points of shape (n, n_inputs), to a dict of arrays of shape (n,).
    nodes : int
        Nodes on each input.
    progress : callable, optional
        Called with the share of the error's probes that are evaluated.

    Raises
    ------
    ValueError
        If there are fewer than two nodes, or the table would hold more than 4,000,000.
    """
    n_inputs = len(rulebase.inputs)
    if nodes < 2 or float(nodes) ** n_inputs > MAX_NODES:
        raise ValueError(
            f"table: {nodes} nodes on each of {n_inputs} inputs; at least 2 nodes on each and "
            f"at most {MAX_NODES} in all are allowed"
        )
    axes = tuple(np.linspace(v.universe.low, v.universe.high, nodes) for v in rulebase.inputs)
    flat = evaluate(_net(axes))
    shape = (nodes,) * n_inputs
    table = InterpolationTable(axes, {name: v.reshape(shape) for name, v in flat.items()}, {})
    worst = dict.fromkeys(flat, 0.0)
    knots = [_knots(variable) for variable in rulebase.inputs]
    nets = list(_probes(axes, knots))
    for done, probes in enumerate(nets, start=1):
        truth, answer = evaluate(probes), table(probes)
        for name in worst:
            gap = np.abs(answer[name] - truth[name])
            # A number on one side only: the cell touches a place where no rule fires.
            gap[np.isnan(answer[name]) != np.isnan(truth[name])] = np.inf
            # Rounding of two different sums of products, even where the table is exact.
            rounding = 1e-14 * np.abs(truth[name])
            worst[name] = max(worst[name], _largest(gap), _largest(rounding))
        if progress is not None:
            progress(done / len(nets))
    return InterpolationTable(axes, table.values, {name: 2 * w for name, w in worst.items()})


def _net(axes: tuple[Array, ...]) -> Array:
    return np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=-1)


def _knots(variable: Variable) -> Array:
    """Points of an input at which an output may jump, points beside them, and points between."""
    low, high = variable.universe.low, variable.universe.high
    ends = {e for s in variable.sets for e in (*s.support()[:2], *s.core(low, high))}
    knots = np.array(sorted(e for e in ends if low <= e <= high))
    beside = _BESIDE * (high - low)
    between = (knots[1:] + knots[:-1]) / 2
    found = np.concatenate([knots, knots - beside, knots + beside, between])
    return np.unique(np.clip(found, low, high))


def _probes(axes: tuple[Array, ...], knots: list[Array]) -> Iterator[Array]:
    """Nets of points inside the cells and at `knots`, some thousand points to a net at the most.

    Of each axis up to so many points are taken that there are 1,000,000 inside the cells in all,
    and with three inputs or more as many knots. A net is small on every axis, so that few rules
    fire on it.
    """
    inside = (np.arange(PROBES_PER_CELL) + 0.5) / PROBES_PER_CELL
    limit = max(2, int(1_000_000 ** (1 / len(axes))))
    length = max(2, int(_NET ** (1 / len(axes))))
    fine = []
    for axis, own in zip(axes, knots, strict=True):
        dense = _thinned((axis[:-1, None] + inside * (axis[1] - axis[0])).ravel(), limit)
        kept = own if len(axes) <= _ALL_KNOTS else _thinned(own, max(2, limit // 4))
        points = np.union1d(dense, kept)
        fine.append([points[i : i + length] for i in range(0, len(points), length)])
    return map(_net, product(*fine))


def _thinned(points: Array, limit: int) -> Array:
    """So many of some points, evenly from the first to the last."""
    if len(points) <= limit:
        return points
    return np.asarray(points[np.unique(np.linspace(0, len(points) - 1, limit).astype(int))])


def _largest(values: Array) -> float:
    """Largest of the values that are not NaN; zero where all are."""
    return float(np.fmax.reduce(values, initial=0.0))
