"""Trackers tuned on sets of tracks, and ranked.

A tracker with parameters can only be judged when they are tuned: `tune` finds them, and `rank`
measures trackers on fresh tracks, under the conditions of `VARIANTS`.
"""

from fuzzytrack.tuning.families import FAMILIES, Family
from fuzzytrack.tuning.ranking import Change, Ranking, rank
from fuzzytrack.tuning.search import tune
from fuzzytrack.tuning.variants import VARIANTS, Variant

__all__ = ["FAMILIES", "VARIANTS", "Change", "Family", "Ranking", "Variant", "rank", "tune"]
