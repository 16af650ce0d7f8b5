"""What writers of other formats share: their result, sets without hedges, and rules by weight."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import Conditions, Rule, RuleBase
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.yamltree import quoted

__all__ = ["BaseSets", "Row", "Translation", "no_counterpart", "one_line", "rows"]


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


def no_counterpart(rules: RuleBase, what: str, target: str) -> RuleBaseError:
    """Error about something that another format does not have."""
    return RuleBaseError(f"{rules.name}: {what} has no counterpart in {target}")


def one_line(text: str, what: str, forbidden: str, target: str) -> str:
    """A text that stands on one line of a file."""
    text = " ".join(text.split())
    found = re.search(f"[{re.escape(forbidden)}\x00-\x1f\x7f]", text) if forbidden else None
    if found is not None:
        raise RuleBaseError(f"{what} {quoted(text)}: {found.group()!r} may not be in {target}")
    return text
