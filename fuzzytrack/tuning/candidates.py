"""Families of trackers that a search can tune: free parameters, and the tracker that they make."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

from fuzzytrack.trackers.base import Tracker
from fuzzytrack.tuning.parameters import Numbers, Parameter, Space
from fuzzytrack.yamltree import suggestion

__all__ = ["Candidates", "Choice", "chosen"]


@dataclass(frozen=True)
class Candidates(ABC):
    """Trackers of one kind that differ in some numbers.

    Attributes
    ----------
    title : str
        For tables.
    space : Space
        The free numbers.
    """

    title: str
    space: Space

    @abstractmethod
    def text(self, numbers: Numbers) -> str:
        """What makes the tracker with these numbers again: a specification, or a rule base.

        Raises
        ------
        ValueError
            If the numbers make none.
        """

    @abstractmethod
    def tracker(self, numbers: Numbers) -> Tracker:
        """Tracker with these numbers.

        Raises
        ------
        ValueError
            If the numbers make none.
        """

    @abstractmethod
    def restricted(self, kept: Sequence[int]) -> Candidates:
        """The same with some of the numbers free, by number; the others stay where they start."""


@dataclass(frozen=True)
class Choice:
    """A number that can be free, and the words that choose it.

    Attributes
    ----------
    parameter : Parameter
    words : frozenset of str
        Besides the name of the parameter: those of groups that it belongs to.
    """

    parameter: Parameter
    words: frozenset[str] = field(default_factory=frozenset)

    def has(self, word: str) -> bool:
        """Whether a word chooses it."""
        return word == self.parameter.name or word in self.words


def chosen(choices: Sequence[Choice], free: Collection[str] | None, whose: str) -> list[int]:
    """Numbers of the choices that some words choose, in order; all of them without words.

    Raises
    ------
    ValueError
        If a word chooses nothing, or nothing is free; lists the words that are allowed.
    """
    names = [choice.parameter.name for choice in choices]
    groups = sorted(set().union(*(choice.words for choice in choices))) if choices else []
    allowed = tuple(dict.fromkeys((*groups, *names)))
    if not choices or (free is not None and not free):
        what = f"; name some out of {', '.join(allowed)}" if allowed else ""
        raise ValueError(f"free: {whose} has no number that is free{what}")
    for word in free or ():
        if word not in allowed:
            raise ValueError(f"free: {whose} has no number {word!r}{suggestion(word, allowed)}")
    return [
        k
        for k, choice in enumerate(choices)
        if free is None or any(choice.has(word) for word in free)
    ]
