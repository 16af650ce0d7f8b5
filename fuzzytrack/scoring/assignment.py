"""The best assignment between two sets where only some pairs are possible."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array

__all__ = ["best_assignment"]

Integers = NDArray[np.int64]

# Members of a problem up to which it is not worth looking for its components.
_FEW = 100


def best_assignment(
    left: Integers, right: Integers, gain: Array, problem: Integers | None = None
) -> Integers:
    """Choose pairs, each member in one at most, with the greatest sum of gains.

    Many problems that have no member in common may be given at once, as those of all instants.

    Parameters
    ----------
    left, right : ndarray of int, shape (n_pairs,)
        Members of the possible pairs, numbered from 0; no pair is given twice.
    gain : ndarray, shape (n_pairs,)
        What a pair is worth; pairs that are worth 0 or less are never chosen.
    problem : ndarray of int, shape (n_pairs,), optional
        Numbers of the problems, in order, if pairs and members are sorted by them.

    Returns
    -------
    ndarray of int
        Numbers of the chosen pairs, in order.

    Notes
    -----
    A pair whose members have no other is chosen at once. The rest falls into connected components,
    each solved by the algorithm of Jonker and Volgenant as modified by Crouse (2016), in SciPy; a
    problem with few members is solved as a whole.
    """
    useful = np.flatnonzero(gain > 0)
    left, right, gain = left[useful], right[useful], gain[useful]
    if not len(useful):
        return useful
    alone = (np.bincount(left)[left] == 1) & (np.bincount(right)[right] == 1)
    if alone.all():
        return useful
    chosen = [np.flatnonzero(alone)]
    rest = np.flatnonzero(~alone)
    if problem is None:
        chosen += _by_components(left, right, gain, rest)
    else:
        numbers = problem[useful[rest]]
        for part in np.split(rest, np.flatnonzero(numbers[1:] != numbers[:-1]) + 1):
            row, column = left[part] - left[part[0]], right[part] - right[part].min()
            shape = int(row[-1]) + 1, int(column.max()) + 1
            if max(shape) <= _FEW:
                chosen.append(part[_solved(row, column, gain[part], shape)])
            else:
                chosen += _by_components(left, right, gain, part)
    return np.asarray(useful[np.sort(np.concatenate(chosen))])


def _by_components(left: Integers, right: Integers, gain: Array, pairs: Integers) -> list[Integers]:
    """Chosen ones of some pairs, component by component."""
    rows, row = np.unique(left[pairs], return_inverse=True)
    columns, column = np.unique(right[pairs], return_inverse=True)
    label = _components(row, column, len(rows), len(columns))
    height, mine = _places(label[: len(rows)])
    width, yours = _places(label[len(rows) :])
    component = label[row]
    # With one member on a side, the best pair is the answer; the first one of equals.
    single = np.minimum(height, width)[component] == 1
    one = np.flatnonzero(single)
    one = one[np.lexsort((-gain[pairs[one]], component[one]))]
    chosen = [pairs[one[np.unique(component[one], return_index=True)[1]]]]
    rest = np.flatnonzero(~single)
    rest = rest[np.argsort(component[rest], kind="stable")]
    bounds = np.flatnonzero(np.diff(component[rest])) + 1
    for part in np.split(rest, bounds) if len(rest) else ():
        shape = int(height[component[part[0]]]), int(width[component[part[0]]])
        found = _solved(mine[row[part]], yours[column[part]], gain[pairs[part]], shape)
        chosen.append(pairs[part[found]])
    return chosen


def _components(row: Integers, column: Integers, rows: int, columns: int) -> Integers:
    """Connected component of each row and of each column."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    size = rows + columns
    graph = coo_array((np.ones(len(row), dtype=np.int8), (row, column + rows)), shape=(size, size))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _places(label: Integers) -> tuple[Integers, Integers]:
    """How many members each component has, and the place of each member in its component."""
    count = np.bincount(label)
    order = np.argsort(label, kind="stable")
    place = np.empty(len(label), dtype=np.int64)
    place[order] = np.arange(len(label)) - np.repeat(np.cumsum(count) - count, count)
    return count.astype(np.int64), place


def _solved(row: Integers, column: Integers, gain: Array, shape: tuple[int, int]) -> Integers:
    """Chosen pairs of one problem, by their places in it."""
    from scipy.optimize import linear_sum_assignment

    if min(shape) == 1:
        return np.array([int(np.argmax(gain))])
    table = np.zeros(shape)
    table[row, column] = gain
    place = np.full(shape, -1, dtype=np.int64)
    place[row, column] = np.arange(len(row))
    found = place[linear_sum_assignment(table, maximize=True)]
    # A pair that is not possible stands for two members that are left alone.
    return np.asarray(found[found >= 0])
