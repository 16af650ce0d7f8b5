"""Trackers tuned on sets of tracks, and ranked."""

from fuzzytrack.tuning.ranking import FAMILIES, rank, tune

__all__ = ["FAMILIES", "rank", "tune"]
