"""What is wrong with a live feed: counted, and told of as it happens, but not too often."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable

from fuzzytrack.plurals import counted

__all__ = ["FAR_AHEAD", "FAULTS", "LiveFaults"]

#: A time that is ahead of all others by more than this (s), and the lateness, is wrong.
FAR_AHEAD = 60.0

#: Kinds of faults: what one is called, and several.
FAULTS = {
    "faulty": ("faulty line, left out", "faulty lines, left out"),
    "repeated": (
        "plot at a time that its track has already, not used",
        "plots at times that their tracks have already, not used",
    ),
    "too_late": ("plot too late, not used", "plots too late, not used"),
    "ahead": (
        "time far ahead, after which its track began anew",
        "times far ahead, after which their tracks began anew",
    ),
}
# Seconds after which a fault of the same kind is told of again.
_QUIET = 10.0


class LiveFaults:
    """Counts of faults by their kind.

    Parameters
    ----------
    tell : callable, optional
        Called with a sentence about the first fault of a kind, and about later ones at most once in
        ten seconds.

    Attributes
    ----------
    counts : Counter of str
        How many there were, by the names of `FAULTS`.
    """

    def __init__(self, tell: Callable[[str], None] | None = None) -> None:
        self._tell = tell
        self.counts: Counter[str] = Counter()
        self._told: dict[str, float] = {}

    def add(self, kind: str, sentence: str) -> None:
        """Count a fault.

        Parameters
        ----------
        kind : str
            One of `FAULTS`.
        sentence : str
            What is wrong, and where.
        """
        self.counts[kind] += 1
        now = time.monotonic()
        if self._tell is not None and now - self._told.get(kind, now - _QUIET) >= _QUIET:
            self._told[kind] = now
            so_far = self.counts[kind]
            self._tell(sentence if so_far == 1 else f"{sentence} ({so_far} of this kind so far)")

    def sentences(self) -> tuple[str, ...]:
        """Counts in words, of the kinds that there were."""
        return tuple(counted(self.counts[k], *FAULTS[k]) for k in FAULTS if self.counts[k])
