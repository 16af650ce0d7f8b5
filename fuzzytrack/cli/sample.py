"""The command `sample`: small simulated recordings to try things with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import print_json, say, say_aside
from fuzzytrack.cli.output_file import STANDARD_OUTPUT, output_file
from fuzzytrack.io.formats import check_table, write_table
from fuzzytrack.simulation.samples import SAMPLES, SampleKind, make_sample

__all__ = ["sample"]


def sample(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help=f"{', '.join(SAMPLES)}; none lists them.")
    ] = None,
    output: Annotated[
        str | None,
        typer.Option(
            "--output", "-o", metavar="FILE.csv|-", help="To write (or .parquet); - prints CSV."
        ),
    ] = None,
    truth: Annotated[
        str | None,
        typer.Option(metavar="FILE.csv", help="Write the true positions."),
    ] = None,
    seed: options.Seed = 0,
    json: options.Json = False,
) -> None:
    """Write a small simulated recording to try things with, or list them.

    The command that tracks it is printed, too.
    """
    if name is None:
        _list(output, truth, json)
        return
    made = make_sample(name, seed)
    if output is None:
        raise ValueError(f"sample {name}: needs -o, as in -o {name}.csv; -o - prints it")
    if output == STANDARD_OUTPUT and json:
        raise ValueError("--json: -o - prints the plots; name a file")
    if truth is not None:
        check_table(truth)
        if truth == output:
            raise ValueError(f"--truth: {truth} is the file of the plots; name another")
    with output_file(output) as place:
        write_table(str(place), made.plots)
    if truth is not None:
        write_table(truth, made.truth)
    command = track_command(SAMPLES[name], output)
    if json:
        rows = len(made.plots["time"])
        print_json({"name": name, "rows": rows, "output": output, "truth": truth, "track": command})
        return
    # Standard output has the plots only.
    tell = say_aside if output == STANDARD_OUTPUT else say
    for written in (output, truth):
        if written not in (None, STANDARD_OUTPUT):
            tell(f"wrote {written}")
    tell(f"track it with: {command}{_needed(SAMPLES[name])}")


def track_command(kind: SampleKind, file: str) -> str:
    """The command that tracks a sample."""
    return " ".join([f"fuzzytrack {kind.command}", file, *_as_options(kind.reading)])


def _as_options(reading: Mapping[str, Any]) -> list[str]:
    """Arguments of `fuzzytrack.track` as options of the command."""
    return [
        f"--{name.replace('_', '-')} {','.join(value) if isinstance(value, tuple) else value}"
        for name, value in reading.items()
    ]


def _needed(kind: SampleKind) -> str:
    """Extra that reading a sample needs, in words; empty if it needs none."""
    if not kind.extra:
        return ""
    return f"  (needs the extra {kind.extra}: pip install 'fuzzytrack[{kind.extra}]')"


def _list(output: str | None, truth: str | None, json: bool) -> None:
    """Print which samples there are, and how each is tracked."""
    for option, value in (("-o", output), ("--truth", truth)):
        if value is not None:
            raise ValueError(f"{option} {value}: of which sample? one of {', '.join(SAMPLES)}")
    kinds = {name: (kind, track_command(kind, f"{name}.csv")) for name, kind in SAMPLES.items()}
    if json:
        fields = {
            name: {"summary": kind.summary, "track": command, "extra": kind.extra or None}
            for name, (kind, command) in kinds.items()
        }
        print_json({"samples": [{"name": name, **each} for name, each in fields.items()]})
        return
    for name, (kind, command) in kinds.items():
        say(f"{name:6} {kind.summary}")
        say(f"       fuzzytrack sample {name} -o {name}.csv")
        say(f"       {command}{_needed(kind)}")
