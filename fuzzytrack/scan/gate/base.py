"""Role: whether a plot may be that of a track."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting

__all__ = ["Gate", "GateKernels", "gates"]


class GateKernels(NamedTuple):
    """Kernels of a gate.

    Attributes
    ----------
    reach : callable
        ``reach(tracks, i, x, y, clock, variance) -> distance``: no plot farther from the predicted
        position of track i (m) is accepted. `variance` is the largest one that an innovation can
        have in any direction (m²).
    distance : callable
        ``distance(tracks, i, plots, j, clock, dx, dy, s11, s12, s22) -> distance``: -1 if plot j
        is refused, else how far it is, for associations that go by it. The innovation is (dx, dy)
        (m), S its covariance (m²).
    """

    reach: Callable[[Any, int, float, float, Any, float], float]
    distance: Callable[[Any, int, Any, int, Any, float, float, float, float, float], float]


class Gate(Part):
    """Says whether a plot may be that of a track."""

    @abstractmethod
    def kernels(self, setting: Setting, at: int) -> GateKernels:
        """Kernels of this part; its memory of a track begins at column `at`."""


gates: Registry[type[Gate]] = Registry("gate", "fuzzytrack.scan.gate", Gate)
