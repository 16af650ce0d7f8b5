"""Track update: how a track moves, and how a plot corrects it."""

from fuzzytrack.scan.update.base import Update, UpdateKernels, updates
from fuzzytrack.scan.update.transient import Transient

__all__ = ["Transient", "Update", "UpdateKernels", "updates"]
