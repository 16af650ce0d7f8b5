"""Experiments on simulated tracks: Monte Carlo runs, their results, and comparison."""

from fuzzytrack.testbed.comparison import Comparison, compare, compare_tracks
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.testbed.results import Results

__all__ = ["Comparison", "Results", "compare", "compare_tracks", "monte_carlo"]
