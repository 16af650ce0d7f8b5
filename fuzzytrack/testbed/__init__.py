"""Experiments on simulated tracks, their results, and comparison, also on recorded plots."""

from fuzzytrack.testbed.comparison import Comparison, compare, compare_tracks
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.testbed.recorded_comparison import compare_recorded
from fuzzytrack.testbed.recorded_scores import RecordedComparison
from fuzzytrack.testbed.results import Results

__all__ = [
    "Comparison",
    "RecordedComparison",
    "Results",
    "compare",
    "compare_recorded",
    "compare_tracks",
    "monte_carlo",
]
