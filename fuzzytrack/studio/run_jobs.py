"""Monte Carlo experiments of a page, and one run of them plot by plot."""

from __future__ import annotations

import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.studio.history import Texts
from fuzzytrack.studio.jobs import Job, Work
from fuzzytrack.studio.limits import check_runs_fit, run_bytes
from fuzzytrack.studio.notes import by_name
from fuzzytrack.studio.run_results import operations, results_as_json
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.testbed.results import Results
from fuzzytrack.trackers.base import Tracker

__all__ = ["Run", "run_work"]

# A preview is shown again after this many times what the last one took, s.
_RARELY = 10
_PAUSE = 0.3


@dataclass
class Run:
    """A Monte Carlo experiment of a page.

    Attributes
    ----------
    scenario : Scenario
    trackers : dict of str to Tracker
    runs, seed : int
    texts : Texts
        What it was made of.
    saved : str or None
        The rule base as it was saved last at that time.
    results : Results or None
        When it is done.
    """

    scenario: Scenario
    trackers: dict[str, Tracker]
    runs: int
    seed: int
    texts: Texts
    saved: str | None
    results: Results | None = None

    @property
    def size(self) -> int:
        """Bytes of its errors."""
        scenario = self.scenario
        each = run_bytes(len(scenario.time), scenario.n_axes, len(self.trackers))
        return self.runs * each

    def check(self) -> None:
        """Refuse what needs too much memory.

        Raises
        ------
        ValueError
        """
        scenario = self.scenario
        check_runs_fit(self.runs, len(scenario.time), scenario.n_axes, len(self.trackers))


def run_work(run: Run) -> Work:
    """The work of a job that does the runs; they are those of ``fuzzytrack testbed``."""

    def work(job: Job, pool: ProcessPoolExecutor) -> dict[str, Any]:
        counts = _operations(run)
        shown, cost = time.monotonic(), 0.0

        def preview(found: Results) -> None:
            nonlocal shown, cost
            now = time.monotonic()
            if found.runs == run.runs or now - shown < max(_PAUSE, _RARELY * cost):
                return
            job.show(results_as_json(found, counts))
            shown = time.monotonic()
            cost = shown - now

        found = monte_carlo(
            run.scenario,
            run.trackers,
            run.runs,
            run.seed,
            progress=job.progress,
            preview=preview,
            executor=pool,
        )
        run.results = found
        return {**results_as_json(found, counts), "notes": by_name(job.notes, run.trackers)}

    return work


def _operations(run: Run) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = {}
    for name, tracker in run.trackers.items():
        try:
            found |= operations({name: tracker}, run.scenario.n_axes)
        except Exception:
            # A kernel of a plug-in may refuse numbers that count; the rest is shown without them.
            continue
    return found
