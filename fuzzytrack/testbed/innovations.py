"""Innovations of a tracker on recorded plots, and what they say without any truth."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError, TrackWarning
from fuzzytrack.io.recording import Track
from fuzzytrack.recordings.ragged import batches, run_tracks, sigmas_of
from fuzzytrack.reprs import summary
from fuzzytrack.testbed.metrics import squared_distance
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["Innovations", "Positions", "Whiteness", "expected_outside", "positions_of"]

#: Predicted deviations from which on a plot is outside.
_FAR = 3.0


@dataclass(frozen=True, eq=False)
class Positions:
    """What a tracker makes of all plots of all tracks, one track after the other.

    Attributes
    ----------
    predicted, filtered : ndarray, shape (n_plots, n_axes)
        Positions (m); NaN where there is none yet, infinite throughout where a track cannot be
        followed with numbers.
    variance : ndarray or None, shape (n_plots, n_axes)
        Predicted variance of each innovation (m²); None if the tracker predicts none.
    """

    predicted: Array
    filtered: Array
    variance: Array | None

    def __repr__(self) -> str:
        return summary(self, "predicted", variance=self.variance is not None)


def positions_of(tracker: Tracker, tracks: Sequence[Track]) -> Positions:
    """Run a tracker over recorded tracks.

    Parameters
    ----------
    tracker : Tracker
    tracks : sequence of Track
        Plots that are used; each with its noise, or none of them.

    Raises
    ------
    ValueError
        If the tracker needs the noise, and it is not known.
    """
    pairs = [(track.time, track.plots) for track in tracks]
    sigmas = sigmas_of(tracks)
    keep = ("predicted", "filtered") if isinstance(tracker, LaneTracker) else None
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            # The table shows it if gains do not suit the times.
            warnings.simplefilter("ignore", TrackWarning)
            results = run_tracks(tracker, pairs, sigmas=sigmas, keep=keep)
            variance = _variances(tracker, tracks) if sigmas else None
    except DataError:
        lost = np.full((sum(map(len, (t for t, _ in pairs))), pairs[0][1].shape[1]), math.inf)
        return Positions(lost, lost, None)
    predicted = np.concatenate([result.predicted for result in results])
    return Positions(predicted, np.concatenate([r.filtered for r in results]), variance)


def _variances(tracker: Tracker, tracks: Sequence[Track]) -> Array | None:
    """Predicted variances of all innovations, step by step, since a run does not keep them."""
    if not isinstance(tracker, LaneTracker) or not _predicts_variance(tracker):
        return None
    total = sum(len(track.time) for track in tracks)
    gap = np.full((1, tracks[0].plots.shape[1]), np.nan)
    plots = np.concatenate([*(track.plots for track in tracks), gap])
    sigmas = np.concatenate([*(t.sigma for t in tracks if t.sigma is not None), gap])
    # A missed plot may have no noise; it is not used, but a number is needed.
    sigmas = np.where(np.isnan(plots), 1.0, sigmas)
    found = np.full((total + 1, plots.shape[1]), np.nan)
    for batch in batches([track.time for track in tracks]):
        state = None
        for t, rows in zip(batch.times, batch.places, strict=True):
            z, sigma = plots[rows], sigmas[rows]
            if state is None:
                state = tracker.start(z, t, sigma)
                continue
            found[rows] = tracker.predict(state, t, sigma).innovation_variance
            state = tracker.step(state, z, t, sigma)
    return found[:total]


def _predicts_variance(tracker: LaneTracker) -> bool:
    """Whether a tracker has a variance for the plots of a straight track."""
    straight = np.arange(4.0)[:, None]
    state = tracker.start(straight[0], 0.0, 1.0)
    for k in (1, 2):
        state = tracker.step(state, straight[k], float(k), 1.0)
    return bool(np.isfinite(tracker.predict(state, 3.0, 1.0).innovation_variance).all())


# -------------------------------------------------------------------- what they say


def expected_outside(n_axes: int) -> float:
    """Share of plots outside 3σ on some axis, of a tracker whose predicted variances are right."""
    return 1 - math.erf(_FAR / math.sqrt(2)) ** n_axes


@dataclass(frozen=True)
class Whiteness:
    """Correlation of each innovation with the one before.

    Attributes
    ----------
    correlation : float
        Positive where a tracker is late, negative where it overshoots; NaN without two in a row.
    reach : float
        In 95 % of recordings, innovations that do not depend on each other are between minus this
        and this.
    """

    correlation: float
    reach: float

    def __repr__(self) -> str:
        return summary(self, "correlation", "reach")


@dataclass(frozen=True, eq=False)
class Innovations:
    """Innovations at the plots that are scored, the plots of a track in order.

    Attributes
    ----------
    values : ndarray, shape (n_scored, n_axes)
        Plots minus predictions (m); infinite where a track cannot be followed.
    variance : ndarray or None, shape (n_scored, n_axes)
        Predicted variance of each (m²), None where there is none.
    tracks : ndarray of int, shape (n_scored,)
        To which track each belongs.
    """

    values: Array
    variance: Array | None
    tracks: NDArray[np.int64]

    def __repr__(self) -> str:
        return summary(self, "values")

    @property
    def squares(self) -> Array:
        """Squared length of each (m²), shape (n_scored,)."""
        return squared_distance(self.values)

    @property
    def rms(self) -> float:
        """Root mean square of their lengths (m)."""
        return math.sqrt(float(self.squares.mean()))

    @property
    def log_likelihood(self) -> float:
        """Mean logarithm of the likelihood of a plot, normally distributed (nats); NaN without."""
        if self.variance is None:
            return math.nan
        terms = self.values**2 / self.variance + np.log(2 * math.pi * self.variance)
        return float(-0.5 * terms.sum(axis=1).mean())

    @property
    def outside(self) -> float:
        """Share of plots more than three predicted deviations off on some axis; NaN without."""
        if self.variance is None:
            return math.nan
        far: Mask = np.abs(self.values) > _FAR * np.sqrt(self.variance)
        return float(far.any(axis=1).mean())

    @property
    def whiteness(self) -> Whiteness:
        """Correlation of each with the one before in its track.

        Notes
        -----
        Its reach is that of independent innovations of any distribution, and of a size that may
        change: products of neighbors then have no mean, and are not correlated with each other.
        """
        follows = self.tracks[1:] == self.tracks[:-1]
        products = (self.values[1:] * self.values[:-1]).sum(axis=1)[follows]
        total = float((self.values**2).sum())
        if not len(products) or not 0 < total < math.inf:
            return Whiteness(math.nan, math.nan)
        reach = 1.96 * math.sqrt(float((products**2).sum())) / total
        return Whiteness(float(products.sum()) / total, reach)
