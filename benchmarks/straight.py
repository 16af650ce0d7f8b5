"""Share of straight tracks that a scheduler loses at irregular times with many missed plots.

    python -m benchmarks.straight [--tracks 1000] [-o straight.json]

A target on a straight line, random intervals of which the longest is ten times the shortest, with
the mean for which the trackers are set, and probability of detection 0.4. A track is lost if a
prediction at a plot after the hundredth is wrong by more than 100 standard deviations of the noise.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.ranked import Conditions, ranked
from benchmarks.ranking import Table, lines, markdown
from benchmarks.work import ROOT
from fuzzytrack.arrays import Array
from fuzzytrack.cli.output import progress, write_json
from fuzzytrack.errors import TrackWarning
from fuzzytrack.simulation.noise import streams
from fuzzytrack.simulation.sampling import Sampling
from fuzzytrack.simulation.scenario import PlotNoise
from fuzzytrack.simulation.trajectories import constant_velocity
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_trackers

SCANS, PLOTS, FAR = 500, 100, 100.0
SAMPLING, SENSORS = Sampling("log-uniform", (1, 10)), PlotNoise(1.0, detection=0.4)


def lost(tracker: Tracker, tracks: int, seed: int) -> tuple[float, bool]:
    """Share of tracks that are lost, and whether the run said that its gains do not suit."""
    runs = streams(seed, tracks)
    times = SAMPLING.times(np.arange(float(SCANS)), runs)
    _, truth = constant_velocity(speed=3.0, heading=0.6, at=times)
    plots = SENSORS.measure(truth, runs)
    with warnings.catch_warnings(record=True) as said, np.errstate(all="ignore"):
        warnings.simplefilter("always")
        predicted = tracker.run(times, plots.z, plots.sigma).predicted
        distance = np.linalg.norm(predicted - truth, axis=2)
    seen = ~np.isnan(plots.z[..., 0])
    late = seen & (np.cumsum(seen, axis=0) > PLOTS)
    wrong: Array = late & ~(distance <= FAR)
    warned = any(issubclass(each.category, TrackWarning) for each in said)
    return float(wrong.any(axis=0).mean()), warned


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.straight",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--tracks", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=20)
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    parser.add_argument("--docs", action="store_true", help="write the table of docs/ranking.md")
    given = parser.parse_args(arguments)
    trackers = as_trackers(ranked(Conditions()))
    found: dict[str, Any] = {"tracks": given.tracks, "seed": given.seed, "lost": {}}
    with progress("tracking") as watch:
        for number, (name, tracker) in enumerate(trackers.items(), 1):
            share, warned = lost(tracker, given.tracks, given.seed)
            found["lost"][name] = {"share": share, "warned": warned}
            watch(number / len(trackers))
    print("\n".join(lines(table(found))))
    if given.output:
        write_json(given.output, found, 1)
    if given.docs:
        (ROOT / "docs" / "ranking-straight.txt").write_text(markdown(table(found)))
    return 0


def table(found: Mapping[str, Any]) -> Table:
    """Share that each tracker loses, the least first; a head in front."""
    rows = sorted(found["lost"].items(), key=lambda item: item[1]["share"])
    return [
        ["", "tracks lost, %", "says so when run"],
        *([name, f"{100 * each['share']:.1f}", "yes" * each["warned"]] for name, each in rows),
    ]


if __name__ == "__main__":
    sys.exit(main())
