"""One aircraft that flies circuits, among the clutter of an air-traffic radar.

    python -m benchmarks.aircraft FOLDER [-o aircraft.json]

FOLDER holds ``radar_plots_sim.csv``, plots with range and azimuth, simulated on a recorded flight,
and ``truth_1s.csv`` with the flight; they are not part of this package. The scan tracker is the
shipped configuration ``air``.
The aircraft is tracked where a track is within 500 m; a track is false where none is.
"""

from __future__ import annotations

import argparse
import csv
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np

from benchmarks.peers import Array
from benchmarks.ranking import lines, rounded
from benchmarks.scan_judge import Judgment, Rule, judged
from benchmarks.scan_peers import Setting, followed, shipped
from fuzzytrack.cli.output import write_json
from fuzzytrack.json_types import plain
from fuzzytrack.scan.scan import Scan

SCANNER = "air"
PERIOD = 4.0
RULE = Rule(cutoff=500.0, reach=500.0, fast=40.0, window=30.0)


def scans(path: Path) -> list[Scan]:
    """Scans of the recording, also those without a plot; x to the east, y to the north."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    plots: dict[int, list[tuple[float, float]]] = {}
    for row in rows:
        distance, azimuth = float(row["range_m"]), np.radians(float(row["az_deg"]))
        place = distance * np.sin(azimuth), distance * np.cos(azimuth)
        plots.setdefault(int(row["scan"]), []).append(place)
    return [
        Scan(PERIOD * k, np.array(plots.get(k, []), float).reshape(-1, 2))
        for k in range(max(plots) + 1)
    ]


def truth(path: Path) -> dict[int, Array]:
    """Time and position of the aircraft."""
    with path.open(newline="") as file:
        rows = [[float(row[key]) for key in ("t_s", "x_m", "y_m")] for row in csv.DictReader(file)]
    return {1: np.array(rows)}


def judge(folder: Path, scanner: str = SCANNER) -> tuple[Judgment, int]:
    """Figures, and how many tracks were reported."""
    found = scans(folder / "radar_plots_sim.csv")
    tracks = followed(shipped(scanner), found, Setting(PERIOD))
    times = [scan.time for scan in found]
    figures = judged(
        tracks, times, truth(folder / "truth_1s.csv"), PERIOD, complete=True, rule=RULE
    )
    return figures, len(np.unique(tracks.track_id))


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.aircraft",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    given = parser.parse_args(arguments)
    figures, tracks = judge(given.folder)
    told = {**asdict(figures), "tracks": float(tracks)}
    print("\n".join(lines([[name, f"{value:.4g}"] for name, value in told.items()])))
    if given.output:
        write_json(given.output, rounded(plain(told)), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
