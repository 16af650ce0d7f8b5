"""The command `compare`: trackers on a true track with simulated noise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.output import (
    paragraph,
    print_json,
    print_table,
    progress,
    say_aside,
    show,
    with_error,
)
from fuzzytrack.cli.plot_options import reads_positions
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import read_recording, recording_files
from fuzzytrack.plurals import counted
from fuzzytrack.testbed.comparison import Comparison, compare_tracks
from fuzzytrack.testbed.marks import BEST, WORSE
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_trackers

__all__ = ["DEFAULT_TRACKERS", "compare", "print_comparison", "print_marks", "trackers_named"]

DEFAULT_TRACKERS = "maneuver,fixed:alpha=0.5377:beta=0.2018,chan-style,stiffness-damping"


@reads_positions
def compare(
    file: options.Plots,
    reading: Reading,
    noise: Annotated[
        float,
        typer.Option(metavar="SIGMA", help="Standard deviation of the noise on each axis, > 0."),
    ],
    trackers: Annotated[
        str, typer.Option(metavar="A,B,C", help="Trackers; see `fuzzytrack trackers`.")
    ] = DEFAULT_TRACKERS,
    runs: Annotated[int, typer.Option(min=1, help="Monte Carlo runs.")] = 200,
    seed: options.Seed = 0,
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """Compare trackers on a true track with simulated noise.

    The positions in the file are taken as true. Every tracker sees the same noise, and the same
    seed gives the same numbers.
    """
    if not 0 < noise < math.inf:
        raise ValueError(f"--noise must be > 0, got {noise:g}")
    options.load_plugins(plugin)
    chosen = trackers_named(trackers)
    with progress("reading") as watch:
        recording = read_recording(PlotFiles.of(recording_files(file), reading), watch)
    for note in recording.findings.notes:
        say_aside(f"note: {note}")
    tracks = [(track.time, track.plots) for track in recording.tracks]
    with progress("comparing") as watch:
        found = compare_tracks(chosen, tracks, noise, runs, seed, watch)
    if json:
        print_json({"file": file, "tracks": len(tracks), **found.to_json_dict()})
    else:
        print_comparison(found)


def trackers_named(text: str) -> dict[str, Tracker]:
    """Trackers as written after ``--trackers``."""
    names = options.names(text, "--trackers")
    found = as_trackers(names)
    for name, tracker in found.items():
        if not getattr(tracker, "causal", True):
            typer.echo(f"note: {name} uses the plot that it predicts", err=True)
    return found


def print_comparison(found: Comparison) -> None:
    """Table of a comparison, RMSE ± its standard error."""
    rows = [
        [
            name,
            with_error(found.predicted_rmse[k], found.predicted_error[k]),
            with_error(found.filtered_rmse[k], found.filtered_error[k]),
            "" if k == 0 else f"{100 * found.predicted_change[k]:+.1f} %",
            mark,
        ]
        for k, (name, mark) in enumerate(zip(found.names, found.marks, strict=True))
    ]
    rows += [[], ["the plots themselves", "", show(found.measured_rmse), "", ""]]
    print_table(
        ["RMSE of position (m)", "predicted", "filtered", "vs first", ""],
        rows,
        title=(
            f"{counted(found.runs, 'run')} of {counted(found.scans.mean(), 'scan')}, "
            f"noise {found.sigma:g} m on each axis, seed {found.seed}"
        ),
    )
    print_marks(found.marks)
    if len(found.names) > 1:
        paragraph("vs first: change of the predicted RMSE against the first tracker.")


def print_marks(marks: Sequence[str]) -> None:
    """Say what the marks in a table mean, where the truth is known."""
    for mark, meaning in _MEANINGS.items():
        if any(mark in each for each in marks):
            paragraph(f"{mark}: {meaning}.")


_MEANINGS = {
    BEST: "the least RMSE of predicted positions",
    WORSE: "the filtered positions are worse than the plots themselves",
}
