"""The search for the parameters of a family of trackers on sets of tracks."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.simulation.published import TrackSet
from fuzzytrack.tasks import Progress
from fuzzytrack.tuning.families import Family
from fuzzytrack.tuning.objective import prediction_mse

__all__ = ["tune"]


def tune(
    family: Family,
    sets: Sequence[TrackSet],
    seed: int,
    evaluations: int = 200,
    progress: Progress | None = None,
) -> tuple[float, ...]:
    """Parameters with the least geometric mean of the RMSE over some sets of tracks.

    Parameters
    ----------
    family : Family
        With at least one parameter to tune.
    sets : sequence of TrackSet
    seed : int
        Seed of the noise.
    evaluations : int
        Number of trackers to try.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    tuple of float

    Notes
    -----
    Nelder and Mead's simplex over the logarithms of the parameters; it finds a local optimum.
    """
    from scipy.optimize import minimize

    low, high = np.log(family.low), np.log(family.high)
    tried = 0

    def numbers(place: Array) -> tuple[float, ...]:
        inside = np.clip(place, 0.0, 1.0)
        return tuple(float(x) for x in np.exp(low + inside * (high - low)))

    def loss(place: Array) -> float:
        nonlocal tried
        tried += 1
        if progress is not None:
            progress(min(1.0, tried / evaluations))
        try:
            tracker = family.make(numbers(place))
        except ValueError:
            return math.inf
        means = [prediction_mse(tracker, tracks, seed).mean() for tracks in sets]
        # A place outside the limits is scored as the edge, plus a penalty that grows with distance.
        outside = np.abs(place - np.clip(place, 0.0, 1.0)).sum()
        return float(np.log(means).mean() / 2 + outside)

    start = (np.log(family.start) - low) / (high - low)
    simplex = np.vstack([start, *(start + 0.15 * row for row in np.eye(len(start)))])
    found = minimize(
        loss,
        start,
        method="Nelder-Mead",
        options={"maxfev": evaluations, "initial_simplex": simplex, "xatol": 1e-3, "fatol": 1e-5},
    )
    return numbers(found.x)
