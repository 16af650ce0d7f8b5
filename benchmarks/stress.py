"""Trackers that know the time, on plots that come after 0.001 to 10,000 units of time.

    python -m benchmarks.stress [--plots 1000000]

Targets on straight lines; intervals log-uniform, and a standard deviation of each plot from one
tenth to ten times the usual one, which the tracker is told. Shown is the largest error of a
prediction on one axis in units of its own standard deviation, and how many of them are not finite
or have no positive variance. A million normal numbers reach about 5.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator

import numpy as np

from benchmarks.ranked import Conditions, ranked, with_level
from benchmarks.ranking import KALMAN
from fuzzytrack.arrays import Array
from fuzzytrack.cli.output import progress
from fuzzytrack.tasks import Progress, part
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_trackers

TRACKS = 200
SHORTEST, LONGEST = 1e-3, 1e4


def plots(steps: int, seed: int) -> Iterator[tuple[Array, Array, Array]]:
    """Time, position and standard deviation of the plots of all tracks, scan by scan."""
    rng = np.random.default_rng(seed)
    velocity = rng.normal(size=(TRACKS, 2))
    time = np.zeros(TRACKS)
    for _ in range(steps):
        time = time + SHORTEST * (LONGEST / SHORTEST) ** rng.random(TRACKS)
        sigma = np.repeat(10 ** rng.uniform(-1, 1, (TRACKS, 1)), 2, axis=1)
        yield time, time[:, None] * velocity + sigma * rng.normal(size=(TRACKS, 2)), sigma


def stressed(tracker: Tracker, steps: int, seed: int, watch: Progress) -> tuple[float, int]:
    """Largest normalized error, and the number of predictions that are no numbers."""
    state, worst, broken = None, 0.0, 0
    for k, (time, z, sigma) in enumerate(plots(steps, seed)):
        if state is None:
            state = tracker.start(z, time, sigma)
            continue
        if k > 1:
            prediction = tracker.predict(state, time, sigma)
            variance = prediction.innovation_variance
            good = np.isfinite(prediction.position) & np.isfinite(variance) & (variance > 0)
            broken += int((~good).sum())
            errors = abs(z - prediction.position)[good] / np.sqrt(variance[good])
            worst = max(worst, float(errors.max(initial=0.0)))
        state = tracker.step(state, z, time, sigma)
        watch((k + 1) / steps)
    return worst, broken


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.stress",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--plots", type=int, default=1_000_000, help="of all tracks together")
    parser.add_argument("--seed", type=int, default=20)
    given = parser.parse_args(arguments)
    names = (KALMAN, *with_level(Conditions()))
    trackers = as_trackers({name: ranked(Conditions())[name] for name in names})
    steps = math.ceil(given.plots / TRACKS)
    with progress("tracking") as watch:
        for number, (name, tracker) in enumerate(trackers.items()):
            tracker.compile(2)
            share = part(watch, number / len(trackers), (number + 1) / len(trackers))
            worst, broken = stressed(tracker, steps, given.seed, share)
            print(f"{name:20} largest error {worst:6.2f} √S, {broken} that are no numbers")
    return 0


if __name__ == "__main__":
    sys.exit(main())
