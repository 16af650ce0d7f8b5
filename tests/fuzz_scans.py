"""Fuzz scan trackers: every scan is taken, or refused with a ValueError that changes nothing.

Run as ``python tests/fuzz_scans.py --scans 100000 --seed 1 --jobs 2``. A recording of some scans is
made from the seed and its number alone, so that any finding can be repeated. It is tracked three
times: scan by scan; by a session that is pickled and loaded between random scans; and in one run,
without the scans that were refused. All three must report the same.
"""

from __future__ import annotations

import argparse
import multiprocessing
import pickle
import random
import resource
import sys
import time
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scanners.catalog import load_scanner
from fuzzytrack.scan.scanners.loading import shipped_scanners
from fuzzytrack.scan.track_reports import TrackReports

CONFIGURATIONS = shipped_scanners()
# Recordings of a task; CPU seconds of one; MiB of the process.
CHUNK, SECONDS, MEBIBYTES = 20, 30.0, 1500
#: Plots of the largest scans.
CROWD = 100_000
PERIOD = 1.678

# -------------------------------------------------------------------- recordings


def recording(seed: int, index: int, crowd: int = CROWD) -> list[Scan]:
    """Ships, clutter, and some scans that no radar makes."""
    rng = np.random.default_rng([seed, index])
    ships, size = int(rng.integers(0, 12)), 10.0 ** rng.uniform(1.0, 4.5)
    start, velocity = rng.uniform(-size, size, (ships, 2)), rng.normal(0, 4, (ships, 2))
    scans = []
    for k in range(int(rng.choice((5, 20, 60)))):
        seen = (start + PERIOD * k * velocity)[rng.random(ships) < 0.9]
        clutter = rng.uniform(-size, size, (rng.poisson(rng.choice((0, 3, 20))), 2))
        plots = np.concatenate([seen + rng.normal(0, 1, seen.shape), clutter])
        own = tuple(rng.uniform(-10, 10, 2).tolist())
        scan = Scan(PERIOD * k, plots, own=own)
        if rng.random() < 0.25:
            scan = SPOILERS[rng.choice(len(SPOILERS), p=WEIGHTS)](rng, scan, crowd)
        scans.append(scan)
    return scans


Rng = np.random.Generator


def empty(_rng: Rng, scan: Scan, _crowd: int) -> Scan:
    return replace(scan, positions=np.empty((0, 2)))


def twice(rng: Rng, scan: Scan, _crowd: int) -> Scan:
    return replace(scan, positions=np.repeat(scan.positions, int(rng.integers(2, 6)), axis=0))


def one_spot(rng: Rng, scan: Scan, crowd: int) -> Scan:
    count = crowd if rng.random() < 0.01 else int(rng.integers(2, 300))
    spread = rng.choice((0.0, 1e-9, 1.0, 10.0))
    positions = rng.uniform(-100, 100, 2) + spread * rng.standard_normal((count, 2))
    return replace(scan, positions=positions)


def wrong_number(rng: Rng, scan: Scan, _crowd: int) -> Scan:
    plots = np.concatenate([scan.positions, np.zeros((1, 2))])
    values = (np.nan, np.inf, -np.inf, 1e308, -1e300, 5e-324)
    plots[rng.integers(len(plots)), rng.integers(2)] = rng.choice(values)
    return replace(scan, positions=plots)


def far(rng: Rng, scan: Scan, _crowd: int) -> Scan:
    return replace(scan, positions=scan.positions * 10.0 ** rng.uniform(1, 9))


def at_the_radar(_rng: Rng, scan: Scan, _crowd: int) -> Scan:
    return replace(scan, positions=np.concatenate([scan.positions, [scan.own]]))


def wrong_time(rng: Rng, scan: Scan, _crowd: int) -> Scan:
    choices = (-1.0, 0.0, scan.time - PERIOD, scan.time - 7 * PERIOD, np.nan, np.inf)
    return replace(scan, time=float(rng.choice(choices)))


def later(rng: Rng, scan: Scan, _crowd: int) -> Scan:
    """So that scans after it go backwards."""
    return replace(scan, time=scan.time + float(rng.choice((1e-9, 0.1, 20.0, 1e4))))


def covariances(rng: Rng, scan: Scan, _crowd: int) -> Scan:
    deviation = 10.0 ** rng.uniform(-3, 3)
    found = np.tile([deviation**2, 0.0, deviation**2], (len(scan), 1))
    if len(found) and rng.random() < 0.3:
        found[0] = rng.choice(([0.0, 0.0, 0.0], [1.0, 2.0, 1.0], [-1.0, 0.0, 1.0], [np.nan] * 3))
    return replace(scan, covariances=found)


def own_times(rng: Rng, scan: Scan, _crowd: int) -> Scan:
    times = scan.time - PERIOD * rng.random(len(scan))
    if len(times) and rng.random() < 0.2:
        times[0] = rng.choice((np.nan, scan.time + 1.0, scan.time - 1e4))
    return replace(scan, times=times)


def wrong_shape(rng: Rng, scan: Scan, _crowd: int) -> Scan:
    shapes = (np.zeros(3), np.zeros((2, 3)), np.zeros((1, 2, 1)))
    return replace(scan, positions=shapes[rng.integers(len(shapes))])


SPOILERS = (
    empty, twice, one_spot, wrong_number, far, at_the_radar, wrong_time, later, covariances,
    own_times, wrong_shape,
)  # fmt: skip
WEIGHTS = np.array([3, 3, 2, 3, 1, 1, 2, 1, 2, 2, 0.5]) / 20.5

# -------------------------------------------------------------------- trying


@dataclass
class Report:
    """What came of some recordings."""

    scans: int = 0
    taken: int = 0
    refused: int = 0
    slowest: float = 0.0
    slowest_index: int = -1
    peak: float = 0.0
    failures: list[str] = field(default_factory=list)

    def add(self, other: Report) -> None:
        self.scans += other.scans
        self.taken += other.taken
        self.refused += other.refused
        if other.slowest > self.slowest:
            self.slowest, self.slowest_index = other.slowest, other.slowest_index
        self.peak = max(self.peak, other.peak)
        self.failures += other.failures


def equal(one: TrackReports, other: TrackReports) -> bool:
    pairs = ((getattr(one, each.name), getattr(other, each.name)) for each in fields(TrackReports))
    return all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in pairs)


class FoundError(Exception):
    """What a fuzzer finds."""


def check_identities(live: TrackReports, before: set[int], newest: int) -> set[int]:
    """Identities of live tracks: each once, and new ones newer than any before."""
    found = live.track_id.tolist()
    if len(set(found)) < len(found):
        raise FoundError("two tracks with one identity")
    if any(each <= newest for each in set(found) - before):
        raise FoundError("an identity is used again")
    if not np.isfinite(live.position).all() or not np.isfinite(live.deviation).all():
        raise FoundError("a track without a finite state")
    return set(found)


def attempt(seed: int, index: int, crowd: int, report: Report) -> None:
    scans = recording(seed, index, crowd)
    chance = random.Random(f"{seed}/{index}")
    scanner = load_scanner(CONFIGURATIONS[index % len(CONFIGURATIONS)])
    session, resumed = scanner.start(), scanner.start()
    good, reports = [], []
    live, newest = set[int](), 0
    for scan in scans:
        report.scans += 1
        if chance.random() < 0.2:
            resumed = pickle.loads(pickle.dumps(resumed))
        outcomes: list[Any] = []
        for each in (session, resumed):
            try:
                outcomes.append(each.step(scan))
            except ValueError as error:
                outcomes.append(str(error))
        one, other = outcomes
        if isinstance(one, str):
            report.refused += 1
            if one != other:
                raise FoundError(f"refused with {one!r}, resumed with {other!r}")
            continue
        report.taken += 1
        if isinstance(other, str) or not equal(one, other):
            raise FoundError("a session that was pickled reports something else")
        good.append(scan)
        reports.append(one)
        live = check_identities(session.tracks(), live, newest)
        newest = max(newest, *live, 0)
    if not equal(scanner.run(good).reports, TrackReports.joined(reports)):
        raise FoundError("one run reports something else")


def run(task: tuple[int, int, int, int]) -> Report:
    """Try recordings number `first` to ``first + count``; the largest scans have `crowd` plots."""
    seed, first, count, crowd = task
    report = Report()
    for index in range(first, first + count):
        started = time.process_time()
        try:
            attempt(seed, index, crowd, report)
        except Exception as error:
            report.failures.append(f"recording {index}: {type(error).__name__}: {error}")
        elapsed = time.process_time() - started
        if elapsed > report.slowest:
            report.slowest, report.slowest_index = elapsed, index
        if elapsed > SECONDS:
            report.failures.append(f"recording {index}: {elapsed:.1f} s")
    report.peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    if report.peak > MEBIBYTES:
        report.failures.append(f"recordings {first} to {first + count}: {report.peak:.0f} MiB")
    return report


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scans", type=int, default=100_000, help="number of scans")
    parser.add_argument("--seed", type=int, default=1, help="which recordings")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    given = parser.parse_args()
    total = Report()
    # Mean length of a recording is 28 scans.
    tasks = ((given.seed, first, CHUNK, CROWD) for first in range(0, given.scans, CHUNK))
    with multiprocessing.Pool(given.jobs) as pool:
        for report in pool.imap(run, tasks):
            total.add(report)
            if total.scans >= given.scans or len(total.failures) > 20:
                break
    print(
        f"{total.scans} scans, {total.taken} taken and {total.refused} refused; slowest recording "
        f"{total.slowest:.1f} s (number {total.slowest_index}), peak {total.peak:.0f} MiB"
    )
    for failure in total.failures:
        print(f"FAILED {failure}")
    return int(bool(total.failures))


if __name__ == "__main__":
    sys.exit(main())
