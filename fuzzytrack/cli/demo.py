"""The command `demo`: a simulated turning target, tracked and drawn."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from fuzzytrack.arrays import Array
from fuzzytrack.cli import options
from fuzzytrack.cli.compare import DEFAULT_TRACKERS, trackers_named
from fuzzytrack.cli.comparison_tables import print_comparison
from fuzzytrack.cli.output import RESULTS, output_folder, print_json, progress, say, write_json
from fuzzytrack.cli.pictures import save_picture, surfaces
from fuzzytrack.fuzzy.loading import load_rulebase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.formats import write_table
from fuzzytrack.io.recording import Recording, Track
from fuzzytrack.recordings.track_writer import write_tracks
from fuzzytrack.simulation.trajectories import turning_target
from fuzzytrack.testbed.comparison import Comparison
from fuzzytrack.testbed.comparison import compare as run_comparison
from fuzzytrack.trackers.result import TrackResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["demo"]


SIGMA = 50.0
# The tracker that we recommend, whose track is drawn, and the published rule base beside it.
BEST = "maneuver"
PUBLISHED = "stiffness-damping"


def demo(
    output: options.Folder = "demo",
    force: options.Force = False,
    seed: options.Seed = 0,
    runs: Annotated[int, typer.Option(min=1, help="Monte Carlo runs.")] = 100,
    json: options.Json = False,
) -> None:
    """Track a simulated turning target, and draw the results.

    A target flies straight at 150 m/s, turns by 180 degrees at 3 degrees a second, and flies
    straight again; it is seen every second with 50 m of noise on each axis.
    """
    folder = output_folder(str(output), force=force)
    t, truth = turning_target()
    trackers = trackers_named(DEFAULT_TRACKERS)
    with progress("comparing") as watch:
        found = run_comparison(trackers, t, truth, SIGMA, runs, seed, watch)
    noise = np.random.default_rng(seed).standard_normal(truth.shape)
    results = {name: tr.run(t, truth + SIGMA * noise, SIGMA) for name, tr in trackers.items()}
    written = [folder / RESULTS]
    write_json(written[0], found.to_json_dict())
    written += _tables(folder, found, results[BEST])
    written += _pictures(folder, truth, results)
    if json:
        print_json({**found.to_json_dict(), "files": written})
        return
    print_comparison(found)
    say()
    for path in written:
        say(f"wrote {path}")


def _tables(folder: Path, found: Comparison, result: TrackResult) -> list[Path]:
    """Write the comparison and one track."""
    comparison, track = folder / "comparison.csv", folder / "track.csv"
    write_table(comparison, {"tracker": found.names, **found.errors()})
    plots = Track("", result.time, result.measured)
    write_tracks(track, Recording("demo", Columns("t", "", ("x", "y")), (plots,)), [result])
    return [comparison, track]


def _pictures(
    folder: Path,
    truth: Array,
    results: dict[str, TrackResult],
) -> list[Path]:
    """Draw the rule bases, the gains, the track and the errors."""

    def memberships(name: str) -> Figure:
        from fuzzytrack.plotting import plot_memberships

        return plot_memberships(load_rulebase(name))[0]

    def gain_plane() -> Figure:
        from fuzzytrack.plotting import plot_gain_plane

        # All of them in one order, so that a tracker has the color that it has in other pictures.
        return plot_gain_plane(results, load_rulebase(PUBLISHED))[0]

    def track() -> Figure:
        from fuzzytrack.plotting import plot_track

        return plot_track(results[BEST], truth, gains=True)[0]

    def errors() -> Figure:
        from fuzzytrack.plotting import plot_errors

        return plot_errors(results, truth)[0]

    drawings: dict[str, Callable[[], Figure]] = {
        "track": track,
        "errors": errors,
        "gain-plane": gain_plane,
        f"{BEST}-surfaces": lambda: surfaces(FuzzySystem(load_rulebase(BEST)), 101),
        f"{BEST}-memberships": lambda: memberships(BEST),
        f"{PUBLISHED}-surfaces": lambda: surfaces(FuzzySystem(load_rulebase(PUBLISHED)), 101),
        f"{PUBLISHED}-memberships": lambda: memberships(PUBLISHED),
    }
    paths = []
    with progress("drawing") as watch:
        for number, (name, draw) in enumerate(drawings.items(), 1):
            paths.append(folder / f"{name}.png")
            save_picture(paths[-1], draw)
            watch(number / len(drawings))
    return paths
