"""Where the last run of a page went: inputs of its rules, and gains."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.simulation.noise import Plots
from fuzzytrack.studio.rule_inputs import rule_inputs, scheduler_of
from fuzzytrack.studio.run_jobs import Run
from fuzzytrack.studio.tracker_texts import EDITOR
from fuzzytrack.testbed.montecarlo import simulated_runs
from fuzzytrack.trackers.base import Tracker

__all__ = ["visited_cells", "visited_gains"]

_CELLS = 41
# Runs and plots that are followed; plain Python takes 0.1 ms for a plot.
_MOST_RUNS, _MOST_PLOTS = 200, 20_000
_DIGITS = 3


def visited_cells(run: Run | None, rules: RuleBase) -> Mapping[str, Any]:
    """How often the inputs of a rule base were in each cell of a grid.

    Parameters
    ----------
    run : Run or None
        Followed is its tracker with the rule base of the editor, or the first with the same inputs.
    rules : RuleBase

    Returns
    -------
    dict
        ``tracker`` (None if there is none), ``inputs``, and ``counts``: rows over the second input,
        columns over the first, from the lowest to the highest value.
    """
    names = rules.input_names[:2]
    blank: dict[str, Any] = {"tracker": None, "inputs": names, "counts": [], "runs": 0}
    found = None if run is None else _followed(run, rules)
    if run is None or found is None or len(names) < 2:
        return blank
    name, tracker = found
    edges = [np.linspace(v.universe.low, v.universe.high, _CELLS + 1) for v in rules.inputs[:2]]
    counts = np.zeros((_CELLS, _CELLS))
    runs = _runs(run)
    for k in range(runs):
        times, _, _, plots = simulated_runs(run.scenario, run.seed, range(k, k + 1))
        inputs = _of_run(tracker, times, plots)
        known = inputs[~np.isnan(inputs).any(axis=1)][:, :2]
        inside = np.stack([np.clip(known[:, j], e[0], e[-1]) for j, e in enumerate(edges)], axis=1)
        counts += np.histogram2d(inside[:, 1], inside[:, 0], [edges[1], edges[0]])[0]
    return {"tracker": name, "inputs": names, "counts": counts.astype(int), "runs": runs}


def visited_gains(run: Run, rules: RuleBase) -> list[list[float]]:
    """Gains α, β that the tracker of `visited_cells` used, to three digits, and how often."""
    found = _followed(run, rules)
    if found is None:
        return []
    times, _, _, plots = simulated_runs(run.scenario, run.seed, range(_runs(run)))
    gains = found[1].run(times, plots.z, plots.sigma).gains
    pairs = np.stack([gains.alpha.ravel(), gains.beta.ravel()], axis=1)
    known = pairs[~np.isnan(pairs).any(axis=1)].round(_DIGITS)
    each, counts = np.unique(known, axis=0, return_counts=True)
    return [[*pair, count] for pair, count in zip(each.tolist(), counts.tolist(), strict=True)]


def _runs(run: Run) -> int:
    """How many runs are followed."""
    scenario = run.scenario
    each = len(scenario.time) * scenario.n_axes
    return max(1, min(run.runs, _MOST_RUNS, _MOST_PLOTS // each))


def _followed(run: Run, rules: RuleBase) -> tuple[str, Tracker] | None:
    fitting = []
    for name, tracker in run.trackers.items():
        scheduler = scheduler_of(tracker)
        if scheduler is not None and scheduler.rules.input_names == rules.input_names:
            fitting.append((name, tracker))
    edited = [each for each in fitting if each[0].partition(":")[0] == EDITOR]
    return next(iter(edited + fitting), None)


def _of_run(tracker: Tracker, times: Array, plots: Plots) -> Array:
    """Inputs of the rules in the first of some runs, shape (n, n_inputs)."""
    time = times if times.ndim == 1 else times[:, 0]
    sigma = np.broadcast_to(plots.sigma, plots.z.shape)
    found = rule_inputs(tracker, time, plots.z[:, 0], sigma[:, 0])
    assert found is not None  # `_followed` has chosen one with rules
    return found.reshape(-1, found.shape[-1])
