"""Updater of Stone Soup."""

from __future__ import annotations

from typing import Any

import numpy as np
from stonesoup.updater.kalman import ExtendedKalmanUpdater

from fuzzytrack.interop.stonesoup.component import GainScheduledComponent
from fuzzytrack.interop.stonesoup.states import (
    ScheduledGaussianStatePrediction,
    ScheduledGaussianStateUpdate,
)

__all__ = ["GainScheduledUpdater"]


class GainScheduledUpdater(GainScheduledComponent, ExtendedKalmanUpdater):
    """Updates predictions of `GainScheduledPredictor` with the gains of a scheduler.

    Measurements are predicted as by its base class, so that hypothesizers gate with the innovation
    covariance. A detection is turned into a position, by the inverse of its measurement model, and
    given to the tracker with the standard deviation on each axis.

    Raises
    ------
    ValueError, RuleBaseError
        If the text names no alpha-beta tracker, or the mappings do not fit it.
    """

    # The covariance is always in Joseph form, which is symmetric.
    force_symmetric_covariance = False
    force_positive_definite_covariance = False
    use_joseph_cov = True

    def update(self, hypothesis: Any, **kwargs: Any) -> ScheduledGaussianStateUpdate:
        """Add a plot to a track.

        Parameters
        ----------
        hypothesis : stonesoup.types.hypothesis.SingleHypothesis
            Its prediction is from `GainScheduledPredictor`, for the time of the detection.
        **kwargs
            Passed to `predict_measurement`.

        Returns
        -------
        ScheduledGaussianStateUpdate
            A second detection at one time leaves the state as it is.

        Raises
        ------
        ValueError
            If the prediction is another one, or the detection is no position.
        """
        prediction, detection = hypothesis.prediction, hypothesis.measurement
        if getattr(prediction, "before", None) is None:
            raise ValueError(
                f"hypothesis: its prediction, a {type(prediction).__name__}, is not from "
                "GainScheduledPredictor; start tracks with GainScheduledInitiator, and predict "
                "them with GainScheduledPredictor"
            )
        if detection.timestamp != prediction.timestamp:
            raise ValueError(
                f"hypothesis: its prediction is for {prediction.timestamp}, its detection of "
                f"{detection.timestamp}; predict for the time of the detection"
            )
        if hypothesis.measurement_prediction is None:
            model = self._check_measurement_model(detection.measurement_model)
            hypothesis.measurement_prediction = self.predict_measurement(
                prediction, measurement_model=model, **kwargs
            )
        return self._updated(prediction, detection, hypothesis)

    def _updated(
        self, prediction: ScheduledGaussianStatePrediction, detection: Any, hypothesis: Any
    ) -> ScheduledGaussianStateUpdate:
        recursion, before = self._recursion, prediction.before
        recursion.check(before)
        when = detection.timestamp
        if recursion.is_at(before, when):
            # With T = 0 there is no gain β/T.
            vector, covar, memory = prediction.state_vector, prediction.covar, before
        else:
            position, noise = self._position_of(detection)
            predicted = np.asarray(prediction.covar)
            memory = recursion.corrected(before, predicted, position, noise, when)
            vector, covar = recursion.vector(memory), memory.covar
        return ScheduledGaussianStateUpdate(
            vector, covar, timestamp=when, hypothesis=hypothesis, memory=memory
        )
