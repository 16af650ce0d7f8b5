"""The fuzzy system: a rule base that can be evaluated, explained and drawn."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import NoRuleFiresWarning
from fuzzytrack.fuzzy.defuzzification import defuzzify
from fuzzytrack.fuzzy.fuzzification import Fuzzification
from fuzzytrack.fuzzy.inference import (
    Antecedents,
    Conclusions,
    antecedents,
    conclusions,
    conjoin,
    disjoin,
    output_grid,
)
from fuzzytrack.fuzzy.loading import as_rulebase
from fuzzytrack.fuzzy.relation import compose, relation
from fuzzytrack.fuzzy.rulebase import Rule, RuleBase
from fuzzytrack.fuzzy.table import InterpolationTable, build_table, default_nodes
from fuzzytrack.html_reprs import Cell, block, table
from fuzzytrack.reprs import call, summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["METHODS", "FiredRule", "FuzzySystem", "Surface"]


METHODS = ("exact", "relation", "table")
# Points at a time, and strengths of rules that fire at one of them, at a time: the arrays of one
# chunk stay in the processor cache.
_CHUNK = 4_096
_MOST_STRENGTHS = 262_144


@dataclass(frozen=True)
class FiredRule:
    """A rule with the strength at which it fires; see `FuzzySystem.explain`."""

    number: int
    strength: float
    rule: Rule

    def __str__(self) -> str:
        return f"{self.strength:.4f}  {self.rule}"


@dataclass(frozen=True, eq=False)
class Surface:
    """Control surface of one output over two inputs.

    Attributes
    ----------
    x_name, y_name, output : str
        The two inputs and the output.
    x : ndarray, shape (nx,)
    y : ndarray, shape (ny,)
    values : ndarray, shape (nx, ny)
        ``values[i, j]`` is the output at ``x[i]``, ``y[j]``.
    """

    x_name: str
    y_name: str
    output: str
    x: Array
    y: Array
    values: Array

    def __repr__(self) -> str:
        return summary(self, "x_name", "y_name", "output", "values")


class FuzzySystem:
    """Evaluates a rule base.

    Parameters
    ----------
    rules : RuleBase, str or path
        The rule base; or the name of a shipped one or the path of a file, as for
        `fuzzytrack.load_rulebase`.
    method : {"exact", "relation", "table"}
        ``exact`` evaluates the membership functions at the input itself and only the rules that
        fire; ``relation`` reads the discrete relational matrix at the nearest grid point (Llinas
        et al. 1998, Eqs. 3.2 to 3.10, literally), and equals ``exact`` on grid points; ``table``
        interpolates a table of ``exact`` values, see `table_bounds`.
    fuzzification : Fuzzification, optional
        Singleton unless given.
    table_nodes : int, optional
        Nodes on each input for ``method="table"``; 2001 for one input, 201 for two, and fewer for
        more (about 40,000 in all) unless given.

    Raises
    ------
    RuleBaseError
        If there is no such rule base.
    TypeError
        If `rules` is something else.
    ValueError
        If the method is unknown, or the algebra does not allow it (see Notes).

    Notes
    -----
    Inputs outside of their universe are replaced by its nearest end; a NaN input gives NaN. With
    non-singleton inputs ``exact`` uses that the composition factorizes over the sets. This holds
    for every algebra but min with sum, where the outputs have the AND and OR of the rule base, and
    alternatives of a rule are joined by that OR; elsewhere ``relation`` has to be used.
    """

    def __init__(
        self,
        rules: RuleBase | str | os.PathLike[str],
        method: str = "exact",
        *,
        fuzzification: Fuzzification | None = None,
        table_nodes: int | None = None,
    ) -> None:
        if method not in METHODS:
            raise ValueError(f"method: unknown {method!r}; one of {', '.join(METHODS)}")
        self.rules = rules = as_rulebase(rules)
        self.method = method
        self.fuzzification = fuzzification or Fuzzification()
        self.table_nodes = default_nodes(len(rules.inputs)) if table_nodes is None else table_nodes
        if not self.fuzzification.is_singleton:
            for variable in rules.inputs:
                self.fuzzification.check(variable)
            algebras = [rules.operators_of(output) for output in rules.outputs]
            if not all(o.is_classical for o in (rules.operators, *algebras)):
                raise ValueError(
                    "fuzzification: non-singleton inputs need product or min for and, "
                    "implication and weighting, and sum or max for or"
                )
            if method != "relation" and not _factorizes(rules):
                raise ValueError(
                    "method: with non-singleton inputs, min and sum do not factorize, nor do an "
                    "and or or of an output, or alternatives, other than those of the rule base; "
                    "use method='relation'"
                )
        if method == "table":
            _ = self._table

    def __repr__(self) -> str:
        options: dict[str, object] = {}
        if self.method != "exact":
            options["method"] = self.method
        if not self.fuzzification.is_singleton:
            options["fuzzification"] = self.fuzzification
        if self.table_nodes != default_nodes(len(self.rules.inputs)):
            options["table_nodes"] = self.table_nodes
        return call("FuzzySystem", [self.rules], options)

    def plot(self, output: str | None = None, **options: Any) -> Figure:
        """Picture of the control surfaces.

        Parameters
        ----------
        output : str, optional
            Name of one output; all unless given.
        **options
            As for `fuzzytrack.plotting.plot_surface`: style, points, inputs, at.
        """
        from fuzzytrack.plotting import plot_surface

        return plot_surface(self, output, **options)[0]

    def _repr_html_(self) -> str:
        """Its variables and rules, for notebooks."""
        rules = self.rules
        variables = (
            [role, variable.axis_label, Cell(variable.drawing())]
            for role, every in (("input", rules.inputs), ("output", rules.outputs))
            for variable in every
        )
        drawn = table(["", "variable", "sets"], variables, words=3)
        title = f"{rules.name}, evaluated by the method {self.method}"
        return block(title, drawn, *rules.html_parts())

    # ---------------------------------------------------------------- evaluation

    def __call__(self, /, **inputs: ArrayLike) -> dict[str, float | Array]:
        """Evaluate every output.

        Parameters
        ----------
        **inputs : array_like
            One value for each input, by name; they broadcast. What is masked is NaN.

        Returns
        -------
        dict
            For each output a float, or an array of the broadcast shape.

        Raises
        ------
        TypeError
            If an input is missing or unknown.

        Warns
        -----
        NoRuleFiresWarning
            Where no rule fires and the output has no default: the value is NaN.
        """
        points, shape = self._points(inputs)
        values = self.evaluate(points)
        self._warn_where_empty(points, values)
        if shape == ():
            return {name: float(v[0]) for name, v in values.items()}
        return {name: v.reshape(shape) for name, v in values.items()}

    def evaluate(self, points: Array) -> dict[str, Array]:
        """Evaluate at `points`, shape (n, n_inputs), columns in the order of the inputs.

        Gives no warning.
        """
        evaluate = {
            "exact": self._evaluate_exact,
            "relation": self._evaluate_relation,
            "table": self._evaluate_table,
        }[self.method]
        return self._in_chunks(points, evaluate)

    def _in_chunks(self, points: Array, evaluate: object) -> dict[str, Array]:
        universes = [v.universe for v in self.rules.inputs]
        clipped = np.stack([u.clip(points[:, k]) for k, u in enumerate(universes)], axis=1)
        known = ~np.any(np.isnan(clipped), axis=1)
        result = {name: np.full(len(points), np.nan) for name in self.rules.output_names}
        for start in range(0, len(points), _CHUNK):
            rows = np.flatnonzero(known[start : start + _CHUNK]) + start
            if len(rows):
                for name, values in evaluate(clipped[rows]).items():  # type: ignore[operator]
                    result[name][rows] = values
        return result

    def _points(self, inputs: Mapping[str, ArrayLike]) -> tuple[Array, tuple[int, ...]]:
        names = self.rules.input_names
        if set(inputs) != set(names):
            got = ", ".join(inputs) or "none"
            raise TypeError(f"inputs: expected {', '.join(names)}; got {got}")
        arrays = np.broadcast_arrays(*(_numbers(inputs[n]) for n in names))
        return np.stack([a.ravel() for a in arrays], axis=1), arrays[0].shape

    def _warn_where_empty(self, points: Array, values: dict[str, Array]) -> None:
        known = ~np.isnan(points).any(axis=1)
        for name, result in values.items():
            rows = np.flatnonzero(np.isnan(result) & known)
            if len(rows):
                where = _place(self.rules.input_names, points[rows[0]])
                more = f" and at {len(rows) - 1} more points" if len(rows) > 1 else ""
                what = f"no rule about {name} fires at {where}"
                if self.underflows(name, points[rows[0]]):
                    what = f"the strengths of all rules about {name} underflow to 0 at {where}"
                warnings.warn(
                    f"{self.rules.name}: {what}{more}: NaN; "
                    "add a rule, or give the output a default",
                    NoRuleFiresWarning,
                    stacklevel=3,
                )

    def _evaluate_exact(self, points: Array) -> dict[str, Array]:
        result = {name: np.empty(len(points)) for name in self.rules.output_names}
        for part, firing, strength in self._strengths_in_parts(points):
            for name, found in self._conclusions.items():
                fuzzy = found.of(firing).infer(strength)
                result[name][part] = self._crisp(name, fuzzy, points[part])
        return result

    def _strengths_in_parts(self, points: Array) -> Iterator[tuple[slice, NDArray[np.intp], Array]]:
        """Parts of the points, the rules that fire in each, and their strengths there."""
        for start in range(0, len(points), _CHUNK):
            grades, whole = self._grades(points[start : start + _CHUNK])
            firing = self._antecedents.firing(grades)
            conditions = self._antecedents.of(firing)
            count = grades[0].shape[1]
            rows = max(1, _MOST_STRENGTHS // max(1, len(firing)))
            for first in range(0, count, rows):
                part = slice(first, min(first + rows, count))
                strength = conditions.strengths(
                    [g[:, part] for g in grades], whole and [w[part] for w in whole]
                )
                yield slice(start + part.start, start + part.stop), firing, strength

    def _evaluate_relation(self, points: Array) -> dict[str, Array]:
        inputs = self.rules.inputs
        result = {}
        for name in self.rules.output_names:
            matrix = self.relation(name)
            if self.fuzzification.is_singleton:
                # Eq. 3.9: the column of the nearest grid point
                cell = tuple(v.universe.nearest(points[:, k]) for k, v in enumerate(inputs))
                fuzzy = matrix[cell]
            else:
                spread = [
                    self.fuzzification.membership(v, points[:, k]) for k, v in enumerate(inputs)
                ]
                fuzzy = np.stack(
                    [
                        compose(self.rules, matrix, [s[row] for s in spread])
                        for row in range(len(points))
                    ]
                )
            nearest = [
                v.universe.values[v.universe.nearest(points[:, k])] for k, v in enumerate(inputs)
            ]
            result[name] = self._crisp(name, fuzzy, np.stack(nearest, axis=1))
        return result

    def _evaluate_table(self, points: Array) -> dict[str, Array]:
        return self._table(points)

    def _crisp(self, name: str, fuzzy: Array, points: Array) -> Array:
        output = self.rules.output(name)
        operators = self.rules.operators_of(output)
        if output.is_linear:
            y = output.values_of_sets(points)
        else:
            y, _ = output_grid(operators, output)
        values = defuzzify(operators.defuzzification, y, fuzzy)
        if output.default is None:
            return values
        return np.where(np.isnan(values), output.default, values)

    # ---------------------------------------------------------------- why

    def strengths(self, points: Array) -> Array:
        """Evaluate the strength of every rule: (n, n_rules) from points of (n, n_inputs)."""
        return self._antecedents.strengths(*self._grades(points))

    def _grades(self, points: Array) -> tuple[list[Array], list[Array] | None]:
        """For each input, grades of its sets, and of its whole universe if inputs are fuzzy."""
        variables = self.rules.inputs
        x = [v.universe.clip(points[:, k]) for k, v in enumerate(variables)]
        if self.fuzzification.is_singleton:
            return [v.memberships(at) for v, at in zip(variables, x, strict=True)], None
        grades, whole = [], []
        operators = self.rules.operators
        for variable, at in zip(variables, x, strict=True):
            # sup or sum over x of μ_A'(x) and μ_A(x): the composition, one input at a time
            spread = self.fuzzification.membership(variable, at)
            met = conjoin(operators, variable.memberships()[:, None, :], spread[None, :, :])
            grades.append(disjoin(operators, met, -1))
            whole.append(disjoin(operators, spread, -1))
        return grades, whole

    def is_silent(self, points: Array) -> NDArray[np.bool_]:
        """Whether no rule fires, at points of shape (n, n_inputs): shape (n,)."""
        silent = np.ones(len(points), dtype=bool)
        for part, _, strength in self._strengths_in_parts(points):
            silent[part] = ~(strength != 0).any(axis=1)
        return silent

    def underflows(self, output: str, point: Array) -> bool:
        """Whether rules about an output have strengths above 0 at a point that are lost in floats.

        Parameters
        ----------
        output : str
            Name of the output.
        point : ndarray, shape (n_inputs,)
            No NaN.
        """
        about = {
            rule.groups
            for rule in self.rules.rules
            for c in rule.consequents
            if c.output == output and c.confidence > 0
        }
        value = dict(zip(self.rules.input_names, point.tolist(), strict=True))
        strength = self.strengths(point[None])[0]
        silent = all(
            s == 0.0
            for s, rule in zip(strength, self.rules.rules, strict=True)
            if rule.groups in about
        )
        return silent and any(
            all(self.rules.input(name).is_within(term, value[name]) for name, term in conditions)
            for groups in about
            for conditions in groups
        )

    def explain(self, /, **inputs: float) -> list[FiredRule]:
        """Rules that fire at a point, strongest first.

        Parameters
        ----------
        **inputs : float
            One number for each input, by name.

        Returns
        -------
        list of FiredRule
            Strength (before confidence), rule and its number from 1; equal strengths in the order
            of the rules.

        Raises
        ------
        TypeError
            If an input is missing or unknown, or is an array.
        """
        points, shape = self._points(inputs)
        if shape != ():
            raise TypeError("explain takes one point; give a number for each input")
        strength = self.strengths(points)[0]
        fired = [
            FiredRule(k + 1, float(s), self.rules.rules[k]) for k, s in enumerate(strength) if s > 0
        ]
        return sorted(fired, key=lambda f: (-f.strength, f.number))

    # ---------------------------------------------------------------- data

    @cached_property
    def _antecedents(self) -> Antecedents:
        return antecedents(self.rules)

    @cached_property
    def _conclusions(self) -> dict[str, Conclusions]:
        return {v.name: conclusions(self.rules, v) for v in self.rules.outputs}

    @cached_property
    def _relations(self) -> dict[str, Array]:
        return {}

    @cached_property
    def _table(self) -> InterpolationTable:
        def exact(points: Array) -> dict[str, Array]:
            return self._in_chunks(points, self._evaluate_exact)

        return build_table(self.rules, exact, self.table_nodes)

    @property
    def table(self) -> InterpolationTable:
        """The interpolation table, built at first use."""
        return self._table

    @property
    def table_bounds(self) -> dict[str, float]:
        """Error bound of ``method="table"`` for each output, measured when the table was built."""
        return dict(self._table.bounds)

    def relation(self, output: str) -> Array:
        """Relational matrix μ_R(x, y) of one output; see `fuzzytrack.fuzzy.relation.relation`."""
        if output not in self._relations:
            matrix = relation(self.rules, self.rules.output(output))
            matrix.flags.writeable = False
            self._relations[output] = matrix
        return self._relations[output]

    def surface(
        self,
        output: str,
        points: int = 101,
        *,
        inputs: tuple[str, str] | None = None,
        at: Mapping[str, float] | None = None,
        corners: bool = False,
    ) -> Surface:
        """Control surface of one output over two inputs.

        Parameters
        ----------
        output : str
            Name of the output.
        points : int
            Points on each axis, at least 2.
        inputs : (str, str), optional
            The two inputs; the first two unless given.
        at : mapping, optional
            Values of the other inputs.
        corners : bool
            Whether the points include every corner of the sets, see `Variable.nodes`.

        Returns
        -------
        Surface

        Raises
        ------
        ValueError
            If the rule base has one input, `inputs` are not two different ones, a value in `at` is
            missing or not needed, or `points` is below 2.
        """
        self.rules.output(output)
        names = inputs or self.rules.input_names[:2]
        if len(self.rules.inputs) < 2:
            raise ValueError(f"surface: {self.rules.name} has one input; a surface needs two")
        if points < 2:
            raise ValueError(f"surface: points must be at least 2, got {points}")
        if len(names) != 2 or names[0] == names[1]:
            raise ValueError(f"surface: inputs must be two different inputs, got {names}")
        variables = [self.rules.input(name) for name in names]
        fixed = dict(at or {})
        others = [name for name in self.rules.input_names if name not in names]
        if set(fixed) != set(others):
            raise ValueError(
                f"surface: at must give {', '.join(others) or 'nothing'}; "
                f"got {', '.join(fixed) or 'nothing'}"
            )
        axes = [v.nodes(points, corners=corners) for v in variables]
        grid = dict(zip(names, np.meshgrid(*axes, indexing="ij"), strict=True))
        values = self(**grid, **fixed)[output]
        return Surface(names[0], names[1], output, axes[0], axes[1], np.asarray(values))


def _factorizes(rules: RuleBase) -> bool:
    """Whether fuzzy inputs may be composed with the rules one input at a time."""
    common = rules.operators
    algebras = [rules.operators_of(output) for output in rules.outputs]
    either = {common.disjunction, *(o.disjunction for o in algebras)}
    if any(rule.alternatives for rule in rules.rules):
        either.add(common.alternatives)
    both = {common.conjunction, *(o.conjunction for o in algebras)}
    return len(both) == len(either) == 1 and not (both == {"min"} and either == {"sum"})


def _numbers(values: ArrayLike) -> Array:
    """Values of an input; NaN where they are masked."""
    if np.ma.is_masked(values):
        return np.asarray(np.ma.filled(np.ma.asarray(values).astype(np.float64), np.nan))
    return np.asarray(values, dtype=np.float64)


def _place(names: tuple[str, ...], point: Array) -> str:
    return ", ".join(f"{n}={x:.6g}" for n, x in zip(names, point, strict=True))
