"""Role: how a track moves, and how a plot corrects it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting
from fuzzytrack.scan.update.companion import Companion

__all__ = ["Update", "UpdateKernels", "updates"]

#: Position (m), velocity (m/s), and covariance of the position: xx, xy, yy (m²).
Predicted = tuple[float, float, float, float, float, float, float]


class UpdateKernels(NamedTuple):
    """Kernels of an update.

    Attributes
    ----------
    start : callable
        ``start(tracks, i, plots, j, clock)``: a track starts at plot j. The state and covariance
        of one plot are set already.
    predict : callable
        ``predict(tracks, i, dt) -> (x, y, vx, vy, p11, p12, p22)``: the state of track i a time
        dt >= 0 (s) after its last plot, with the covariance of the position.
    velocity_variance : callable
        ``velocity_variance(tracks, i, dt) -> (v11, v22)``: variances of that velocity (m²/s²).
    hit : callable
        ``hit(tracks, i, plots, j, clock)``: plot j corrects track i; the innovation is in the
        plot's row. The time of the track is still that of the plot before.
    """

    start: Callable[[Any, int, Any, int, Any], None]
    predict: Callable[[Any, int, float], Predicted]
    velocity_variance: Callable[[Any, int, float], tuple[float, float]]
    hit: Callable[[Any, int, Any, int, Any], None]


class Update(Part):
    """Predicts tracks, and corrects them by their plots."""

    def companion(self, at: int) -> Companion | None:
        """What a session keeps for it beside the array of tracks, if anything."""
        return None

    @abstractmethod
    def kernels(self, setting: Setting, at: int) -> UpdateKernels:
        """Kernels of this part; its memory of a track begins at column `at`."""


updates: Registry[type[Update]] = Registry("track update", "fuzzytrack.scan.update", Update)
