"""Track quality: a number that says how good a track is."""

from fuzzytrack.scan.quality.base import Quality, QualityKernels, qualities
from fuzzytrack.scan.quality.existence import Existence

__all__ = ["Existence", "Quality", "QualityKernels", "qualities"]
