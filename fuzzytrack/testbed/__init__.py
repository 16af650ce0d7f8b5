"""Simulated targets, and trackers run and compared on simulated noise."""

from fuzzytrack.testbed.comparison import Comparison, compare, compare_tracks
from fuzzytrack.testbed.ragged import run_tracks
from fuzzytrack.testbed.trajectories import turning_target

__all__ = ["Comparison", "compare", "compare_tracks", "run_tracks", "turning_target"]
