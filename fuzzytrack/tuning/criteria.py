"""Criteria of tuning: what is summed over plots, and how two trackers are compared by it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.tuning.data import Batch

__all__ = ["CRITERIA", "Change", "Criterion", "Likelihood", "RmsError"]

#: A change, and the ends of its 95 % interval.
Change = tuple[float, float, float]


class Criterion(ABC):
    """What is summed over the scored plots, and how two trackers are compared by it.

    Attributes
    ----------
    unit : str
        Of the value that is shown.
    """

    unit: ClassVar[str]

    @abstractmethod
    def terms(self, tracker: Tracker, batch: Batch) -> Array:
        """What each plot adds to the sum, shape (n_steps, n_tracks); anything where none is scored.

        Infinite where the tracker makes no prediction.
        """

    @abstractmethod
    def value(self, total: float, plots: int) -> float:
        """Value that is shown of a sum over some plots; less is better."""

    @abstractmethod
    def loss(self, total: float, plots: int) -> float:
        """Value that is minimized."""

    @abstractmethod
    def change(self, tuned: Array, other: Array, plots: NDArray[np.int64]) -> Change:
        """Change of the value from another tracker to the tuned one, with a 95 % interval.

        Parameters
        ----------
        tuned, other : ndarray, shape (n_units,)
            Sums of both in each unit.
        plots : ndarray of int, shape (n_units,)
            Plots of each unit.

        Notes
        -----
        Jackknife over units, with Student's t. Both saw the same plots, so the interval is that of
        paired differences.
        """

    @abstractmethod
    def written(self, change: Change) -> str:
        """A change with its interval, as text."""


class RmsError(Criterion):
    """Root mean square of prediction minus truth or, without truth, minus plot (m)."""

    unit = "m"

    def terms(self, tracker: Tracker, batch: Batch) -> Array:
        """See `Criterion.terms`: squared distances."""
        if isinstance(tracker, LaneTracker):
            # In one thread, since the code is shared; other processors run other trials.
            result = tracker.run(
                batch.time, batch.plots, batch.sigma, keep=("predicted",), threads=1
            )
        else:
            result = tracker.run(batch.time, batch.plots, batch.sigma)
        with np.errstate(over="ignore", invalid="ignore"):
            return _finite(((result.predicted - batch.target) ** 2).sum(axis=-1))

    def value(self, total: float, plots: int) -> float:
        """See `Criterion.value`: the RMS error."""
        return math.sqrt(total / plots)

    def loss(self, total: float, plots: int) -> float:
        """See `Criterion.loss`: the logarithm of the RMS error."""
        return 0.5 * math.log(total / plots) if total > 0 else -math.inf

    def change(self, tuned: Array, other: Array, plots: NDArray[np.int64]) -> Change:
        """See `Criterion.change`: relative."""
        if not (np.isfinite(tuned).all() and np.isfinite(other).all()):
            whole = -1.0 if np.isfinite(tuned).all() else math.inf
            return whole, whole, whole
        ratio = 0.5 * math.log(tuned.sum() / other.sum())
        without = 0.5 * np.log((tuned.sum() - tuned) / (other.sum() - other))
        low, middle, high = (math.expm1(x) for x in _interval(ratio, without))
        return middle, low, high

    def written(self, change: Change) -> str:
        """See `Criterion.written`: in percent."""
        middle, low, high = (100 * x for x in change)
        return f"{middle:+.1f} % ({low:+.1f} to {high:+.1f})"


class Likelihood(Criterion):
    """Negative logarithm of the likelihood of a plot, with normal innovations (nats).

    It needs a tracker that keeps the variance of its innovations, see
    `fuzzytrack.trackers.prediction.Prediction`. Each track is followed step by step, which takes
    longer than a run.
    """

    unit = "nats a plot"

    def terms(self, tracker: Tracker, batch: Batch) -> Array:
        """See `Criterion.terms`: ½ Σ (e²/S + ln 2πS) over the axes."""
        if not isinstance(tracker, LaneTracker):
            return np.full(batch.scored.shape, math.inf)
        found = np.full(batch.scored.shape, math.inf)
        state = None
        for k, (t, z) in enumerate(zip(batch.time, batch.plots, strict=True)):
            sigma = None if batch.sigma is None else batch.sigma[k]
            if state is None:
                state = tracker.start(z, t, sigma)
                continue
            with np.errstate(all="ignore"):
                predicted = tracker.predict(state, t, sigma)
                variance = predicted.innovation_variance
                squares = (z - predicted.position) ** 2 / variance
                found[k] = 0.5 * (squares + np.log(2 * math.pi * variance)).sum(axis=-1)
            state = tracker.step(state, z, t, sigma)
        return _finite(found)

    def value(self, total: float, plots: int) -> float:
        """See `Criterion.value`: the mean."""
        return total / plots

    def loss(self, total: float, plots: int) -> float:
        """See `Criterion.loss`: the mean."""
        return total / plots

    def change(self, tuned: Array, other: Array, plots: NDArray[np.int64]) -> Change:
        """See `Criterion.change`: the difference."""
        if not np.isfinite(tuned - other).all():
            whole = -math.inf if np.isfinite(tuned).all() else math.inf
            return whole, whole, whole
        difference, count = tuned - other, plots.sum()
        without = (difference.sum() - difference) / (count - plots)
        low, middle, high = _interval(float(difference.sum() / count), without)
        return middle, low, high

    def written(self, change: Change) -> str:
        """See `Criterion.written`."""
        middle, low, high = change
        return f"{middle:+.3f} ({low:+.3f} to {high:+.3f})"


#: Criteria by the names that users write.
CRITERIA: dict[str, Criterion] = {"rms": RmsError(), "likelihood": Likelihood()}


def _finite(terms: Array) -> Array:
    return np.where(np.isfinite(terms), terms, math.inf)


def _interval(middle: float, without: Array) -> tuple[float, float, float]:
    """Value with the ends of its 95 % interval, from the values without each of the units."""
    from scipy.stats import t

    count = len(without)
    spread = math.sqrt((count - 1) / count * float(((without - without.mean()) ** 2).sum()))
    reach = float(t.ppf(0.975, count - 1)) * spread
    return middle - reach, middle, middle + reach
