"""What every tracker promises of its predictions, a function for each promise."""

from __future__ import annotations

import math
import pickle
from functools import partial
from typing import Any

import numpy as np

from fuzzytrack.normalizations.predicted import Predicted
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.schedulers.kalman_ca import KalmanCA
from fuzzytrack.schedulers.kalman_cv import KalmanCV
from fuzzytrack.testing.samples import (
    SIGMA,
    STEPS,
    TRACKS,
    expect,
    expect_refused,
    sample_plots,
)
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.covariance import track_covariance
from fuzzytrack.trackers.prediction import Prediction
from fuzzytrack.trackers.state import TrackState

__all__ = ["predict_equals_missed_plot", "variance_equals_track_covariance"]


def predict_equals_missed_plot(tracker: Tracker, seed: int) -> None:
    """A prediction is what a step with a missed plot gives, and leaves the state alone."""
    times, plots = sample_plots(seed)
    own_delay = np.linspace(0.0, 1.0, TRACKS)
    for k in (1, 2, 3, 10, STEPS - 1):
        for z, delay in ((plots[:, 0], 0.0), (plots, 0.0), (plots, own_delay)):
            state, t = tracker.run(times[:k], z[:k], SIGMA).state, times[k] + delay
            assert state is not None
            before = pickle.dumps(state)
            found = tracker.predict(state, t, SIGMA)
            expect(pickle.dumps(state) == before, "predict must leave the state as it is")
            coasted = tracker.step(state, np.full(z[k].shape, np.nan), t, SIGMA)
            for name in ("time", "position", "velocity", "acceleration"):
                expect(
                    np.array_equal(getattr(found, name), getattr(coasted, name), equal_nan=True),
                    f"predict must equal a step with a missed plot: {name} differs (step {k})",
                )
            _expect_variances(found, z[k].shape)
    _expect_later_times(tracker, tracker.start(plots[0], 5.0, SIGMA))


def variance_equals_track_covariance(tracker: Tracker, seed: int) -> None:
    """The innovation variance is that of `track_covariance`, where that has the model."""
    model = _model(tracker)
    if model is None:
        return
    times, plots = sample_plots(seed)
    # A tracker with a noise of its own does not see that of the plots.
    sigma = getattr(tracker, "sigma_w", None) or SIGMA
    known = track_covariance(tracker.run(times, plots, sigma), sigma, **model).innovation_variance
    state = tracker.start(plots[0], times[0], sigma)
    for k in range(1, STEPS):
        found = tracker.predict(state, times[k], sigma).innovation_variance
        there = ~np.isnan(known[k])
        expect(
            bool((abs(found[there] - known[k][there]) <= 1e-12 * known[k][there]).all()),
            f"innovation_variance must be that of track_covariance (step {k})",
        )
        state = tracker.step(state, plots[k], times[k], sigma)


def _expect_later_times(tracker: Tracker, state: TrackState) -> None:
    for t in (5.0, 4.0, math.nan):
        expect_refused(
            partial(tracker.predict, state, t, SIGMA),
            "to predict for a time that is not later than that of the state",
        )


def _expect_variances(found: Prediction, shape: tuple[int, ...]) -> None:
    variance, s = found.position_variance, found.innovation_variance
    for name, array in (("position_variance", variance), ("innovation_variance", s)):
        expect(
            array.shape == shape,
            f"{name} must have the shape {shape} of the plots, has {array.shape}",
        )
    expect(
        np.array_equal(s, variance + SIGMA**2, equal_nan=True),
        "innovation_variance must be position_variance plus the variance of the plot",
    )
    expect(not (variance < 0).any(), "position_variance must not be negative")


def _model(tracker: Tracker) -> dict[str, Any] | None:
    """Arguments of `track_covariance` for the model behind a tracker's variances, if they fit."""
    if not isinstance(tracker, AlphaBetaTracker):
        return None
    scheduler, two_point = tracker.scheduler, tracker.start_mode == "two-point"
    if isinstance(scheduler, FuzzyScheduler) and isinstance(scheduler.normalization, Predicted):
        still = 0.0 if scheduler.uses_acceleration else None
        return {"sigma_v": 0.0, "acceleration_sigma": still} if two_point else None
    # What is presumed of a new track's velocity is for the start that uses it.
    if not isinstance(scheduler, KalmanCV | KalmanCA) or (two_point and scheduler.velocity_sigma):
        return None
    return {
        "sigma_v": scheduler.sigma_v,
        "velocity_sigma": scheduler.velocity_sigma,
        "acceleration_sigma": getattr(scheduler, "acceleration_sigma", None),
    }
