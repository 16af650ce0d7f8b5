"""The command that tunes the numbers of a configuration of a scan tracker."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, print_table, progress, say
from fuzzytrack.cli.plot_options import number_or, reads_scans
from fuzzytrack.io.files import check_output
from fuzzytrack.io.reading import Reading
from fuzzytrack.plurals import counted
from fuzzytrack.tuning.scan_sources import scan_sources
from fuzzytrack.tuning.scanner_tuner import tune_scanner
from fuzzytrack.tuning.tuned_scanner import TunedScanner
from fuzzytrack.workers import workers

__all__ = ["tune"]

_SCANS = "Scans"


@reads_scans
def tune(
    config: Annotated[
        str,
        typer.Argument(
            metavar="CONFIG", help="Shipped name, or file; NAME:role.number=value changes it."
        ),
    ],
    data: Annotated[
        list[str],
        typer.Argument(
            metavar="PLOTS|SCENE...",
            help="Files of plots without identities, with --truth; or scenes of many targets, to "
            "be simulated: harbor:radar.detection=0.6. Each counts alike.",
        ),
    ],
    reading: Reading,
    free: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,C",
            help="Numbers to tune: clutter.cell, or clutter for all of a part. [default: all]",
        ),
    ] = None,
    metric: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="What is minimized: ospa, gospa, ospa2, idf1 or any other of `fuzzytrack score`; "
            "or study, a weighted sum.",
        ),
    ] = "ospa",
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="OUT.yaml", help="Write the tuned configuration."),
    ] = None,
    truth: Annotated[
        str | None, typer.Option(metavar="FILE", help="True positions of recorded plots.")
    ] = None,
    lag: Annotated[
        str | None,
        typer.Option(
            metavar="S|GROUP=S,…|auto",
            help="Time by which the clock of the plots is late; auto fits it once. [default: 0]",
        ),
    ] = None,
    moving_above: Annotated[
        float | None,
        typer.Option(
            metavar="V",
            help="The truth lists moving objects only: slower tracks far from them do not count, "
            "m/s.",
        ),
    ] = None,
    scan: Annotated[
        str | None,
        typer.Option(
            metavar="COL",
            help="Column that says which scan a plot is of. [default: recognized]",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    period: Annotated[
        str | None,
        typer.Option(
            metavar="S",
            help="Time of a turn of the antenna, s. [default: recognized]",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    scans: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Table of all scans, those without a plot included: scan, time, own position.",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    group: Annotated[
        str | None,
        typer.Option(
            metavar="COL",
            help="Column that says which of several recordings a row is of.",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    own: Annotated[
        str | None,
        typer.Option(
            metavar="COL,COL",
            help="Columns of the position of a moving radar, in the frame of the plots.",
            rich_help_panel=_SCANS,
        ),
    ] = None,
    runs: Annotated[int, typer.Option(min=1, help="Runs of each scene.")] = 3,
    seed: options.Seed = 0,
    trials: Annotated[
        int | None,
        typer.Option(min=1, help="Configurations a search tries. [default: 60, and 40 a number]"),
    ] = None,
    leave_one_out: Annotated[
        bool,
        typer.Option(
            "--leave-one-out",
            help="Judge on each recording or scene by a search that does not see it.",
        ),
    ] = False,
    jobs: Annotated[int, typer.Option(min=1, help="Processes of this computer.")] = 1,
    state: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Keep the search there, so that it can be resumed."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue the search that --state holds.")
    ] = False,
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """Tune the numbers of a configuration on simulated scenes, or on recordings with truth.

    The same seed gives the same numbers on any number of processes.
    """
    options.load_plugins(plugin)
    if output is not None:
        if Path(output).suffix not in (".yaml", ".yml"):
            raise ValueError(f"output: {output} must end in .yaml, the suffix of configurations")
        check_output(output, tuple(data))
    recordings = scan_sources(
        data,
        runs=runs,
        seed=seed,
        truth=truth,
        reading=reading,
        lag=None if lag is None else options.lags(lag),
        moving_above=moving_above,
        group=group,
        scan=scan,
        period=None if period is None else number_or(period, "--period", {}),
        scans=scans,
        own=None if own is None else options.names(own, "--own"),
    )
    try:
        with workers(jobs, None) as executor, progress("tuning") as watch:
            found = tune_scanner(
                recordings,
                config,
                free=None if free is None else options.names(free, "--free"),
                metric=metric,
                trials=trials,
                seed=seed,
                leave_one_out=leave_one_out,
                executor=executor,
                state=state,
                resume=resume,
                progress=watch,
                name=None if output is None else Path(output).stem,
            )
    except KeyboardInterrupt:
        if state is None or not Path(state).exists():
            raise  # before the first trial nothing is kept
        typer.echo(f"interrupted; the search is in {state}; continue with --resume", err=True)
        raise typer.Exit(130) from None
    if output is not None:
        found.save(output)
    if json:
        print_json({**found.to_json_dict(), "output": output})
        return
    _print(found)
    say(f"wrote {output}" if output else found.text.rstrip())


def _print(found: TunedScanner) -> None:
    say(
        f"{counted(found.recordings, 'recording')}, {counted(found.trials, 'trial')}, "
        f"seed {found.seed}"
    )
    heads: list[Any] = ["", found.start_name, "tuned", "left out"]
    print_table(heads, found.cells, title=found.objective)
    say()
    numbers = [
        [name, f"{found.start[name]:.5g}", f"{value:.5g}"] for name, value in found.numbers.items()
    ]
    print_table(["free number", "start", "tuned"], numbers)
    say()
    say(found.verdict)
    say()
