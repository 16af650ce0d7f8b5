"""Commands about recordings: read, tracked, compared, tuned on."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.specs import is_file, split
from fuzzytrack.studio.arguments import Arguments
from fuzzytrack.studio.folder import naming
from fuzzytrack.studio.handlers import Handler, Later
from fuzzytrack.studio.limits import MESSAGE_BYTES
from fuzzytrack.studio.pages import Page
from fuzzytrack.studio.recorded import Recorded, summary_of, tracked_as_json
from fuzzytrack.studio.run_handlers import trackers_of
from fuzzytrack.studio.tracker_texts import EDITOR, check_place
from fuzzytrack.studio.tune_jobs import Tuning, tune_work

__all__ = ["HANDLERS"]

Answer = Mapping[str, Any]

_MOST_TRIALS, _MOST_FOLDS, _MOST_RUNS, _MOST_SEED = 100_000, 100, 10_000, 2**53
_STEPS = 100
_COLUMNS = ("time", "id", "axes", "sigma", "truth")


def upload(page: Page, given: Arguments) -> Later:
    """Take a recording, CSV, and say what is in it."""
    name = given.text("name", longest=100)
    text = given.text("text", longest=MESSAGE_BYTES)
    path = page.studio.uploads.put(page.key, name, text)

    recording = _recorded(path, given)

    def work() -> Answer:
        told = {"name": name, "columns": recording.columns(), "problem": None}
        try:
            return told | summary_of(recording.read())
        except ValueError as failure:
            # Another column may be all that is needed.
            return told | {"problem": str(failure), "plots": None, "tracks": None}

    return Later(work)


def _recorded(path: Path, given: Arguments) -> Recorded:
    """A recording with what the page says of its columns."""
    return Recorded(
        path,
        time=given.text("time", None),
        id=given.text("id", None),
        axes=given.texts("axes", None),
        sigma=given.number("sigma", None),
        truth=given.texts("truth", None),
    )


def track(page: Page, given: Arguments) -> Later:
    """Track a recording with some trackers, and compare them."""
    name = given.text("name")
    path = page.studio.uploads.path(page.key, name)
    recording = _recorded(path, given)
    make = trackers_of(page, given.texts("trackers"))

    def work() -> Answer:
        trackers = make()
        with naming(path):
            return {"name": name, **tracked_as_json(recording.read(), trackers)}

    return Later(work)


def tune(page: Page, given: Arguments) -> Later:
    """Start the tuning of a tracker, on a recording or the scenario of the page."""
    text = given.text("on", None)
    data: Scenario | Recorded = page.session.reading.scenario
    if text is None:
        page.session.check_loads("scenario")
    else:
        data = _recorded(page.studio.uploads.path(page.key, text), given)
    free = given.text("free", None)
    tuning = Tuning(
        data,
        _tuned(page, given.text("tracker", EDITOR)),
        [word.strip() for word in free.split(",")] if free and free.strip() else None,
        given.whole("trials", 1, _MOST_TRIALS, None),
        given.whole("folds", 2, _MOST_FOLDS, 5),
        given.whole("runs", 1, _MOST_RUNS, 60),
        given.whole("seed", 0, _MOST_SEED, 0),
    )

    def work() -> Answer:
        page.job = page.studio.jobs.start("tune", _STEPS, tune_work(tuning), page.report)
        return {"job": page.job.number}

    return Later(work)


def _tuned(page: Page, text: str) -> RuleBase | str:
    """What is tuned: the rule base of the editor, or what a text names."""
    check_place(text, "tracker")
    name, options = split(text, "tracker")
    if name == EDITOR:
        if options:
            raise ValueError(
                "tracker: 'editor' takes no parameters here; save it, and name the file"
            )
        page.session.check_loads("rules")
        return page.session.reading.rules
    if is_file(name):
        return str(page.studio.folder.place(name)) + text.strip()[len(name) :]
    return text


HANDLERS = {
    "upload": Handler(upload, ("name", "text", *_COLUMNS)),
    "track": Handler(track, ("name", "trackers", *_COLUMNS)),
    "tune": Handler(tune, ("on", "tracker", "free", "trials", "folds", "runs", "seed", *_COLUMNS)),
}
