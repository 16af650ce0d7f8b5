"""Plots of a set of random tracks, and the errors of a tracker that predicts them."""

from __future__ import annotations

import warnings
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError, TrackWarning
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.published import ALL_SETS, track_set
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.tuning.variants import Variant

__all__ = ["ScoredPlots", "scored_plots", "squared_errors"]


@dataclass(frozen=True, eq=False)
class ScoredPlots:
    """Plots of a set of tracks, and which of their predictions are scored.

    Attributes
    ----------
    time : ndarray, shape (n_steps,) or (n_steps, n_tracks)
        Times of the scans, common or each track's own.
    truth, z, sigma : ndarray, shape (n_steps, n_tracks, 2)
        True positions, plots, and the standard deviations that a tracker is told; NaN where a plot
        is missed.
    scored : ndarray of bool, shape (n_steps, n_tracks)
        Scans with a plot, from the first scored scan of the set and the third plot of the track on.
    """

    time: Array
    truth: Array
    z: Array
    sigma: Array
    scored: Mask

    def __repr__(self) -> str:
        return summary(self, "time", "truth")


def scored_plots(name: str, variant: Variant, tracks: int, seed: int) -> ScoredPlots:
    """Plots of a set of tracks under the conditions of a variant.

    Parameters
    ----------
    name : {"report", "mixed", "strong", "weaving"}
        Set of tracks, see `fuzzytrack.simulation.published.track_set`.
    variant : Variant
        When plots come, and how good they are.
    tracks : int
        Number of tracks.
    seed : int
        Seed, not negative. Tracks and noise of each set have streams of their own. Variants have
        the same tracks.
    """
    motion, noise = np.random.SeedSequence([seed, ALL_SETS.index(name)]).spawn(2)
    found = track_set(name, tracks, int(motion.generate_state(1)[0]), variant.sampling)
    plots = variant.sensors.measure(found.position, noise.spawn(tracks))
    seen = ~np.isnan(plots.z).any(axis=2)
    scored = seen & (np.cumsum(seen, axis=0) > 2)
    scored[: found.first_scored] = False
    return ScoredPlots(found.time, found.position, plots.z, plots.sigma, scored)


def squared_errors(tracker: Tracker, plots: ScoredPlots) -> Array:
    """Squared errors of the predictions of each track, summed over the plots that are scored.

    Parameters
    ----------
    tracker : Tracker
    plots : ScoredPlots

    Returns
    -------
    ndarray, shape (n_tracks,)
        Infinite for a track whose numbers became too large for the computer.
    """
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # The errors show it if gains do not suit the times.
        warnings.simplefilter("ignore", TrackWarning)
        predicted = _predicted(tracker, plots)
        squares = ((predicted - plots.truth) ** 2).sum(axis=2)
        known = np.where(np.isnan(squares), np.inf, squares)
        return np.asarray(np.where(plots.scored, known, 0.0).sum(axis=0))


def _predicted(tracker: Tracker, plots: ScoredPlots) -> Array:
    """Predictions of all tracks; NaN for those that cannot be followed with numbers."""
    try:
        return tracker.run(plots.time, plots.z, plots.sigma).predicted
    except DataError:
        pass
    found = np.full(plots.z.shape, np.nan)
    for k in range(plots.z.shape[1]):
        one = np.s_[:, k : k + 1]
        time = plots.time[one] if plots.time.ndim == 2 else plots.time
        sigma = np.broadcast_to(plots.sigma, plots.z.shape)[one]
        with suppress(DataError):
            found[one] = tracker.run(time, plots.z[one], sigma).predicted
    return found
