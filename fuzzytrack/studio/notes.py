"""Warnings of work for a page: notes beside its results, in place of lines on the console."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from fuzzytrack.errors import CacheWarning, NoRuleFiresWarning, PluginWarning, TrackWarning
from fuzzytrack.trackers.base import Tracker

__all__ = ["MOST_NOTES", "by_name", "noted", "warnings_to_notes"]

#: Notes of one piece of work; every run of a tracker may have one.
MOST_NOTES = 20
# What a page is told, and what whoever started the server is told.
_OF_PAGE, _OF_CONSOLE = (NoRuleFiresWarning, TrackWarning), (CacheWarning, PluginWarning)

# The notes of the work of a thread.
_thread = threading.local()


@contextmanager
def noted() -> Iterator[list[str]]:
    """Collect what is warned of tracks and rules in this thread, each text once.

    Yields
    ------
    list of str
        Filled meanwhile, where `warnings_to_notes` is in force.
    """
    before = getattr(_thread, "notes", None)
    notes: list[str] = []
    _thread.notes = notes
    try:
        yield notes
    finally:
        _thread.notes = before


def by_name(notes: Sequence[str], trackers: Mapping[str, Tracker]) -> list[str]:
    """Notes with the names of trackers, each once; warnings begin with trackers as Python.

    Parameters
    ----------
    notes : sequence of str
    trackers : mapping of str to Tracker
        As the page names them.
    """
    names: dict[str, list[str]] = {}
    for text in notes:
        found = [name for name, each in trackers.items() if text.startswith(f"{each!r}: ")]
        said = text.removeprefix(f"{trackers[found[0]]!r}: ") if found else text
        names.setdefault(said, []).extend(found)
    return [f"{', '.join(each)}: {said}" if each else said for said, each in names.items()]


@contextmanager
def warnings_to_notes() -> Iterator[None]:
    """Give warnings to the work in whose thread they are issued.

    It holds for the whole program, so it is for its first thread. Warnings of plug-ins and of the
    cache of compiled code are shown as before, since they are no matter of a page. All others are
    dropped: where numbers of a page overflow, NumPy warns of every operation, and the page shows a
    gap; and where a surface has no rule, it has a hole.
    """
    shown = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
        notes: list[str] | None = getattr(_thread, "notes", None)
        if issubclass(category, _OF_CONSOLE):
            shown(message, category, *where, **more)
        elif notes is None or not issubclass(category, _OF_PAGE) or str(message) in notes:
            return
        elif len(notes) < MOST_NOTES:
            notes.append(str(message))

    with warnings.catch_warnings():
        for category in _OF_PAGE:
            # Not once: each piece of work has its own.
            warnings.simplefilter("always", category)
        warnings.showwarning = show
        yield
