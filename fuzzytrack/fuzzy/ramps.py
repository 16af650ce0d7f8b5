"""A rule base whose grades add up to 1 at every point, as a sum of products of ramps.

Where neighboring sets cross, one rises as the other falls, so a grade is the difference of two
ramps, each 0 below an interval and 1 above it. With products as AND and sums as OR, an output is
then a sum over products of ramps, one for each input, whose weights are differences of neighboring
cells of the rule table. Most of these weights are zero, and neither look-ups of rules nor divisions
are needed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.inference import Conclusions, conclusions
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.reprs import summary

__all__ = ["Ramps", "find_ramps"]


# Weights so small beside the cells are rounding.
_ROUNDING = 1e-13
# Weights are often whole multiples of one step: up to this multiple, they are written so.
_LARGEST_MULTIPLE = 8


@dataclass(frozen=True, eq=False)
class Ramps:
    """What `fuzzytrack.fuzzy.kernel` writes out.

    Attributes
    ----------
    ends : tuple of list of (float, float)
        For each input the ends of its ramps, in rising order.
    cells : dict of ndarray
        For each output its value in every cell of the rule table: one axis an input.
    """

    ends: tuple[list[tuple[float, float]], ...]
    cells: dict[str, Array]

    def __repr__(self) -> str:
        return summary(self, "ends", "cells")

    def lines(self) -> list[str]:
        """Python source: ``y0``, ``y1``, … of ``x0``, ``x1``, ….

        Each x must be a number; beyond its universe it counts as its end.
        """
        written = []
        for k, ends in enumerate(self.ends):
            # Ramps of one slope share a product.
            slopes = [1.0 / (high - low) for low, high in ends]
            products = {slope: f"p{k}_{m}" for m, slope in enumerate(dict.fromkeys(slopes))}
            written += [f"{name} = x{k} * {slope!r}" for slope, name in products.items()]
            for j, ((low, _), slope) in enumerate(zip(ends, slopes, strict=True), start=1):
                name = f"r{k}_{j}"
                written += [
                    f"{name} = {products[slope]} - {low * slope!r}",
                    # In this form each compiles to one instruction.
                    f"{name} = 0.0 if {name} < 0.0 else {name}",
                    f"{name} = 1.0 if {name} > 1.0 else {name}",
                ]
        for k, cells in enumerate(self.cells.values()):
            base, unit, weights = _weights(cells)
            terms = _expression(weights, 0)
            written.append(f"y{k} = {base!r}" + (f" + {unit!r} * ({terms})" if terms else ""))
        return written


def find_ramps(rules: RuleBase) -> Ramps | None:
    """Ramps of a rule base, or None if it cannot be written with them."""
    if not rules.adds_products:
        return None
    orders = [_order(variable) for variable in rules.inputs]
    cells = {}
    for output in rules.outputs:
        values = _cells(rules, conclusions(rules, output), [len(v.sets) for v in rules.inputs])
        if values is None:
            return None
        cells[output.name] = values
    ends = []
    for axis, (variable, order) in enumerate(zip(rules.inputs, orders, strict=True)):
        crossings = None if order is None else _crossings(variable, order)
        if order is None or crossings is None:
            return None
        ends.append(crossings)
        cells = {name: values.take(order, axis) for name, values in cells.items()}
    return Ramps(tuple(ends), cells)


def _order(variable: Variable) -> list[int] | None:
    """Indices of the sets from low to high; None if some are not trapezoids."""
    if any(s.shape not in ("trimf", "trapmf") for s in variable.sets):
        return None
    return sorted(range(len(variable.sets)), key=lambda k: variable.sets[k].parameters)


def _crossings(variable: Variable, order: list[int]) -> list[tuple[float, float]] | None:
    """Intervals in which a set falls as the next one rises; None if they do not fit."""
    low, high = variable.universe.low, variable.universe.high
    corners = []
    for k in order:
        first, *middle, last = variable.sets[k].parameters
        corners.append((first, middle[0], middle[-1], last))
    ends = [(c, d) for _, _, c, d in corners[:-1]]
    fits = ends == [(a, b) for a, b, _, _ in corners[1:]]
    fits = fits and corners[0][1] <= low and corners[-1][2] >= high
    # Sets with a vertical flank share their corner, and it has grade 1 in both.
    narrow = any(d - c < 1e-9 * (high - low) for c, d in ends)
    inside = all(low <= c and d <= high for c, d in ends)
    return ends if fits and inside and not narrow else None


def _cells(rules: RuleBase, about: Conclusions, shape: list[int]) -> Array | None:
    """Value of an output in each cell, by sets; None if cells differ in weight or are empty."""
    area, first = about.grades.sum(axis=1), about.grades @ about.y
    totals, moments = np.zeros(shape), np.zeros(shape)
    for r, confidence, term in zip(about.rule, about.confidence, about.term, strict=True):
        where: list[int | slice] = [slice(None)] * len(shape)
        for name, word in rules.rules[r].conditions:
            axis = rules.input_names.index(name)
            where[axis] = rules.inputs[axis].index(word)
        totals[tuple(where)] += confidence * area[term]
        moments[tuple(where)] += confidence * first[term]
    largest = float(totals.max())
    if not largest > 0.0 or float(totals.min()) < (1.0 - _ROUNDING) * largest:
        return None
    return np.asarray(moments / totals)


def _weights(cells: Array) -> tuple[float, float, Array]:
    """First cell, a unit, and the weights of the products of ramps in it (0 for the first)."""
    weights = cells
    for axis in range(cells.ndim):
        weights = np.diff(weights, axis=axis, prepend=0.0)
    first = (0,) * cells.ndim
    base = float(cells[first])
    weights[first] = 0.0
    weights[np.abs(weights) < _ROUNDING * np.abs(cells).max()] = 0.0
    sizes = np.abs(weights[weights != 0.0])
    if not len(sizes):
        return base, 1.0, weights
    # The largest one gives the step most precisely.
    unit = float(sizes.max()) / max(1.0, float(np.rint(sizes.max() / sizes.min())))
    multiples = np.rint(weights / unit)
    alike = np.abs(multiples * unit - weights).max() < _ROUNDING * np.abs(cells).max()
    if alike and np.abs(multiples).max() <= _LARGEST_MULTIPLE:
        return base, unit, multiples
    return base, 1.0, weights


def _expression(weights: Array, axis: int) -> str:
    """Sum over the products of ramps of this input and those after it; empty if there are none."""
    if weights.ndim == 0:
        return repr(float(weights)) if weights else ""
    terms = []
    for j, part in enumerate(weights):
        inner = _expression(part, axis + 1)
        if not inner:
            continue
        name = f"r{axis}_{j}"
        if j == 0:
            terms.append(inner)
        elif inner == "1.0":
            terms.append(name)
        elif inner == "-1.0":
            terms.append(f"-{name}")
        else:
            terms.append(f"{inner} * {name}" if part.ndim == 0 else f"{name} * ({inner})")
    return _sum(terms)


def _sum(terms: list[str]) -> str:
    """Sum of two halves, each summed so: the fewest additions then depend on one another."""
    # If possible, no sum starts with a minus.
    terms = sorted(terms, key=lambda term: term.startswith("-"))
    if len(terms) < 3:
        return " + ".join(terms).replace("+ -", "- ")
    half = (len(terms) + 1) // 2
    rest = _sum(terms[half:])
    if len(terms) - half > 1:
        rest = f"({rest})"
    return f"{_sum(terms[:half])} + {rest}".replace("+ -", "- ")
