"""Columns of the relational matrix of Llinas et al. (1998), one number for each output set."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fuzzytrack.fuzzy.inference import antecedents, conclusions
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.reprs import summary

__all__ = ["Columns", "columns"]


@dataclass(frozen=True)
class Columns:
    """Columns of a relational matrix, for every cell of the inputs' grid.

    Attributes
    ----------
    low, step : tuple of float
        First point and spacing of each input's grid.
    levels : tuple
        ``levels[output][i][j]``: the weights of the output's sets where the inputs are at grid
        points i and j, for the centroid with the area of each set in them.
    centers : tuple
        ``centers[output]``: the sets' centroids.
    """

    low: tuple[float, float]
    step: tuple[float, float]
    levels: tuple[list[list[list[float]]], ...]
    centers: tuple[list[float], ...]

    def __repr__(self) -> str:
        return summary(self, "low", "step")


def columns(rules: RuleBase) -> Columns:
    """Columns of the relational matrix of a rule base with two inputs, product and sum.

    Raises
    ------
    ValueError
        If the rule base is another.
    """
    operators = rules.operators
    algebras = {(o.conjunction, o.disjunction) for o in map(rules.operators_of, rules.outputs)}
    if algebras != {("product", "sum")} or any(rule.alternatives for rule in rules.rules):
        raise ValueError(
            f"rules: {rules.name} must have the operators product and sum; it has "
            f"{operators.conjunction} and {operators.disjunction}"
        )
    if len(rules.inputs) != 2:
        raise ValueError(f"rules: {rules.name} must have 2 inputs, it has {len(rules.inputs)}")
    grids = [v.universe.values for v in rules.inputs]
    cells = [g.ravel() for g in np.meshgrid(*map(np.arange, map(len, grids)), indexing="ij")]
    grades = [v.memberships()[:, places] for v, places in zip(rules.inputs, cells, strict=True)]
    strength = antecedents(rules).strengths(grades)
    levels, centers = [], []
    for output in rules.outputs:
        about = conclusions(rules, output)
        area = about.grades.sum(axis=1)
        called = np.zeros((len(strength), len(area)))
        for rule, term, confidence in zip(about.rule, about.term, about.confidence, strict=True):
            called[:, term] += strength[:, rule] * confidence
        table = (called * area).reshape(len(grids[0]), len(grids[1]), len(area))
        levels.append(table.tolist())
        centers.append((about.grades @ about.y / area).tolist())
    first, second = (v.universe for v in rules.inputs)
    return Columns(
        (first.first, second.first), (first.step, second.step), tuple(levels), tuple(centers)
    )
