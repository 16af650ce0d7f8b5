"""Role: how tracks begin."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting

__all__ = ["Initiation", "InitiationKernels", "initiations"]


class InitiationKernels(NamedTuple):
    """Kernels of an initiation.

    Attributes
    ----------
    start : callable
        ``start(tracks, i, plots, j, clock)``: sets the state and the covariance of a track that
        starts at plot j; its time is set already.
    accept : callable
        ``accept(tracks, i, plots, j, dt, dx, dy) -> bool``: whether plot j may be that of track i,
        beside the gate; (dx, dy) is the innovation (m), dt the time since the last plot (s).
    second : callable
        ``second(tracks, i, plots, j, dt) -> bool``: sets the state by the second plot of a track
        and returns True, or False if the update shall do it.
    """

    start: Callable[[Any, int, Any, int, Any], None]
    accept: Callable[[Any, int, Any, int, float, float, float], bool]
    second: Callable[[Any, int, Any, int, float], bool]


class Initiation(Part):
    """Begins tracks at plots that no track uses."""

    @abstractmethod
    def kernels(self, setting: Setting, at: int) -> InitiationKernels:
        """Kernels of this part; its memory of a track begins at column `at`."""


initiations: Registry[type[Initiation]] = Registry(
    "track initiation", "fuzzytrack.scan.initiation", Initiation
)
