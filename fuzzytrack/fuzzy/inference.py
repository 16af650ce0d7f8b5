"""Rule evaluation on arrays: from input grades to fuzzy outputs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.norms import S_NORMS, T_NORMS
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.rulebase import Conditions, RuleBase
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.reprs import summary

__all__ = ["Conclusions", "conclusions", "conjoin", "disjoin", "output_grid", "strengths"]


#: Distance from a grid point, in steps of the grid, up to which a place is on it.
_ROUNDING = 1e-9


def conjoin(operators: Operators, a: Array, b: Array) -> Array:
    """AND of two arrays of grades (Table 3.1 of Llinas et al. 1998)."""
    return T_NORMS[operators.conjunction].values(a, b)


def disjoin(operators: Operators, grades: Array, axis: int | tuple[int, ...]) -> Array:
    """OR over axes of an array of grades (Table 3.1): sum or max."""
    return np.asarray(grades.sum(axis) if operators.disjunction == "sum" else grades.max(axis))


def output_grid(operators: Operators, output: Variable) -> tuple[Array, Array]:
    """Points on which an output is inferred, and the sets' grades there.

    Weighted centers (Eq. 3.13) are the centroid over a universe made of the sets' centers, each
    belonging to its own set alone; so the same inference serves them. A singleton between two grid
    points is a point more, which belongs to singletons alone: the sums over the other sets stay.

    Returns
    -------
    y : ndarray, shape (n,)
    grades : ndarray, shape (n_sets, n)
    """
    if operators.defuzzification == "weighted-centers":
        return output.centers(), np.eye(len(output.sets))
    universe = output.universe
    places = {s.parameters[0] for s in output.sets if s.shape == "singleton"}
    inside = (p for p in places if universe.low <= p <= universe.high)
    between = [p for p in inside if not _is_on(universe, p)]
    if not between:
        return universe.values, output.memberships()
    y = np.sort(np.concatenate([universe.values, between]))
    points = np.searchsorted(y, universe.values)
    grades = np.zeros((len(output.sets), len(y)))
    grades[:, points] = output.memberships()
    for row, fuzzy_set in enumerate(output.sets):
        if fuzzy_set.shape == "singleton" and fuzzy_set.parameters[0] in between:
            grades[row] = y == fuzzy_set.parameters[0]
    return y, grades


def _is_on(universe: Universe, place: float) -> bool:
    """Whether a place is one of the grid points, up to rounding."""
    nearest = universe.values[universe.nearest(np.asarray(place))]
    return bool(abs(nearest - place) <= _ROUNDING * universe.step)


@dataclass(frozen=True)
class Conclusions:
    """Conclusions of the rules about one output, as arrays over its consequents.

    Attributes
    ----------
    rule, term : ndarray of int, shape (n_consequents,)
        Index of the rule, and of the output set that it concludes.
    confidence : ndarray, shape (n_consequents,)
    y, grades : ndarray
        The output's grid and the grades of its sets there; see `output_grid`.
    """

    operators: Operators
    rule: NDArray[np.intp]
    term: NDArray[np.intp]
    confidence: Array
    y: Array
    grades: Array

    def __repr__(self) -> str:
        return summary(self, "operators", "grades")

    def infer(self, strength: Array) -> Array:
        """Fuzzy output, shape (n, n_grid), from rule strengths, shape (n, n_rules)."""
        operators = self.operators
        called = T_NORMS[operators.weighing].values(strength[:, self.rule], self.confidence)
        imply = T_NORMS[operators.implying].values
        if operators.disjunction == "sum" and operators.implying == "product":
            chosen = np.zeros((len(self.term), len(self.grades)))
            chosen[np.arange(len(self.term)), self.term] = 1.0
            return np.asarray((called @ chosen) @ self.grades)
        fuzzy = np.zeros((len(strength), len(self.y)))
        if operators.disjunction == "max":
            for term in np.unique(self.term):
                level = called[:, self.term == term].max(axis=1)
                np.maximum(fuzzy, imply(level[:, None], self.grades[term]), out=fuzzy)
            return fuzzy
        # The sum of clipped sets does not regroup by set: join rule by rule.
        join = S_NORMS[operators.disjunction].values
        for column, term in enumerate(self.term):
            fuzzy = join(fuzzy, imply(called[:, column, None], self.grades[term]))
        return fuzzy


def conclusions(rulebase: RuleBase, output: Variable) -> Conclusions:
    """Collect the conclusions of the rules about one output."""
    rows = [
        (number, output.index(consequent.set_name), consequent.confidence)
        for number, rule in enumerate(rulebase.rules)
        for consequent in rule.consequents
        if consequent.output == output.name
    ]
    rule, term, confidence = zip(*rows, strict=True)
    operators = rulebase.operators_of(output)
    y, grades = output_grid(operators, output)
    return Conclusions(operators, np.array(rule), np.array(term), np.array(confidence), y, grades)


def strengths(
    rulebase: RuleBase, grades: dict[str, Array], whole: dict[str, Array] | None = None
) -> Array:
    """Evaluate the firing strength of every rule (Eq. 3.4).

    Parameters
    ----------
    rulebase : RuleBase
    grades : dict of ndarray
        For each input, the grades of its sets, shape (n_sets, n).
    whole : dict of ndarray, optional
        For each input, its grade of the whole universe, shape (n,): the grade of a fuzzy input in a
        rule that does not name it. One unless given.

    Returns
    -------
    ndarray, shape (n, n_rules)
    """

    def strength(conditions: Conditions) -> Array:
        members = [grades[name][rulebase.input(name).index(term)] for name, term in conditions]
        named = dict(conditions)
        members += [grade for name, grade in (whole or {}).items() if name not in named]
        return reduce(T_NORMS[rulebase.operators.conjunction].values, members)

    either = S_NORMS[rulebase.operators.alternatives].values
    return np.stack([reduce(either, map(strength, r.groups)) for r in rulebase.rules]).T
