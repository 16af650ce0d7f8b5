"""Trackers: the recursion, its state and results."""

from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.base import Tracker, trackers
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import Gains, TrackState

__all__ = ["AlphaBetaTracker", "Gains", "TrackResult", "TrackState", "Tracker", "trackers"]
