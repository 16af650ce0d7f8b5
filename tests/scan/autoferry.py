"""Recorded plots of a marine radar with the truth of two boats, and how tracks are scored on them.

The data are CC0; see its README. The radar's clock lags that of the truth by a time that differs
between the recordings.
"""

from __future__ import annotations

import csv
import math
import os
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from fuzzytrack.scan import Scan

BESIDE = Path(__file__).resolve().parents[2].parent / "shared" / "data"
FOLDER = Path(os.environ.get("FUZZYTRACK_DATA", BESIDE)) / "autoferry_radar"

#: Lag of the radar (s) by number of the recording.
LAGS = {"2": 2.25, "4": 3.5, "16": 1.75}


def rows(name, scenario):
    if not (FOLDER / name).is_file():
        pytest.skip(f"no {name} in FUZZYTRACK_DATA or beside the project")
    with open(FOLDER / name) as file:
        return [row for row in csv.DictReader(file) if row["scenario"] == scenario]


def numbers(row, *names):
    return [float(row[name]) for name in names]


def scans_of(scenario):
    """Scans of a recording, the empty ones too."""
    plots = {}
    for row in rows("radar_detections.csv", scenario):
        plots.setdefault(row["scan"], []).append(numbers(row, "north_m", "east_m"))
    return [
        Scan(
            float(row["t_s"]),
            np.array(plots.get(row["scan"], [])).reshape(-1, 2),
            own=tuple(numbers(row, "own_north_m", "own_east_m")),
        )
        for row in rows("radar_scans.csv", scenario)
    ]


def truth_of(scenario):
    """Function of a radar's time: which boats there are, and where."""
    tracks = {}
    for row in rows("ground_truth.csv", scenario):
        tracks.setdefault(row["target_id"], []).append(numbers(row, "t_s", "north_m", "east_m"))
    tracks = {name: np.array(track) for name, track in tracks.items()}

    def at(time):
        t = time - LAGS[scenario]
        return {
            name: np.array([np.interp(t, track[:, 0], track[:, axis]) for axis in (1, 2)])
            for name, track in tracks.items()
            if track[0, 0] <= t <= track[-1, 0]
        }

    return at


def ospa(truth, tracks, cut=20.0):
    """OSPA of order 2 (Schuhmacher, Vo & Vo 2008); NaN if there is nothing at all."""
    if len(truth) == 0 and len(tracks) == 0:
        return math.nan
    if len(truth) == 0 or len(tracks) == 0:
        return cut
    apart = np.linalg.norm(np.asarray(truth)[:, None] - np.asarray(tracks)[None], axis=-1)
    squares = np.minimum(apart, cut) ** 2
    total = squares[linear_sum_assignment(squares)].sum()
    total += cut**2 * abs(len(truth) - len(tracks))
    return math.sqrt(total / max(len(truth), len(tracks)))


def score(scenario, tracked):
    """OSPA, share of the time tracked within 15 m, switches of identity, and false scans.

    `tracked` has, for each scan, a dictionary of position and speed by track. What stands still
    and is not near a boat is shore, a moored boat or a buoy; the truth does not have these, so
    they are left out. A track is false where it moves faster than 0.5 m/s on average over its
    life and is not within 20 m of a boat.
    """
    scans, at = scans_of(scenario), truth_of(scenario)
    first, last = {}, {}
    for scan, found in zip(scans, tracked, strict=True):
        for name, position in found.items():
            first.setdefault(name, (scan.time, position))
            last[name] = scan.time, position
    moving = {
        name
        for name in first
        if math.dist(first[name][1], last[name][1]) > 0.5 * max(last[name][0] - first[name][0], 1.0)
    }
    values, near, possible, switches, false, seen = [], 0, 0, 0, 0, {}
    for scan, found in zip(scans, tracked, strict=True):
        truth = at(scan.time)
        if not truth:
            continue
        close = {
            name
            for name, position in found.items()
            if min(math.dist(position, boat) for boat in truth.values()) < 20.0
        }
        values.append(
            ospa(list(truth.values()), [found[name] for name in found if name in close | moving])
        )
        false += len((found.keys() & moving) - close)
        possible += len(truth)
        names = list(found)
        apart = np.array([[math.dist(b, found[x]) for x in names] for b in truth.values()])
        apart = apart.reshape(len(truth), len(names))
        for boat, j in zip(*linear_sum_assignment(np.minimum(apart, 15.0)), strict=True):
            if apart[boat, j] < 15.0:
                near += 1
                name = list(truth)[boat]
                switches += seen.get(name, names[j]) != names[j]
                seen[name] = names[j]
    return float(np.mean(values)), near / possible, switches, false
