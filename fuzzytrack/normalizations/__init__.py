"""Normalizations: how an innovation becomes the inputs of a rule base."""

from fuzzytrack.normalizations.chan import Normalization, normalizations
from fuzzytrack.normalizations.predicted import Scale

__all__ = ["Normalization", "Scale", "normalizations"]
