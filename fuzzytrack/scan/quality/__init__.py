"""Track quality: a number that says how good a track is."""

from fuzzytrack.scan.quality.base import Quality, QualityKernels, qualities
from fuzzytrack.scan.quality.existence import Existence
from fuzzytrack.scan.quality.log_likelihood_ratio import LogLikelihoodRatio
from fuzzytrack.scan.quality.m_of_n import MOfN
from fuzzytrack.scan.quality.zhang_jiang import QualityFactor

__all__ = [
    "Existence",
    "LogLikelihoodRatio",
    "MOfN",
    "Quality",
    "QualityFactor",
    "QualityKernels",
    "qualities",
]
