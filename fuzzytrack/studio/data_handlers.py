"""Commands about recordings: read, tracked, compared, tuned on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.specs import is_file, split
from fuzzytrack.studio.arguments import Arguments, renamed
from fuzzytrack.studio.handlers import Handler, Later
from fuzzytrack.studio.limits import MESSAGE_BYTES
from fuzzytrack.studio.pages import Page
from fuzzytrack.studio.reading_arguments import READING, reading_options
from fuzzytrack.studio.recorded import Recorded, summary_of
from fuzzytrack.studio.run_handlers import trackers_of
from fuzzytrack.studio.track_jobs import track_work
from fuzzytrack.studio.tracker_texts import EDITOR, check_place
from fuzzytrack.studio.tune_jobs import Tuning, tune_work

__all__ = ["HANDLERS"]

Answer = Mapping[str, Any]

_MOST_TRIALS, _MOST_FOLDS, _MOST_RUNS, _MOST_SEED = 100_000, 100, 10_000, 2**53
_STEPS = 100


def upload(page: Page, given: Arguments) -> Later:
    """Take a recording, CSV, and say what is in it."""
    name = given.text("name", longest=100)
    page.studio.uploads.put(page.key, name, given.text("text", longest=MESSAGE_BYTES))
    return recording(page, given)


def recording(page: Page, given: Arguments) -> Later:
    """Say what is in a recording; the page no longer waits for tracks of what it said before."""
    name = given.text("name")
    found = _recorded(page, name, given)
    page.replace("track")

    def work() -> Answer:
        told = {"name": name, "columns": found.columns(), "problem": None}
        try:
            return told | summary_of(found.read())
        except (ValueError, OSError) as failure:
            # Another column may be all that is needed.
            return told | {"problem": str(failure), "plots": None, "tracks": None}

    return Later(work)


def _recorded(page: Page, name: str, given: Arguments) -> Recorded:
    """A recording with what the page says of it."""
    path = page.studio.uploads.path(page.key, name)
    options = reading_options(given)
    truth = options.get("truth", ())
    is_file = len(truth) == 1 and truth[0].lower().endswith(".csv")
    true_file = page.studio.uploads.path(page.key, truth[0]) if is_file else None
    return Recorded(path, options, true_file)


def track(page: Page, given: Arguments) -> Later:
    """Start to track a recording with some trackers, and to compare them."""
    found = _recorded(page, given.text("name"), given)
    make = trackers_of(page, given.texts("trackers"))

    def work() -> Answer:
        make()  # what cannot be made is refused at once
        page.replace("track")
        return {"job": page.start("track", _STEPS, track_work(found, make)).number}

    return Later(work)


def tune(page: Page, given: Arguments) -> Later:
    """Start the tuning of a tracker, on a recording or the scenario of the page."""
    text = given.text("on", None)
    data: Scenario | Recorded = page.session.reading.scenario
    if text is None:
        page.session.check_loads("scenario")
    else:
        with renamed(name="on"):
            data = _recorded(page, text, given)
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
        return {"job": page.start("tune", _STEPS, tune_work(tuning)).number}

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
    "recording": Handler(recording, ("name", *READING)),
    "upload": Handler(upload, ("name", "text", *READING)),
    "track": Handler(track, ("name", "trackers", *READING)),
    "tune": Handler(tune, ("on", "tracker", "free", "trials", "folds", "runs", "seed", *READING)),
}
