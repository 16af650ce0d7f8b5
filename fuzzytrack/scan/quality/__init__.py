"""Track quality: a number that says how good a track is."""

from fuzzytrack.scan.quality.base import Quality, QualityKernels, qualities
from fuzzytrack.scan.quality.existence import Existence
from fuzzytrack.scan.quality.zhang_jiang import QualityFactor

__all__ = ["Existence", "Quality", "QualityFactor", "QualityKernels", "qualities"]
