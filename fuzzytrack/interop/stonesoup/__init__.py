"""Plug-in for Stone Soup: alpha-beta(-gamma) trackers as its predictor, updater and initiator.

Stone Soup finds this package by its entry point: ``from stonesoup.plugins.fuzzytrack import ...``.
It needs the extra ``stonesoup``; importing it without raises an ImportError, and nothing else.
"""

from importlib.util import find_spec

if find_spec("stonesoup") is None:
    raise ImportError(
        "fuzzytrack.interop.stonesoup needs Stone Soup, which is not installed; "
        "pip install 'fuzzytrack[stonesoup]'"
    )

from fuzzytrack.interop.stonesoup.exchange import from_stonesoup, to_stonesoup
from fuzzytrack.interop.stonesoup.initiator import GainScheduledInitiator
from fuzzytrack.interop.stonesoup.memory import TrackMemory
from fuzzytrack.interop.stonesoup.metrics import stonesoup_metrics
from fuzzytrack.interop.stonesoup.predictor import GainScheduledPredictor
from fuzzytrack.interop.stonesoup.states import (
    ScheduledGaussianState,
    ScheduledGaussianStatePrediction,
    ScheduledGaussianStateUpdate,
)
from fuzzytrack.interop.stonesoup.updater import GainScheduledUpdater
from fuzzytrack.interop.stonesoup.yaml_tags import add_to_yaml

__all__ = [
    "GainScheduledInitiator",
    "GainScheduledPredictor",
    "GainScheduledUpdater",
    "ScheduledGaussianState",
    "ScheduledGaussianStatePrediction",
    "ScheduledGaussianStateUpdate",
    "TrackMemory",
    "add_to_yaml",
    "from_stonesoup",
    "stonesoup_metrics",
    "to_stonesoup",
]
