"""Inputs at which a program in C is checked, and the outputs of the library there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.interop.c99.number_types import NumberType
from fuzzytrack.reprs import summary

__all__ = ["Vectors", "library_values", "vectors"]

# Vectors of a program at the most: more make it larger than the devices that it runs on.
_MOST = 2_048


@dataclass(frozen=True, eq=False)
class Vectors:
    """Inputs as numbers of C, and the outputs of the library.

    Attributes
    ----------
    inputs : ndarray, shape (n, n_inputs)
    expected : ndarray, shape (n, n_outputs)
        Not rounded; in steps for integers.
    """

    inputs: NDArray[Any]
    expected: Array

    def __repr__(self) -> str:
        return summary(self, "inputs", "expected")


def vectors(system: FuzzySystem, number: NumberType, nodes: Sequence[Array] = ()) -> Vectors:
    """Break points, middles of cells and ends of every input, and inputs beyond them.

    Parameters
    ----------
    system : FuzzySystem
    number : NumberType
    nodes : sequence of ndarray
        Nodes of a table: each is a break point too.

    Returns
    -------
    Vectors
        Every combination of the points of the inputs, if these are not more than 2,048; otherwise
        so many of them, with every point of every input.
    """
    inputs = system.rules.inputs
    axes = [
        number.given(_points(v, nodes[k] if nodes else np.empty(0)), v.universe)
        for k, v in enumerate(inputs)
    ]
    axes = [np.unique(axis) for axis in axes]
    inside = _combined(axes)
    rows = np.concatenate([inside, *([] if number.whole else [_beyond(inputs, inside)])])
    return Vectors(rows, library_values(system, number, rows))


def library_values(system: FuzzySystem, number: NumberType, rows: NDArray[Any]) -> Array:
    """Outputs of the library at numbers of C, in the unit of errors, shape (n, n_outputs)."""
    rules = system.rules
    points = [number.meant(rows[:, k], v.universe) for k, v in enumerate(rules.inputs)]
    values = system.evaluate(np.stack(points, axis=1))
    return np.stack([number.wanted(values[v.name], v.universe) for v in rules.outputs], axis=1)


def _points(variable: Variable, nodes: Array) -> Array:
    """Ends, corners and centers of the sets, nodes, and the middles between them."""
    low, high = variable.universe.low, variable.universe.high
    marks = {*variable.centers().tolist(), *(p for s in variable.sets for p in s.breakpoints())}
    inside = [mark for mark in marks if low < mark < high]
    points = np.unique(np.concatenate([[low, high], inside, nodes]))
    return np.union1d(points, (points[1:] + points[:-1]) / 2)


def _combined(axes: list[NDArray[Any]]) -> NDArray[Any]:
    total = math.prod(map(len, axes))
    if total <= _MOST:
        return np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=-1)
    # Evenly over all of them; then every point of an input with the others in turn.
    chosen = np.linspace(0, total - 1, _MOST // 2).astype(np.int64)
    spread = np.unravel_index(chosen, tuple(map(len, axes)))
    longest = max(map(len, axes))
    turns = [np.arange(longest) * (2 * k + 1) % len(axis) for k, axis in enumerate(axes)]
    for k, axis in enumerate(axes):
        turns[k][: len(axis)] = np.roll(np.arange(len(axis)), k)[: len(turns[k])]
    columns = [axis[np.concatenate([a, b])] for axis, a, b in zip(axes, spread, turns, strict=True)]
    return np.stack(columns, axis=-1)


def _beyond(inputs: tuple[Variable, ...], inside: NDArray[Any]) -> NDArray[Any]:
    """For each input numbers beyond its ends, infinities and NaN; the others in the middle."""
    middle = inside[len(inside) // 2]
    rows = []
    for k, variable in enumerate(inputs):
        low, high = variable.universe.low, variable.universe.high
        for value in (low - (high - low), high + (high - low), -np.inf, np.inf, np.nan):
            row = middle.copy()
            row[k] = value
            rows.append(row)
    return np.array(rows, dtype=inside.dtype)
