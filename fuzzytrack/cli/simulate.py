"""The command `simulate`: simulated plots written to a file."""

from __future__ import annotations

import os
from typing import Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import progress, say
from fuzzytrack.errors import ScenarioError
from fuzzytrack.io.formats import check_table, write_table
from fuzzytrack.plurals import counted
from fuzzytrack.simulation.plot_table import plot_columns, truth_columns
from fuzzytrack.simulation.scenario_files import load_scenario, scenario_path, shipped_scenarios
from fuzzytrack.simulation.scene.files import load_scene, names_scene, scene_path, shipped_scenes
from fuzzytrack.simulation.scene.simulate import simulate_scans
from fuzzytrack.simulation.scene.tables import plot_table, scan_table, truth_table
from fuzzytrack.yamltree import quoted, suggestion

__all__ = ["simulate"]

_MANY = "Scenes of many targets"
_TABLES = (".csv", ".parquet", ".pq", ".txt")


def _print_schema(asked: bool) -> None:
    if asked:
        from fuzzytrack.simulation.scene.schema import dumps_scene_schema

        say(dumps_scene_schema().rstrip())
        raise typer.Exit


def simulate(
    scenario: Annotated[
        str,
        typer.Argument(
            metavar="SCENARIO|SCENE",
            help="Name of a shipped scenario or scene, or FILE.yaml; of a scene, settings may "
            "follow: dense-traffic:traffic.ships.count=10000.",
        ),
    ],
    output: Annotated[
        str, typer.Option("--output", "-o", metavar="FILE.csv", help="To write (or .parquet).")
    ],
    # The file after --truth, which is a flag: the parser takes it for an argument.
    file: Annotated[str | None, typer.Argument(metavar="--truth FILE.csv", hidden=True)] = None,
    runs: Annotated[
        int | None, typer.Option(min=1, help="Monte Carlo runs of a single target. [default: 1]")
    ] = None,
    seed: options.Seed = 0,
    truth: Annotated[
        bool,
        typer.Option(
            "--truth",
            help="Followed by FILE.csv: the truth to this file. Alone: the true positions of a "
            "single target in place of its plots.",
        ),
    ] = False,
    scans: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.csv",
            help="Table of the scans, those without plots, too: time and place of the radar.",
            rich_help_panel=_MANY,
        ),
    ] = None,
    polar: Annotated[
        bool,
        typer.Option(
            "--polar", help="With columns range and azimuth (degrees).", rich_help_panel=_MANY
        ),
    ] = False,
    own: Annotated[
        bool,
        typer.Option(
            "--own", help="With columns own_x and own_y, the radar.", rich_help_panel=_MANY
        ),
    ] = False,
    truth_id: Annotated[
        bool,
        typer.Option(
            "--truth-id",
            help="With column truth_id, the target of each plot; 0 is clutter.",
            rich_help_panel=_MANY,
        ),
    ] = False,
    schema: Annotated[
        bool,
        typer.Option(
            "--schema",
            callback=_print_schema,
            is_eager=True,
            help="Print the JSON Schema of files of scenes, for editors, and do nothing else.",
            rich_help_panel=_MANY,
        ),
    ] = False,
    plugin: options.Plugins = None,
) -> None:
    """Write the plots of a simulated target, or the scans of a scene of many targets.

    The plots of a single target are those that `fuzzytrack testbed` makes with the same seed.
    """
    options.load_plugins(plugin)
    if truth and file is not None and scenario.lower().endswith(_TABLES):
        # --truth FILE.csv stood before the scenario.
        scenario, file = file, scenario
    if file is not None and not truth:
        raise ValueError(f"unexpected argument {file!r}; a file of the truth follows --truth")
    if names_scene(scenario):
        if runs is not None:
            raise ValueError("--runs: a scene is simulated once for a seed; leave it out")
        if truth and file is None:
            raise ValueError(
                f"--truth: name its file, as in --truth truth.csv; {scenario} is a "
                "scene of many targets"
            )
        columns = {"polar": polar, "own": own, "truth_id": truth_id}
        _scene(scenario, output, file, scans, seed, columns)
        return
    for option, given in (
        ("--scans", scans),
        ("--polar", polar),
        ("--own", own),
        ("--truth-id", truth_id),
    ):
        if given:
            raise ValueError(f"{option}: is for scenes of many targets; {scenario} has one")
    _refuse_unknown(scenario)
    _target(scenario, output, truth, file, runs or 1, seed)


def _refuse_unknown(name: str) -> None:
    """ScenarioError for a name that neither a scenario nor a scene has; it lists both."""
    known = sorted([*shipped_scenarios(), *shipped_scenes()])
    is_path = name.lower().endswith((".yaml", ".yml")) or os.sep in name or "/" in name
    if not is_path and name not in known:
        raise ScenarioError(
            f"unknown scenario {quoted(name)}{suggestion(name, known)}; or a path that ends in "
            ".yaml"
        )


def _target(
    scenario: str, output: str, truth: bool, truth_file: str | None, runs: int, seed: int
) -> None:
    """Write what a scenario with one target gives."""
    path = str(scenario_path(scenario))
    files = _checked({"--output": output, "--truth": truth_file}, path)
    experiment = load_scenario(scenario)
    alone = truth and truth_file is None
    made = truth_columns(experiment, runs) if alone else plot_columns(experiment, runs, seed)
    _write(files["--output"], made, path)
    if truth_file is not None:
        _write(truth_file, truth_columns(experiment, runs), path)


def _scene(
    name: str,
    output: str,
    truth: str | None,
    scans: str | None,
    seed: int,
    columns: dict[str, bool],
) -> None:
    """Write what a scene of many targets gives."""
    path = str(scene_path(name))
    _checked({"--output": output, "--truth": truth, "--scans": scans}, path)
    simulated = simulate_scans(load_scene(name), seed)
    _write(output, plot_table(simulated, **columns), path)
    if truth is not None:
        _write(truth, truth_table(simulated), path)
    if scans is not None:
        _write(scans, scan_table(simulated), path)
    plots = counted(len(simulated.target_id), "plot")
    clutter = int((simulated.target_id == 0).sum())
    say(
        f"{counted(len(simulated.scans), 'scan')}, {plots}, {clutter} of them clutter, "
        f"{counted(simulated.truth.n_targets, 'target')}"
    )


def _checked(files: dict[str, str | None], scenario: str) -> dict[str, str]:
    """Files to be written, by their options; ValueError before anything is simulated."""
    found: dict[str, str] = {}
    for option, file in files.items():
        if file is None:
            continue
        if file in found.values():
            raise ValueError(f"{option}: {file} is written already; name another file")
        check_table(file, (scenario,))
        found[option] = file
    return found


def _write(file: str, columns: Any, scenario: str) -> None:
    with progress("writing") as watch:
        write_table(file, columns, (scenario,), watch)
    say(f"wrote {file}")
