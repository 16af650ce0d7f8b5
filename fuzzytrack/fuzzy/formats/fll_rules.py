"""Rules of the FuzzyLite Language: ``if a is very b and c is d then e is f with 0.5``."""

from __future__ import annotations

import re
from dataclasses import dataclass

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.fuzzy.formats import fll_words as words
from fuzzytrack.fuzzy.formats.parts import Condition, Group, RulePart, VariablePart
from fuzzytrack.fuzzy.formats.source_text import SourceText
from fuzzytrack.fuzzy.rulebase import MAX_ALTERNATIVES
from fuzzytrack.yamltree import quoted, suggestion

__all__ = ["RuleParser"]

_TOKEN = re.compile(r"[()]|[^\s()]+")
_DEEPEST = 20


@dataclass(frozen=True)
class _Token:
    text: str
    column: int


class RuleParser:
    """Parses one rule.

    Parameters
    ----------
    source : SourceText
    line, column : int
        Where the rule starts.
    text : str
        The rule.
    inputs, outputs : list of VariablePart
    distributes : bool
        Whether AND distributes over OR, as it does over the maximum; otherwise an ``or`` inside of
        an ``and`` has no counterpart.
    """

    def __init__(
        self,
        source: SourceText,
        line: int,
        column: int,
        text: str,
        inputs: list[VariablePart],
        outputs: list[VariablePart],
        *,
        distributes: bool,
    ) -> None:
        self.source, self.line = source, line
        self.tokens = [_Token(m.group(), column + m.start()) for m in _TOKEN.finditer(text)]
        self.end = column + len(text)
        self.inputs, self.outputs = inputs, outputs
        self.distributes = distributes
        self.next = 0
        self.depth = 0

    def rule(self) -> RulePart:
        """Read the whole rule.

        Raises
        ------
        RuleBaseError
            At the first mistake.
        """
        place = self._here()
        self._expect("if")
        groups = self._either()
        self._expect("then")
        conclusions = [self._conclusion()]
        while self._peek() == "and":
            self.next += 1
            conclusions.append(self._conclusion())
        weight = 1.0
        if self._peek() == "with":
            self.next += 1
            here = self._here()
            weight = self.source.number(self._word("a weight"), here, "weight")
        if self.next < len(self.tokens):
            raise self._error(f"{quoted(self._peek())} after the end of the rule")
        return RulePart(tuple(groups), tuple(conclusions), weight, place)

    # ---------------------------------------------------------------- tokens

    def _peek(self) -> str:
        return self.tokens[self.next].text if self.next < len(self.tokens) else ""

    def _here(self) -> Location:
        column = self.tokens[self.next].column if self.next < len(self.tokens) else self.end
        return self.source.place(self.line, column)

    def _error(self, message: str) -> RuleBaseError:
        return RuleBaseError(message, self._here())

    def _word(self, what: str) -> str:
        if self.next >= len(self.tokens):
            raise self._error(f"{what} is missing at the end of the rule")
        self.next += 1
        return self.tokens[self.next - 1].text

    def _expect(self, word: str) -> None:
        if self._peek() != word:
            raise self._error(f"expected {word!r}, got {quoted(self._peek() or 'the end')}")
        self.next += 1

    # ---------------------------------------------------------------- conditions

    def _either(self) -> list[Group]:
        """Alternatives; AND binds more tightly than OR."""
        groups = self._both()
        while self._peek() == "or":
            self.next += 1
            groups += self._both()
            self._check_count(groups)
        return groups

    def _both(self) -> list[Group]:
        groups = self._single()
        while self._peek() == "and":
            here = self._here()
            self.next += 1
            others = self._single()
            if not self.distributes and len(groups) * len(others) > 1:
                raise RuleBaseError(
                    "'or' inside of 'and' has no counterpart, unless the disjunction is Maximum",
                    here,
                )
            groups = [(*one, *other) for one in groups for other in others]
            self._check_count(groups)
        return groups

    def _check_count(self, groups: list[Group]) -> None:
        if len(groups) > MAX_ALTERNATIVES:
            raise self._error(f"more than {MAX_ALTERNATIVES} alternatives in one rule")

    def _single(self) -> list[Group]:
        if self._peek() != "(":
            return [(self._condition(),)]
        self.depth += 1
        if self.depth > _DEEPEST:
            raise self._error(f"more than {_DEEPEST} parentheses inside of one another")
        self.next += 1
        groups = self._either()
        self._expect(")")
        self.depth -= 1
        return groups

    def _condition(self) -> Condition:
        here = self._here()
        name = self._word("a variable")
        for of_output, variables in ((False, self.inputs), (True, self.outputs)):
            for number, variable in enumerate(variables):
                if variable.name == name:
                    return self._of(number, variable, of_output)
        names = tuple(v.name for v in (*self.inputs, *self.outputs))
        raise RuleBaseError(
            f"unknown variable {quoted(name)}{suggestion(name, names)}",
            here,
        )

    def _of(self, number: int, variable: VariablePart, of_output: bool) -> Condition:
        """``is``, hedges and a set of a variable."""
        self._expect("is")
        hedges = []
        while self._peek() in words.HEDGES:
            hedges.append(words.HEDGES[self._word("a hedge")])
            if hedges[-1] == "any":
                return Condition(number, 0, tuple(hedges), of_output)
        here = self._here()
        term = self._word("a term")
        return Condition(number, variable.set_index(term, here), tuple(hedges), of_output)

    def _conclusion(self) -> Condition:
        here = self._here()
        name = self._word("an output")
        for number, variable in enumerate(self.outputs):
            if variable.name == name:
                found = self._of(number, variable, False)
                if found.hedges:
                    raise RuleBaseError("a hedge in a conclusion has no counterpart", here)
                return found
        names = tuple(v.name for v in self.outputs)
        raise RuleBaseError(
            f"unknown output {quoted(name)}{suggestion(name, names)}",
            here,
        )
