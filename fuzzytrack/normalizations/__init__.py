"""Normalizations: how an innovation becomes the inputs of a rule base."""

from fuzzytrack.normalizations.base import Normalization, normalizations
from fuzzytrack.normalizations.chan import Chan, ChanMagnitude, ChanSigned
from fuzzytrack.normalizations.predicted import Predicted
from fuzzytrack.normalizations.scale import Scale
from fuzzytrack.normalizations.smoothed import Smoothed, SmoothedMagnitude
from fuzzytrack.normalizations.surprise import Surprise

__all__ = [
    "Chan",
    "ChanMagnitude",
    "ChanSigned",
    "Normalization",
    "Predicted",
    "Scale",
    "Smoothed",
    "SmoothedMagnitude",
    "Surprise",
    "normalizations",
]
