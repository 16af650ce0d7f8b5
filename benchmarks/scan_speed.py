"""Time and memory of a scan with its life cycle, from a harbor's few boats to 100,000 ships.

    python -m benchmarks.scan_speed [--targets 100,1000,10000,100000] [--area 5000] [--cpu] [--docs]

As many clutter plots as ships, ships seen in 93 of 100 scans, 25 scans: the median of the last 8,
through the public call, one after another as a radar delivers them. Memory is what the process has
at its peak beyond what it had with all plots at hand. Each size is measured in a process of its
own, after one run that compiles. Beside them, at sizes that they can do, Stone Soup's nearest
neighbors with a KD-tree and norfair, on the same plots in the same run.

With ``--cpu`` processor time is counted, for a machine with other work. ``--docs`` writes the table
of docs/scan-machine.md.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import math
import multiprocessing
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from benchmarks.machine import describe
from benchmarks.ranking import Table, lines, markdown, rounded
from benchmarks.report import NotMeasured
from benchmarks.scan_peers import Peer, Setting, followed, norfair, shipped, stonesoup
from benchmarks.scan_traffic import traffic
from benchmarks.work import ROOT
from fuzzytrack.cli.output import write_json
from fuzzytrack.json_types import plain

#: Milliseconds a scan that are asked of `default`, by number of ships.
TARGETS = {100: 0.15, 1_000: 1.3, 10_000: 14.0, 100_000: 210.0}
#: Ships of a harbor, with twice as many clutter plots, and the time that is asked (ms).
HARBOR, HARBOR_TARGET = 2, 0.02
#: The largest numbers of ships that a peer is given: seconds a scan at more.
LARGEST = {"Stone Soup GNN": 100, "norfair": 1_000}
LAST = 8
TABLES = ROOT / "docs" / "scan-speed-table.txt"


@dataclass(frozen=True)
class Cost:
    """Cost of one tracker at one size.

    Attributes
    ----------
    name : str
    ships : int
    milliseconds, worst : float
        Of the last scans: median and largest.
    megabytes : float
        At the peak, beyond the plots.
    tracks : int
        Reported after the last scan.
    """

    name: str
    ships: int
    milliseconds: float
    worst: float
    megabytes: float
    tracks: int


def peer_of(name: str) -> Peer:
    if name == "norfair":
        return norfair
    if name == "Stone Soup GNN":
        return stonesoup("GNN")
    return shipped(name)


def cost(name: str, ships: int, area: float, scans: int, cpu: bool) -> Cost:
    """Measure; in the process in which it is called."""
    peer, setting = peer_of(name), Setting(1.678, range_noise=1.0, bearing_noise=0.0)
    clock = time.process_time if cpu else time.perf_counter
    clutter = 2.0 if ships == HARBOR else 1.0
    followed(peer, traffic(HARBOR, area, scans=3).scans, setting)
    world = traffic(ships, area, scans=scans, clutter=clutter)
    before = _memory(restart=True)
    steps, seconds, step = peer(world.scans, setting), [], None
    for _ in world.scans:
        begin = clock()
        step = next(steps.each)
        seconds.append(clock() - begin)
    peak, last = _memory(), 1e3 * np.array(seconds[-LAST:])
    tracks = len(steps.shown(step)[0])
    return Cost(name, ships, float(np.median(last)), float(last.max()), peak - before, tracks)


def _memory(restart: bool = False) -> float:
    """Peak of resident memory (MB); of what is resident now, from now on, if it can restart."""
    if restart:
        with contextlib.suppress(OSError):
            Path("/proc/self/clear_refs").write_text("5")
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return float(line.split()[1]) / 1024
    return math.nan


def measured(
    sizes: Sequence[int], area: float, scans: int, cpu: bool, peers: Sequence[str]
) -> list[Cost | str]:
    """Costs, or why there is none, size by size; each in a new process."""
    jobs = [(name, ships) for ships in (HARBOR, *sizes) for name in ("default", *peers)
            if ships <= LARGEST.get(name, ships)]  # fmt: skip
    found: list[Cost | str] = []
    for name, ships in jobs:
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            try:
                found.append(pool.apply(cost, (name, ships, area, scans, cpu)))
            except NotMeasured as reason:
                found.append(f"{name}: {reason}")
    return list(dict.fromkeys(found))


def exponents(costs: Sequence[Cost]) -> dict[str, float]:
    """Exponent of the growth of time from each size to the next, and over all."""
    own = [each for each in costs if each.name == "default" and each.ships > HARBOR]
    steps = list(itertools.pairwise(own))
    if len(own) > 2:
        steps.append((own[0], own[-1]))
    return {
        f"{one.ships:,} to {two.ships:,}": math.log(two.milliseconds / one.milliseconds)
        / math.log(two.ships / one.ships)
        for one, two in steps
    }


def table(found: Sequence[Cost | str]) -> Table:
    """A row for each tracker and size; a head in front."""
    rows = [["", "ships", "ms a scan", "worst", "asked", "memory, MB", "tracks", "times default"]]
    own = {each.ships: each.milliseconds for each in costs(found) if each.name == "default"}
    for each in costs(found):
        asked = {HARBOR: HARBOR_TARGET, **TARGETS}.get(each.ships)
        rows.append([
            each.name, f"{each.ships:,}", f"{each.milliseconds:.3g}", f"{each.worst:.3g}",
            f"≤ {asked:g}" if each.name == "default" and asked else "",
            f"{each.megabytes:.3g}", f"{each.tracks:,}",
            "" if each.name == "default" else f"{each.milliseconds / own[each.ships]:.3g}",
        ])  # fmt: skip
    return rows


def costs(found: Sequence[Cost | str]) -> list[Cost]:
    return [each for each in found if isinstance(each, Cost)]


def described(found: Sequence[Cost | str], machine: Mapping[str, object], cpu: bool) -> str:
    """Table and notes for the documentation."""
    clock = "processor time" if cpu else "wall-clock time"
    growth = ", ".join(f"{size}: {value:.2f}" for size, value in exponents(costs(found)).items())
    reasons = [f"- {each}\n" for each in found if isinstance(each, str)]
    return (
        f"*Measured on:* {machine['processor']}, {clock}, one thread.\n\n{markdown(table(found))}\n"
        f"\nExponent of growth: {growth}.\n{''.join(reasons)}"
    )


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.scan_speed",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--targets", default=",".join(map(str, TARGETS)), help="numbers of ships")
    parser.add_argument("--area", type=float, default=5000.0, help="of a ship, m²")
    parser.add_argument("--scans", type=int, default=25)
    parser.add_argument("--cpu", action="store_true", help="processor time")
    parser.add_argument("--alone", action="store_true", help="without peers")
    parser.add_argument("--docs", action="store_true", help="write the table of the documentation")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    given = parser.parse_args(arguments)
    sizes = [int(each) for each in given.targets.split(",")]
    peers = [] if given.alone else list(LARGEST)
    found = measured(sizes, given.area, given.scans, given.cpu, peers)
    print("\n".join(lines(table(found))))
    for size, value in exponents(costs(found)).items():
        print(f"growth, {size} ships: exponent {value:.2f}")
    print("\n".join(each for each in found if isinstance(each, str)))
    machine = describe()
    if given.docs:
        TABLES.write_text(described(found, machine, given.cpu))
    if given.output:
        told = {
            "machine": machine, "cpu": given.cpu,
            "costs": [each if isinstance(each, str) else asdict(each) for each in found],
        }  # fmt: skip
        write_json(given.output, rounded(plain(told)), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
