"""Trackers as a page names them: the rule base in the editor, files of the folder, names."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Protocol

from fuzzytrack import specs
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.recordings.preparation import shares_covariance, suited
from fuzzytrack.studio.folder import naming
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_trackers, catalog, tracker_of_rules

__all__ = [
    "EDITOR",
    "MOST_TRACKERS",
    "SAVED",
    "MakeTrackers",
    "check_place",
    "listed_trackers",
    "make_trackers",
]  # fmt: skip

#: Names of the rule base as it is in the editor, and as it was last saved or opened.
EDITOR, SAVED = "editor", "saved"
#: Trackers of one job.
MOST_TRACKERS = 40


class MakeTrackers(Protocol):
    """Makes the trackers of a job; see `make_trackers`."""

    def __call__(self, axes_differ: bool = False) -> dict[str, Tracker]:
        """Make them, for plots whose noise may differ between axes."""


def make_trackers(
    texts: Sequence[str],
    edited: Callable[[str], RuleBase],
    path: Callable[[str], Path],
    *,
    axes_differ: bool = False,
) -> dict[str, Tracker]:
    """Make trackers of what a page names, each named by its text.

    Parameters
    ----------
    texts : sequence of str
        As `fuzzytrack.trackers.catalog.make_tracker` reads them; files are those of the folder,
        and ``editor`` and ``saved`` are rule bases of the page.
    edited : callable
        Gives the rule base of `EDITOR` or `SAVED`.
    path : callable
        Path of a file of the folder; refuses others.
    axes_differ : bool
        Whether the noise of the plots differs between axes; trackers then keep a covariance for
        each, as those of commands do, see `fuzzytrack.recordings.preparation.suited`.

    Raises
    ------
    ValueError
        If there are too many, or none, or one cannot be made.
    """
    if len(texts) > MOST_TRACKERS:
        raise ValueError(f"trackers: {len(texts)}; at most {MOST_TRACKERS}")
    named: dict[str, Tracker | str] = {}
    files: list[Path] = []
    for text in texts:
        if text in named:
            raise ValueError(f"trackers: {text!r} is given twice")
        check_place(text, "trackers")
        name, options = specs.split(text, "tracker")
        if name in (EDITOR, SAVED):
            rules = edited(name)
            named[text] = made = _of_rules(text, rules, options)
            if axes_differ and shares_covariance(text, made):
                named[text] = _of_rules(text, rules, {**options, "axes": "own"})
        elif specs.is_file(name):
            files.append(path(name))
            if not files[-1].is_file():
                raise ValueError(f"trackers: {name} is not in the folder")
            named[text] = str(files[-1]) + text.strip()[len(name) :]
        else:
            named[text] = text
    with ExitStack() as stack:
        for file in files:
            stack.enter_context(naming(file))
        found = as_trackers(named)
        return {
            name: suited(named[name], tracker, axes_differ=axes_differ)[1]
            for name, tracker in found.items()
        }


def check_place(text: str, argument: str) -> None:
    """Refuse a tracker that names a file which is not in the folder.

    Parameters
    ----------
    text : str
        As a page names a tracker.
    argument : str
        Its argument, for messages.

    Raises
    ------
    ValueError
    """
    name, options = specs.split(text, "tracker")
    for value in (*options.values(), name):
        if "/" in value or "\\" in value:
            raise ValueError(f"{argument}: {text!r} names a file outside of the folder")
    if any(map(specs.is_file, options.values())):
        raise ValueError(f"{argument}: {text!r}: a file cannot be a parameter here")


def _of_rules(text: str, rules: RuleBase, options: dict[str, str]) -> Tracker:
    try:
        return tracker_of_rules(rules, options)
    except (TypeError, ValueError) as error:
        raise ValueError(f"tracker {text!r}: {error}") from error


def listed_trackers() -> list[dict[str, Any]]:
    """All trackers that a page can choose from, with their parameters."""
    return [
        {
            "name": entry.name,
            "kind": entry.kind,
            "help": entry.source,
            "package": entry.package,
            "parameters": [_parameter(each) for each in entry.parameters],
        }
        for entry in catalog()
        if entry.kind != "normalization"
    ]


def _parameter(text: str) -> dict[str, str | None]:
    name, sign, default = text.partition("=")
    return {"name": name, "default": default if sign else None, "help": ""}
