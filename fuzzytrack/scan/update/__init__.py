"""Track update: how a track moves, and how a plot corrects it."""

from fuzzytrack.scan.update.base import Update, UpdateKernels, updates
from fuzzytrack.scan.update.quality_gains import QualityGains
from fuzzytrack.scan.update.transient import Transient

__all__ = ["QualityGains", "Transient", "Update", "UpdateKernels", "updates"]
