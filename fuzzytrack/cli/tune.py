"""The command that tunes the numbers of a tracker on data."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, print_table, progress, say, say_notes, show
from fuzzytrack.cli.plot_options import gate_width, reads_plots
from fuzzytrack.fuzzy.loading import shipped_rulebases
from fuzzytrack.io.files import check_output
from fuzzytrack.io.reading import Reading
from fuzzytrack.plurals import counted
from fuzzytrack.specs import is_file, split
from fuzzytrack.tuning.tuned import Tuned
from fuzzytrack.tuning.tuner import tune as tune_tracker
from fuzzytrack.workers import workers

__all__ = ["tune"]


@reads_plots
def tune(
    data: Annotated[
        list[str],
        typer.Argument(
            metavar="DATA|SCENARIO...",
            help="File or folder of plots; or a shipped scenario, or FILE.yaml, to be simulated. "
            "Several count alike.",
        ),
    ],
    reading: Reading,
    tracker: Annotated[
        str,
        typer.Option(
            "--tracker",
            metavar="FAMILY",
            help="Rule base or FILE.yaml; or fixed, kalata, kalman-cv, kalman-ca, imm or any "
            "other tracker, with numbers to begin at: kalman-cv:sigma_v=2.",
        ),
    ],
    free: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,C",
            help="Numbers to tune. Of a rule base: outputs, sets, normalization, a variable, "
            "VARIABLE.SET or a setting. [default: all; of other trackers those of the family]",
        ),
    ] = None,
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="OUT.yaml", help="Write the tuned rule base."),
    ] = None,
    truth: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|COL,COL",
            help="True positions, or their columns. [default: the plots are]",
        ),
    ] = None,
    gate: options.Gate = "auto",
    runs: Annotated[int, typer.Option(min=1, help="Runs of a scenario.")] = 60,
    seed: options.Seed = 0,
    trials: Annotated[
        int | None,
        typer.Option(min=1, help="Trackers a search tries. [default: 60, and 40 a number]"),
    ] = None,
    folds: Annotated[int, typer.Option(min=2, help="Folds, each held out once.")] = 5,
    criterion: Annotated[
        str, typer.Option(metavar="rms|likelihood", help="What is minimized.")
    ] = "rms",
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
    """Tune the numbers of a tracker, and judge it on tracks that it was not tuned on.

    The same seed gives the same numbers on any number of processes. Without --truth, predictions of
    recorded plots are compared with the plots, which are read as `fuzzytrack track` reads them.
    """
    options.load_plugins(plugin)
    if output is not None:
        _check_output(output, tracker, data)
    try:
        with workers(jobs, None) as executor, progress("tuning") as watch:
            found = tune_tracker(
                data,
                tracker,
                free=None if free is None else options.names(free, "--free"),
                truth=truth,
                gate=gate_width(gate),
                reading=reading,
                runs=runs,
                seed=seed,
                trials=trials,
                folds=folds,
                criterion=criterion,
                executor=executor,
                state=state,
                resume=resume,
                progress=watch,
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
    if output is not None:
        say(f"wrote {output}")
        if found.parameters:
            say(f"tracker: {output}:{found.parameters}")


def _check_output(output: str, tracker: str, data: list[str]) -> None:
    """Find out what cannot be written before the work is done."""
    name, _ = split(tracker, "tracker")
    if not (is_file(name) or name in shipped_rulebases()):
        raise ValueError(
            f"--output: a tuned {name} has no file; without it, its specification is printed"
        )
    check_output(output, tuple(data))


def _print(found: Tuned) -> None:
    say_notes(found.notes)
    say(
        f"{found.data}: {counted(found.plots, 'plot')}, {found.folds} folds by {found.units}, "
        f"{counted(found.trials, 'trial')}, seed {found.seed}"
    )
    if found.units != "tracks":
        say("fewer than 3 tracks: blocks of time are held out instead of tracks")
    rows = [
        [row.name, show(row.training), show(row.held_out), row.change_text] for row in found.rows
    ]
    print_table(
        ["", "training", "held out", "tuned against it (95 %)"],
        rows,
        title=found.objective,
    )
    say()
    numbers = [
        [name, f"{found.start[name]:.5g}", f"{value:.5g}"] for name, value in found.numbers.items()
    ]
    print_table(["free number", "start", "tuned"], numbers)
    for name in found.unused:
        say(f"{name}: without an effect on these data, left as it was")
    say()
    say(found.verdict)
    if not found.is_rulebase:
        say(f"tracker: {found.text}")
