"""Role: when tentative tracks are confirmed, and when tracks end."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting

__all__ = ["CONFIRM", "END", "KEEP", "Confirmation", "ConfirmationKernels", "confirmations"]

#: Answers of `ConfirmationKernels.decide`.
KEEP, CONFIRM, END = 0, 1, 2


class ConfirmationKernels(NamedTuple):
    """Kernels of a confirmation.

    Attributes
    ----------
    start, hit : callable
        ``start(tracks, i, plots, j, clock)``, ``hit(tracks, i, plots, j, clock)``: as for
        `fuzzytrack.scan.quality.base.QualityKernels`; after quality, kind and update.
    decide : callable
        ``decide(tracks, i, clock) -> answer``: ``KEEP``, ``CONFIRM`` or ``END``; after each scan,
        and at the start, where a track that ends at once does not begin.
    """

    start: Callable[[Any, int, Any, int, Any], None]
    hit: Callable[[Any, int, Any, int, Any], None]
    decide: Callable[[Any, int, Any], int]


class Confirmation(Part):
    """Decides when a tentative track is confirmed, and when a track ends."""

    @abstractmethod
    def kernels(self, setting: Setting, at: int) -> ConfirmationKernels:
        """Kernels of this part; its memory of a track begins at column `at`."""


confirmations: Registry[type[Confirmation]] = Registry(
    "confirmation", "fuzzytrack.scan.confirmation", Confirmation
)
