"""The command `testbed`: Monte Carlo experiments, and the table of their results."""

from __future__ import annotations

import math
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.compare import trackers_named
from fuzzytrack.cli.comparison_tables import print_marks
from fuzzytrack.cli.output import (
    RESULTS,
    output_folder,
    paragraph,
    print_json,
    print_table,
    progress,
    say,
    show,
    with_error,
    write_json,
)
from fuzzytrack.cli.pictures import save_picture
from fuzzytrack.io.files import check_output
from fuzzytrack.plurals import counted
from fuzzytrack.simulation.scenario import Scenario
from fuzzytrack.simulation.scenario_files import load_scenario, scenario_source, shipped_scenarios
from fuzzytrack.testbed.chunk_store import remove_chunks
from fuzzytrack.testbed.marks import marks_of
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.testbed.results import Results
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.workers import workers

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["experiment"]

_FILES = (RESULTS, "report.html")


def experiment(
    scenario: options.ScenarioOrNone = None,
    trackers: Annotated[
        str | None,
        typer.Option(metavar="A,B,C", help="Instead of those that the scenario names."),
    ] = None,
    runs: Annotated[int, typer.Option(min=1, help="Monte Carlo runs.")] = 200,
    seed: options.Seed = 0,
    jobs: Annotated[int, typer.Option(min=1, help="Processes of this computer.")] = 1,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask cluster, e.g. tcp://host:8786.")
    ] = None,
    output: options.Folder = None,
    force: options.Force = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue the job whose chunks are in the folder.")
    ] = False,
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """Run trackers on many random draws of a scenario.

    Without SCENARIO lists those that are shipped. The same seed gives the same numbers on any
    number of processes or computers.
    """
    if scenario is None:
        _list(json)
        return
    if resume and output is None:
        raise ValueError("--resume needs -o DIR, the folder of the job to continue")
    if resume and force:
        raise ValueError("--resume and --force: give one of them")
    options.load_plugins(plugin)
    drawn = load_scenario(scenario)
    chosen = _chosen(trackers, drawn)
    try:
        with workers(jobs, scheduler) as executor, progress("simulating") as watch:
            folder = None if output is None else _folder(output, force, resume)
            found = monte_carlo(
                drawn,
                chosen,
                runs,
                seed,
                progress=watch,
                executor=executor,
                folder=folder,
                resume=resume,
            )
        command = _command(scenario, trackers, runs, seed, plugin)
        written = [] if folder is None else _write(folder, found, command)
    except KeyboardInterrupt:
        if output is None:
            raise
        typer.echo(f"interrupted; finished runs are in {output}; continue with --resume", err=True)
        raise typer.Exit(130) from None
    if json:
        print_json({**found.to_json_dict(), "files": written})
        return
    _print(found)
    for path in written:
        say(f"wrote {path}")


def _list(json: bool) -> None:
    """List the shipped scenarios."""
    rows = [(name, scenario_source(name)) for name in shipped_scenarios()]
    if json:
        print_json([{"name": name, "source": source} for name, source in rows])
    else:
        print_table(["scenario", "source"], rows, words=2)


def _chosen(text: str | None, scenario: Scenario) -> Mapping[str, Tracker] | None:
    """Trackers that were asked for; None stands for those of the scenario."""
    if text is not None:
        return trackers_named(text)
    if not scenario.trackers:
        raise ValueError(f"--trackers: needed, since scenario {scenario.name!r} names none")
    return None


# -------------------------------------------------------------------- folder


def _folder(output: str, force: bool, resume: bool) -> Path:
    """Folder, made if it does not exist; checks before the work that its files can be written."""
    folder = output_folder(output, force=force, resume=resume)
    if force:
        remove_chunks(folder)
    for name in _FILES:
        check_output(folder / name)
    return folder


def _command(
    scenario: str, trackers: str | None, runs: int, seed: int, plugin: list[str] | None
) -> str:
    """Command that gives the same numbers."""
    words = ["fuzzytrack", "testbed", scenario, "--runs", str(runs), "--seed", str(seed)]
    if trackers is not None:
        words += ["--trackers", trackers]
    for script in plugin or ():
        words += ["--plugin", script]
    return shlex.join(words)


def _write(folder: Path, found: Results, command: str) -> list[Path]:
    """Write numbers, report and pictures."""
    from fuzzytrack.reports.html_report import report_pictures, write_report

    written = [folder / name for name in _FILES]
    write_json(written[0], found.to_json_dict(), indent=1)
    with progress("drawing"):
        pictures = report_pictures(found)
        write_report(written[1], found, pictures=pictures, command=command)
        for name, figure in pictures.items():
            written.append(folder / f"{name}.png")
            _save(written[-1], figure)
    return written


def _save(path: Path, figure: Figure) -> None:
    save_picture(path, lambda: figure)


# -------------------------------------------------------------------- table


def _print(found: Results) -> None:
    """Tables of the trackers, numbers ± their standard errors."""
    table = found.table()
    predicted, filtered = ([row[f"{of}_rmse"] for row in table] for of in ("predicted", "filtered"))
    marks = marks_of(predicted, filtered, found.measured_rmse)
    rows = [
        [
            row["name"],
            with_error(row["predicted_rmse"], row["predicted_rmse_se"]),
            with_error(row["filtered_rmse"], row["filtered_rmse_se"]),
            _change(row),
            mark,
        ]
        for row, mark in zip(table, marks, strict=True)
    ]
    rows += [[], ["the plots themselves", "", show(found.measured_rmse), "", ""]]
    print_table(["RMSE (m)", "predicted", "filtered", "vs first", ""], rows, title=_title(found))
    print_marks(marks)
    paragraph(
        "vs first: 95 % interval of the change in a run's RMSE of prediction against the first "
        "tracker; * means 0 is outside."
    )
    say()
    rows = [
        [
            row["name"],
            with_error(row["predicted_mean"], row["predicted_mean_se"]),
            show(math.sqrt(row["predicted_variance"])),
            show(row["peak"]),
            "–" if row["peak_scan"] is None else str(row["peak_scan"] + 1),
        ]
        for row in table
    ]
    print_table(["error of prediction (m)", "mean", "std dev", "peak RMSE", "at scan"], rows)


def _title(found: Results) -> str:
    first = found.first_scored + 1
    return (
        f"{found.scenario}: {counted(found.runs, 'run')} of {counted(len(found.time), 'scan')}, "
        f"scored from scan {first}, seed {found.seed}"
    )


def _change(row: Mapping[str, Any]) -> str:
    low, high = row["change_low"], row["change_high"]
    if low is None or not low <= high:
        return "" if low is None else "–"
    return f"{low:+.3g} to {high:+.3g}{'*' if low > 0 or high < 0 else ' '}"
