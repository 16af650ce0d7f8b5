"""Python, and commands, that do what is on the page: an experiment, tracks, a tuning.

Tracks of plots without identities are not for the page, which gives the command for them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fuzzytrack import specs
from fuzzytrack.recordings.scan_options import OF_TRACKS
from fuzzytrack.studio.tracker_texts import EDITOR, SAVED

__all__ = ["PageTexts", "RunSnippet", "ScanSnippet", "Snippet", "TrackSnippet", "TuneSnippet"]

#: A command, what follows it, and its options by their names.
Command = tuple[str, Sequence[str], Mapping[str, object]]


@dataclass(frozen=True)
class PageTexts:
    """Texts of a page, and where a script finds them.

    Attributes
    ----------
    rules, scenario : str
        Name of what is shipped, or of a file; empty if the text differs from that.
    rules_text, scenario_text : str
    saved : str
        Name of the rule base as it was last saved or opened; empty if it never was, or if the file
        has been saved anew since.
    saved_text : str
        That rule base.
    """

    rules: str
    rules_text: str
    scenario: str
    scenario_text: str
    saved: str
    saved_text: str

    def named(self, tracker: str) -> str | None:
        """A tracker as a script names it; None if it is a rule base that has no name."""
        name, _ = specs.split(tracker, "tracker")
        if name not in (EDITOR, SAVED):
            return tracker
        file = self.rules if name == EDITOR else self.saved
        return file + tracker.strip()[len(name) :] if file else None

    def typed(self, tracker: str) -> str:
        """A tracker as a command names it.

        Raises
        ------
        ValueError
            If its rule base has not been saved.
        """
        found = self.named(tracker)
        if found is None:
            raise ValueError(
                "what: save the rule base first, before it is run; a command names its file"
            )
        return found

    def all_typed(self, trackers: Sequence[str]) -> list[str]:
        """Trackers as a command names them, each once: it refuses one that is given twice.

        Raises
        ------
        ValueError
            As for `typed`.
        """
        return list(dict.fromkeys(map(self.typed, trackers)))

    @property
    def typed_scenario(self) -> str:
        """The scenario as a command names it.

        Raises
        ------
        ValueError
            If it has not been saved.
        """
        if not self.scenario:
            raise ValueError(
                "what: save the scenario first, before it is run; a command names its file"
            )
        return self.scenario


class Script:
    """Lines of Python, with the imports that they need.

    Parameters
    ----------
    texts : PageTexts
    """

    def __init__(self, texts: PageTexts) -> None:
        self._texts = texts
        self._imports: dict[str, None] = {}
        self._lines: list[str] = []

    def imports(self, module: str, name: str) -> None:
        """Import a name."""
        self._imports[f"from {module} import {name}"] = None

    def add(self, line: str) -> None:
        """Add a line, unless it is there."""
        if line not in self._lines:
            self._lines.append(line)

    def scenario(self) -> str:
        """Expression for the scenario of the page."""
        if self._texts.scenario:
            return repr(self._texts.scenario)
        self.imports("fuzzytrack.simulation.scenario_files", "loads_scenario")
        self.add(f"scenario = loads_scenario({_literal(self._texts.scenario_text)})")
        return "scenario"

    def rules(self, tracker: str) -> str:
        """Expression for the rule base of a tracker, which has no name."""
        is_saved = specs.split(tracker, "tracker")[0] == SAVED
        name = "saved" if is_saved else "rules"
        text = self._texts.saved_text if is_saved else self._texts.rules_text
        self.imports("fuzzytrack.fuzzy.loading", "loads_rulebase")
        self.add(f"{name} = loads_rulebase({_literal(text)})")
        return name

    def trackers(self, texts: Sequence[str]) -> str:
        """Expression for some trackers."""
        found = {text: self._tracker(text) for text in texts}
        if all(value == repr(text) for text, value in found.items()):
            return f"[{', '.join(found.values())}]"
        return "{" + ", ".join(f"{text!r}: {value}" for text, value in found.items()) + "}"

    def _tracker(self, text: str) -> str:
        named = self._texts.named(text)
        if named is not None:
            return repr(named)
        self.imports("fuzzytrack.trackers.catalog", "tracker_of_rules")
        return f"tracker_of_rules({self.rules(text)}, {specs.split(text, 'tracker')[1]!r})"

    def __str__(self) -> str:
        return "\n".join([*sorted(self._imports), "", *self._lines, ""])


@dataclass(frozen=True)
class Snippet(ABC):
    """What a page does, as Python and as a command.

    Attributes
    ----------
    texts : PageTexts
    """

    texts: PageTexts

    @abstractmethod
    def python(self) -> str:
        """The script."""

    @abstractmethod
    def command(self) -> Command:
        """The command; ValueError if it names what has not been saved."""


@dataclass(frozen=True)
class RunSnippet(Snippet):
    """A Monte Carlo experiment."""

    trackers: Sequence[str]
    runs: int
    seed: int

    def python(self) -> str:
        """See `Snippet.python`."""
        script = Script(self.texts)
        script.imports("fuzzytrack.testbed.montecarlo", "monte_carlo")
        scenario, trackers = script.scenario(), script.trackers(self.trackers)
        script.add(f"trackers = {trackers}")
        script.add(
            f"results = monte_carlo({scenario}, trackers, runs={self.runs}, seed={self.seed})"
        )
        script.add("for row in results.table():")
        script.add('    print(row["name"], row["predicted_rmse"], row["predicted_rmse_se"])')
        return str(script)

    def command(self) -> Command:
        """See `Snippet.command`."""
        trackers = self.texts.all_typed(self.trackers)
        options = {"trackers": trackers, "runs": self.runs, "seed": self.seed}
        return "testbed", [self.texts.typed_scenario], options


@dataclass(frozen=True)
class TrackSnippet(Snippet):
    """Trackers compared on a recording."""

    name: str
    trackers: Sequence[str]
    options: Mapping[str, Any]

    def python(self) -> str:
        """See `Snippet.python`."""
        script = Script(self.texts)
        script.imports("fuzzytrack.testbed", "compare_recorded")
        script.add(f"trackers = {script.trackers(self.trackers)}")
        given = "".join(f", {k}={v!r}" for k, v in _python_options(self.options).items())
        script.add(f"found = compare_recorded(trackers, {self.name!r}{given})")
        script.add("for score in found.scores:")
        script.add("    print(score.name, score.rms)")
        return str(script)

    def command(self) -> Command:
        """See `Snippet.command`."""
        trackers = self.texts.all_typed(self.trackers)
        return "compare", [self.name], {"trackers": trackers, **self.options}


@dataclass(frozen=True)
class ScanSnippet(Snippet):
    """Tracks of plots without identities."""

    name: str
    options: Mapping[str, Any]

    def python(self) -> str:
        """See `Snippet.python`."""
        script = Script(self.texts)
        script.imports("fuzzytrack", "track_scans")
        given = "".join(f", {k}={v!r}" for k, v in self._read.items())
        script.add(f"found = track_scans({self.name!r}{given})")
        script.add("print(found)")
        return str(script)

    def command(self) -> Command:
        """See `Snippet.command`."""
        return (
            "scan",
            [self.name],
            {**self._read, "output": f"tracks-of-{Path(self.name).stem}.csv"},
        )

    @property
    def _read(self) -> dict[str, Any]:
        unused = ("id", "truth", *OF_TRACKS)
        return {name: value for name, value in self.options.items() if name not in unused}


@dataclass(frozen=True)
class TuneSnippet(Snippet):
    """The tuning of a tracker, on a recording or the scenario of the page."""

    on: str | None
    tracker: str
    options: Mapping[str, Any]

    def python(self) -> str:
        """See `Snippet.python`."""
        script = Script(self.texts)
        script.imports("fuzzytrack.tuning.tuner", "tune")
        data = script.scenario() if self.on is None else repr(self.on)
        named = self.texts.named(self.tracker)
        tracker = script.rules(self.tracker) if named is None else repr(named)
        given = "".join(f", {k}={v!r}" for k, v in _python_options(self.options).items())
        script.add(f"tuned = tune({data}, {tracker}{given})")
        script.add("print(tuned.report)")
        return str(script)

    def command(self) -> Command:
        """See `Snippet.command`."""
        data = self.texts.typed_scenario if self.on is None else self.on
        return "tune", [data], {"tracker": self.texts.typed(self.tracker), **self.options}


def _python_options(options: Mapping[str, Any]) -> dict[str, Any]:
    """Options that are given, as functions take them."""
    given = {name: value for name, value in options.items() if value is not None}
    if "truth" in given:
        given["truth"] = ",".join(given["truth"])
    return given


def _literal(text: str) -> str:
    """A text over several lines as Python, if it can be written so."""
    plain = '"""' not in text and "\\" not in text and "\r" not in text
    if plain and text.endswith("\n") and not text.startswith('"'):
        return f'"""{text}"""'
    return repr(text)
