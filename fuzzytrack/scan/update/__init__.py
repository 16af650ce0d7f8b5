"""Track update: how a track moves, and how a plot corrects it."""

from fuzzytrack.scan.update.base import Update, UpdateKernels, updates
from fuzzytrack.scan.update.companion import Companion
from fuzzytrack.scan.update.quality_gains import QualityGains
from fuzzytrack.scan.update.tracker import TrackerUpdate
from fuzzytrack.scan.update.transient import Transient

__all__ = [
    "Companion",
    "QualityGains",
    "TrackerUpdate",
    "Transient",
    "Update",
    "UpdateKernels",
    "updates",
]
