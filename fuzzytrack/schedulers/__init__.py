"""Gain schedulers: they choose the gains of a tracker."""

from fuzzytrack.schedulers.base import GainScheduler, schedulers
from fuzzytrack.schedulers.benedict_bordner import BenedictBordner
from fuzzytrack.schedulers.fading_memory import FadingMemory
from fuzzytrack.schedulers.fixed import FixedGains
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.schedulers.growing_memory import GrowingMemory
from fuzzytrack.schedulers.innovation import InnovationScheduler
from fuzzytrack.schedulers.kalman_ca import KalmanCA
from fuzzytrack.schedulers.kalman_cv import KalmanCV
from fuzzytrack.schedulers.linear_combination import LinearCombination
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
