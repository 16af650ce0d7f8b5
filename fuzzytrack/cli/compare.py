"""The command `compare`: trackers on recorded plots, or on true tracks with simulated noise."""

from __future__ import annotations

import math
import re
from itertools import pairwise
from typing import Annotated

import typer

from fuzzytrack.cli import options
from fuzzytrack.cli.comparison_tables import print_comparison, print_recorded
from fuzzytrack.cli.noise_words import noise_json
from fuzzytrack.cli.output import print_json, progress, say_notes
from fuzzytrack.cli.plot_options import gate_width, reads_plots
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import read_recording, recording_files
from fuzzytrack.recordings.preparation import DEFAULT_TRACKER
from fuzzytrack.recordings.used_plots import read_used_plots
from fuzzytrack.testbed.comparison import compare_tracks
from fuzzytrack.testbed.recorded_comparison import compare_used
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_trackers

__all__ = ["DEFAULT_TRACKERS", "compare", "trackers_named"]

DEFAULT_TRACKERS = "maneuver,fixed:alpha=0.5377:beta=0.2018,chan-style,stiffness-damping"


@reads_plots
def compare(
    file: options.Plots,
    reading: Reading,
    truth: Annotated[
        str | None,
        typer.Option(metavar="FILE|COL,COL", help="True positions of the plots, or their columns."),
    ] = None,
    noise: Annotated[
        float | None,
        typer.Option(
            metavar="SIGMA",
            help="Take FILE as the truth, and simulate plots with this standard deviation, m.",
        ),
    ] = None,
    trackers: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,C",
            help=f"Trackers; see `fuzzytrack trackers`. [default: {DEFAULT_TRACKERS}]",
        ),
    ] = None,
    gate: options.Gate = "auto",
    runs: Annotated[
        int | None, typer.Option(min=1, help="Monte Carlo runs, with --noise. [default: 200]")
    ] = None,
    seed: options.Seed = 0,
    plugin: options.Plugins = None,
    json: options.Json = False,
) -> None:
    """Compare trackers on recorded plots, with or without truth.

    Without truth, predictions are compared with the next plot: its noise is the same for all
    trackers. With --noise, FILE holds true positions, to which noise is added.
    """
    options.load_plugins(plugin)
    width = gate_width(gate)
    chosen = trackers_named(trackers or DEFAULT_TRACKERS)
    if noise is not None:
        _check_simulated(noise, truth, gate, reading)
        _compare_simulated(chosen, file, reading, noise, runs or 200, seed, json)
        return
    if runs is not None:
        raise ValueError("--runs: is the number of simulated runs; it needs --noise SIGMA")
    with progress("reading") as watch:
        used = read_used_plots(file, reading, truth=truth, gate=width, progress=watch)
    if trackers is None and not used.has_sigma:
        say_notes([f"compared without {DEFAULT_TRACKER}, which needs the noise of the plots"])
        del chosen[DEFAULT_TRACKER]
    with progress("comparing") as watch:
        texts = {name: name for name in chosen}
        found = compare_used(texts, used, seed=seed, progress=watch)
    if json:
        told = {"file": file, "truth": truth, **noise_json(used.decoder)}
        print_json({**told, **found.to_json_dict()})
    else:
        print_recorded(found, used.decoder)


def _check_simulated(noise: float, truth: str | None, gate: str, reading: Reading) -> None:
    if not 0 < noise < math.inf:
        raise ValueError(f"--noise must be > 0, got {noise:g}")
    said = reading.description
    given = {
        "--truth": truth is not None,
        "--gate": gate != "auto",
        "--sigma": said.sigma not in (None, "auto"),
        "--sigma-range": said.sigma_range is not None,
        "--sigma-azimuth": said.sigma_azimuth is not None,
        "--sigma-elevation": said.sigma_elevation is not None,
    }
    for option in (name for name, is_given in given.items() if is_given):
        raise ValueError(f"{option}: with --noise the file is the truth; leave out one of the two")


def _compare_simulated(
    trackers: dict[str, Tracker],
    file: str,
    reading: Reading,
    noise: float,
    runs: int,
    seed: int,
    json: bool,
) -> None:
    """Trackers on the positions of a file, which are taken as true, with simulated noise."""
    with progress("reading") as watch:
        recording = read_recording(PlotFiles.of(recording_files(file), reading), watch)
    say_notes(recording.findings.notes)
    tracks = [(track.time, track.plots) for track in recording.tracks]
    with progress("comparing") as watch:
        found = compare_tracks(trackers, tracks, noise, runs, seed, watch)
    if json:
        print_json({"file": file, "tracks": len(tracks), **found.to_json_dict()})
    else:
        print_comparison(found)


def trackers_named(text: str) -> dict[str, Tracker]:
    """Trackers as written after ``--trackers``."""
    names = options.names(text, "--trackers")
    for before, name in pairwise(names):
        if re.match(r"\w+\s*=", name):
            raise ValueError(
                f"--trackers: {name!r} is a parameter; a colon stands before it: {before}:{name}"
            )
    found = as_trackers(names)
    for name, tracker in found.items():
        if not getattr(tracker, "causal", True):
            typer.echo(f"note: {name} uses the plot that it predicts", err=True)
    return found
