"""Rule evaluation on arrays: from input grades to fuzzy outputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.norms import S_NORMS, T_NORMS
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.variable import Universe, Variable
from fuzzytrack.reprs import summary

__all__ = [
    "Antecedents",
    "Conclusions",
    "antecedents",
    "conclusions",
    "conjoin",
    "disjoin",
    "output_grid",
]


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

    def of(self, rules: NDArray[np.intp]) -> Conclusions:
        """Those of some rules alone, given by ascending indices."""
        rows, rule = _among(self.rule, rules)
        return replace(self, rule=rule, term=self.term[rows], confidence=self.confidence[rows])

    def infer(self, strength: Array) -> Array:
        """Fuzzy output, shape (n, n_grid), from rule strengths, shape (n, n_rules)."""
        operators = self.operators
        imply = T_NORMS[operators.implying].values
        if operators.disjunction == "sum" and operators.implying == "product":
            terms, levels = self._levels(strength, np.add)
            return np.asarray(levels.T @ self.grades[terms])
        fuzzy = np.zeros((len(strength), len(self.y)))
        if operators.disjunction == "max":
            for term, level in zip(*self._levels(strength, np.maximum), strict=True):
                np.maximum(fuzzy, imply(level[:, None], self.grades[term]), out=fuzzy)
            return fuzzy
        # The sum of clipped sets does not regroup by set: join rule by rule.
        join = S_NORMS[operators.disjunction].values
        called = self._called(strength, np.arange(len(self.term)))
        for row, term in zip(called, self.term, strict=True):
            fuzzy = join(fuzzy, imply(row[:, None], self.grades[term]))
        return fuzzy

    def _called(self, strength: Array, consequents: NDArray[np.intp]) -> Array:
        """How strongly some of the consequents are concluded, shape (n_consequents, n)."""
        confidence = self.confidence[consequents, None]
        weigh = T_NORMS[self.operators.weighing].values
        return weigh(strength.T[self.rule[consequents]], confidence)

    def _levels(self, strength: Array, join: np.ufunc) -> tuple[NDArray[np.intp], Array]:
        """Sets that are concluded, and how strongly each is by all rules, shape (n_terms, n)."""
        order = np.argsort(self.term, kind="stable")
        terms, starts = np.unique(self.term[order], return_index=True)
        # No matrix product, which would be one of many small ones, each on all processors.
        return terms, join.reduceat(self._called(strength, order), starts, axis=0)


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


@dataclass(frozen=True)
class Antecedents:
    """Conditions of rules as arrays, with a row for each group of conditions by which a rule fires.

    Attributes
    ----------
    operators : Operators
    rule : ndarray of int, shape (n_groups,)
        Index of the rule, ascending.
    term : ndarray of int, shape (n_groups, n_inputs)
        Index of the set that is needed of each input, -1 where any value will do.
    """

    operators: Operators
    rule: NDArray[np.intp]
    term: NDArray[np.intp]

    def __repr__(self) -> str:
        return summary(self, "operators", "term")

    def firing(self, grades: Sequence[Array]) -> NDArray[np.intp]:
        """Rules with a strength above 0 at one of some points at least, as ascending indices.

        Parameters
        ----------
        grades : sequence of ndarray
            For each input the grades of its sets, shape (n_sets, n).
        """
        met = np.ones(len(self.rule), dtype=bool)
        for of_input, term in zip(grades, self.term.T, strict=True):
            met &= np.append(of_input.any(axis=1), True)[term]
        return np.unique(self.rule[met])

    def of(self, rules: NDArray[np.intp]) -> Antecedents:
        """Those of some rules alone, given by ascending indices."""
        rows, rule = _among(self.rule, rules)
        return Antecedents(self.operators, rule, self.term[rows])

    def strengths(self, grades: Sequence[Array], whole: Sequence[Array] | None = None) -> Array:
        """Firing strength of every rule (Llinas et al. 1998, Eq. 3.4), shape (n, n_rules).

        Parameters
        ----------
        grades : sequence of ndarray
            For each input the grades of its sets, shape (n_sets, n).
        whole : sequence of ndarray, optional
            For each input its grade of the whole universe, shape (n,): the grade of a fuzzy input
            in a rule that does not name it. One unless given.
        """
        both = T_NORMS[self.operators.conjunction].values
        either = S_NORMS[self.operators.alternatives].values
        anything = [np.ones(g.shape[1]) for g in grades] if whole is None else whole
        members = (
            # The last row is that of the index -1.
            np.concatenate([of_input, all_of_it[None]])[term]
            for of_input, all_of_it, term in zip(grades, anything, self.term.T, strict=True)
        )
        groups = reduce(both, members)
        _, firsts, counts = np.unique(self.rule, return_index=True, return_counts=True)
        found = groups if len(firsts) == len(groups) else groups[firsts]
        for further in range(1, max(counts, default=0)):
            more = counts > further
            found[more] = either(found[more], groups[firsts[more] + further])
        return np.asarray(found.T)


def antecedents(rulebase: RuleBase) -> Antecedents:
    """Collect the conditions of the rules."""
    places = {
        (variable.name, name): (axis, term)
        for axis, variable in enumerate(rulebase.inputs)
        for term, name in enumerate(variable.set_names)
    }
    groups = [(k, group) for k, rule in enumerate(rulebase.rules) for group in rule.groups]
    term = np.full((len(groups), len(rulebase.inputs)), -1, dtype=np.intp)
    for row, (_, group) in enumerate(groups):
        for condition in group:
            axis, index = places[condition]
            term[row, axis] = index
    return Antecedents(rulebase.operators, np.array([k for k, _ in groups]), term)


def _among(
    rule: NDArray[np.intp], rules: NDArray[np.intp]
) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
    """Which rows are about one of some rules, and the place of the rule among these."""
    rows = np.isin(rule, rules)
    return rows, np.searchsorted(rules, rule[rows])
