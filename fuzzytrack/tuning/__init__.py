"""Trackers tuned on sets of tracks, and ranked.

A tracker with parameters can only be judged when they are tuned: `tune` finds them, and `rank`
measures tuned trackers on fresh tracks.
"""

from fuzzytrack.tuning.families import FAMILIES, Family
from fuzzytrack.tuning.ranking import Ranked, rank
from fuzzytrack.tuning.search import tune

__all__ = ["FAMILIES", "Family", "Ranked", "rank", "tune"]
