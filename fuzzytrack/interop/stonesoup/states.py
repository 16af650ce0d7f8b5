"""States of Stone Soup that carry the memory of a tracker.

`stonesoup.types.state.CreatableFromState` finds them for the classes ``Prediction`` and ``Update``
by their two base classes.
"""

from __future__ import annotations

from stonesoup.base import Property
from stonesoup.types.prediction import Prediction
from stonesoup.types.state import GaussianState
from stonesoup.types.update import Update

from fuzzytrack.interop.stonesoup.memory import TrackMemory

__all__ = [
    "ScheduledGaussianState",
    "ScheduledGaussianStatePrediction",
    "ScheduledGaussianStateUpdate",
]


class ScheduledGaussianState(GaussianState):
    """Gaussian state with the memory of a tracker."""

    memory: TrackMemory = Property(
        default=None, doc="The tracker as it is after the state's time, from which it goes on."
    )


class ScheduledGaussianStatePrediction(Prediction, ScheduledGaussianState):
    """Prediction by `GainScheduledPredictor`.

    `memory` is that of a track that has no plot at this time; a plot is added to `before`.
    """

    before: TrackMemory = Property(
        default=None, doc="The tracker as it was before the time of the prediction."
    )


class ScheduledGaussianStateUpdate(Update, ScheduledGaussianState):
    """Update by `GainScheduledUpdater`, and first state by `GainScheduledInitiator`."""
