"""Trackers, their states and results, and the base classes for trackers of your own."""

from fuzzytrack.lanes.layout import Rows
from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.lanes.start import single_axis_step
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.bank import ParallelBank
from fuzzytrack.trackers.base import Tracker, trackers
from fuzzytrack.trackers.imm import InteractingPair
from fuzzytrack.trackers.imm_three import three_model_imm
from fuzzytrack.trackers.imm_two import two_model_imm
from fuzzytrack.trackers.interacting_models import InteractingModels, MotionModel
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.trackers.prediction import Prediction
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import Gains, TrackState
from fuzzytrack.trackers.track_store import TrackStore
from fuzzytrack.trackers.window_search import WindowSearch

__all__ = [
    "AlphaBetaTracker",
    "Gains",
    "InteractingModels",
    "InteractingPair",
    "LaneProgram",
    "LaneTracker",
    "MotionModel",
    "ParallelBank",
    "Prediction",
    "Rows",
    "TrackResult",
    "TrackState",
    "TrackStore",
    "Tracker",
    "WindowSearch",
    "single_axis_step",
    "three_model_imm",
    "trackers",
    "two_model_imm",
]
