"""Tune the families of `fuzzytrack.tuning`, and print their numbers.

Those for all sets go into benchmarks/ranked.py. It takes about an hour.
"""

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np

from benchmarks.families import FAMILIES
from benchmarks.objective import prediction_mse
from fuzzytrack.simulation.published import TRACK_SETS, track_set
from fuzzytrack.tuning.parameters import Parameter, Space
from fuzzytrack.tuning.search import Search
from fuzzytrack.tuning.trial import REFUSED

TRACKS, SEED = 120, 1


def loss(family, numbers, sets):
    """Logarithm of the geometric mean of the RMSE over some sets of tracks."""
    try:
        tracker = family.make(numbers)
    except ValueError:
        return REFUSED
    means = [prediction_mse(tracker, tracks, SEED).mean() for tracks in sets]
    return float(np.log(means).mean() / 2)


def tuned(name, target, evaluations):
    names = TRACK_SETS if target == "all" else (target,)
    sets = [track_set(each, TRACKS, SEED) for each in names]
    family = FAMILIES[name]
    limits = zip(family.start, family.low, family.high, strict=True)
    space = Space(tuple(Parameter(f"number {k}", *each) for k, each in enumerate(limits)))
    search = Search(space, SEED, evaluations)
    while not search.finished:
        search.tell([loss(family, numbers, sets) for numbers in search.ask()])
    return search.best


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
