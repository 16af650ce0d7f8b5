"""Plots that the checks track, and how they compare what comes out."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import TrackState

__all__ = [
    "AXES", "SIGMA", "STEPS", "TRACKS", "arrays", "expect", "expect_refused", "expect_same",
    "sample_plots",
]  # fmt: skip

STEPS, TRACKS, AXES = 24, 5, 2
#: Standard deviation of the plots (m).
SIGMA = 10.0


def expect(holds: bool, promise: str) -> None:
    """Raise AssertionError with the promise, unless it holds."""
    if not holds:
        raise AssertionError(promise)


def expect_refused(call: Callable[[], Any], what: str) -> None:
    """Raise AssertionError unless a call raises ValueError."""
    try:
        call()
    except ValueError:
        return
    raise AssertionError(f"{what} must raise ValueError")


def sample_plots(seed: int) -> tuple[Array, Array]:
    """Irregular times, and noisy turning tracks with missed plots, also in one axis alone."""
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.5, 2.0, STEPS))
    angle = np.outer(times, random.uniform(-0.1, 0.1, TRACKS))
    plots = 1e3 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    plots += random.normal(0.0, SIGMA, plots.shape)
    plots[random.random((STEPS, TRACKS)) < 0.15] = np.nan
    plots[9:12, 0] = np.nan
    plots[:2, 1] = np.nan
    plots[7, 2, 0] = np.nan
    return times, plots


def arrays(result: TrackResult | TrackState) -> dict[str, Array]:
    """All arrays of a result, or of a state under the same names."""
    names = ("predicted", "velocity", "acceleration", "innovation")
    found = {name: getattr(result, name) for name in names}
    position = result.filtered if isinstance(result, TrackResult) else result.position
    gains = result.gains
    return {
        **found, "filtered": position,
        "alpha": gains.alpha, "beta": gains.beta, "gamma": gains.gamma,
    }  # fmt: skip


def expect_same(one: dict[str, Array], other: dict[str, Array], promise: str) -> None:
    """Raise AssertionError with the promise if an array differs, NaN being equal to NaN."""
    for name, array in one.items():
        expect(np.array_equal(array, other[name], equal_nan=True), f"{promise}: {name} differs")
