"""The protocol of trackers, and their registry."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, runtime_checkable

from numpy.typing import ArrayLike

from fuzzytrack.plugins import Registry
from fuzzytrack.trackers.prediction import Prediction
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import TrackState

__all__ = ["Tracker", "trackers"]


@runtime_checkable
class Tracker(Protocol):
    """Turns plots into tracks, at once or plot by plot, with the same numbers."""

    def run(self, t: ArrayLike, z: ArrayLike, sigma: ArrayLike | None = None) -> TrackResult:
        """Track all plots; see `fuzzytrack.AlphaBetaTracker.run`."""
        ...

    def start(self, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None = None) -> TrackState:
        """State after a first plot."""
        ...

    def step(
        self, state: TrackState, z: ArrayLike, t: ArrayLike, sigma: ArrayLike | None = None
    ) -> TrackState:
        """State after one more plot."""
        ...

    def predict(
        self, state: TrackState, t: ArrayLike, sigma: ArrayLike | None = None
    ) -> Prediction:
        """Predicted position at a later time; see `fuzzytrack.AlphaBetaTracker.predict`."""
        ...


trackers: Registry[Callable[..., Tracker]] = Registry("tracker", "fuzzytrack.trackers", Tracker)
