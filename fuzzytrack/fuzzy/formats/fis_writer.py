"""Rule bases written as FIS files of MATLAB's Fuzzy Logic Toolbox."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from fuzzytrack.fuzzy.coverage import find_hole
from fuzzytrack.fuzzy.formats import fis_words as words
from fuzzytrack.fuzzy.formats.carried import Carried
from fuzzytrack.fuzzy.formats.parts import DEFAULT_GRID
from fuzzytrack.fuzzy.formats.translation import (
    FormatWriter,
    Row,
    Translation,
    one_line,
    rows,
)  # fmt: skip
from fuzzytrack.fuzzy.numbers import written
from fuzzytrack.fuzzy.rulebase import Conditions, RuleBase
from fuzzytrack.fuzzy.shapes import LINEAR
from fuzzytrack.fuzzy.variable import Variable

__all__ = ["dumps_fis"]

_FIS = "FIS"


def dumps_fis(rules: RuleBase) -> Translation:
    """Write a rule base as the text of a FIS file.

    Weighted centers become a Sugeno system whose constants are the centers.

    Parameters
    ----------
    rules : RuleBase

    Returns
    -------
    Translation
        What the format lacks and MATLAB does not need, as labels and the settings of a scheduler,
        stands in comments, from which `fuzzytrack.fuzzy.formats.fis_reader.loads_fis` takes it.
        Points of outputs and defaults stand there too, and are named in the notes.

    Raises
    ------
    RuleBaseError
        If MATLAB has no counterpart to something by which outputs are computed; names it.
    """
    return _FisWriter(rules).translation()


class _FisWriter(FormatWriter):
    def __init__(self, rules: RuleBase) -> None:
        super().__init__(rules, _FIS)
        algebras = {rules.operators_of(output) for output in rules.outputs}
        if len(algebras) > 1:
            raise self.lacks("an output with operators of its own")
        (self.operators,) = algebras
        self.sugeno = self.operators.defuzzification == "weighted-centers"
        self.rows = [row for rule in rules.rules for row in self._rows(rows(rule))]

    # ---------------------------------------------------------------- the text

    def translation(self) -> Translation:
        rules = self.rules
        usual = {v.name: (v.universe.low + v.universe.high) / 2 for v in rules.outputs}
        lines = [
            "[System]",
            *self._system(),
        ]
        for role, variables in (("Input", rules.inputs), ("Output", rules.outputs)):
            for number, variable in enumerate(variables, start=1):
                lines += ["", f"[{role}{number}]", *self._variable(role, variable)]
        lines += ["", "[Rules]", *(self._rule(row) for row in self.rows)]
        # After the last rule, where no reader expects anything more.
        lines += ["", *Carried.of(rules, usual).lines("%")]
        return Translation("\n".join(lines) + "\n", tuple(self._notes(usual)))

    def _system(self) -> Iterator[str]:
        operators = self.operators
        yield f"Name={_quoted(one_line(self.rules.name, 'name', '', _FIS))}"
        yield f"Type='{'sugeno' if self.sugeno else 'mamdani'}'"
        yield "Version=2.0"
        yield f"NumInputs={len(self.rules.inputs)}"
        yield f"NumOutputs={len(self.rules.outputs)}"
        yield f"NumRules={len(self.rows)}"
        conjunction = self.rules.operators.conjunction
        yield f"AndMethod='{self.word(conjunction, words.ANDS, 'and')}'"
        yield f"OrMethod='{self._either()}'"
        if self.sugeno:
            self._check_sums()
            yield "ImpMethod='prod'"
            yield "AggMethod='sum'"
        else:
            yield f"ImpMethod='{self.word(operators.implying, words.IMPLICATIONS, 'implication')}'"
            yield f"AggMethod='{self.word(operators.disjunction, words.AGGREGATIONS, 'or')}'"
        kind = words.DEFUZZIFICATIONS["sugeno" if self.sugeno else "mamdani"]
        yield f"DefuzzMethod='{self.word(operators.defuzzification, kind, 'defuzzification')}'"

    def _either(self) -> str:
        """The OR of conditions; it matters only where a rule has alternatives."""
        if not any(len(row.groups) > 1 for row in self.rows):
            alternatives = self.rules.operators.alternatives
            return "probor" if alternatives == "algebraic-sum" else "max"
        return self.word(self.rules.operators.alternatives, words.ORS, "alternatives")

    def _check_sums(self) -> None:
        """Sugeno systems add up the rules; another OR is the same only where each set has one."""
        if self.operators.disjunction == "sum":
            return
        concluded = [pair for row in self.rows for pair in row.sets.items()]
        if len(set(concluded)) < len(concluded):
            raise self.lacks(
                f"or {self.operators.disjunction} with weighted-centers, where rules share a set,"
            )

    def _variable(self, role: str, variable: Variable) -> Iterator[str]:
        universe = variable.universe
        sets = (self.inputs if role == "Input" else self.outputs)[variable.name]
        constant = self.sugeno and role == "Output"
        yield f"Name={_quoted(variable.name)}"
        yield f"Range=[{written(universe.low)} {written(universe.high)}]"
        yield f"NumMFs={len(sets.sets)}"
        for number, each in enumerate(sets.sets, start=1):
            if constant:
                shape, parameters = self._conclusion(variable, each.name)
            else:
                shape, parameters = self._shape(role, each.shape, each.parameters, each.name)
            numbers = " ".join(map(written, parameters))
            yield f"MF{number}={_quoted(each.name)}:'{shape}',[{numbers}]"

    def _conclusion(self, variable: Variable, name: str) -> tuple[str, tuple[float, ...]]:
        fuzzy_set = variable.sets[variable.index(name)]
        if fuzzy_set.base == LINEAR:
            return "linear", fuzzy_set.parameters
        return "constant", (fuzzy_set.center(variable.universe.low, variable.universe.high),)

    def _shape(
        self, role: str, shape: str, parameters: tuple[float, ...], name: str
    ) -> tuple[str, tuple[float, ...]]:
        if shape == "singleton" and role == "Input":
            return "trimf", parameters * 3
        if shape not in words.SHAPES:
            raise self.lacks(f"the shape {shape} of {name!r}")
        if shape == "gauss2mf" and parameters[0] > parameters[2]:
            raise self.lacks(f"gauss2mf with mean1 > mean2, of {name!r},")
        return shape, words.SHAPES[shape].written(parameters)

    # ---------------------------------------------------------------- rules

    def _rows(self, found: Iterator[Row]) -> Iterator[Row]:
        """Rules with one connection each: those of maxima may be divided."""
        for row in found:
            single = all(len(group) == 1 for group in row.groups)
            inputs = [name for group in row.groups for name, _ in group]
            if len(row.groups) == 1 or (single and len(set(inputs)) == len(inputs)):
                yield row
                continue
            maxima = self.operators.disjunction == self.rules.operators.alternatives == "max"
            if not maxima or self.sugeno:
                raise self.lacks(f"alternatives of several conditions ({row.groups[1]})")
            for group in row.groups:
                yield row._replace(groups=(group,))

    def _rule(self, row: Row) -> str:
        asked = [self._input_index(name, row.groups) for name in self.rules.input_names]
        concluded = []
        for name in self.rules.output_names:
            index = 0
            if name in row.sets:
                place, hedges = self.outputs[name].find(row.sets[name])
                index = self._signed(place, hedges, f"{name} is {row.sets[name]}")
            concluded.append(str(index))
        connection = 2 if len(row.groups) > 1 else 1
        sets = f"{' '.join(asked)}, {' '.join(concluded)}"
        return f"{sets} ({self.weight(row)}) : {connection}"

    def _input_index(self, name: str, groups: tuple[Conditions, ...]) -> str:
        for group in groups:
            term = dict(group).get(name)
            if term is not None:
                place, hedges = self.inputs[name].find(term)
                return str(self._signed(place, hedges, f"{name} is {term}"))
        return "0"

    def _signed(self, place: int, hedges: tuple[str, ...], what: str) -> int:
        """Index of a set from 1, negative for its complement."""
        if hedges not in ((), ("not",)):
            raise self.lacks(f"the hedge of '{what}', {' '.join(hedges)},")
        return -(place + 1) if hedges else place + 1

    # ---------------------------------------------------------------- notes

    def _notes(self, usual: Mapping[str, float]) -> Iterator[str]:
        for output in self.rules.outputs:
            universe = output.universe
            grid = universe.points, universe.grid
            if not self.sugeno and grid != DEFAULT_GRID:
                what = f"{universe.points} points"
                if universe.grid == "midpoints":
                    what = f"the midpoints of {universe.points} cells"
                yield (
                    f"{output.name} is summed over {what}; MATLAB takes 101 points with both ends, "
                    "unless evalfisOptions says otherwise (NumSamplePoints)"
                )
            if output.default == usual[output.name]:
                continue
            hole = find_hole(self.rules, output.name)
            if hole is not None:
                here = "NaN" if output.default is None else f"{output.default:g}"
                yield (
                    f"{output.name} is {here} where no rule fires; MATLAB gives the middle of the "
                    f"range, {usual[output.name]:g}"
                )


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"
