"""Trackers tuned on data or on sets of tracks, and ranked.

`tune` finds the numbers of a tracker, and judges it on data that it was not tuned on. `rank`
measures trackers on fresh tracks, under the conditions of `VARIANTS`.
"""

from fuzzytrack.tuning.data import TuningData, TuningTrack
from fuzzytrack.tuning.ranking import Change, Ranking, rank
from fuzzytrack.tuning.tuned import Tuned
from fuzzytrack.tuning.tuner import tune
from fuzzytrack.tuning.variants import VARIANTS, Variant

__all__ = [
    "VARIANTS",
    "Change",
    "Ranking",
    "Tuned",
    "TuningData",
    "TuningTrack",
    "Variant",
    "rank",
    "tune",
]
