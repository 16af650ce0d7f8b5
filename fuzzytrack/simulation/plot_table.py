"""Simulated plots and true tracks of a scenario as the columns of a table, a row for each plot."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.simulation.noise import streams, truth_of_runs
from fuzzytrack.simulation.scenario import Scenario

__all__ = ["plot_columns", "truth_columns"]

Columns = dict[str, Sequence[str] | Array]


def plot_columns(scenario: Scenario, runs: int, seed: int) -> Columns:
    """Plots of all runs beside the truth; those of `fuzzytrack.testbed.monte_carlo`.

    Parameters
    ----------
    scenario : Scenario
        Target and sensors.
    runs : int
        Number of runs, at least 1.
    seed : int
        Seed, not negative.

    Returns
    -------
    dict of str to sequence
        ``run`` from 0, ``t_s``, and for each axis ``x_m`` (NaN where there is no plot),
        ``true_x_m`` and ``sigma_x_m``. Runs follow each other, scan by scan.

    Raises
    ------
    ValueError
        If `runs` or `seed` is out of range.
    """
    position, _ = scenario.truth(0, runs)
    plots = scenario.sensors.measure(position, streams(seed, runs))
    return {
        **_clock(scenario, runs),
        **_by_axis("{}_m", plots.z),
        **_by_axis("true_{}_m", np.broadcast_to(truth_of_runs(position, runs), plots.z.shape)),
        **_by_axis("sigma_{}_m", plots.sigma),
    }


def truth_columns(scenario: Scenario, runs: int) -> Columns:
    """True positions of each run's target; of one run if they are the same in all.

    Parameters
    ----------
    scenario, runs
        As for `plot_columns`.

    Returns
    -------
    dict of str to sequence
        ``run`` from 0, ``t_s``, and ``x_m`` and so on for each axis.
    """
    true = truth_of_runs(scenario.truth(0, runs)[0], runs)
    return {**_clock(scenario, true.shape[1]), **_by_axis("{}_m", true)}


def _clock(scenario: Scenario, runs: int) -> Columns:
    """Run and time of each row."""
    times = scenario.times(0, runs)
    each = np.broadcast_to(times.reshape(len(times), -1), (len(times), runs))
    number = np.repeat(np.arange(runs), len(scenario.time))
    return {"run": number.astype(str).tolist(), "t_s": each.T.ravel()}


def _by_axis(name: str, values: Array) -> dict[str, Array]:
    """Columns of values of shape (n_steps, runs, n_axes), named after their axes."""
    n_axes = values.shape[-1]
    axes = ("x", "y", "z")[:n_axes] if n_axes <= 3 else [f"x{k + 1}" for k in range(n_axes)]
    return {name.format(axis): values[..., k].T.ravel() for k, axis in enumerate(axes)}
