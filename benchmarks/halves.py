"""Trackers tuned on one half of a recorded track and judged on the other.

    python -m benchmarks.halves FOLDER [--runs 30] [--trials 300] [-o halves.json]

FOLDER is that of `benchmarks.recorded`, and so is the noise. Each tracker is measured on the second
half of a track with its own numbers, and tuned on the first half.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

import fuzzytrack as ft
from benchmarks.ranking import lines
from benchmarks.recorded import CASES, Case, change
from fuzzytrack.cli.output import progress, write_json
from fuzzytrack.io.recording import read_tracks
from fuzzytrack.json_types import plain
from fuzzytrack.tasks import Progress, part
from fuzzytrack.testbed.comparison import compare
from fuzzytrack.tuning.data import TuningData, TuningTrack

REFERENCE = "kalman-cv"


def specifications(case: Case) -> dict[str, str]:
    """Trackers as they are without tuning on this track; those of the random sets for the IMM."""
    sigma, period, level = case.conditions.sigma, case.conditions.period, case.conditions.level
    unit = level / 3.0
    return {
        "kalman-cv": f"kalman-cv:sigma_v={0.87 * sigma / period**2:.6g}",
        "imm (CV/CA)": f"imm:quiet_sigma={0.1 * unit:.6g}:maneuver_sigma={unit:.6g}",
        "imm-two": f"imm-two:level={level:g}",
        "imm-three": f"imm-three:level={level:g}",
        "maneuver-two-rules": f"maneuver-two-rules:level={level:g}",
        "maneuver": f"maneuver:level={level:g}",
    }


def measured(case: Case, folder: Path, runs: int, trials: int, watch: Progress) -> dict[str, Any]:
    """RMSE of the predictions in the second half, as they are and tuned on the first."""
    (track,) = read_tracks(folder / case.file, time="t_s", axes=["x_m", "y_m"]).tracks
    times, truth = track.time[:: case.every], track.plots[:: case.every]
    half, sigma = len(times) // 2, case.conditions.sigma
    noise = np.random.default_rng(7).normal(0.0, sigma, (runs, half, 2))
    first = TuningData(
        "first half",
        tuple(
            TuningTrack(str(k), times[:half], truth[:half] + each, truth[:half],
                        np.full((half, 2), sigma))
            for k, each in enumerate(noise)
        ),
    )  # fmt: skip
    trackers: dict[str, Any] = {}
    specs = specifications(case)
    for k, (name, spec) in enumerate(specs.items()):
        share = part(watch, 0.9 * k / len(specs), 0.9 * (k + 1) / len(specs))
        found = ft.tune(first, spec, folds=2, trials=trials, seed=1, progress=share)
        trackers[name], trackers[f"{name}, tuned"] = spec, found.tracker
    found = compare(trackers, times[half:], truth[half:], sigma, runs, 20, None)
    rmse = dict(zip(found.names, found.predicted_rmse.tolist(), strict=True))
    changes = {name: change(found, name, f"{REFERENCE}, tuned") for name in found.names}
    return {"scans": len(times) - half, "rmse": rmse, "changes": changes}


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.halves",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--runs", type=int, default=30, help="of simulated noise")
    parser.add_argument("--trials", type=int, default=300, help="trackers that a search tries")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    given = parser.parse_args(arguments)
    cases = {}
    with progress("tuning") as watch:
        for k, (name, case) in enumerate(CASES.items()):
            share = part(watch, k / len(CASES), (k + 1) / len(CASES))
            cases[name] = measured(case, given.folder, given.runs, given.trials, share)
    heads = [f"{name}, {head}" for name in cases for head in ("m", f"% vs {REFERENCE}, tuned")]
    rows = [["", *heads]]
    for name in next(iter(cases.values()))["rmse"]:
        cells = [name]
        for case in cases.values():
            ratio, error = case["changes"][name]
            cells += [f"{case['rmse'][name]:.4g}", f"{100 * ratio:+.1f} ± {100 * error:.1f}"]
        rows.append(cells)
    print("\n".join(lines(rows)))
    if given.output:
        write_json(given.output, plain({"runs": given.runs, "cases": cases}), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
