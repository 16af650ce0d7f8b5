"""The best assignment between two sets where only some pairs are possible."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array

__all__ = ["best_assignment"]

Integers = NDArray[np.int64]


def best_assignment(left: Integers, right: Integers, gain: Array) -> Integers:
    """Choose pairs, each member in one at most, with the greatest sum of gains.

    Many problems that have no member in common may be given at once, as those of all instants.

    Parameters
    ----------
    left, right : ndarray of int, shape (n_pairs,)
        Members of the possible pairs, numbered from 0; no pair is given twice.
    gain : ndarray, shape (n_pairs,)
        What a pair is worth; pairs that are worth 0 or less are never chosen.

    Returns
    -------
    ndarray of int
        Numbers of the chosen pairs, in order.

    Notes
    -----
    A pair whose members have no other is chosen at once. The rest falls into connected components,
    each solved by the algorithm of Jonker and Volgenant as modified by Crouse (2016), in SciPy.
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
    rows, row = np.unique(left[rest], return_inverse=True)
    columns, column = np.unique(right[rest], return_inverse=True)
    component = _components(row, column, len(rows), len(columns))
    order = np.argsort(component, kind="stable")
    for part in np.split(order, np.flatnonzero(np.diff(component[order])) + 1):
        chosen.append(rest[part[_solved(row[part], column[part], gain[rest[part]])]])
    return np.asarray(useful[np.sort(np.concatenate(chosen))])


def _components(row: Integers, column: Integers, rows: int, columns: int) -> Integers:
    """Connected component of each pair."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    size = rows + columns
    graph = coo_array((np.ones(len(row), dtype=np.int8), (row, column + rows)), shape=(size, size))
    return np.asarray(connected_components(graph, directed=False)[1][row], dtype=np.int64)


def _solved(row: Integers, column: Integers, gain: Array) -> Integers:
    """Chosen pairs of one component, by their places in it."""
    from scipy.optimize import linear_sum_assignment

    rows, row = np.unique(row, return_inverse=True)
    columns, column = np.unique(column, return_inverse=True)
    if len(rows) == 1 or len(columns) == 1:
        return np.array([int(np.argmax(gain))])
    table = np.zeros((len(rows), len(columns)))
    table[row, column] = gain
    place = np.full(table.shape, -1, dtype=np.int64)
    place[row, column] = np.arange(len(row))
    found = place[linear_sum_assignment(table, maximize=True)]
    # A pair that is not possible stands for two members that are left alone.
    return np.asarray(found[found >= 0])
