"""What tuning for the ranking minimizes: the error of predictions on a set of random tracks."""

from __future__ import annotations

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.simulation.published import TRACK_SETS, TrackSet
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_tracker

__all__ = ["prediction_mse"]


def prediction_mse(tracker: Tracker | str, tracks: TrackSet, seed: int) -> Array:
    """Mean squared error of the predictions of each track, with noise of standard deviation 1.

    Parameters
    ----------
    tracker : Tracker or str
        The tracker, or what names it, see `fuzzytrack.trackers.catalog.make_tracker`.
    tracks : TrackSet
    seed : int
        Seed of the noise; the same noise for every tracker.

    Returns
    -------
    ndarray, shape (n_tracks,)
        Mean over the scored scans of the squared distance, in units of the noise's variance.
    """
    noise = np.random.default_rng([seed, TRACK_SETS.index(tracks.name)])
    plots = tracks.position + noise.standard_normal(tracks.position.shape)
    predicted = as_tracker(tracker).run(tracks.time, plots, 1.0).predicted
    error = (predicted - tracks.position)[tracks.first_scored :]
    return np.asarray((error**2).sum(axis=-1).mean(axis=0))
