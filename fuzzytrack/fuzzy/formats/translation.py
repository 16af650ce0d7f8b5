"""What writers of other formats share: their result, sets without hedges, and rules by weight."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.numbers import written
from fuzzytrack.fuzzy.rulebase import Conditions, Rule, RuleBase
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.yamltree import quoted

__all__ = ["BaseSets", "FormatWriter", "Row", "Translation", "one_line", "rows"]


class Translation(NamedTuple):
    """A rule base in another format.

    Parameters
    ----------
    text : str
        The file.
    notes : tuple of str
        Where another program computes otherwise from it; empty if it does not.
    """

    text: str
    notes: tuple[str, ...]


class Row(NamedTuple):
    """A rule of a format in which a rule has one weight and one set of an output.

    Parameters
    ----------
    groups : tuple of conditions
        As of `fuzzytrack.fuzzy.rulebase.Rule`.
    sets : dict of str to str
        Set that is concluded, by output.
    weight : float
    """

    groups: tuple[Conditions, ...]
    sets: dict[str, str]
    weight: float


def rows(rule: Rule) -> Iterator[Row]:
    """Rules that together say what a rule says: of several sets or confidences, one in each."""
    left = list(rule.consequents)
    while left:
        weight = left[0].confidence
        sets: dict[str, str] = {}
        for consequent in list(left):
            if consequent.confidence == weight and consequent.output not in sets:
                sets[consequent.output] = consequent.set_name
                left.remove(consequent)
        yield Row(rule.groups, sets, weight)


@dataclass(frozen=True)
class _Base:
    name: str
    shape: str
    parameters: tuple[float, ...]


class BaseSets:
    """Sets of a variable without their hedges, each once, and what each set is of them.

    Parameters
    ----------
    variable : Variable

    Attributes
    ----------
    sets : list
        With `name`, `shape` and `parameters`.
    """

    def __init__(self, variable: Variable) -> None:
        self.sets: list[_Base] = []
        self.variable = variable
        self._found: dict[str, tuple[int, tuple[str, ...]]] = {}
        for plain in (True, False):
            for each in variable.sets:
                if (not each.hedges) == plain:
                    self._found[each.name] = self._index(each), each.hedges

    def _index(self, fuzzy: FuzzySet) -> int:
        name = fuzzy.name
        if fuzzy.hedges:
            for index, each in enumerate(self.sets):
                if (each.shape, each.parameters) == (fuzzy.base, fuzzy.parameters):
                    return index
        taken = [each.name for each in self.sets]
        plain = name.removeprefix("_".join([*fuzzy.hedges, ""])) if fuzzy.hedges else name
        short = plain if plain and plain not in (*taken, *self.variable.set_names) else name
        self.sets.append(_Base(short, fuzzy.base, fuzzy.parameters))
        return len(self.sets) - 1

    def find(self, set_name: str) -> tuple[int, tuple[str, ...]]:
        """Place of the set without its hedges, from 0, and the hedges."""
        return self._found[set_name]


class FormatWriter:
    """What a writer of a format begins with: a rule base, its sets, and words for its operators.

    Parameters
    ----------
    rules : RuleBase
    target : str
        Name of the format, for messages.

    Attributes
    ----------
    inputs, outputs : dict of str to BaseSets
        By the name of the variable.
    """

    def __init__(self, rules: RuleBase, target: str) -> None:
        self.rules = rules
        self.target = target
        self.inputs = {v.name: BaseSets(v) for v in rules.inputs}
        self.outputs = {v.name: BaseSets(v) for v in rules.outputs}

    def lacks(self, what: str) -> RuleBaseError:
        """Error about something that the format does not have."""
        return RuleBaseError(f"{self.rules.name}: {what} has no counterpart in {self.target}")

    def word(self, word: str, allowed: Mapping[str, str], what: str) -> str:
        """Their word for one of ours, of a mapping from theirs to ours."""
        for theirs, ours in allowed.items():
            if ours == word:
                return theirs
        raise self.lacks(f"{what} {word}")

    def weight(self, row: Row) -> str:
        """Weight of a rule, by which formats multiply its strength."""
        for name in row.sets:
            weighing = self.rules.operators_of(self.rules.output(name)).weighing
            if row.weight != 1.0 and weighing != "product":
                raise self.lacks(f"a confidence that is joined by {weighing}")
        return written(row.weight)


def one_line(text: str, what: str, forbidden: str, target: str) -> str:
    """A text that stands on one line of a file."""
    text = " ".join(text.split())
    found = re.search(f"[{re.escape(forbidden)}\x00-\x1f\x7f]", text) if forbidden else None
    if found is not None:
        raise RuleBaseError(f"{what} {quoted(text)}: {found.group()!r} may not be in {target}")
    return text
