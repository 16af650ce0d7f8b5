"""A table as it is computed in C with floating-point numbers, rounding by rounding.

Shares of an interval come from its nearer end, so that an output near zero is as precise as any
other. A node that a float cannot hold is the next one above, and its rest is kept beside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.interop.c99.grid_table import GridTable
from fuzzytrack.reprs import summary

__all__ = ["FloatAxis", "FloatLookup", "float_lookup"]

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class FloatAxis:
    """Nodes of an input as numbers of C.

    Attributes
    ----------
    nodes : ndarray, shape (n,)
    rests : ndarray, shape (n,), or None
        What is to be added to each node; None if nothing is.
    rates : ndarray, shape (n - 1,)
        Inverse widths of the intervals.
    """

    nodes: Floats
    rests: Floats | None
    rates: Floats

    def __repr__(self) -> str:
        return summary(self, "nodes")

    def shares(self, x: Floats) -> tuple[NDArray[np.intp], Floats, Floats]:
        """Interval of each x, and the shares of it below and above x; NaN for NaN."""
        last = len(self.nodes) - 1
        inside = np.clip(x, self.nodes[0], self.nodes[last])
        index = np.zeros(x.shape, np.intp)
        for k in range(1, last):
            index[inside >= self.nodes[k]] = k
        below = inside - self.nodes[index]
        above = self.nodes[index + 1] - inside
        if self.rests is not None:
            below = below - self.rests[index]
            above = above + self.rests[index + 1]
        below, above = below * self.rates[index], above * self.rates[index]
        if self.rests is not None:
            below, above = np.maximum(below, 0), np.maximum(above, 0)
        return index, below, above


@dataclass(frozen=True, eq=False)
class FloatLookup:
    """A table in numbers of C; called with points, it gives what C gives.

    Attributes
    ----------
    axes : tuple of FloatAxis
        One for each input.
    moments, totals : dict of ndarray
        As in `fuzzytrack.interop.c99.grid_table.GridTable`.
    defaults : dict of float
        For each output with totals its value where no rule fires, or NaN.
    """

    axes: tuple[FloatAxis, ...]
    moments: dict[str, Floats]
    totals: dict[str, Floats]
    defaults: dict[str, float]

    def __repr__(self) -> str:
        return summary(self, "axes", "moments", "totals")

    def __call__(self, points: Array) -> dict[str, Floats]:
        """Outputs at points, shape (n, n_inputs), which are numbers of C already."""
        dtype = self.axes[0].nodes.dtype
        shares = [axis.shares(points[:, k].astype(dtype)) for k, axis in enumerate(self.axes)]
        result = {}
        for name, table in self.moments.items():
            value = _interpolated(table, shares)
            if name in self.totals:
                total = _interpolated(self.totals[name], shares)
                fires = ~(total <= 0)
                quotient = value / np.where(fires, total, dtype.type(1))
                value = np.where(fires, quotient, dtype.type(self.defaults[name]))
            result[name] = value
        return result


def float_lookup(table: GridTable, defaults: dict[str, float], dtype: Any) -> FloatLookup:
    """Round a table to numbers of C.

    Parameters
    ----------
    table : GridTable
    defaults : dict of float
        For each output its default, or NaN.
    dtype : numpy.float64 or numpy.float32

    Raises
    ------
    ValueError
        If a number of the table is too large for the type.
    """
    with np.errstate(over="ignore"):
        axes = tuple(_axis(nodes, dtype) for nodes in table.nodes)
        moments = {name: values.astype(dtype) for name, values in table.moments.items()}
    if not all(np.isfinite(v).all() for v in (*(a.rates for a in axes), *moments.values())):
        raise ValueError(
            "number: break points are too close, or outputs too large, for a float; use double"
        )
    totals = {name: values.astype(dtype) for name, values in table.totals.items()}
    return FloatLookup(axes, moments, totals, {name: defaults[name] for name in totals})


def _axis(nodes: Array, dtype: Any) -> FloatAxis:
    rounded = nodes.astype(dtype)
    # From below a node to its float and above, comparisons with both give the same.
    short = rounded < nodes
    rounded[short] = np.nextafter(rounded[short], dtype(np.inf))
    if rounded[0] > nodes[0]:
        rounded[0] = np.nextafter(rounded[0], dtype(-np.inf))
    rests = (nodes - rounded.astype(np.float64)).astype(dtype)
    return FloatAxis(rounded, rests if rests.any() else None, (1.0 / np.diff(nodes)).astype(dtype))


def _interpolated(table: Floats, shares: list[tuple[NDArray[np.intp], Floats, Floats]]) -> Floats:
    """Multilinear between the corners of each point's cell: the last input first."""
    n = len(shares)
    corners = [
        table[tuple(shares[k][0] + step for k, step in enumerate(steps))]
        for steps in product((0, 1), repeat=n)
    ]
    for _, below, above in reversed(shares):
        corners = [
            _between(low, high, below, above)
            for low, high in zip(corners[::2], corners[1::2], strict=True)
        ]
    return corners[0]


def _between(low: Floats, high: Floats, below: Floats, above: Floats) -> Floats:
    span = high - low
    return np.where(below <= above, low + below * span, high - above * span)
