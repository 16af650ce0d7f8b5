"""Role: whether a track moves."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.track_columns import KIND

__all__ = ["MOVING", "STATIC", "UNDECIDED", "Kind", "KindKernels", "kinds"]

#: Numbers of the words of `fuzzytrack.scan.track_reports.KINDS`.
UNDECIDED, MOVING, STATIC = 0.0, 1.0, 2.0


def as_decided(tracks: Any, i: int) -> float:
    """The kind of a track that decisions go by."""
    return tracks[i, KIND]  # type: ignore[no-any-return]


class KindKernels(NamedTuple):
    """Kernels of a kind. The kind is the column ``KIND`` of a track, its evidence ``MOTION``.

    Attributes
    ----------
    start, hit : callable
        ``start(tracks, i, plots, j, clock)``, ``hit(tracks, i, plots, j, clock)``: as for
        `fuzzytrack.scan.quality.base.QualityKernels`; after the quality, before the update.
    miss : callable
        ``miss(tracks, i, clock)``: no plot in this scan.
    reported : callable
        ``reported(tracks, i) -> kind``: what is reported; by default the kind that the other parts
        go by.
    """

    start: Callable[[Any, int, Any, int, Any], None]
    hit: Callable[[Any, int, Any, int, Any], None]
    miss: Callable[[Any, int, Any], None]
    reported: Callable[[Any, int], float] = as_decided


class Kind(Part):
    """Decides whether a track moves, is static, or neither is sure."""

    @abstractmethod
    def kernels(self, setting: Setting, at: int) -> KindKernels:
        """Kernels of this part; its memory of a track begins at column `at`."""


kinds: Registry[type[Kind]] = Registry("kind of track", "fuzzytrack.scan.kind", Kind)
