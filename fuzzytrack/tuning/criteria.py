"""Criteria of tuning: what is summed over plots, and how two trackers are compared by it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.tuning.data import Batch
from fuzzytrack.tuning.folds import Folds

__all__ = ["CRITERIA", "Change", "Criterion", "Likelihood", "RmsError"]

#: A change, and the ends of its 95 % interval.
Change = tuple[float, float, float]


class Criterion(ABC):
    """What is summed over the scored plots, and how two trackers are compared by it.

    The level of a tracker is a mean over groups of tracks, so that each of them counts alike; the
    level is minimized.
    """

    @abstractmethod
    def terms(self, tracker: Tracker, batch: Batch) -> Array:
        """What each plot adds to the sum, shape (n_steps, n_tracks); anything where none is scored.

        Infinite where the tracker makes no prediction.
        """

    @abstractmethod
    def level(self, total: Array, plots: Array) -> Array:
        """Level of sums over some plots; elementwise."""

    @abstractmethod
    def value(self, level: float) -> float:
        """Value that is shown of a level; less is better."""

    @abstractmethod
    def change(self, difference: float) -> float:
        """Change that is shown of a difference of levels."""

    @abstractmethod
    def written(self, change: Change) -> str:
        """A change with its interval, as text."""

    def levels(self, sums: Array, folds: Folds, units: NDArray[np.bool_]) -> float:
        """Mean level over the groups of some units.

        Parameters
        ----------
        sums : ndarray, shape (n_units,)
        folds : Folds
        units : ndarray of bool, shape (n_units,)
            Which units count.
        """
        groups = folds.group[units]
        total: Array = np.bincount(groups, sums[units]).astype(np.float64)
        plots: Array = np.bincount(groups, folds.plots[units]).astype(np.float64)
        there = plots > 0
        return float(self.level(total[there], plots[there]).mean())

    def compare(self, tuned: Array, other: Array, folds: Folds) -> Change:
        """Change from another tracker to the tuned one, with a 95 % interval.

        Parameters
        ----------
        tuned, other : ndarray, shape (n_units,)
            Sums of both in each unit.
        folds : Folds

        Notes
        -----
        Jackknife over the units of each group, with Student's t. Both saw the same plots, so the
        interval is that of paired differences.
        """
        if not (np.isfinite(tuned).all() and np.isfinite(other).all()):
            whole = self.change(-math.inf if np.isfinite(tuned).all() else math.inf)
            return whole, whole, whole
        from scipy.stats import t

        every = np.ones(len(tuned), dtype=np.bool_)

        def difference(units: NDArray[np.bool_]) -> float:
            return self.levels(tuned, folds, units) - self.levels(other, folds, units)

        variance, freedom = 0.0, 0
        for group in np.unique(folds.group):
            members = np.flatnonzero(folds.group == group)
            without = [difference(_all_but(every, unit)) for unit in members.tolist()]
            count = len(members)
            if count > 1:
                variance += (count - 1) ** 2 / count * float(np.var(without, ddof=1))
                freedom += count - 1
        reach = float(t.ppf(0.975, freedom)) * math.sqrt(variance)
        middle = difference(every)
        return self.change(middle), self.change(middle - reach), self.change(middle + reach)


def _all_but(units: NDArray[np.bool_], unit: int) -> NDArray[np.bool_]:
    rest = units.copy()
    rest[unit] = False
    return rest


class RmsError(Criterion):
    """Root mean square of prediction minus truth or, without truth, minus plot (m).

    Its level is the logarithm, so that a group counts by relative changes of its error.
    """

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

    def level(self, total: Array, plots: Array) -> Array:
        """See `Criterion.level`: the logarithm of the RMS error."""
        with np.errstate(divide="ignore"):
            return np.asarray(0.5 * np.log(total / plots))

    def value(self, level: float) -> float:
        """See `Criterion.value`: the RMS error, the geometric mean over groups."""
        return math.exp(level)

    def change(self, difference: float) -> float:
        """See `Criterion.change`: relative."""
        return math.expm1(difference)

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

    def level(self, total: Array, plots: Array) -> Array:
        """See `Criterion.level`: the mean."""
        return np.asarray(total / plots)

    def value(self, level: float) -> float:
        """See `Criterion.value`: the level itself."""
        return level

    def change(self, difference: float) -> float:
        """See `Criterion.change`: the difference itself."""
        return difference

    def written(self, change: Change) -> str:
        """See `Criterion.written`."""
        middle, low, high = change
        return f"{middle:+.3f} ({low:+.3f} to {high:+.3f})"


#: Criteria by the names that users write.
CRITERIA: dict[str, Criterion] = {"rms": RmsError(), "likelihood": Likelihood()}


def _finite(terms: Array) -> Array:
    return np.where(np.isfinite(terms), terms, math.inf)
