"""Commands about runs: Monte Carlo jobs, their end, and one run plot by plot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fuzzytrack.fuzzy.loading import loads_rulebase
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.specs import split
from fuzzytrack.studio.arguments import Arguments, renamed
from fuzzytrack.studio.handlers import Handler, Later
from fuzzytrack.studio.limits import MOST_RUNS
from fuzzytrack.studio.notes import by_name, noted
from fuzzytrack.studio.pages import Page
from fuzzytrack.studio.run_jobs import Run, run_work
from fuzzytrack.studio.run_results import paired_as_json
from fuzzytrack.studio.tracker_texts import EDITOR, MakeTrackers, make_trackers
from fuzzytrack.studio.walk import MOST_STEPS, walk
from fuzzytrack.testbed.montecarlo import simulated_runs
from fuzzytrack.trackers.base import Tracker

__all__ = ["HANDLERS", "trackers_of"]

Answer = Mapping[str, Any]
_MOST_SEED = 2**53


def run(page: Page, given: Arguments) -> Later:
    """Start a Monte Carlo experiment with the scenario of the page."""
    texts = given.texts("trackers")
    runs = given.whole("runs", 1, MOST_RUNS)
    seed = given.whole("seed", 0, _MOST_SEED, 0)
    page.session.check_loads("scenario")
    scenario = page.session.reading.scenario
    make = trackers_of(page, texts)
    made_of, saved = page.session.texts, page.session.saved_text("rules")

    def work() -> Answer:
        started = Run(scenario, make(), runs, seed, made_of, saved)
        started.check()
        page.studio.make_room_for(started, page)
        job = page.start("run", runs, run_work(started))
        page.run = started
        return {"job": job.number}

    return Later(work)


def trackers_of(page: Page, texts: list[str]) -> MakeTrackers:
    """Function that makes trackers of texts, with the rule base as it is now."""
    if any(split(text, "tracker")[0] == EDITOR for text in texts):
        page.session.check_loads("rules")
    rules = page.session.reading.rules
    saved = page.session.saved_text("rules")

    def edited(name: str) -> RuleBase:
        if name == EDITOR:
            return rules
        if saved is None:
            raise ValueError("trackers: the rule base has not been saved yet; save it first")
        return loads_rulebase(saved)

    def make(axes_differ: bool = False) -> dict[str, Tracker]:
        return make_trackers(texts, edited, page.studio.folder.place, axes_differ=axes_differ)

    return make


def cancel(page: Page, given: Arguments) -> Answer:
    """Cancel a job of the page at once."""
    return {"job": page.cancel(given.whole("job", 1, _MOST_SEED)).as_json(False)}


def walk_run(page: Page, given: Arguments) -> Later:
    """One run of one tracker, plot by plot, with the plots that the experiment has in it."""
    text = given.text("tracker")
    with renamed(trackers="tracker"):
        make = trackers_of(page, [text])
    seed = given.whole("seed", 0, _MOST_SEED, 0)
    number = given.whole("run", 0, MOST_RUNS - 1, 0)
    page.session.check_loads("scenario")
    scenario = page.session.reading.scenario
    if len(scenario.time) > MOST_STEPS:
        raise ValueError(f"run: has {len(scenario.time)} scans; at most {MOST_STEPS} can be walked")

    def work() -> Answer:
        with renamed(trackers="tracker", truth=None):
            trackers = make()
            (tracker,) = trackers.values()
            times, true, _, plots = simulated_runs(scenario, seed, range(number, number + 1))
        sigma = np.broadcast_to(plots.sigma, plots.z.shape)
        time = times if times.ndim == 1 else times[:, 0]
        with noted() as notes, renamed(z=None):
            found = walk(tracker, time, plots.z[:, 0], sigma[:, 0], true[:, 0])
        return {**found, "notes": by_name(notes, trackers)}

    return Later(work)


def paired(page: Page, given: Arguments) -> Later:
    """Difference of two trackers of the last experiment, run by run, and over time."""
    first, second = given.text("first"), given.text("second")
    results = page.results
    return Later(lambda: paired_as_json(results, first, second))


HANDLERS = {
    "run": Handler(run, ("trackers", "runs", "seed")),
    "cancel": Handler(cancel, ("job",)),
    "paired": Handler(paired, ("first", "second")),
    "walk": Handler(walk_run, ("tracker", "run", "seed")),
}
