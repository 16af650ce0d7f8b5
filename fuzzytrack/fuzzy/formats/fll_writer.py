"""Rule bases written in the FuzzyLite Language, version 6 and later."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.formats import fll_words as words
from fuzzytrack.fuzzy.formats.carried import Carried
from fuzzytrack.fuzzy.formats.translation import (
    BaseSets,
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
from fuzzytrack.yamltree import quoted

__all__ = ["dumps_fll"]

_FLL = "FLL"
_NAME = re.compile(r"[A-Za-z0-9_.]+")


def dumps_fll(rules: RuleBase) -> Translation:
    """Write a rule base as the text of an FLL file.

    Parameters
    ----------
    rules : RuleBase

    Returns
    -------
    Translation
        What the format lacks stands in comments, from which
        `fuzzytrack.fuzzy.formats.fll_reader.loads_fll` takes it. Grids that fuzzylite does not
        have, and sets that have other names there, are named in the notes.

    Raises
    ------
    RuleBaseError
        If fuzzylite has no counterpart to something by which outputs are computed; names it.
    """
    return _FllWriter(rules).translation()


class _FllWriter(FormatWriter):
    def __init__(self, rules: RuleBase) -> None:
        super().__init__(rules, _FLL)
        self.renamed: list[str] = []
        self.names = {
            v.name: self._set_names(v, sets)
            for v, sets in zip(
                (*rules.inputs, *rules.outputs),
                (*self.inputs.values(), *self.outputs.values()),
                strict=True,
            )
        }

    def _set_names(self, variable: Variable, sets: BaseSets) -> list[str]:
        """Names of sets with the characters that the language has."""
        if not _NAME.fullmatch(variable.name) or variable.name in words.KEYWORDS:
            raise RuleBaseError(
                f"{self.rules.name}: the name {quoted(variable.name)} has no counterpart in FLL; "
                "rename the variable with letters from A to Z, digits and _, and no word of rules"
            )
        found: list[str] = []
        for each in sets.sets:
            name = re.sub(r"[^A-Za-z0-9_.]", "_", each.name)
            if name in words.KEYWORDS or not name:
                name = f"{name}_"
            while name in found:
                name += "_"
            if name != each.name:
                self.renamed.append(f"{quoted(each.name)} of {variable.name} is named {name!r}")
            found.append(name)
        return found

    # ---------------------------------------------------------------- the text

    def translation(self) -> Translation:
        rules = self.rules
        carried = Carried.of(rules, {v.name: v.default for v in rules.outputs})
        lines = [
            *carried.lines("#"),
            f"Engine: {one_line(rules.name, 'name', '#', _FLL)}",
        ]
        for variable in rules.inputs:
            lines += self._input(variable)
        for variable in rules.outputs:
            lines += self._output(variable)
        for implication, outputs in self._blocks().items():
            lines += self._block(implication, outputs)
        return Translation("\n".join(lines) + "\n", (*self._notes(), *self.renamed))

    def _input(self, variable: Variable) -> Iterator[str]:
        yield f"InputVariable: {variable.name}"
        yield "  enabled: true"
        yield f"  range: {written(variable.universe.low)} {written(variable.universe.high)}"
        # Beyond its universe an input counts as the end of it.
        yield "  lock-range: true"
        for name, each in zip(
            self.names[variable.name], self.inputs[variable.name].sets, strict=True
        ):
            shape, parameters = each.shape, each.parameters
            if shape == "singleton":
                shape, parameters = "trapmf", parameters * 4
            yield self._term(name, shape, parameters)

    def _output(self, variable: Variable) -> Iterator[str]:
        operators = self.rules.operators_of(variable)
        universe = variable.universe
        yield f"OutputVariable: {variable.name}"
        yield "  enabled: true"
        yield f"  range: {written(universe.low)} {written(universe.high)}"
        yield "  lock-range: false"
        constant = operators.defuzzification == "weighted-centers"
        aggregation = self.word(operators.disjunction, words.S_NORMS, "or")
        if constant and operators.disjunction == "sum":
            aggregation = "none"
        yield f"  aggregation: {aggregation}"
        if constant:
            yield "  defuzzifier: WeightedAverage TakagiSugeno"
        else:
            word = self.word(operators.defuzzification, words.DEFUZZIFIERS, "defuzzification")
            yield f"  defuzzifier: {word} {universe.points}"
        yield f"  default: {'nan' if variable.default is None else written(variable.default)}"
        yield "  lock-previous: false"
        for name, each in zip(
            self.names[variable.name], self.outputs[variable.name].sets, strict=True
        ):
            if constant:
                yield self._conclusion(name, variable, each.name)
            else:
                yield self._term(name, each.shape, each.parameters)

    def _conclusion(self, name: str, variable: Variable, set_name: str) -> str:
        fuzzy_set = variable.sets[variable.index(set_name)]
        if fuzzy_set.base == LINEAR:
            return f"  term: {name} Linear {' '.join(map(written, fuzzy_set.parameters))}"
        center = fuzzy_set.center(variable.universe.low, variable.universe.high)
        return f"  term: {name} Constant {written(center)}"

    def _term(self, name: str, shape: str, parameters: tuple[float, ...]) -> str:
        found = words.term_of(shape, parameters)
        if found is None:
            raise self.lacks(f"the shape {shape} of {name!r}")
        term, numbers = found
        texts = [written(x) if math.isfinite(x) else repr(x) for x in numbers]
        return f"  term: {name} {term} {' '.join(texts)}"

    # ---------------------------------------------------------------- rules

    def _blocks(self) -> dict[str, list[str]]:
        """Names of outputs by their implication, each of which needs a block of rules."""
        found: dict[str, list[str]] = {}
        for output in self.rules.outputs:
            operators = self.rules.operators_of(output)
            constant = operators.defuzzification == "weighted-centers"
            implication = "none"
            if not constant:
                implication = self.word(operators.implying, words.T_NORMS, "implication")
            found.setdefault(implication, []).append(output.name)
        return found

    def _block(self, implication: str, outputs: list[str]) -> Iterator[str]:
        operators = self.rules.operators
        yield "RuleBlock: "
        yield "  enabled: true"
        yield f"  conjunction: {self.word(operators.conjunction, words.T_NORMS, 'and')}"
        yield f"  disjunction: {self.word(operators.alternatives, words.S_NORMS, 'alternatives')}"
        yield f"  implication: {implication}"
        yield "  activation: General"
        for rule in self.rules.rules:
            for row in rows(rule):
                sets = {name: term for name, term in row.sets.items() if name in outputs}
                if sets:
                    yield self._rule(row._replace(sets=sets))

    def _rule(self, row: Row) -> str:
        conditions = " or ".join(self._group(group) for group in row.groups)
        conclusions = " and ".join(
            f"{name} is {self._concluded(name, term)}" for name, term in row.sets.items()
        )
        weight = "" if row.weight == 1.0 else f" with {self.weight(row)}"
        return f"  rule: if {conditions} then {conclusions}{weight}"

    def _group(self, conditions: Conditions) -> str:
        found = []
        for name, term in conditions:
            place, hedges = self.inputs[name].find(term)
            theirs = [self.word(hedge, words.HEDGES, "the hedge") for hedge in hedges]
            if "any" in theirs[:-1]:
                raise self.lacks("a hedge after any")
            term_words = theirs if theirs[-1:] == ["any"] else [*theirs, self.names[name][place]]
            found.append(f"{name} is {' '.join(term_words)}")
        return " and ".join(found)

    def _concluded(self, name: str, term: str) -> str:
        place, hedges = self.outputs[name].find(term)
        if hedges:
            raise self.lacks(f"the hedge of '{name} is {term}', {' '.join(hedges)},")
        return self.names[name][place]

    # ---------------------------------------------------------------- notes

    def _notes(self) -> Iterator[str]:
        for output in self.rules.outputs:
            operators = self.rules.operators_of(output)
            if operators.defuzzification != "weighted-centers" and output.universe.grid == "ends":
                yield (
                    f"{output.name} is summed over {output.universe.points} points with both ends; "
                    f"fuzzylite takes the midpoints of {output.universe.points} cells"
                )
            if operators.defuzzification == "bisector":
                yield f"{output.name}: the bisector of fuzzylite may be a cell off"
