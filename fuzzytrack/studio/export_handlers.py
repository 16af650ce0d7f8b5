"""Commands that give what is on the page to be kept: texts, snippets, a report."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fuzzytrack.specs import is_file, split
from fuzzytrack.studio.arguments import Arguments
from fuzzytrack.studio.handlers import Handler, Later
from fuzzytrack.studio.limits import MOST_RUNS
from fuzzytrack.studio.pages import Page
from fuzzytrack.studio.snippets import OnPage, python_snippet
from fuzzytrack.studio.tracker_texts import EDITOR, SAVED

__all__ = ["HANDLERS"]

Answer = Mapping[str, Any]

_RUNS = 200


def export(page: Page, given: Arguments) -> Answer:
    """A text of the page as a file to be kept."""
    kind = {"yaml": "rules", "scenario": "scenario"}[given.choice("what", ("yaml", "scenario"))]
    found = page.session.texts.rules if kind == "rules" else page.session.texts.scenario
    name = found.name if is_file(found.name) else f"{found.name}.yaml"
    return {"name": name, "text": found.text}


def snippet(page: Page, given: Arguments) -> Answer:
    """Python, or a command, that gives the numbers of the experiment on the page."""
    what = given.choice("what", ("python", "command"))
    shown = _shown(page, given)
    if what == "python":
        return {"text": python_snippet(shown)}
    if page.studio.command is None:
        raise ValueError("what: there is no command here; take 'python'")
    if not shown.scenario:
        raise ValueError("what: save the scenario first; a command names its file")
    trackers = [_named(shown, text) for text in shown.trackers]
    return {"text": page.studio.command(shown.scenario, trackers, shown.runs, shown.seed)}


def _shown(page: Page, given: Arguments) -> OnPage:
    session, run = page.session, page.run
    texts = session.texts
    usual = session.reading.scenario.trackers if run is None else list(run.trackers)
    return OnPage(
        rules=texts.rules.name if session.is_saved("rules") else "",
        rules_text=texts.rules.text,
        scenario=texts.scenario.name if session.is_saved("scenario") else "",
        scenario_text=texts.scenario.text,
        saved=texts.rules.name if session.saved_text("rules") is not None else "",
        trackers=given.texts("trackers", list(usual or [EDITOR])),
        runs=given.whole("runs", 1, MOST_RUNS, _RUNS if run is None else run.runs),
        seed=given.whole("seed", 0, 2**53, 0 if run is None else run.seed),
    )


def _named(shown: OnPage, text: str) -> str:
    """A tracker as a command names it."""
    name, _ = split(text, "tracker")
    if name not in (EDITOR, SAVED):
        return text
    file = shown.rules if name == EDITOR else shown.saved
    if not file:
        raise ValueError("what: save the rule base first; a command names its file")
    return file + text.strip()[len(name) :]


def report(page: Page, given: Arguments) -> Later:
    """The last run as one HTML page, with its pictures."""
    run = page.run
    if run is None or run.results is None:
        raise ValueError("there are no results yet; run an experiment to its end first")
    results = run.results

    def work() -> Answer:
        from fuzzytrack.reports.html_report import write_report

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "report.html"
            write_report(path, results)
            return {"name": f"{results.scenario}.html", "text": path.read_text(encoding="utf-8")}

    return Later(work)


HANDLERS = {
    "export": Handler(export, ("what",)),
    "snippet": Handler(snippet, ("what", "trackers", "runs", "seed")),
    "report": Handler(report),
}
