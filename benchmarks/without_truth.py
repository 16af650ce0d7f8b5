"""Whether comparison without truth tells what the truth would, and how often its intervals cover.

    python -m benchmarks.without_truth [--recordings 50] [--repeats 1000] [-o without_truth.json]

Ranking: twelve trackers on simulated recordings of 30 tracks, from the random sets under regular
and irregular conditions, as ``fuzzytrack compare`` compares them with estimated noise. Kendall's τ
between their order by the RMS of innovations and by the RMSE of predictions, on the same plots.

Coverage: how often the interval of the change against the first tracker holds the true change, that
of a simulation a thousand times as large. Recordings of many short tracks, and of few long ones.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.ranked import Conditions, ranked
from benchmarks.ranking import Table, lines
from fuzzytrack.arrays import Array
from fuzzytrack.cli.output import progress, write_json
from fuzzytrack.json_types import plain
from fuzzytrack.tasks import Progress
from fuzzytrack.testbed import compare_recorded
from fuzzytrack.testbed.block_bootstrap import rms_change
from fuzzytrack.testbed.metrics import squared_distance
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.tuning import VARIANTS
from fuzzytrack.tuning.scored_plots import scored_plots

#: The trackers that are ranked; the first is that of the intervals.
TRACKERS = (
    "maneuver", "imm-two", "imm-three", "omega-schedule", "stiffness-damping", "chan-style",
    "fixed (published)", "fixed .543 .548", "Kalman CV", "Benedict-Bordner (tuned)",
    "fading memory (tuned)", "window search (tuned)",
)  # fmt: skip
SETS = ("mixed", "strong", "weaving")
CONDITIONS = ("constant T", "jitter", "Pd.7", "burst", "sigma/plot")
#: Those of the intervals, of every kind and far apart as well as close.
COVERED = (
    "maneuver", "imm-two", "omega-schedule", "fixed .543 .548", "Kalman CV", "stiffness-damping",
)  # fmt: skip
# Tracks of a recording that is ranked, and recordings of the true changes.
_TRACKS, _TRUE = 30, 1000


def _specs(names: tuple[str, ...]) -> dict[str, str]:
    every = ranked(Conditions())
    return {name: every[name] for name in names}


# -------------------------------------------------------------------- ranking


@dataclass(frozen=True)
class Order:
    """Orders of the trackers on one recording."""

    name: str
    tau: float
    best_is_best: bool
    innovations: dict[str, float]
    errors: dict[str, float]


def orders(recordings: int, seed: int, watch: Progress) -> Iterator[Order]:
    from scipy.stats import kendalltau

    for number in range(recordings):
        kind, variant = SETS[number % 3], CONDITIONS[number % 5]
        plots = scored_plots(kind, VARIANTS[variant], _TRACKS, seed + number)
        found = compare_recorded(
            _specs(TRACKERS), _columns(plots.time, plots.z, plots.truth), id="id",
            axes=("x", "y"), truth="true_x,true_y",
        )  # fmt: skip
        rms = {score.name: score.rms for score in found.scores}
        true = {score.name: score.true.predicted for score in found.scores if score.true}
        tau = float(kendalltau(list(rms.values()), list(true.values())).statistic)
        best = min(rms, key=rms.__getitem__) == min(true, key=true.__getitem__)
        yield Order(f"{kind}, {variant}", tau, best, rms, true)
        watch((number + 1) / recordings)


def _columns(time: Array, z: Array, truth: Array) -> dict[str, Array]:
    """A recording as columns, the rows of each track in order."""
    steps, tracks = z.shape[:2]
    times = np.broadcast_to(time if time.ndim == 2 else time[:, None], (steps, tracks))
    rows = {"t": times.T.ravel(), "id": np.repeat(np.arange(tracks), steps)}
    for name, positions in (("", z), ("true_", truth)):
        for axis, values in zip("xy", np.moveaxis(positions, 2, 0), strict=True):
            rows[name + axis] = values.T.ravel()
    return rows


# -------------------------------------------------------------------- coverage


@dataclass(frozen=True)
class Kind:
    """Recordings of one kind: a random set, or "long" tracks of some plots."""

    name: str
    tracks: int
    plots: int = 0

    def __str__(self) -> str:
        return f"{self.name}, {self.tracks} × {self.plots or 'all'}"


KINDS = (
    Kind("mixed", 25), Kind("mixed", 10), Kind("strong", 40), Kind("weaving", 25),
    Kind("long", 20, 200), Kind("long", 5, 400), Kind("long", 2, 1000), Kind("long", 1, 2000),
    Kind("long", 1, 500),
)  # fmt: skip


def wandering(steps: int, tracks: int, rng: np.random.Generator) -> Array:
    """Positions of targets that fly straight and maneuver in turns, shape (steps, tracks, 2)."""
    found = np.empty((steps, tracks, 2))
    position, velocity = np.zeros((tracks, 2)), 10 * rng.standard_normal((tracks, 2))
    acceleration, left = np.zeros((tracks, 2)), np.zeros(tracks)
    for k in range(steps):
        maneuvers, course = rng.random(tracks) < 0.4, 2 * np.pi * rng.random(tracks)
        size = np.where(maneuvers, 3 * rng.random(tracks), 0.0)
        change = size[:, None] * np.stack([np.cos(course), np.sin(course)], axis=1)
        begins = left <= 0
        acceleration = np.where(begins[:, None], change, acceleration)
        left = np.where(begins, rng.geometric(np.where(maneuvers, 0.1, 0.04)), left) - 1
        found[k] = position
        position = position + velocity + acceleration / 2
        velocity = velocity + acceleration
    return found


def squares(kind: Kind, recordings: int, seed: int) -> Array:
    """Squared innovations, shape (n_trackers, recordings, tracks, plots)."""
    tracks, first = kind.tracks * recordings, 2
    if kind.plots:
        rng = np.random.default_rng(seed)
        truth = wandering(kind.plots, tracks, rng)
        time, z = np.arange(float(kind.plots)), truth + rng.standard_normal(truth.shape)
    else:
        plots = scored_plots(kind.name, VARIANTS["constant T"], tracks, seed)
        time, z, first = plots.time, plots.z, int(plots.scored[:, 0].argmax())
    found = []
    for spec in _specs(COVERED).values():
        predicted = make_tracker(spec).run(time, z, 1.0).predicted
        each = squared_distance(z - predicted)[first:]
        found.append(each.T.reshape(recordings, kind.tracks, -1))
    return np.array(found)


def true_changes(kind: Kind, recordings: int, seed: int) -> Array:
    """Change of the RMS against the first tracker over many recordings, in parts for memory."""
    size = min(recordings, max(1, 400_000 // (kind.tracks * (kind.plots or 60))))
    parts = range(0, recordings, size)
    sums = sum(squares(kind, size, seed + k).mean(axis=(1, 2, 3)) for k in parts)
    return np.asarray(np.sqrt(sums / sums[0]) - 1)


@dataclass(frozen=True)
class Coverage:
    """Share of intervals that hold the true change, and their median width, in percent."""

    kind: str
    repeats: int
    true: dict[str, float]
    covered: dict[str, float]
    width: dict[str, float]

    @property
    def mean(self) -> float:
        return float(np.mean(list(self.covered.values())))


def coverage(kind: Kind, repeats: int, seed: int) -> Coverage:
    errors = squares(kind, repeats, seed)
    true = true_changes(kind, _TRUE, seed + 10_000)
    whose = np.repeat(np.arange(errors.shape[2]), errors.shape[3])
    covered, width = {}, {}
    for name, second, change in zip(COVERED[1:], errors[1:], true[1:].tolist(), strict=True):
        found = [
            rms_change(one.ravel(), two.ravel(), whose, seed=k)
            for k, (one, two) in enumerate(zip(errors[0], second, strict=True))
        ]
        covered[name] = 100 * float(np.mean([each.low <= change <= each.high for each in found]))
        width[name] = 100 * float(np.median([each.high - each.low for each in found]))
    known = dict(zip(COVERED[1:], (100 * true[1:]).tolist(), strict=True))
    return Coverage(str(kind), repeats, known, covered, width)


# -------------------------------------------------------------------- command


def order_table(found: list[Order]) -> Table:
    rows = [["", "mean τ", "least τ", "same best"]]
    groups = {"all": found}
    for order in found:
        for name in order.name.split(", "):
            groups.setdefault(name, []).append(order)
    for name, group in groups.items():
        taus = [order.tau for order in group]
        best = sum(order.best_is_best for order in group)
        rows.append([name, f"{np.mean(taus):.3f}", f"{min(taus):.3f}", f"{best} of {len(group)}"])
    return rows


def coverage_table(found: list[Coverage]) -> Table:
    rows = [["covered, % (width, %)", "mean", *COVERED[1:]]]
    for each in found:
        cells = [f"{each.covered[n]:.1f} ({each.width[n]:.3g})" for n in COVERED[1:]]
        rows.append([each.kind, f"{each.mean:.1f}", *cells])
    return rows


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.without_truth",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--recordings", type=int, default=50, help="that are ranked")
    parser.add_argument("--repeats", type=int, default=1000, help="intervals of each kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    given = parser.parse_args(arguments)
    with progress("ranking") as watch:
        ranking = list(orders(given.recordings, given.seed, watch))
    print("\n".join(lines(order_table(ranking))))
    covered: list[Coverage] = []
    with progress("covering") as watch:
        for number, kind in enumerate(KINDS):
            covered.append(coverage(kind, given.repeats, given.seed + 1))
            watch((number + 1) / len(KINDS))
    print("\n".join(lines(coverage_table(covered))))
    if given.output:
        told: dict[str, Any] = {
            "ranking": [vars(each) for each in ranking],
            "coverage": [vars(each) for each in covered],
        }
        write_json(given.output, plain(told), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
