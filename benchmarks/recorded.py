"""Every scheduler of the package on recorded tracks with simulated noise.

    python -m benchmarks.recorded FOLDER [--runs 60] [-o recorded.json]

FOLDER holds the recordings, which are not part of this package: ``adsb_turns/truth_1s.csv``, an
airliner that flies circuits, and ``uav_gps/uav_enu.csv``, a small UAV with hard turns; both have
the columns t_s (s), x_m and y_m (m). The recorded positions are taken as true, every fourth one of
the airliner. The noise is independent of plot to plot, and known to the trackers, as is the
strongest maneuver to expect. The numbers of the trackers are those of the random sets. There is one
track of each: the standard errors are those of the noise alone.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.ranked import Conditions, ranked
from benchmarks.ranking import AGAINST, KALMAN, Table, lines, markdown, rounded, shown
from benchmarks.work import ROOT
from fuzzytrack.cli.output import progress, write_json
from fuzzytrack.io.recording import read_tracks
from fuzzytrack.json_types import plain
from fuzzytrack.tasks import Progress, part
from fuzzytrack.testbed.comparison import Comparison, compare
from fuzzytrack.version import __version__


@dataclass(frozen=True)
class Case:
    """A recording, and what its plots are like.

    Attributes
    ----------
    file : str
        Below the folder of the recordings.
    every : int
        Which of the recorded positions are scans: every one, every second, ...
    conditions : Conditions
    """

    file: str
    every: int
    conditions: Conditions


CASES = {
    "ADS-B": Case("adsb_turns/truth_1s.csv", 4, Conditions(level=10.0, sigma=60.0, period=4.0)),
    "UAV": Case("uav_gps/uav_enu.csv", 1, Conditions(level=5.0, sigma=10.0, period=1.0)),
}


def measured(case: Case, folder: Path, runs: int, seed: int, watch: Progress) -> dict[str, Any]:
    """RMSE of the predictions (m) and paired changes, in plain types."""
    track, *others = read_tracks(folder / case.file, time="t_s", axes=["x_m", "y_m"]).tracks
    if others:
        raise SystemExit(f"error: {case.file}: holds more than one track")
    times, truth = track.time[:: case.every], track.plots[:: case.every]
    trackers = ranked(case.conditions)
    found = compare(trackers, times, truth, case.conditions.sigma, runs, seed, watch)
    return {
        "conditions": vars(case.conditions),
        "scans": len(times),
        "trackers": {name: spec.replace(f"{ROOT}/", "") for name, spec in trackers.items()},
        "rmse": dict(zip(found.names, found.predicted_rmse.tolist(), strict=True)),
        "changes": {
            reference: {name: change(found, name, reference) for name in found.names}
            for reference in (KALMAN, *AGAINST)
            if reference in trackers
        },
    }


def change(found: Comparison, name: str, reference: str) -> list[float]:
    """Relative change of the RMSE against a reference, and its standard error over runs."""
    mine, theirs = (found.predicted_mse[found.names.index(one)] for one in (name, reference))
    ratio = math.sqrt(mine.mean() / theirs.mean())
    spread = mine / mine.mean() - theirs / theirs.mean()
    return [ratio - 1, ratio * float(np.std(spread)) / (2 * math.sqrt(found.runs))]


def table(found: Mapping[str, Any]) -> Table:
    """RMSE and changes of all trackers, a head in front; the best in the first case first."""
    cases = found["cases"]
    heads = [f"{name}, {head}" for name in cases for head in ("m", f"% vs {KALMAN}")]
    first = next(iter(cases.values()))
    rows = [["", *heads]]
    for name in sorted(first["rmse"], key=lambda each: first["rmse"][each] or math.inf):
        cells = [name]
        for case in cases.values():
            rmse = case["rmse"][name]
            lost = rmse is None or rmse > 1e6
            cells += ["diverges" if lost else f"{rmse:.4g}", shown(case["changes"][KALMAN][name])]
        rows.append(cells)
    return rows


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.recorded",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--runs", type=int, default=60, help="of simulated noise")
    parser.add_argument("--seed", type=int, default=20)
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    parser.add_argument("--docs", action="store_true", help="write the table of docs/ranking.md")
    given = parser.parse_args(arguments)
    cases = {}
    with progress("tracking") as watch:
        for k, (name, case) in enumerate(CASES.items()):
            share = part(watch, k / len(CASES), (k + 1) / len(CASES))
            try:
                cases[name] = measured(case, given.folder, given.runs, given.seed, share)
            except OSError as error:
                raise SystemExit(f"error: {given.folder / case.file}: {error.strerror}") from None
    how = {"fuzzytrack": __version__, "runs": given.runs, "seed": given.seed}
    found = rounded(plain({**how, "cases": cases}))
    print("\n".join(lines(table(found))))
    if given.output:
        write_json(given.output, found, 1)
    if given.docs:
        (ROOT / "docs" / "ranking-recorded.txt").write_text(
            f"*{given.runs} runs, seed {given.seed}.*\n\n{markdown(table(found))}"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
