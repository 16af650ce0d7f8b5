"""Control systems of scikit-fuzzy as rule bases, and back.

A control system samples its sets on the universe of their variable and draws straight lines between
the points, which is the shape ``discrete`` here. It cuts sets at the strengths of rules and takes
their maximum, whatever stands for AND.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from functools import reduce
from operator import and_, or_
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.fuzzy.formats.parts import Condition, RulePart, SetPart, System, VariablePart
from fuzzytrack.fuzzy.loading import as_rulebase
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.rulebase import MAX_ALTERNATIVES, Conditions, Rule, RuleBase
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.yamltree import quoted

if TYPE_CHECKING:
    from skfuzzy.control import ControlSystem

__all__ = ["from_skfuzzy", "to_skfuzzy"]

#: Fewest cells over which an output is summed.
_CELLS = 2000
#: Evenly spaced points of a universe that is written.
_POINTS = 501
#: Points that a line through their neighbors meets so nearly are left out.
_STRAIGHT = 1e-14

_ANDS = {"fmin": "min", "minimum": "min", "multiply": "product", "accumulation_mult": "product"}
_ORS = {"fmax": "max", "maximum": "max", "accumulation_max": "max"}
_CRISP = ("centroid", "bisector", "mom", "som", "lom")

Groups = list[tuple[Condition, ...]]


# -------------------------------------------------------------------- from scikit-fuzzy


def from_skfuzzy(control_system: ControlSystem, name: str = "control-system") -> RuleBase:
    """Rule base of a control system of scikit-fuzzy.

    Parameters
    ----------
    control_system : skfuzzy.control.ControlSystem
        Antecedents may have any universes, of 2 to 2000 points. The names of variables become
        identifiers.
    name : str
        Name of the rule base.

    Returns
    -------
    RuleBase
        Inputs and rules are the same; outputs are summed over at least 2000 cells. Scikit-fuzzy
        instead integrates straight lines between the points of the universe of a consequent, so
        outputs differ by what these lines differ from the sets where two of them cross between two
        points: less than a step of that universe.

    Raises
    ------
    RuleBaseError
        If a part has no counterpart: functions other than the minimum, the product and the maximum,
        a NOT of several terms joined by a product, two terms of one variable that hold together,
        weights above 1, other defuzzification methods.
    TypeError
        If it is no control system.
    """
    from skfuzzy.control import ControlSystem

    if not isinstance(control_system, ControlSystem):
        raise TypeError(
            "control_system must be a skfuzzy.control.ControlSystem, got "
            f"{type(control_system).__name__}"
        )
    try:
        return _Reader(control_system, name).system().rulebase()
    except RuleBaseError as error:
        number = error.location.line if error.location else 0
        where = f"control_system, rule {number}" if number else "control_system"
        raise RuleBaseError(f"{where}: {error.message}") from None


def _place(rule: int = 0) -> Location:
    """Place of a rule by its number from 1; 0 for all else."""
    return Location("control_system", rule, 1)


class _Reader:
    def __init__(self, control_system: Any, name: str) -> None:
        self.name = name
        self.rules = list(control_system.rules)
        self.antecedents = list(control_system.antecedents)
        self.consequents = list(control_system.consequents)
        self.conjunction = self._common("and_func", _ANDS)
        self._common("or_func", _ORS)

    def _common(self, attribute: str, allowed: dict[str, str]) -> str:
        """The norm of all rules for one of their functions."""
        found = set()
        for number, rule in enumerate(self.rules, start=1):
            function = getattr(getattr(rule, attribute), "__name__", "?")
            if function not in allowed:
                raise RuleBaseError(
                    f"{attribute} {function} has no counterpart; allowed: {', '.join(allowed)}",
                    _place(number),
                )
            found.add(allowed[function])
        if len(found) > 1:
            raise RuleBaseError(f"rules with different functions {attribute} have no counterpart")
        return found.pop() if found else "min"

    def system(self) -> System:
        inputs = [self._variable(v) for v in self.antecedents]
        outputs = [self._output(v) for v in self.consequents]
        system = System(self.name, _place(), self._operators("centroid"), inputs, outputs)
        methods = [v.defuzzify_method for v in self.consequents]
        if methods:
            system.operators = self._operators(methods[0])
        for part, method in zip(outputs, methods, strict=True):
            own = self._operators(method)
            part.operators = None if own == system.operators else own
        for number, rule in enumerate(self.rules, start=1):
            system.rules += self._rule(rule, number)
        return system

    def _operators(self, method: str) -> Operators:
        if method not in _CRISP:
            raise RuleBaseError(
                f"defuzzify_method {quoted(str(method))} has no counterpart; allowed: "
                f"{', '.join(_CRISP)}"
            )
        return Operators(self.conjunction, "max", method, "min", "product")

    def _variable(self, variable: Any) -> VariablePart:
        label = str(variable.label)
        universe = np.asarray(variable.universe, dtype=np.float64)
        if universe.ndim != 1 or len(universe) < 2 or not np.all(np.diff(universe) > 0):
            raise RuleBaseError(f"universe of {quoted(label)} must ascend, with 2 points or more")
        part = VariablePart(label, float(universe[0]), float(universe[-1]), _place(), label=label)
        for term in variable.terms.values():
            grades = np.clip(np.asarray(term.mf, dtype=np.float64), 0.0, 1.0)
            kept = _corners(universe, grades)
            pairs = np.stack([universe[kept], grades[kept]], axis=1)
            numbers = tuple(pairs.ravel().tolist())
            part.sets.append(SetPart(str(term.label), "discrete", numbers, _place()))
        return part

    def _output(self, variable: Any) -> VariablePart:
        method = getattr(variable.accumulation_method, "__name__", "?")
        if method not in _ORS:
            raise RuleBaseError(
                f"accumulation_method {method} of {quoted(str(variable.label))} has no "
                f"counterpart; allowed: {', '.join(_ORS)}"
            )
        part = self._variable(variable)
        cells = len(variable.universe) - 1
        # Points of the universe are ends of cells, so that sets are straight within each.
        part.grid = (cells * -(-_CELLS // cells), "midpoints")
        return part

    # ---------------------------------------------------------------- rules

    def _rule(self, rule: Any, number: int) -> Iterator[RulePart]:
        """One part for each weight of a conclusion."""
        place = _place(number)
        groups = tuple(self._groups(rule.antecedent, place, wanted=True))
        by_weight: dict[float, list[Condition]] = {}
        for consequent in rule.consequent:
            found = self._condition(consequent.term, place)
            if not found.of_output:
                raise RuleBaseError("a conclusion about an antecedent has no counterpart", place)
            by_weight.setdefault(float(consequent.weight), []).append(
                Condition(found.variable, found.index)
            )
        for weight, conclusions in by_weight.items():
            yield RulePart(groups, tuple(conclusions), weight, place)

    def _groups(self, clause: Any, place: Location, *, wanted: bool) -> Groups:
        """Alternatives of joint conditions; those of the complement if it is not `wanted`."""
        kind = getattr(clause, "kind", None)
        if kind is None:
            found = self._condition(clause, place)
            hedges = () if wanted else ("not",)
            return [(Condition(found.variable, found.index, hedges, found.of_output),)]
        if kind == "not":
            return self._groups(clause.term1, place, wanted=not wanted)
        if not wanted and self.conjunction != "min":
            raise RuleBaseError(
                "a NOT of several terms has no counterpart where AND is the product", place
            )
        first = self._groups(clause.term1, place, wanted=wanted)
        second = self._groups(clause.term2, place, wanted=wanted)
        # The complement of a minimum is the maximum of the complements.
        if (kind == "or") == wanted:
            groups = [*first, *second]
        else:
            groups = [(*one, *other) for one in first for other in second]
        if len(groups) > MAX_ALTERNATIVES:
            raise RuleBaseError(f"more than {MAX_ALTERNATIVES} alternatives", place)
        return groups

    def _condition(self, term: Any, place: Location) -> Condition:
        for of_output, variables in ((False, self.antecedents), (True, self.consequents)):
            for number, variable in enumerate(variables):
                if term.parent is variable:
                    index = list(variable.terms).index(term.label)
                    return Condition(number, index, (), of_output)
        raise RuleBaseError(f"the term {term!r} belongs to no variable of the system", place)


def _corners(x: Array, y: Array) -> NDArray[np.intp]:
    """Indices of the points of a line that are no points of a straight part of it."""
    inside = y[:-2] + (y[2:] - y[:-2]) * ((x[1:-1] - x[:-2]) / (x[2:] - x[:-2]))
    bends = np.abs(inside - y[1:-1]) > _STRAIGHT
    return np.flatnonzero(np.concatenate([[True], bends, [True]]))


# -------------------------------------------------------------------- to scikit-fuzzy


def to_skfuzzy(rules: RuleBase | str | os.PathLike[str], points: int = _POINTS) -> ControlSystem:
    """Control system of scikit-fuzzy of a rule base.

    Parameters
    ----------
    rules : RuleBase, str or path
        The rule base; or as for `fuzzytrack.load_rulebase`.
    points : int
        Evenly spaced points of each universe, at least 2; the corners of sets are added. Sets
        without curves are then exact, others are lines between the points.

    Returns
    -------
    skfuzzy.control.ControlSystem
        A simulation of it integrates straight lines and does not sum over a grid, and raises an
        error where no rule fires; defaults, universes and settings of a scheduler are not in it.

    Raises
    ------
    RuleBaseError
        If scikit-fuzzy has no counterpart to the operators; names it.
    ValueError
        If `points` is below 2.
    """
    from skfuzzy import control

    if points < 2:
        raise ValueError(f"points must be at least 2, got {points}")
    rules = as_rulebase(rules)
    _check(rules)
    antecedents = {v.name: _sampled(control.Antecedent, v, points) for v in rules.inputs}
    consequents = {}
    for output in rules.outputs:
        consequent = _sampled(control.Consequent, output, points)
        consequent.defuzzify_method = rules.operators_of(output).defuzzification
        consequents[output.name] = consequent
    joined = np.fmin if rules.operators.conjunction == "min" else np.multiply
    written = [
        control.Rule(
            reduce(or_, (_joint(group, antecedents) for group in rule.groups)),
            _concluded(rule, consequents),
            and_func=joined,
        )
        for rule in rules.rules
    ]
    return control.ControlSystem(written)


def _check(rules: RuleBase) -> None:
    operators = rules.operators
    several = any(rule.alternatives for rule in rules.rules)
    sure = all(c.confidence == 1.0 for rule in rules.rules for c in rule.consequents)
    algebras = [rules.operators_of(output) for output in rules.outputs]
    for fits, what in (
        (operators.conjunction in ("min", "product"), f"and {operators.conjunction}"),
        (not several or operators.alternatives == "max", f"alternatives {operators.alternatives}"),
        *((o.disjunction == "max", f"or {o.disjunction}") for o in algebras),
        *((o.implying == "min", f"implication {o.implying}") for o in algebras),
        *((o.defuzzification in _CRISP, o.defuzzification) for o in algebras),
        *((sure or o.weighing == "product", f"weighting {o.weighing}") for o in algebras),
    ):
        if not fits:
            raise RuleBaseError(f"{rules.name}: {what} has no counterpart in scikit-fuzzy")


def _sampled(kind: Callable[[Array, str], Any], variable: Variable, points: int) -> Any:
    x = variable.nodes(points)
    found = kind(x, variable.name)
    for fuzzy_set in variable.sets:
        found[fuzzy_set.name] = np.clip(fuzzy_set.membership(x), 0.0, 1.0)
    return found


def _joint(conditions: Conditions, antecedents: dict[str, Any]) -> Any:
    return reduce(and_, (antecedents[name][term] for name, term in conditions))


def _concluded(rule: Rule, consequents: dict[str, Any]) -> list[Any]:
    return [consequents[c.output][c.set_name] % c.confidence for c in rule.consequents]
