"""Trackers: the recursion, its state and results."""

from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.bank import ParallelBank
from fuzzytrack.trackers.base import Tracker, trackers
from fuzzytrack.trackers.imm import InteractingModels
from fuzzytrack.trackers.prediction import Prediction
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import Gains, TrackState
from fuzzytrack.trackers.track_store import TrackStore
from fuzzytrack.trackers.window_search import WindowSearch

__all__ = [
    "AlphaBetaTracker",
    "Gains",
    "InteractingModels",
    "ParallelBank",
    "Prediction",
    "TrackResult",
    "TrackState",
    "TrackStore",
    "Tracker",
    "WindowSearch",
    "trackers",
]
