"""Stone Soup with its Kalman filter and with trackers of this package: ten targets in clutter.

    python -m benchmarks.stonesoup_clutter [--seeds 20] [--trackers omega-schedule,...]

Ten ships that turn, end and are followed by others, with fifty clutter plots in each of 60 scans;
the scene and its noise are those of `benchmarks.scan_rivals`. Everything else is Stone Soup's, and
the same for all: global nearest neighbor by Mahalanobis distance, gate, tracks confirmed by four
plots, deletion. Only predictor, updater and first states differ. All get the same plots, seed by
seed, so that differences are paired: their means with standard errors are against the Kalman
filter. OSPA has the cut-off 20 m and order 2.
"""

from __future__ import annotations

import argparse
import sys
from functools import partial

from benchmarks.scan_peers import Peer, stonesoup
from benchmarks.scan_rivals import SETTING, judged_by_seed, print_tables, traffic

#: Kalman filter of the plug-in, told the same; classical gains; rule bases.
TRACKERS = (
    f"kalman-cv:sigma_v={SETTING.acceleration}",
    "fixed:alpha=0.5:beta=0.2",
    "benedict-bordner:alpha=0.5",
    "stiffness-damping",
    "omega-schedule",
    "maneuver-two-rules",
    "maneuver",
)
SHIPS, SCANS = 10, 60


def peers(trackers: tuple[str, ...]) -> dict[str, Peer]:
    """Stone Soup with each of the trackers, first with its own Kalman filter."""
    found = {"Stone Soup Kalman": stonesoup("GNN")}
    return found | {text: stonesoup("GNN", text) for text in trackers}


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.stonesoup_clutter",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--scans", type=int, default=SCANS)
    parser.add_argument("--trackers", default=",".join(TRACKERS), help="commas between them")
    given = parser.parse_args(arguments)
    trackers = tuple(filter(None, given.trackers.split(",")))
    scene = partial(traffic, ships=SHIPS, scans=given.scans)
    print_tables(judged_by_seed(peers(trackers), given.seeds, scene=scene))
    return 0


if __name__ == "__main__":
    sys.exit(main())
