"""Tune the families of `fuzzytrack.tuning`, and print their numbers.

Those for all sets go into benchmarks/ranked.py. It takes about an hour.
"""

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from fuzzytrack.simulation.published import TRACK_SETS, track_set
from fuzzytrack.tuning import FAMILIES, tune

TRACKS, SEED = 120, 1


def tuned(name, target, evaluations):
    names = TRACK_SETS if target == "all" else (target,)
    sets = [track_set(each, TRACKS, SEED) for each in names]
    return tune(FAMILIES[name], sets, SEED, evaluations)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("families", nargs="*", help="all of them unless given")
    parser.add_argument("--evaluations", type=int, default=40, help="for each number of a family")
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    chosen = given.families or [name for name, family in FAMILIES.items() if family.start]
    with ProcessPoolExecutor(given.jobs, get_context("spawn")) as pool:
        jobs = {}
        for name in chosen:
            evaluations = given.evaluations * len(FAMILIES[name].start)
            for target in (*TRACK_SETS, "all"):
                jobs[name, target] = pool.submit(tuned, name, target, evaluations)
        for name in chosen:
            print(f'    "{name}": {{')
            for target in (*TRACK_SETS, "all"):
                numbers = ", ".join(f"{x:.4g}" for x in jobs[name, target].result())
                print(f'        "{target}": ({numbers},),')
            print("    },", flush=True)


if __name__ == "__main__":
    sys.exit(main())
