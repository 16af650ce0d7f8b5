"""The outputs of a rule base at the nodes of a grid, multilinear between them.

With products as AND, sums as OR and sets that are straight between their corners, the strength of
every rule is multilinear between the break points of all sets, and so are the sums over the rules
whose quotient an output is. A table of these sums at the break points is then exact. Where the sets
share out every point, the sum that divides is constant, and the output itself is tabulated. Of any
other rule base a table on a finer grid is an approximation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.inference import conclusions
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.reprs import summary

__all__ = ["GridTable", "breakpoint_table", "default_nodes", "even_table"]

#: Most nodes of a table, over all inputs.
MAX_NODES = 65_536
# Nodes of an approximate table, over all inputs, unless a number is given.
_NODES = 4_300
# Sums so alike are one number, but for rounding.
_ROUNDING = 1e-13
# Break points so close, as a part of the universe, are a jump.
_CLOSE = 1e-9


@dataclass(frozen=True, eq=False)
class GridTable:
    """Outputs at the nodes of a grid.

    Attributes
    ----------
    nodes : tuple of ndarray
        Two or more nodes of each input, ascending. Beyond the first and the last one, outputs are
        as at these.
    moments : dict of ndarray
        For each output its values at the nodes, one axis an input; or, if it has totals, the
        moments that are divided by them.
    totals : dict of ndarray
        For some outputs the totals that divide their moments; 0 where no rule fires.
    exact : bool
        Whether the outputs are multilinear (or a quotient of such) between the nodes.
    """

    nodes: tuple[Array, ...]
    moments: dict[str, Array]
    totals: dict[str, Array]
    exact: bool

    def __repr__(self) -> str:
        return summary(self, "exact", shape=tuple(map(len, self.nodes)))


def breakpoint_table(rules: RuleBase) -> GridTable | None:
    """Table of a rule base at the break points of its sets, which is exact.

    Returns
    -------
    GridTable or None
        None if no table is exact: for rule bases that do not add products, sets that are not
        straight between their corners or jump, or more than 65,536 nodes.
    """
    if not rules.adds_products:
        return None
    nodes = []
    for variable in rules.inputs:
        found = _break_points(variable)
        if found is None:
            return None
        nodes.append(found)
    if math.prod(map(len, nodes)) > MAX_NODES:
        return None
    moments, totals = {}, {}
    for output in rules.outputs:
        moment, total = _sums(rules, output, nodes)
        largest = float(total.max())
        if largest > 0.0 and float(total.min()) >= (1.0 - _ROUNDING) * largest:
            moments[output.name] = moment / total
        else:
            largest = largest or 1.0
            moments[output.name], totals[output.name] = moment / largest, total / largest
    return _without_flat_ends(GridTable(tuple(nodes), moments, totals, exact=True))


def default_nodes(n_inputs: int) -> int:
    """Nodes on each input of an approximate table: about 4,300 in all."""
    return max(2, int(_NODES ** (1 / n_inputs)))


def even_table(system: FuzzySystem, nodes: int) -> GridTable:
    """Table of any fuzzy system, which is an approximation.

    Parameters
    ----------
    system : FuzzySystem
    nodes : int
        Evenly spaced nodes on each input, at least 2; the corners of its sets are nodes too.

    Raises
    ------
    ValueError
        If there are fewer than 2 nodes, or more than 65,536 over all inputs.
    """
    inputs = system.rules.inputs
    axes = [_apart(v.nodes(nodes), v.universe) for v in inputs] if nodes >= 2 else []
    total = math.prod(map(len, axes))
    if nodes < 2 or total > MAX_NODES:
        raise ValueError(
            f"nodes: {nodes} on each of {len(inputs)} inputs; at least 2 on each and at most "
            f"{MAX_NODES} in all, corners of sets included, are allowed"
        )
    net = np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=-1)
    shape = tuple(map(len, axes))
    values = {name: v.reshape(shape) for name, v in system.evaluate(net).items()}
    return GridTable(tuple(axes), values, {}, exact=False)


def _apart(points: Array, universe: Universe) -> Array:
    """Points without those that are closer to the one before than integers of 16 bits tell."""
    apart = (universe.high - universe.low) / 65_536
    kept = [float(points[0])]
    for point in points[1:-1].tolist():
        if point - kept[-1] >= apart and points[-1] - point >= apart:
            kept.append(point)
    return np.array([*kept, float(points[-1])])


def _break_points(variable: Variable) -> Array | None:
    """Corners of the sets in the universe, and its ends; None if its sets are not straight."""
    low, high = variable.universe.low, variable.universe.high
    if not all(_is_straight(s, low, high) for s in variable.sets):
        return None
    corners = {p for s in variable.sets for p in s.parameters if low < p < high}
    points = sorted({low, high, *corners})
    if any(b - a < _CLOSE * (high - low) for a, b in pairwise(points)):
        return None
    return np.array(points)


def _is_straight(fuzzy_set: FuzzySet, low: float, high: float) -> bool:
    """Whether a set is straight between its corners in a universe, and does not jump in it."""
    if fuzzy_set.shape not in ("trimf", "trapmf"):
        return False
    first, *middle, last = fuzzy_set.parameters
    rises_at_once, falls_at_once = first == middle[0], last == middle[-1]
    if rises_at_once and falls_at_once and first == last:
        return False
    return not (rises_at_once and low < first <= high) and not (
        falls_at_once and low <= last < high
    )


def _sums(rules: RuleBase, output: Variable, nodes: list[Array]) -> tuple[Array, Array]:
    """Moment and total of an output at every node (Llinas et al. 1998, Eqs. 3.11 to 3.13)."""
    about = conclusions(rules, output)
    area, first = about.grades.sum(axis=1), about.grades @ about.y
    shape = tuple(map(len, nodes))
    moment, total = np.zeros(shape), np.zeros(shape)
    for r, confidence, term in zip(about.rule, about.confidence, about.term, strict=True):
        strength: Array = np.ones(shape)
        for name, word in rules.rules[r].conditions:
            axis = rules.input_names.index(name)
            variable = rules.inputs[axis]
            grades = variable.sets[variable.index(word)].membership(nodes[axis])
            strength = strength * grades.reshape(
                [-1 if k == axis else 1 for k in range(len(nodes))]
            )
        moment += strength * (confidence * first[term])
        total += strength * (confidence * area[term])
    return moment, total


def _without_flat_ends(table: GridTable) -> GridTable:
    """The table without first and last nodes at which nothing differs from the next ones."""
    nodes, arrays = list(table.nodes), [*table.moments.values(), *table.totals.values()]
    for axis in range(len(nodes)):
        flat = [
            all(np.array_equal(a.take(k, axis), a.take(k + 1, axis)) for a in arrays)
            for k in range(len(nodes[axis]) - 1)
        ]
        kept = slice(flat[0], len(flat) + 1 - flat[-1])
        if len(nodes[axis][kept]) >= 2:
            nodes[axis] = nodes[axis][kept]
            index = (slice(None),) * axis + (kept,)
            arrays = [a[index] for a in arrays]
    moments = dict(zip(table.moments, arrays, strict=False))
    totals = dict(zip(table.totals, arrays[len(moments) :], strict=True))
    return GridTable(tuple(nodes), moments, totals, table.exact)
