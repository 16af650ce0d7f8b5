"""Commands that give what is on the page to be kept: texts, snippets, a report."""

from __future__ import annotations

import tempfile
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fuzzytrack.specs import is_file
from fuzzytrack.studio.arguments import Arguments
from fuzzytrack.studio.handlers import Handler, Later
from fuzzytrack.studio.limits import MOST_RUNS
from fuzzytrack.studio.pages import Page
from fuzzytrack.studio.reading_arguments import READING, reading_options
from fuzzytrack.studio.run_jobs import Run
from fuzzytrack.studio.snippets import (
    PageTexts,
    RunSnippet,
    ScanSnippet,
    Snippet,
    TrackSnippet,
    TuneSnippet,
)
from fuzzytrack.studio.tracker_texts import EDITOR

__all__ = ["HANDLERS"]

Answer = Mapping[str, Any]

_RUNS = 200
# Settings of matplotlib are those of all threads, and are changed while a report is written.
_drawing = threading.Lock()
_OF_SNIPPETS = (
    *("trackers", "runs", "seed", "name", "on", "tracker", "free", "trials", "folds"),
    *READING,
)


def export(page: Page, given: Arguments) -> Answer:
    """A text of the page as a file to be kept."""
    kind = {"yaml": "rules", "scenario": "scenario"}[given.choice("what", ("yaml", "scenario"))]
    found = page.session.texts.rules if kind == "rules" else page.session.texts.scenario
    name = found.name if is_file(found.name) else f"{found.name}.yaml"
    return {"name": name, "text": found.text}


def snippet(page: Page, given: Arguments) -> Answer:
    """Python, or a command, that does what is on the page: runs, tracks, scans or tunes."""
    what = given.choice("what", ("python", "command"))
    of = given.choice("of", ("run", "track", "scan", "tune"), "run")
    shown = {"run": _run, "track": _track, "scan": _scan, "tune": _tune}[of](page, given)
    if what == "python":
        return {"text": shown.python()}
    if page.studio.command is None:
        raise ValueError("what: there is no command here; take 'python'")
    return {"text": page.studio.command(*shown.command())}


def _texts(page: Page, run: Run | None = None) -> PageTexts:
    """Texts of the page as they are, or those that a run was made of."""
    session = page.session
    texts, saved = session.texts, session.saved_text("rules")
    if run is not None:
        texts, saved = run.texts, run.saved

    def named(kind: str, name: str, text: str | None) -> str:
        """The name, if it still stands for the text."""
        return name if text is not None and session.saved_text(kind, name) == text else ""

    return PageTexts(
        rules=named("rules", texts.rules.name, texts.rules.text),
        rules_text=texts.rules.text,
        scenario=named("scenario", texts.scenario.name, texts.scenario.text),
        scenario_text=texts.scenario.text,
        saved=named("rules", texts.rules.name, saved),
        saved_text=saved or "",
    )


def _run(page: Page, given: Arguments) -> Snippet:
    """The last run with its own texts; another one with those of the page."""
    run = page.run
    usual = page.session.reading.scenario.trackers if run is None else list(run.trackers)
    trackers = given.texts("trackers", list(usual or [EDITOR]))
    runs = given.whole("runs", 1, MOST_RUNS, _RUNS if run is None else run.runs)
    seed = given.whole("seed", 0, 2**53, 0 if run is None else run.seed)
    is_last = run is not None and (list(run.trackers), run.runs, run.seed) == (trackers, runs, seed)
    return RunSnippet(_texts(page, run if is_last else None), trackers, runs, seed)


def _track(page: Page, given: Arguments) -> Snippet:
    return TrackSnippet(
        _texts(page),
        name=given.text("name"),
        trackers=given.texts("trackers", [EDITOR]),
        options=reading_options(given),
    )


def _scan(page: Page, given: Arguments) -> Snippet:
    return ScanSnippet(_texts(page), name=given.text("name"), options=reading_options(given))


def _tune(page: Page, given: Arguments) -> Snippet:
    free = given.text("free", None)
    numbers = ("trials", "folds", "runs", "seed")
    return TuneSnippet(
        _texts(page),
        on=given.text("on", None),
        tracker=given.text("tracker", EDITOR),
        options={
            "free": None if not free else [word.strip() for word in free.split(",")],
            **{name: given.whole(name, 0, 2**53, None) for name in numbers},
            **reading_options(given),
        },
    )


def report(page: Page, given: Arguments) -> Later:
    """The last run as one HTML page, with its pictures."""
    results = page.results

    def work() -> Answer:
        from fuzzytrack.reports.html_report import write_report

        with _drawing, tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "report.html"
            write_report(path, results)
            return {"name": f"{results.scenario}.html", "text": path.read_text(encoding="utf-8")}

    return Later(work)


HANDLERS = {
    "export": Handler(export, ("what",)),
    "snippet": Handler(snippet, ("what", "of", *_OF_SNIPPETS)),
    "report": Handler(report),
}
