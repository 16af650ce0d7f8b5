"""Gain schedulers: who choose the gains of a tracker."""

from fuzzytrack.schedulers.base import GainScheduler, schedulers
from fuzzytrack.schedulers.fading_memory import FadingMemory
from fuzzytrack.schedulers.fixed import FixedGains
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.schedulers.innovation import InnovationScheduler
from fuzzytrack.schedulers.kalman import KalmanCA, KalmanCV
from fuzzytrack.schedulers.memory import BenedictBordner, GrowingMemory, LinearCombination
from fuzzytrack.schedulers.normalization import Normalization, normalizations
from fuzzytrack.schedulers.quality import QualityGains

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
    "Normalization",
    "QualityGains",
    "normalizations",
    "schedulers",
]
