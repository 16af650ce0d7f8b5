"""Dense traffic: a ship and a clutter plot on every 5,000 m², and who is found.

    python -m benchmarks.dense_traffic [--ships 1000] [--seeds 3] [--scans 25] [-o dense.json]

A ship is confirmed if a reported track is within 15 m of it at the last scan, pairs one to one; a
reported track without a ship is false. For every shipped configuration; mean over seeds and the
worst of them.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from benchmarks.ranking import Table, lines, rounded
from benchmarks.scan_judge import Rule
from benchmarks.scan_peers import CONFIGURATIONS, Peer, Setting, followed, shipped
from benchmarks.scan_traffic import Traffic, traffic
from fuzzytrack.cli.output import progress, write_json
from fuzzytrack.json_types import plain

AREA = 5000.0


@dataclass(frozen=True)
class Shares:
    """Shares at the last scan: of ships that have a track, and of tracks without a ship."""

    confirmed: float
    false: float


def shares(peer: Peer, world: Traffic) -> Shares:
    found = followed(peer, world.scans, Setting(1.678, bearing_noise=0.0))
    tracks = found.position[found.time == world.scans[-1].time]
    pairs = matched(tracks, world.truth[-1])
    return Shares(pairs / len(world.truth[-1]), 1 - pairs / max(len(tracks), 1))


def matched(tracks: np.ndarray, ships: np.ndarray) -> int:
    """Number of one-to-one pairs within reach, as many as can be."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import maximum_bipartite_matching
    from scipy.spatial import KDTree

    if not len(tracks):
        return 0
    near = KDTree(tracks).query_ball_point(ships, Rule.reach)
    columns = np.concatenate([np.array(each, int) for each in near])
    starts = np.concatenate([[0], np.cumsum([len(each) for each in near])])
    pairs = csr_matrix((np.ones(len(columns)), columns, starts), (len(ships), len(tracks)))
    return int((maximum_bipartite_matching(pairs, "column") >= 0).sum())


def table(figures: dict[str, list[Shares]]) -> Table:
    rows = [["%", "confirmed", "least", "false", "most"]]
    for name, each in figures.items():
        confirmed = np.array([100 * one.confirmed for one in each])
        false = np.array([100 * one.false for one in each])
        cells = confirmed.mean(), confirmed.min(), false.mean(), false.max()
        rows.append([name, *(f"{cell:.2f}" for cell in cells)])
    return rows


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.dense_traffic",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--ships", type=int, default=1000)
    parser.add_argument("--seeds", type=int, default=3, help="number of worlds")
    parser.add_argument("--scans", type=int, default=25)
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    given = parser.parse_args(arguments)
    figures: dict[str, list[Shares]] = {}
    with progress("scanning") as watch:
        for seed in range(given.seeds):
            world = traffic(given.ships, AREA, scans=given.scans, seed=seed)
            for name in CONFIGURATIONS:
                figures.setdefault(name, []).append(shares(shipped(name), world))
            watch((seed + 1) / given.seeds)
    print("\n".join(lines(table(figures))))
    if given.output:
        told = {name: [asdict(one) for one in each] for name, each in figures.items()}
        write_json(given.output, rounded(plain(told)), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
