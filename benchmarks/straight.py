"""Share of straight tracks that a scheduler loses at irregular times with many missed plots.

    python -m benchmarks.straight [--tracks 1000] [-o straight.json]

A target on a straight line, intervals log-uniform from one to ten, probability of detection 0.4. A
track is lost if a prediction at a plot after the hundredth is wrong by more than 100 standard
deviations of the noise.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.ranked import Conditions, ranked
from fuzzytrack.arrays import Array
from fuzzytrack.cli.output import progress, write_json
from fuzzytrack.simulation.noise import streams
from fuzzytrack.simulation.sampling import Sampling
from fuzzytrack.simulation.scenario import PlotNoise
from fuzzytrack.simulation.trajectories import constant_velocity
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_trackers

SCANS, PLOTS, FAR = 500, 100, 100.0
# The mean of intervals that are log-uniform from 1 to 10.
PERIOD = 9 / np.log(10)
SAMPLING, SENSORS = Sampling("log-uniform", (1, 10)), PlotNoise(1.0, detection=0.4)


def lost(tracker: Tracker, tracks: int, seed: int) -> tuple[float, bool]:
    """Share of tracks that are lost, and whether the run warned."""
    runs = streams(seed, tracks)
    times = SAMPLING.times(PERIOD * np.arange(SCANS), runs)
    _, truth = constant_velocity(speed=3.0, heading=0.6, at=times)
    plots = SENSORS.measure(truth, runs)
    with warnings.catch_warnings(record=True) as said, np.errstate(all="ignore"):
        warnings.simplefilter("always")
        predicted = tracker.run(times, plots.z, plots.sigma).predicted
        distance = np.linalg.norm(predicted - truth, axis=2)
    seen = ~np.isnan(plots.z[..., 0])
    late = seen & (np.cumsum(seen, axis=0) > PLOTS)
    wrong: Array = late & ~(distance <= FAR)
    warned = any(issubclass(each.category, UserWarning) for each in said)
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
    given = parser.parse_args(arguments)
    trackers = as_trackers(ranked(Conditions()))
    found: dict[str, Any] = {"tracks": given.tracks, "seed": given.seed, "lost": {}}
    with progress("tracking") as watch:
        for number, (name, tracker) in enumerate(trackers.items(), 1):
            share, warned = lost(tracker, given.tracks, given.seed)
            found["lost"][name] = {"share": share, "warned": warned}
            print(f"{name:30}{100 * share:7.1f} %{'  with a warning' * warned}")
            watch(number / len(trackers))
    if given.output:
        write_json(given.output, found, 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
