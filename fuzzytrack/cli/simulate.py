"""The command that writes simulated plots to a file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np
import typer

from fuzzytrack.arrays import Array
from fuzzytrack.cli import options
from fuzzytrack.cli.output import progress, say
from fuzzytrack.io.files import check_output
from fuzzytrack.io.tables import table_writer, write_table
from fuzzytrack.simulation.noise import streams
from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.simulation.scenario_files import load_scenario, scenario_path

__all__ = ["simulate"]


def simulate(
    scenario: options.Scenario,
    output: Annotated[
        str, typer.Option("--output", "-o", metavar="FILE.csv", help="To write (or .parquet).")
    ],
    runs: Annotated[int, typer.Option(min=1, help="Monte Carlo runs.")] = 1,
    seed: options.Seed = 0,
    truth: Annotated[
        bool, typer.Option("--truth", help="The true positions alone, without sensors.")
    ] = False,
    plugin: options.Plugins = None,
) -> None:
    """Write the plots of a simulated target, beside the truth.

    The plots are those that `fuzzytrack testbed` makes with the same seed.
    """
    options.load_plugins(plugin)
    path = str(scenario_path(scenario))
    table_writer(output)
    check_output(output, (path,))
    experiment = load_scenario(scenario)
    columns = _true_track(experiment, runs) if truth else _plots(experiment, runs, seed)
    with progress("writing") as watch:
        write_table(output, columns, (path,), watch)
    say(f"wrote {output}")


def _true_track(scenario: Scenario, runs: int) -> dict[str, Sequence[str] | Array]:
    """Positions of each run's target, or of one run if it is the same in all."""
    position, _ = scenario.truth(0, runs)
    by_run = position if position.ndim == 3 else position[:, None]
    return {**_clock(scenario, by_run.shape[1]), **_by_axis("{}_m", by_run)}


def _plots(scenario: Scenario, runs: int, seed: int) -> dict[str, Sequence[str] | Array]:
    position, _ = scenario.truth(0, runs)
    plots = scenario.sensors.measure(position, streams(seed, runs))
    by_run = position if position.ndim == 3 else position[:, None]
    return {
        **_clock(scenario, runs),
        **_by_axis("{}_m", plots.z),
        **_by_axis("true_{}_m", np.broadcast_to(by_run, plots.z.shape)),
        **_by_axis("sigma_{}_m", plots.sigma),
    }


def _clock(scenario: Scenario, runs: int) -> dict[str, Sequence[str] | Array]:
    """Run, from 0, and time of each row: runs follow each other."""
    number = np.repeat(np.arange(runs), len(scenario.time))
    return {"run": number.astype(str).tolist(), "t_s": np.tile(scenario.time, runs)}


def _by_axis(name: str, values: Array) -> dict[str, Array]:
    """Columns of values of shape (n_steps, runs, n_axes), named after their axes."""
    n_axes = values.shape[-1]
    axes = ("x", "y", "z")[:n_axes] if n_axes <= 3 else [f"x{k + 1}" for k in range(n_axes)]
    return {name.format(axis): values[..., k].T.ravel() for k, axis in enumerate(axes)}
