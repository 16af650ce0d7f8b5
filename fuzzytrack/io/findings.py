"""What was found wrong with a recording, or guessed about it, while it was read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any

from fuzzytrack.io.cleaning_rules import CleaningCounts
from fuzzytrack.plurals import counted

__all__ = ["Findings"]


@dataclass
class Findings:
    """Counts of faults, and notes; it grows while a recording is read and tracked.

    Attributes
    ----------
    impossible : Counter of str
        Plots whose position cannot be, and which are missed plots, by the reason.
    cleaning : CleaningCounts
        What the rules of `Cleaning` have changed.
    unnamed : int
        Rows without an identity, which belong to no track and were left out.
    rejected, restarts : int
        Plots beyond the gate of their track, which were not used; tracks that began again after
        several of these.
    notes : list of str
        What was guessed, and what a user might want to know, each once and in a sentence.
    """

    impossible: Counter[str] = field(default_factory=Counter)
    cleaning: CleaningCounts = field(default_factory=CleaningCounts)
    unnamed: int = 0
    rejected: int = 0
    restarts: int = 0
    notes: list[str] = field(default_factory=list)

    def note(self, sentences: Iterable[str]) -> None:
        """Add notes that are not there yet."""
        self.notes += [each for each in dict.fromkeys(sentences) if each not in self.notes]

    def merge(self, other: Findings) -> None:
        """Add what was found in another part of the recording."""
        self.impossible.update(other.impossible)
        self.cleaning = self.cleaning + other.cleaning
        self.unnamed += other.unnamed
        self.rejected += other.rejected
        self.restarts += other.restarts
        self.note(other.notes)

    def sentences(self) -> tuple[str, ...]:
        """What was left out or put right, a phrase for each kind of fault."""
        missed = (
            f"{counted(count, 'plot', 'plots')} with {reason}, taken as missed"
            for reason, count in self.impossible.items()
        )
        rows = counted(self.unnamed, "row") + " without an identity left out"
        gated = counted(self.rejected, "plot") + " beyond the gate, not used"
        again = counted(self.restarts, "track") + " started again after several of these"
        return (
            *([rows] if self.unnamed else []),
            *missed,
            *self.cleaning.sentences(),
            *([gated] if self.rejected else []),
            *([again] if self.restarts else []),
        )

    def to_json_dict(self) -> dict[str, Any]:
        """The same in the types of JSON."""
        own = {"unnamed": self.unnamed, "rejected": self.rejected, "restarts": self.restarts}
        faults = {**own, **self.impossible, **asdict(self.cleaning)}
        return {"faults": faults, "notes": list(self.notes)}
