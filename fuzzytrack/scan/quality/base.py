"""Role: a number that says how good a track is."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting

__all__ = ["Quality", "QualityKernels", "qualities"]


class QualityKernels(NamedTuple):
    """Kernels of a track quality. The number itself is the column ``SCORE`` of a track.

    Attributes
    ----------
    start : callable
        ``start(tracks, i, plots, j, clock)``: a track has started at plot j.
    hit : callable
        ``hit(tracks, i, plots, j, clock)``: plot j is that of track i; hits and misses are counted
        already, the state is corrected, and times are those before.
    miss : callable
        ``miss(tracks, i, clock)``: no plot in this scan; the miss is counted already.
    existence : callable
        ``existence(tracks, i) -> probability`` that there is a target, NaN if it is not known.
    """

    start: Callable[[Any, int, Any, int, Any], None]
    hit: Callable[[Any, int, Any, int, Any], None]
    miss: Callable[[Any, int, Any], None]
    existence: Callable[[Any, int], float]


class Quality(Part):
    """Keeps a number that says how good a track is."""

    @abstractmethod
    def kernels(self, setting: Setting, at: int) -> QualityKernels:
        """Kernels of this part; its memory of a track begins at column `at`."""


qualities: Registry[type[Quality]] = Registry("track quality", "fuzzytrack.scan.quality", Quality)
