"""How well the noise of plots is estimated from the plots themselves.

    python -m benchmarks.noise_estimate [--tracks 100] [--repeats 40] [-o noise.json]

Random tracks with noise of a standard deviation of 1. Each estimate is from all tracks of a set
together; the first row of a set is one of them alone. The spread of estimates from different
tracks is what the standard error should be.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.ranking import Table, lines
from fuzzytrack.arrays import Array
from fuzzytrack.cli.output import progress, write_json
from fuzzytrack.errors import DataError
from fuzzytrack.io.noise_estimate import NoiseEstimate, estimate_noise
from fuzzytrack.simulation.published import ALL_SETS
from fuzzytrack.tuning import VARIANTS
from fuzzytrack.tuning.scored_plots import ScoredPlots, scored_plots

CONSTANT, JITTER = "constant T", "jitter"
#: What is done to plots under jitter, beside the variants of the ranking.
Fault = Callable[[Array, np.random.Generator], Array]


def missed(z: Array, rng: np.random.Generator) -> Array:
    return np.where(rng.random((*z.shape[:2], 1)) < 0.2, np.nan, z)


def spikes(z: Array, rng: np.random.Generator) -> Array:
    side = rng.choice([-50.0, 50.0], (*z.shape[:2], 1))
    return np.where(rng.random((*z.shape[:2], 1)) < 0.02, z + side, z)


def quantized(z: Array, rng: np.random.Generator) -> Array:
    return np.round(z)


FAULTS: dict[str, tuple[Fault, ...]] = {
    "20 % missed": (missed,),
    "2 % spikes of 50 σ": (spikes,),
    "both": (missed, spikes),
    "in whole σ": (quantized,),
}


@dataclass(frozen=True)
class Row:
    """Estimates of one kind of plots: their mean and spread, and their standard error as told."""

    name: str
    estimates: int
    failed: int
    mean: float
    spread: float
    error: float


def estimated(plots: ScoredPlots, z: Array) -> NoiseEstimate:
    scans, tracks, n_axes = z.shape
    time = plots.time if plots.time.ndim == 2 else plots.time[:, None]
    whose = np.broadcast_to(np.arange(tracks), (scans, tracks))
    times = np.broadcast_to(time, (scans, tracks))
    return estimate_noise(times.ravel(), z.reshape(-1, n_axes), whose.ravel())


def row(name: str, kind: str, tracks: int, repeats: int, faults: tuple[Fault, ...] = ()) -> Row:
    """Estimates from fresh tracks of a set in a variant, with faults."""
    variant = VARIANTS[JITTER] if faults else VARIANTS[kind]
    found, failed = [], 0
    for seed in range(repeats):
        plots, rng = scored_plots(name, variant, tracks, seed), np.random.default_rng(seed)
        z = plots.z
        for fault in faults:
            z = fault(z, rng)
        try:
            found.append(estimated(plots, z))
        except DataError:
            failed += 1
    sigma = np.array([each.pooled for each in found])
    errors = np.array([each.pooled_error for each in found])
    title = f"{name}, {kind}" + (", one track" if tracks == 1 else "")
    told = float(np.sqrt((errors**2).mean()))
    return Row(title, len(found), failed, float(sigma.mean()), float(sigma.std(ddof=1)), told)


def rows(tracks: int, repeats: int) -> Iterator[Row]:
    for name in ALL_SETS:
        yield row(name, CONSTANT, 1, repeats)
        for kind in VARIANTS:
            if not kind.startswith("told"):
                yield row(name, kind, tracks, repeats)
        for kind, faults in FAULTS.items():
            yield row(name, kind, tracks, repeats, faults)


def table(found: list[Row]) -> Table:
    return [
        ["", "estimate", "spread", "standard error", "none"],
        *(
            [r.name, f"{r.mean:.3f}", f"{r.spread:.3f}", f"{r.error:.3f}", str(r.failed or "")]
            for r in found
        ),
    ]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.noise_estimate",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--tracks", type=int, default=100, help="of an estimate")
    parser.add_argument("--repeats", type=int, default=40, help="estimates of a row, at least 2")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json", help="write all figures")
    given = parser.parse_args(arguments)
    found: list[Row] = []
    kinds = sum(not kind.startswith("told") for kind in VARIANTS)
    total = len(ALL_SETS) * (1 + kinds + len(FAULTS))
    with progress("estimating") as watch:
        for each in rows(given.tracks, given.repeats):
            found.append(each)
            watch(len(found) / total)
    print("\n".join(lines(table(found))))
    if given.output:
        write_json(given.output, [vars(each) for each in found], 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
