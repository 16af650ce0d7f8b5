"""How long metrics of 50 objects over 100 instants take, beside Stone Soup and py-motmetrics.

    python -m benchmarks.scoring [--repeats N]

Peers that are not installed are left out. Two scenes: objects far from each other, where most pairs
have no rival, and objects in a crowd, where all of them are one problem.
"""

from __future__ import annotations

import argparse
import statistics
import time
import warnings
from datetime import datetime, timedelta

import numpy as np

from fuzzytrack.scoring import Positions, Settings, score
from fuzzytrack.scoring.clear_mot import clear_mot
from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.correspondences import Correspondences
from fuzzytrack.scoring.hota import hota
from fuzzytrack.scoring.idf1 import idf1
from fuzzytrack.scoring.instants import Timing, make_scene
from fuzzytrack.scoring.metrics import evaluate
from fuzzytrack.scoring.ospa import SetAssignment, ospa
from fuzzytrack.scoring.ospa2 import ospa2
from fuzzytrack.scoring.siap import nearest_objects, siap

OBJECTS, INSTANTS, CUTOFF = 50, 100, 20.0


def positions(spread: float, seed: int = 1) -> tuple[Positions, Positions]:
    """Objects that move steadily in a square, and tracks of nine tenths of their positions."""
    rng = np.random.default_rng(seed)
    start, speed = rng.uniform(0, spread, (OBJECTS, 2)), rng.normal(0, 3, (OBJECTS, 2))
    k = np.arange(INSTANTS)
    place = start + speed * k[:, None, None]
    time_, id = np.repeat(k.astype(float), OBJECTS), np.tile(np.arange(OBJECTS), INSTANTS)
    flat = place.reshape(-1, 2)
    seen = rng.random(len(flat)) < 0.9
    noisy = flat + rng.normal(0, 3, flat.shape)
    truth = Positions.make("truth", time_, id, flat)
    tracks = Positions.make("tracks", time_[seen], id[seen], noisy[seen])
    return tracks, truth


def median_ms(run, repeats: int) -> float:
    """Median of the times of some calls (ms), after one that is not counted."""
    run()
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    return 1000 * statistics.median(times)


def ours(tracks: Positions, truth: Positions) -> dict[str, object]:
    """Calls to be timed, by what they compute."""
    scene = make_scene(tracks, truth, Timing())
    near = ClosePairs.of(scene, CUTOFF)

    def set_distance() -> object:
        return ospa(SetAssignment.of(scene, ClosePairs.of(scene, CUTOFF), CUTOFF, 2.0))

    return {
        "OSPA": set_distance,
        "OSPA(2)": lambda: ospa2(scene, near, CUTOFF, 2.0, 10),
        "CLEAR MOT": lambda: clear_mot(scene, Correspondences.of(scene, near, 15.0)),
        "IDF1": lambda: idf1(scene, near, 15.0),
        "HOTA": lambda: hota(scene, near, CUTOFF),
        "SIAP": lambda: siap(scene, nearest_objects(near, 15.0)),
        "all metrics of a scene": lambda: evaluate(scene, Settings()),
        "score, from arrays": lambda: score(tracks, truth),
    }


def stone_soup(tracks: Positions, truth: Positions):
    """OSPA by Stone Soup, or None if that is not installed."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            from stonesoup.metricgenerator.ospametric import OSPAMetric
            from stonesoup.types.state import State
    except ImportError:
        return None
    begin = datetime(2000, 1, 1)

    def states(given: Positions) -> list[object]:
        return [
            State(place[:, None], timestamp=begin + timedelta(seconds=t))
            for t, place in zip(given.time.tolist(), given.position, strict=True)
        ]

    there, found = states(truth), states(tracks)
    metric = OSPAMetric(c=CUTOFF, p=2)
    return lambda: metric.compute_over_time(found, range(len(found)), there, range(len(there)))


def motmetrics(tracks: Positions, truth: Positions):
    """CLEAR MOT by py-motmetrics, or None if that is not installed."""
    try:
        import motmetrics as mm
    except ImportError:
        return None
    scene = make_scene(tracks, truth, Timing())

    def run():
        found = mm.MOTAccumulator(auto_id=True)
        for k in range(INSTANTS):
            a, b = scene.truth.instant == k, scene.tracks.instant == k
            apart = np.hypot(*(scene.truth.position[a][:, None] - scene.tracks.position[b]).T).T
            apart[apart > 15.0] = np.nan
            found.update(scene.truth.id[a], scene.tracks.id[b], apart)
        return mm.metrics.create().compute(found, metrics=["mota", "motp"])

    return run


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=21)
    repeats = parser.parse_args().repeats
    scenes = {"far apart": positions(3000.0), "crowd": positions(60.0)}
    print(f"{OBJECTS} objects, {INSTANTS} instants; median of {repeats} calls, ms")
    for name, (tracks, truth) in scenes.items():
        print(f"\n{name}")
        for what, run in ours(tracks, truth).items():
            print(f"  {what:<28}{median_ms(run, repeats):9.2f}")
        for what, run in (
            ("Stone Soup: OSPA", stone_soup(tracks, truth)),
            ("py-motmetrics: CLEAR MOT", motmetrics(tracks, truth)),
        ):
            if run is not None:
                print(f"  {what:<28}{median_ms(run, 3):9.0f}")


if __name__ == "__main__":
    main()
