"""The command `simulate`: simulated plots written to a file."""

from __future__ import annotations

from typing import Annotated

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import progress, say
from fuzzytrack.io.formats import check_table, write_table
from fuzzytrack.simulation.plot_table import plot_columns, truth_columns
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
    check_table(output, (path,))
    experiment = load_scenario(scenario)
    columns = truth_columns(experiment, runs) if truth else plot_columns(experiment, runs, seed)
    with progress("writing") as watch:
        write_table(output, columns, (path,), watch)
    say(f"wrote {output}")
