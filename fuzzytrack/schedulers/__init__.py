"""Gain schedulers: who choose the gains of a tracker."""

from fuzzytrack.schedulers.base import GainScheduler, schedulers
from fuzzytrack.schedulers.fading_memory import FadingMemory
from fuzzytrack.schedulers.fixed import FixedGains
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.schedulers.growing_memory import BenedictBordner, GrowingMemory, LinearCombination
from fuzzytrack.schedulers.innovation import InnovationScheduler
from fuzzytrack.schedulers.kalman_cv import KalmanCA, KalmanCV
from fuzzytrack.schedulers.track_quality import QualityGains

__all__ = [
    "BenedictBordner",
    "FadingMemory",
    "FixedGains",
    "FuzzyScheduler",
    "GainScheduler",
    "GrowingMemory",
    "InnovationScheduler",
    "KalmanCA",
    "KalmanCV",
    "LinearCombination",
    "QualityGains",
    "schedulers",
]
