"""Clutter model: how dense clutter is at a plot."""

from fuzzytrack.scan.clutter.adaptive_map import AdaptiveMap
from fuzzytrack.scan.clutter.base import Clutter, ClutterKernels, clutters
from fuzzytrack.scan.clutter.constant import ConstantClutter

__all__ = ["AdaptiveMap", "Clutter", "ClutterKernels", "ConstantClutter", "clutters"]
