"""Configurations of scan trackers against Stone Soup, in simulated traffic with heavy clutter.

    python -m benchmarks.scan_rivals [--seeds 20] [--peers GNN,JPDA] [--keep FOLDER] [-o out.json]

200 ships on 10 km², of which some turn, end and are followed by others; 1,000 clutter plots in
each of 30 scans; plots of ships have a standard deviation of 1.2 m in each axis, which every
tracker is told, and are missed one time in ten. Stone Soup is told the true detection probability
and density of clutter, too; *default, told* is `default` with the same numbers. All trackers get
the same plots, seed by seed, so that differences are paired: their means with standard errors are
against ``default``.

Stone Soup needs seconds a scan: with ``--keep`` tracks are kept in a folder, and those that are
there are not computed again.
"""

from __future__ import annotations

import argparse
import math
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from benchmarks.peers import Array
from benchmarks.ranking import Table, lines, rounded
from benchmarks.scan_judge import Judgment, judged
from benchmarks.scan_peers import (
    CONFIGURATIONS,
    Followed,
    Peer,
    Setting,
    followed,
    shipped,
    stonesoup,
)
from fuzzytrack.cli.output import progress, write_json
from fuzzytrack.json_types import plain
from fuzzytrack.simulation.scene import (
    Radar,
    Region,
    ScanTimes,
    Scene,
    SimulatedScans,
    TargetGroup,
    UniformClutter,
    simulate_scans,
)  # fmt: skip

PERIOD, NOISE, SHIPS, SCANS = 1.678, 1.2, 200, 30
AREA = 50_000.0
#: Chosen of some on seed 1000; one scan without a plot ends a track that has fewer hits.
SETTING = Setting(
    PERIOD, range_noise=NOISE, bearing_noise=0.0, extra_noise=0.0, acceleration=0.2, speed=3.0,
    detection=0.9, clutter=5 / AREA, hits=4, tentative_misses=1, misses=4,
)  # fmt: skip
#: `default` with what of this it can be told.
TOLD = "default:sensor.detection=0.9:update.acceleration=0.2:initiation.speed=3"
#: Association of a peer by its name here: exact joint association does not end with 200 tracks.
ASSOCIATIONS = {"GNN": "GNN", "JPDA": "JPDA by propagation"}
#: Attributes of a judgment that are compared.
FIGURES = ("ospa", "tracked", "false", "false_tracks", "breaks", "switches", "rmse")


def traffic(seed: int, ships: int = SHIPS, scans: int = SCANS) -> SimulatedScans:
    """The scene with its truth; plots carry their covariance."""
    scene = Scene(
        "crowded water",
        ScanTimes(count=scans, period=PERIOD, antenna="at-once"),
        Radar(reach=(0, 1e5), sigma_position=NOISE, detection=((0, 0.9), (1e5, 0.9))),
        {
            "sailing": TargetGroup(
                count=ships, births=ships / 500, life=500.0, speed=(1, 6),
                turn_rate=math.radians(3), leg=40.0,
            )
        },
        {"sea": UniformClutter(count=5 * ships)},
        Region(square=math.sqrt(AREA * ships)),
    )  # fmt: skip
    found = simulate_scans(scene, seed)
    variances = [NOISE**2, 0.0, NOISE**2]
    told = [replace(each, covariances=np.tile(variances, (len(each), 1))) for each in found.scans]
    return replace(found, scans=told)


def paths(world: SimulatedScans) -> dict[int, Array]:
    """Time and position of each ship."""
    truth = world.truth
    rows = np.column_stack([truth.time, truth.position])
    return {int(each): rows[truth.target_id == each] for each in np.unique(truth.target_id)}


def kept_or_followed(peer: Peer, world: SimulatedScans, file: Path | None) -> Followed:
    """Tracks of a tracker, from a file if they are there."""
    if file and file.exists():
        with np.load(file) as kept:
            return Followed(**kept)
    found = followed(peer, world.scans, SETTING)
    if file:
        file.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(file, **found._asdict())
    return found


def judged_by_seed(
    peers: Mapping[str, Peer],
    seeds: int,
    keep: Path | None = None,
    scene: Callable[[int], SimulatedScans] | None = None,
) -> dict[str, list[Judgment]]:
    figures: dict[str, list[Judgment]] = {name: [] for name in peers}
    with progress("scanning") as watch:
        for seed in range(seeds):
            world = (scene or traffic)(seed)
            times, truth = [scan.time for scan in world.scans], paths(world)
            for name, peer in peers.items():
                file = keep / f"{file_name(name)}-{seed}.npz" if keep else None
                found = kept_or_followed(peer, world, file)
                figures[name].append(judged(found, times, truth, PERIOD, complete=True))
            watch((seed + 1) / seeds)
    return figures


def file_name(tracker: str) -> str:
    return re.sub(r"\W+", "-", tracker)


def mean_and_error(values: Array) -> tuple[float, float]:
    """Mean with its standard error."""
    error = values.std(ddof=1) / math.sqrt(len(values)) if len(values) > 1 else math.nan
    return float(values.mean()), float(error)


def tables(figures: Mapping[str, list[Judgment]]) -> tuple[Table, Table]:
    """Means, and paired differences against the first; heads in front."""
    first, *others = figures
    means: Table = [["mean", *FIGURES, "ms a scan"]]
    changes: Table = [[f"minus {first}", *FIGURES]]
    for name in figures:
        each = {key: np.array([getattr(one, key) for one in figures[name]]) for key in FIGURES}
        time = np.median([one.milliseconds for one in figures[name]])
        means.append([name, *(f"{v.mean():.3g}" for v in each.values()), f"{time:.3g}"])
        if name in others:
            base = {key: np.array([getattr(one, key) for one in figures[first]]) for key in FIGURES}
            pairs = (mean_and_error(each[key] - base[key]) for key in FIGURES)
            changes.append([name, *(f"{mean:+.3g} ± {error:.1g}" for mean, error in pairs)])
    return means, changes


def print_tables(figures: Mapping[str, list[Judgment]]) -> None:
    for table in tables(figures):
        print("\n".join(lines(table)))


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.scan_rivals",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--peers", default="", help="of Stone Soup: GNN,JPDA")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep tracks, and use them")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    given = parser.parse_args(arguments)
    # Differences are against the first.
    names = sorted(CONFIGURATIONS, key=lambda name: name != "default")
    peers = {name: shipped(name) for name in names}
    peers["default, told"] = shipped(TOLD)
    for name in filter(None, given.peers.split(",")):
        peers[f"Stone Soup {name}"] = stonesoup(ASSOCIATIONS[name])
    figures = judged_by_seed(peers, given.seeds, given.keep)
    print_tables(figures)
    if given.output:
        told = {name: [asdict(one) for one in each] for name, each in figures.items()}
        write_json(given.output, rounded(plain(told)), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
