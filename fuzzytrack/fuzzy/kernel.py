"""A fuzzy system as one straight-line scalar function.

A tracker calls its rule base once for each update, so the rule base is written out as Python source
with its numbers in place: no loops over rules, no look-ups by name, no arrays but constant tables.
The same function runs in plain Python and, compiled, in the batch runner. Names from rule bases
never enter the source, only numbers do.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fuzzytrack.fuzzy.inference import Conclusions, conclusions
from fuzzytrack.fuzzy.norms import S_NORMS, T_NORMS, Norm
from fuzzytrack.fuzzy.ramps import find_ramps
from fuzzytrack.fuzzy.shapes import LINEAR
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.fuzzy.variable import Universe, Variable

__all__ = ["Infer", "infer_function"]

Infer = Callable[[tuple[float, ...]], tuple[float, ...]]

MAX_TABLE = 1_000_000


def infer_function(system: FuzzySystem) -> Infer:
    """Scalar function of a fuzzy system.

    Parameters
    ----------
    system : FuzzySystem
        Its method decides what is written out: the rules (``exact``), the crisp value of every
        grid cell (``relation``), or the interpolation table (``table``).

    Returns
    -------
    callable
        ``infer((x1, ..., xm)) -> (y1, ..., yn)``, inputs and outputs in the order of the rule
        base; floats, not NaN. Outputs are NaN where no rule fires and there is no default. Its
        attribute ``source`` is its text.

    Raises
    ------
    ValueError
        If the method cannot be written out: ``exact`` with bisector or maxima, any but ``table``
        with non-singleton inputs, or a table of more than 1,000,000 cells.
    """
    writer = _Writer(system)
    if not system.fuzzification.is_singleton and system.method != "table":
        raise ValueError(
            "non-singleton inputs: only method='table' can be written as a scalar function"
        )
    {"exact": writer.exact, "relation": writer.relation, "table": writer.table}[system.method]()
    return writer.function()


class _Writer:
    """Collects the lines of the function and the constants that it reads."""

    def __init__(self, system: FuzzySystem) -> None:
        self.system = system
        self.rules = system.rules
        self.lines: list[str] = []
        self.known: dict[tuple[str, ...], str] = {}
        self.count = 0
        self.constants: dict[str, Any] = {"exp": math.exp, "cos": math.cos, "nan": math.nan}

    def inputs(self) -> None:
        for k, variable in enumerate(self.rules.inputs):
            low, high = variable.universe.low, variable.universe.high
            self.lines.append(f"x{k} = min(max(x[{k}], {low!r}), {high!r})")

    def function(self) -> Infer:
        outputs = "".join(f"y{k}, " for k in range(len(self.rules.outputs)))
        body = "\n    ".join([*self.lines, f"return ({outputs})"])
        source = f"def infer(x):\n    {body}\n"
        namespace = dict(self.constants)
        exec(compile(source, "<rule base>", "exec"), namespace)
        infer: Infer = namespace["infer"]
        # There is no file from which it could be read again.
        vars(infer)["source"] = source
        return infer

    def constant(self, name: str, values: np.ndarray[Any, np.dtype[np.float64]]) -> None:
        if values.size > MAX_TABLE:
            raise ValueError(f"a table of {values.size} cells; at most {MAX_TABLE} are allowed")
        self.constants[name] = tuple(values.ravel().tolist())

    # ------------------------------------------------------------ exact

    def exact(self) -> None:
        ramps = find_ramps(self.rules)
        if ramps is not None:
            self.lines += [f"x{k} = x[{k}]" for k in range(len(self.rules.inputs))]
            self.lines += ramps.lines()
            return
        self.inputs()
        for k, variable in enumerate(self.rules.inputs):
            for j, fuzzy_set in enumerate(variable.sets):
                self.lines.append(f"g{k}_{j} = {fuzzy_set.expression(f'x{k}')}")
        for r, rule in enumerate(self.rules.rules):
            names = self.rules.input_names
            operators = self.rules.operators
            joint = [
                self._fold(
                    T_NORMS[operators.conjunction],
                    [f"g{names.index(n)}_{self.rules.input(n).index(term)}" for n, term in group],
                )
                for group in rule.groups
            ]
            strength = self._fold(S_NORMS[operators.alternatives], joint)
            self.lines.append(f"s{r} = {strength}")
        for k, output in enumerate(self.rules.outputs):
            self._exact_output(k, output)

    def _exact_output(self, k: int, output: Variable) -> None:
        about = conclusions(self.rules, output)
        operators = about.operators
        if operators.defuzzification not in ("centroid", "weighted-centers"):
            raise ValueError(
                f"method='exact' schedules gains with centroid or weighted-centers; for "
                f"{operators.defuzzification} use method='relation' or 'table'"
            )
        products = operators.implying == operators.weighing == "product"
        if operators.disjunction == "sum" and products and not output.is_linear:
            moment, total = self._weighted_rules(about)
        elif operators.defuzzification == "weighted-centers":
            moment, total = self._weighted_levels(k, about, output)
        else:
            moment, total = self._over_grid(k, about)
        default = "nan" if output.default is None else repr(output.default)
        self.lines.append(f"y{k} = {moment} / {total} if {total} > 0.0 else {default}")

    def _weighted_rules(self, about: Conclusions) -> tuple[str, str]:
        """Product and sum: every rule is a weight (math of Eqs. 3.11 to 3.13).

        y = Σ sᵢ cᵢⱼ Aⱼ ȳⱼ / Σ sᵢ cᵢⱼ Aⱼ with Aⱼ the set's sum of grades and ȳⱼ its centroid.
        """
        area = about.grades.sum(axis=1)
        first = about.grades @ about.y
        moments, totals = [], []
        for r in np.unique(about.rule):
            mine = about.rule == r
            confidence, term = about.confidence[mine], about.term[mine]
            moments.append(f"s{r} * {float(confidence @ first[term])!r}")
            total = float(confidence @ area[term])
            totals.append(f"s{r}" if total == 1.0 else f"s{r} * {total!r}")
        return self._sum(moments), self._sum(totals)

    def _weighted_levels(self, k: int, about: Conclusions, output: Variable) -> tuple[str, str]:
        levels = list(self._levels(k, about, by_set=about.operators.disjunction != "sum"))
        values = [
            _linear(s.parameters) if s.base == LINEAR else repr(float(y))
            for s, y in zip(output.sets, about.y, strict=True)
        ]
        moments = [f"{level} * {values[term]}" for level, term in levels]
        return self._sum(moments), self._sum([level for level, _ in levels])

    def _over_grid(self, k: int, about: Conclusions) -> tuple[str, str]:
        """Clipped or overlapping sets: sum over the output's grid (Eq. 3.10)."""
        operators = about.operators
        levels = list(self._levels(k, about, by_set=operators.disjunction == "max"))
        n_sets = len(about.grades)
        self.constant(f"B{k}", about.grades.T)
        self.constant(f"Y{k}", about.y)
        self.lines += [f"m{k} = t{k} = 0.0", f"for k in range({len(about.y)}):"]
        members = []
        for level, term in levels:
            grade = [level, f"B{k}[{n_sets} * k + {term}]"]
            members.append(self._fold(T_NORMS[operators.implying], grade, "    "))
        joined = self._fold(S_NORMS[operators.disjunction], members, "    ")
        self.lines += [
            f"    b = {joined}",
            f"    m{k} = m{k} + b * Y{k}[k]",
            f"    t{k} = t{k} + b",
        ]
        return f"m{k}", f"t{k}"

    def _levels(self, k: int, about: Conclusions, *, by_set: bool) -> Iterator[tuple[str, int]]:
        """Names of the levels at which output sets are called, joined by set or for each rule."""
        weigh = T_NORMS[about.operators.weighing]
        called = [
            f"s{r}" if c == 1.0 else self._fold(weigh, [f"s{r}", repr(float(c))])
            for r, c in zip(about.rule, about.confidence, strict=True)
        ]
        if by_set:
            groups = [
                ([called[i] for i in np.flatnonzero(about.term == t)], int(t))
                for t in np.unique(about.term)
            ]
        else:
            groups = [
                ([expression], int(t)) for expression, t in zip(called, about.term, strict=True)
            ]
        for number, (expressions, term) in enumerate(groups):
            level = self._fold(S_NORMS[about.operators.disjunction], expressions)
            self.lines.append(f"l{k}_{number} = {level}")
            yield f"l{k}_{number}", term

    def _fold(self, norm: Norm, terms: list[str], margin: str = "") -> str:
        """Expression of a norm of some terms; one that repeats its arguments is given a name."""
        expression = terms[0]
        for term in terms[1:]:
            if not norm.repeats:
                expression = norm.expression(expression, term)
                continue
            names = []
            for part in (expression, term):
                if part.isidentifier():
                    names.append(part)
                    continue
                self.count += 1
                names.append(f"n{self.count}")
                self.lines.append(f"{margin}{names[-1]} = {part}")
            expression = norm.expression(*names)
        return expression

    def _sum(self, terms: list[str]) -> str:
        """Name of the sum of some terms, written once; long sums in several lines."""
        key = tuple(terms)
        if key not in self.known:
            name = self.known[key] = f"a{len(self.known)}"
            self.lines.append(f"{name} = {' + '.join(terms[:50])}")
            for start in range(50, len(terms), 50):
                self.lines.append(f"{name} = {name} + {' + '.join(terms[start : start + 50])}")
        return self.known[key]

    # ------------------------------------------------------------ tables

    def relation(self) -> None:
        self.inputs()
        universes = [v.universe for v in self.rules.inputs]
        for k, u in enumerate(universes):
            place = f"(x{k} - {u.first!r}) / {u.step!r} + 0.5"
            self.lines.append(f"i{k} = int(min(max({place}, 0.0), {float(u.points - 1)!r}))")
        self.lines.append(f"i = {_flat_index([u.points for u in universes])}")
        grid = np.meshgrid(*(u.values for u in universes), indexing="ij")
        values = self.system.evaluate(np.stack([g.ravel() for g in grid], axis=1))
        for k, name in enumerate(self.rules.output_names):
            self.constant(f"T{k}", values[name])
            self.lines.append(f"y{k} = T{k}[i]")

    def table(self) -> None:
        self.inputs()
        table = self.system.table
        nodes = [len(axis) for axis in table.axes]
        for k, variable in enumerate(self.rules.inputs):
            u: Universe = variable.universe
            step = (u.high - u.low) / (nodes[k] - 1)
            self.lines += [
                f"p{k} = (x{k} - {u.low!r}) / {step!r}",
                f"i{k} = min(int(p{k}), {nodes[k] - 2})",
                f"f{k} = p{k} - i{k}",
            ]
        self.lines.append(f"i = {_flat_index(nodes)}")
        strides = [math.prod(nodes[k + 1 :]) for k in range(len(nodes))]
        for k, name in enumerate(self.rules.output_names):
            self.constant(f"T{k}", table.values[name])
            self.lines.append(f"y{k} = {_interpolation(f'T{k}', strides, 0, 0)}")


def _linear(parameters: tuple[float, ...]) -> str:
    """Value of a linear set at the inputs."""
    *slopes, constant = parameters
    terms = [f"{slope!r} * x{k}" for k, slope in enumerate(slopes)]
    return f"({' + '.join(terms)} + {constant!r})"


def _flat_index(lengths: list[int]) -> str:
    expression = "i0"
    for k, length in enumerate(lengths[1:], start=1):
        expression = f"({expression}) * {length} + i{k}"
    return expression


def _interpolation(table: str, strides: list[int], axis: int, offset: int) -> str:
    """Linear along one axis, each end being the interpolation along the axes that follow."""
    if axis == len(strides):
        return f"{table}[i + {offset}]"
    lower = _interpolation(table, strides, axis + 1, offset)
    upper = _interpolation(table, strides, axis + 1, offset + strides[axis])
    return f"((1.0 - f{axis}) * {lower} + f{axis} * {upper})"
