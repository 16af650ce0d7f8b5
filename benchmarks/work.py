"""What is tracked, and by which trackers."""

from __future__ import annotations

import importlib.util
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

import fuzzytrack as ft
from benchmarks.report import NotMeasured
from benchmarks.scale import Scale
from fuzzytrack.schedulers import GainScheduler

__all__ = [
    "ALPHA", "BETA", "LEVEL", "GivenGains", "difference", "fixed_tracker", "fuzzy_tracker",
    "maneuver_tracker", "plugin_tracker", "predictions", "times_and_plots", "updates_a_second",
    "warm",
]  # fmt: skip

Array = NDArray[np.float64]

ALPHA, BETA = 0.5377, 0.2018
#: The strongest maneuver that is expected of a target (m/s²).
LEVEL = 5.0
ROOT = Path(__file__).resolve().parents[1]


@cache
def fixed_tracker() -> ft.AlphaBetaTracker:
    """Fixed gains."""
    return ft.AlphaBetaTracker(ft.FixedGains(ALPHA, BETA))


@cache
def maneuver_tracker() -> ft.AlphaBetaTracker:
    """Gains from the covariance of a target that maneuvers as rules say."""
    return ft.AlphaBetaTracker(ft.FuzzyScheduler("maneuver", level=LEVEL))


@cache
def fuzzy_tracker(method: str = "exact") -> ft.AlphaBetaTracker:
    """Gains from 49 rules."""
    return ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("stiffness-damping"), method))


@dataclass(frozen=True)
class GivenGains(GainScheduler):
    """Gains that come with each track and axis: α in place of sigma, β after Benedict & Bordner."""

    needs_sigma = True
    uses_acceleration = False

    def kernel(self, n_axes):
        def given_gains(innovation, change, dt, sigma, memory):
            return sigma, sigma * sigma / (2.0 - sigma), 0.0, 1.0, memory

        return given_gains


@dataclass(frozen=True)
class BuiltInTwoSpeed(GainScheduler):
    """Kernel of the example plug-in as a built-in one is written: selects, and no `max`."""

    needs_sigma = True
    uses_acceleration = False

    threshold: float = 3.0
    hold: int = 4

    def initial_memory(self, n_axes):
        return (0.0,)

    def kernel(self, n_axes):
        threshold, hold = self.threshold, float(self.hold)

        def built_in_two_speed(innovation, change, dt, sigma, memory):
            size = innovation if innovation > 0.0 else -innovation
            left = memory[0] - 1.0
            left = left if left > 0.0 else 0.0
            left = hold if size > threshold * sigma else left
            alpha = 0.8 if left > 0.0 else 0.4
            beta = 0.6 if left > 0.0 else 0.1
            return alpha, beta, 0.0, 1.0, (left,)

        return built_in_two_speed


def plugin_tracker() -> ft.AlphaBetaTracker:
    """The scheduler of examples/plugin, as it stands there."""
    path = ROOT / "examples" / "plugin" / "fuzzytrack_two_speed" / "__init__.py"
    if not path.exists():
        raise NotMeasured("examples/plugin is not here")
    name = "fuzzytrack_two_speed"
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, path)
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
    return ft.AlphaBetaTracker(sys.modules[name].TwoSpeed())


def times_and_plots(
    tracks: int, steps: int, axes: int = 1, missed: float = 0.0, seed: int = 1
) -> tuple[Array, Array]:
    """Irregular times, and plots of random walks of shape (steps, tracks, axes).

    More tracks than 20,000 are copies of these; none of the first three plots of a track is missed.
    """
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.5, 1.5, steps))
    own = min(tracks, 20_000)
    walk = np.cumsum(random.normal(0.0, 10.0, (steps, own, axes)), axis=0)
    if missed:
        gone = random.random((steps, own, 1)) < missed
        gone[:3] = False
        walk[np.broadcast_to(gone, walk.shape)] = np.nan
    if own == tracks:
        return times, walk
    plots = np.empty((steps, tracks, axes))
    for first in range(0, tracks, own):
        part = plots[:, first : first + own]
        part[:] = walk[:, : part.shape[1]]
    return times, plots


def predictions(
    tracker: Any,
    times: Array,
    plots: Array,
    sigma: Any = None,
    *,
    threads: int | None = 1,
    dtype: DTypeLike = np.float64,
    out: Array | None = None,
) -> Array:
    """Predictions of a batch, and nothing else; in a new array unless there is one for them."""
    given = {"keep": ("predicted",)} if out is None else {"out": {"predicted": out}}
    return tracker.run(times, plots, sigma, threads=threads, dtype=dtype, **given).predicted


def warm(scale: Scale, tracker: Any, axes: int) -> None:
    """Have a tracker compiled, unless the jobs are tiny."""
    if scale.compiles:
        tracker.compile(axes)


def updates_a_second(plots: Array, seconds: float) -> float:
    """Million updates a second: an update is one axis of one track at one time."""
    return plots.size / seconds / 1e6


def difference(ours: Array, theirs: Array) -> float:
    """Largest difference of two results, over what both have."""
    both = np.isfinite(ours) & np.isfinite(theirs)
    if not both.any():
        raise ValueError("nothing to compare")
    return float(np.abs(ours - theirs)[both].max())
