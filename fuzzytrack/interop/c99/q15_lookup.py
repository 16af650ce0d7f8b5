"""A table as it is computed in C with integers of 16 bits, step by step.

A number q of 16 bits stands for center + q/32768 · half of a universe. Nodes have eight bits more,
since a break point of a set is seldom one of these numbers.

Beside inputs at which no rule fires, both parts of a quotient are close to 0, so there they are
weighed without rounding: the quotient then lies between those at the corners of its cell.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.variable import Universe
from fuzzytrack.interop.c99.grid_table import GridTable
from fuzzytrack.reprs import summary

__all__ = ["Q15Axis", "Q15Lookup", "q15_lookup", "q15_place", "q15_value"]

Integers = NDArray[np.uint64]

#: Bits of a node beyond those of an input.
EXTRA = 8
#: Inputs with which a quotient is weighed without rounding: each needs 16 bits of 64.
MOST_WEIGHED = 3
_TOP = 65_536
# A smaller total is rounding.
_ROUNDING = 1e-9


def q15_place(values: Array, universe: Universe) -> Array:
    """Places of values in steps of 16 bits, -32768 at the low end of a universe; not rounded."""
    center = (universe.low + universe.high) / 2
    return np.asarray((values - center) / (universe.high - universe.low) * _TOP)


def q15_value(q: Array, universe: Universe) -> Array:
    """Values of numbers of 16 bits in a universe."""
    center = (universe.low + universe.high) / 2
    return np.asarray(center + q * ((universe.high - universe.low) / _TOP))


@dataclass(frozen=True, eq=False)
class Q15Axis:
    """Nodes of an input as integers of C.

    Attributes
    ----------
    nodes : ndarray of uint64, shape (n,)
        From 0 at the low end of the universe to 2²⁴ at its high end.
    rates : ndarray of uint64, shape (n - 1,)
        Of each interval 2 to the power 16 + shift, divided by its width.
    shift : int
    """

    nodes: Integers
    rates: Integers
    shift: int

    def __repr__(self) -> str:
        return summary(self, "nodes", "shift")

    def shares(self, q: NDArray[np.int64]) -> tuple[NDArray[np.intp], Integers]:
        """Interval of each number, and the share of it below the number, from 0 to 65536."""
        last = len(self.nodes) - 1
        fine = (q + 32_768).astype(np.uint64) << np.uint64(EXTRA)
        inside = np.clip(fine, self.nodes[0], self.nodes[last])
        index = np.zeros(q.shape, np.intp)
        for k in range(1, last):
            index[inside >= self.nodes[k]] = k
        half = np.uint64(1 << (self.shift - 1))
        share = ((inside - self.nodes[index]) * self.rates[index] + half) >> np.uint64(self.shift)
        return index, share


@dataclass(frozen=True, eq=False)
class Q15Lookup:
    """A table in integers of C; called with numbers of 16 bits, it gives what C gives.

    Attributes
    ----------
    axes : tuple of Q15Axis
        One for each input.
    moments, totals : dict of ndarray of uint64
        As in `fuzzytrack.interop.c99.grid_table.GridTable`, from 0 to 65535.
    defaults : dict of int
        For each output with totals its number where no rule fires, from 0 to 65535.
    """

    axes: tuple[Q15Axis, ...]
    moments: dict[str, Integers]
    totals: dict[str, Integers]
    defaults: dict[str, int]

    def __repr__(self) -> str:
        return summary(self, "axes", "moments", "totals")

    def is_silent(self, name: str) -> bool:
        """Whether there are inputs at which no rule about an output fires."""
        return name in self.totals and not self.totals[name].min() > 0

    def __call__(self, points: NDArray[np.int64]) -> dict[str, NDArray[np.int64]]:
        """Outputs at points, shape (n, n_inputs), as numbers of 16 bits."""
        shares = [axis.shares(points[:, k]) for k, axis in enumerate(self.axes)]
        result = {}
        for name, table in self.moments.items():
            combine = _weighed if self.is_silent(name) else _interpolated
            value = combine(table, shares)
            if name in self.totals:
                total = combine(self.totals[name], shares)
                if self.is_silent(name) and len(shares) == MOST_WEIGHED:
                    many = total >= np.uint64(1 << 47)
                    value, total = (np.where(many, v >> np.uint64(16), v) for v in (value, total))
                divisor = np.maximum(total, np.uint64(1))
                quotient = ((value << np.uint64(16)) + (total >> np.uint64(1))) // divisor
                value = np.where(
                    total == 0,
                    np.uint64(self.defaults[name]),
                    np.minimum(quotient, np.uint64(_TOP - 1)),
                )
            result[name] = value.astype(np.int64) - 32_768
        return result


def q15_lookup(
    table: GridTable,
    inputs: tuple[Universe, ...],
    outputs: dict[str, Universe],
    defaults: dict[str, float],
) -> Q15Lookup:
    """Round a table to integers of C.

    Parameters
    ----------
    table : GridTable
        Without NaN.
    inputs : tuple of Universe
    outputs : dict of Universe
    defaults : dict of float
        For each output with totals its default.

    Raises
    ------
    ValueError
        If two nodes are closer than a part in 2²⁴ of their universe; or no rule fires somewhere,
        and there are more than three inputs, or a node at which the rules hardly fire.
    """
    moments, totals = {}, {}
    for name, values in table.moments.items():
        universe = outputs[name]
        if name in table.totals:
            total = table.totals[name]
            moment = (values - total * universe.low) / (universe.high - universe.low)
            # In a quotient a whole may be any number, as long as it is the same in both.
            moments[name], totals[name] = (_sixteen_bits(v, _TOP - 1) for v in (moment, total))
            _check_totals(name, total, totals[name])
        else:
            moments[name] = _sixteen_bits(_part(values, universe))
    places = {
        name: int(_sixteen_bits(_part(np.array(defaults[name]), outputs[name])))
        for name in totals
        if not np.isnan(defaults[name])
    }
    axes = tuple(_axis(nodes, u) for nodes, u in zip(table.nodes, inputs, strict=True))
    return Q15Lookup(axes, moments, totals, {name: places.get(name, 0) for name in totals})


def _check_totals(name: str, exact: Array, rounded: Integers) -> None:
    """Raise ValueError where integers cannot tell whether a rule fires."""
    if rounded.min() > 0:
        return
    if exact.ndim > MOST_WEIGHED:
        raise ValueError(
            f"number: there are inputs at which no rule about {name} fires, and of {exact.ndim} "
            f"inputs; integers of 64 bits are enough for {MOST_WEIGHED}. Add rules, or use double "
            "or float"
        )
    if ((exact > _ROUNDING) & (rounded == 0)).any():
        raise ValueError(
            f"number: at a break point rules about {name} fire at less than 1/131,070 of their "
            "largest strength, which is 0 in integers of 16 bits; use double or float"
        )


def _part(values: Array, universe: Universe) -> Array:
    return (values - universe.low) / (universe.high - universe.low)


def _sixteen_bits(parts: Array, whole: int = _TOP) -> Integers:
    """Parts of a whole as numbers from 0 to 65535; a whole of 65536 is one too many."""
    return np.clip(np.rint(parts * whole), 0, _TOP - 1).astype(np.uint64)


def _axis(nodes: Array, universe: Universe) -> Q15Axis:
    places = np.rint(_part(nodes, universe) * (1 << (16 + EXTRA))).astype(np.uint64)
    close = np.flatnonzero(np.diff(places) == 0)
    if len(close):
        low, high = nodes[close[0] : close[0] + 2].tolist()
        raise ValueError(
            f"number: the break points {low} and {high} of an input are one in integers of 24 "
            f"bits; use double or float"
        )
    widths = [int(w) for w in np.diff(places)]
    shift = 8
    while shift < 31 and (1 << (17 + shift)) // min(widths) < 1 << 32:
        shift += 1
    rates = np.array([(1 << (16 + shift)) // w for w in widths], np.uint64)
    return Q15Axis(places, rates, shift)


def _weighed(table: Integers, shares: list[tuple[NDArray[np.intp], Integers]]) -> Integers:
    """As `_interpolated`, not rounded: 65536 times as large for each input."""
    corners = _corners(table, shares)
    for _, share in reversed(shares):
        rest = np.uint64(_TOP) - share
        corners = [
            low * rest + high * share for low, high in zip(corners[::2], corners[1::2], strict=True)
        ]
    return corners[0]


def _corners(table: Integers, shares: list[tuple[NDArray[np.intp], Integers]]) -> list[Integers]:
    """Values at the corners of each point's cell, the last input changing fastest."""
    return [
        table[tuple(shares[k][0] + step for k, step in enumerate(steps))]
        for steps in product((0, 1), repeat=len(shares))
    ]


def _interpolated(table: Integers, shares: list[tuple[NDArray[np.intp], Integers]]) -> Integers:
    """Multilinear between the corners of each point's cell: the last input first."""
    corners = _corners(table, shares)
    half, bits = np.uint64(_TOP >> 1), np.uint64(16)
    for _, share in reversed(shares):
        rest = np.uint64(_TOP) - share
        corners = [
            (low * rest + high * share + half) >> bits
            for low, high in zip(corners[::2], corners[1::2], strict=True)
        ]
    return corners[0]
