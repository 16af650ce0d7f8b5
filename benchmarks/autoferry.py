"""Scan trackers on the radar of the Autoferry data set: two boats with known positions in a harbor.

    python -m benchmarks.autoferry FOLDER [--peers] [-o autoferry.json]

FOLDER holds ``radar_detections.csv``, ``radar_scans.csv`` and ``ground_truth.csv`` with scenarios
2, 4 and 16 of https://github.com/Autoferry/sensor_fusion_dataset as tables; they are not part of
this package. The clock of the radar is late against that of the truth, by another time in each
scenario, which was fitted to the plots themselves, not to tracks.

Every shipped configuration, then other trackers in the place of that of ``default``, and with
``--peers`` Stone Soup's nearest neighbors and joint data association on the same plots. See
`benchmarks.scan_judge` for what the columns mean.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.peers import Array
from benchmarks.ranking import Table, lines, rounded
from benchmarks.scan_judge import Judgment, judged, mean_judgment
from benchmarks.scan_peers import CONFIGURATIONS, Peer, Setting, followed, shipped, stonesoup
from fuzzytrack.cli.output import progress, write_json
from fuzzytrack.json_types import plain
from fuzzytrack.scan.scan import Scan
from fuzzytrack.tasks import Progress

#: Time of the radar minus that of the truth (s), by scenario.
LAGS = {2: 2.25, 4: 3.50, 16: 1.75}
PERIOD = 1.678
#: Trackers that take the place of that of `default`.
TRACKERS = {
    "fixed": "fixed:alpha=.5:beta=.2",
    "maneuver": "maneuver:level=0.4",
    "Kalman CV": "kalman-cv:sigma_v=.117",
    "IMM": "imm:quiet_sigma=0.05:maneuver_sigma=0.4:maneuver=cv",
}
#: What Stone Soup is told: the best of a random search of ten minutes on these same scenarios.
PEER_SETTINGS = {
    "GNN": Setting(
        PERIOD, range_noise=1.06, bearing_noise=0.0014, acceleration=0.1, speed=3.3, gate=5.0,
        hits=5, tentative_misses=1, misses=8,
    ),
    "JPDA": Setting(
        PERIOD, range_noise=0.83, bearing_noise=0.0052, acceleration=0.051, speed=3.75, gate=4.6,
        detection=0.91, clutter=1.2e-5, hits=5, tentative_misses=1, misses=6,
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Recording:
    """Scans of a scenario, and paths of its boats by the clock of the radar."""

    scenario: int
    scans: list[Scan]
    truth: Mapping[int, Array]


def recordings(folder: Path) -> list[Recording]:
    """Scenarios of `LAGS` from the tables of a folder."""
    plots, paths = dict[tuple[int, int], Any](), dict[tuple[int, int], Any]()
    for scenario, row in _rows(folder / "radar_detections.csv"):
        plots.setdefault((scenario, int(row["scan"])), []).append(_place(row))
    for scenario, row in _rows(folder / "ground_truth.csv"):
        when = float(row["t_s"]) + LAGS[scenario]
        paths.setdefault((scenario, int(row["target_id"])), []).append((when, *_place(row)))
    scans: dict[int, list[Scan]] = {scenario: [] for scenario in LAGS}
    for scenario, row in _rows(folder / "radar_scans.csv"):
        found = plots.get((scenario, int(row["scan"])), [])
        own = (float(row["own_north_m"]), float(row["own_east_m"]))
        positions = np.array(found, float).reshape(-1, 2)
        scans[scenario].append(Scan(float(row["t_s"]), positions, own=own))
    return [
        Recording(each, scans[each], {k[1]: np.array(p) for k, p in paths.items() if k[0] == each})
        for each in LAGS
    ]


def _rows(path: Path) -> Iterator[tuple[int, dict[str, str]]]:
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            if (scenario := int(row["scenario"])) in LAGS:
                yield scenario, row


def _place(row: Mapping[str, str]) -> tuple[float, float]:
    return float(row["north_m"]), float(row["east_m"])


def judge(peer: Peer, setting: Setting, found: list[Recording]) -> dict[str, Judgment]:
    """Judgments by scenario, and their mean."""
    each = {}
    for one in found:
        times = [scan.time for scan in one.scans]
        tracks = followed(peer, one.scans, setting)
        each[str(one.scenario)] = judged(tracks, times, one.truth, PERIOD, complete=False)
    return {**each, "mean": mean_judgment(list(each.values()))}


def measured(
    peers: Mapping[str, tuple[Peer, Setting]], found: list[Recording], watch: Progress
) -> dict[str, dict[str, Judgment]]:
    figures = {}
    for number, (name, (peer, setting)) in enumerate(peers.items()):
        figures[name] = judge(peer, setting, found)
        watch((number + 1) / len(peers))
    return figures


HEAD = [
    "", "", "OSPA", "with fast", "tracked", "delay, s", "switches", "breaks", "fast, s/min",
    "false, s/min", "RMSE", "ms a scan",
]  # fmt: skip


def table(figures: Mapping[str, Mapping[str, Judgment]]) -> Table:
    """A row for each tracker and scenario; a head in front."""
    rows = [HEAD]
    for name, each in figures.items():
        for scenario, one in each.items():
            cells = [
                f"{one.ospa:.2f}", f"{one.ospa_fast:.2f}", f"{one.tracked:.3f}",
                f"{one.delay:.1f}", f"{one.switches:.2g}", f"{one.breaks:.2g}", f"{one.fast:.1f}",
                f"{one.false:.1f}", f"{one.rmse:.2f}", f"{one.milliseconds:.3g}",
            ]  # fmt: skip
            rows.append([name, scenario, *cells])
    return rows


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.autoferry",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--peers", action="store_true", help="Stone Soup on the same plots")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    given = parser.parse_args(arguments)
    plots = Setting(PERIOD)
    peers = {name: (shipped(name), plots) for name in CONFIGURATIONS}
    for name, tracker in TRACKERS.items():
        peers[f"default, {name}"] = shipped("default", tracker), plots
    if given.peers:
        for name, setting in PEER_SETTINGS.items():
            peers[f"Stone Soup {name}"] = stonesoup(name), setting
    with progress("scanning") as watch:
        figures = measured(peers, recordings(given.folder), watch)
    print("\n".join(lines(table(figures))))
    if given.output:
        told = {
            name: {scenario: asdict(one) for scenario, one in each.items()}
            for name, each in figures.items()
        }
        write_json(given.output, rounded(plain(told)), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
