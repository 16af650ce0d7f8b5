"""Tuning of a tracker as a job of the studio."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.studio.folder import naming
from fuzzytrack.studio.jobs import Job, Work
from fuzzytrack.studio.recorded import Recorded
from fuzzytrack.studio.uploads import check_plots

if TYPE_CHECKING:
    from fuzzytrack.tuning.tuned import Tuned

__all__ = ["Tuning", "tune_work"]


@dataclass(frozen=True)
class Tuning:
    """What is tuned, on what.

    Attributes
    ----------
    data : Scenario or Recorded
        A scenario, whose runs are simulated, or a recording.
    tracker : RuleBase or str
    free : sequence of str or None
        Numbers that are free.
    trials : int or None
    folds, runs, seed : int
        As for `fuzzytrack.tuning.tuner.tune`.
    """

    data: Scenario | Recorded
    tracker: RuleBase | str
    free: Sequence[str] | None
    trials: int | None
    folds: int
    runs: int
    seed: int


def tune_work(tuning: Tuning) -> Work:
    """The work of a job that tunes."""

    def work(job: Job, pool: ProcessPoolExecutor) -> dict[str, Any]:
        from fuzzytrack.tuning.tuner import tune

        data, own = tuning.data, {}
        with contextlib.ExitStack() as stack:
            if isinstance(data, Recorded):
                check_plots(data.path)
                stack.enter_context(naming(data.path))
                stack.enter_context(naming(data.true_file or data.path))
                own = {**data.reading, "truth": data.truth}
            found = tune(
                data.path if isinstance(data, Recorded) else data,
                tuning.tracker,
                free=tuning.free,
                runs=tuning.runs,
                seed=tuning.seed,
                trials=tuning.trials,
                folds=tuning.folds,
                executor=pool,
                progress=job.progress,
                **own,
            )
        return _as_json(_without_path(found, data.path) if isinstance(data, Recorded) else found)

    return work


def _without_path(found: Tuned, path: Path) -> Tuned:
    """A result that names its recording as the page does, not where the server keeps it."""
    data, text = (each.replace(str(path), path.name) for each in (found.data, found.text))
    return replace(found, data=data, text=text)


def _as_json(found: Tuned) -> dict[str, Any]:
    """What ``fuzzytrack tune`` prints; ``text``, the tuned rule base, if it is one."""
    start, *_, tuned = found.rows
    return {
        **found.to_json_dict(),
        "before": start.held_out,
        "after": tuned.held_out,
        "text": found.text if found.is_rulebase else None,
        "report": found.report,
    }
