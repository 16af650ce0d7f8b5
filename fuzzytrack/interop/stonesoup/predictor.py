"""Predictor of Stone Soup."""

from __future__ import annotations

from datetime import datetime
from typing import Any

import numpy as np
from stonesoup.base import Property
from stonesoup.predictor._utils import predict_lru_cache
from stonesoup.predictor.base import Predictor

from fuzzytrack.gains.checks import nonnegative_deviation, number
from fuzzytrack.interop.stonesoup.component import GainScheduledComponent
from fuzzytrack.interop.stonesoup.memory import TrackMemory
from fuzzytrack.interop.stonesoup.states import ScheduledGaussianStatePrediction

__all__ = ["GainScheduledPredictor"]


class GainScheduledPredictor(GainScheduledComponent, Predictor):
    """Predicts tracks of `GainScheduledInitiator`, as the tracker does it.

    Raises
    ------
    ValueError, RuleBaseError
        If the text names no alpha-beta tracker, the mappings do not fit it, or the noise is
        missing or negative.

    Notes
    -----
    Position, velocity and acceleration are those of `fuzzytrack.AlphaBetaTracker.predict`. The
    covariance is the one that follows from the gains, in Joseph form; see
    `fuzzytrack.trackers.covariance`, here with all axes of a track together.
    """

    # Motion is that of the tracker.
    transition_model = None
    control_model = None

    acceleration_noise: float = Property(
        default=None,
        readonly=True,
        doc="Standard deviation of the target's acceleration from plot to plot (m/s²), >= 0; of a "
        "tracker with acceleration that of its change. The covariance follows from it. Without "
        "it that of the tracker is taken, which then needs one.",
    )

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        noise = self.acceleration_noise
        if noise is None:
            noise = self._recursion.noise
        if noise is None:
            raise ValueError(
                f"acceleration_noise: {self.tracker!r} has none of its own; give the standard "
                "deviation of the target's acceleration (m/s²)"
            )
        name = "acceleration_noise"
        self._noise = number(name, nonnegative_deviation(name, noise))

    @predict_lru_cache()
    def predict(self, prior: Any, timestamp: datetime | None = None, **kwargs: Any) -> Any:
        """Predict a track to a time.

        Parameters
        ----------
        prior : ScheduledGaussianState or Track
            From `GainScheduledInitiator`, `GainScheduledUpdater` or this predictor.
        timestamp : datetime
            Time of the prediction, not earlier than that of `prior`.

        Returns
        -------
        ScheduledGaussianStatePrediction

        Raises
        ------
        ValueError
            If the state has no memory, or that of another tracker, or was changed by another
            component, or the time is missing or earlier.
        """
        recursion, memory = self._recursion, self._memory_of(prior)
        if timestamp is None or timestamp < prior.timestamp:
            raise ValueError(
                f"timestamp: must not be earlier than that of the state, {prior.timestamp}, got "
                f"{timestamp}; a track is predicted forward only"
            )
        if timestamp == prior.timestamp:
            return ScheduledGaussianStatePrediction(
                prior.state_vector, prior.covar, timestamp=timestamp, prior=prior, memory=memory,
                # Where the prior has no plot at this time, there may still be one.
                before=getattr(prior, "before", None) or memory,
            )  # fmt: skip
        coasted = recursion.coasted(memory, timestamp, self._noise)
        return ScheduledGaussianStatePrediction(
            recursion.vector(coasted),
            recursion.predicted(memory, timestamp, self._noise),
            timestamp=timestamp,
            prior=prior,
            memory=coasted,
            before=memory,
        )

    def _memory_of(self, prior: Any) -> TrackMemory:
        memory: TrackMemory | None = getattr(prior, "memory", None)
        if memory is None:
            raise ValueError(
                f"prior: {type(prior).__name__} has no memory of a tracker; start tracks with "
                "GainScheduledInitiator and update them with GainScheduledUpdater, but not in a "
                "mixture tracker (PDA, JPDA), which replaces states by others without a memory"
            )
        self._recursion.check(memory)
        if not np.array_equal(self._recursion.vector(memory), prior.state_vector):
            raise ValueError(
                f"prior: the state vector of a {type(prior).__name__} is not that of its memory; "
                "predict and update it with GainScheduledPredictor and GainScheduledUpdater only"
            )
        return memory
