"""Gain schedulers: who choose the gains of a tracker."""

from fuzzytrack.schedulers.base import GainScheduler, schedulers
from fuzzytrack.schedulers.fixed import FixedGains
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.schedulers.normalization import Normalization, normalizations

__all__ = [
    "FixedGains",
    "FuzzyScheduler",
    "GainScheduler",
    "Normalization",
    "normalizations",
    "schedulers",
]
