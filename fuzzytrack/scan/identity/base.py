"""Role: whether a new track is one that was lost."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzytrack.plugins import Registry
from fuzzytrack.scan.part import Part
from fuzzytrack.scan.setting import Setting

__all__ = ["Identity", "IdentityKernels", "identities"]


class IdentityKernels(NamedTuple):
    """Kernels of an identity. `kept` is the array that a session keeps for it, 0 at first.

    Attributes
    ----------
    end : callable
        ``end(tracks, i, clock, kept)``: a confirmed track ends.
    confirm : callable
        ``confirm(tracks, i, clock, kept) -> id``: identity of a track that is confirmed, its own
        or that of a track that has ended.
    """

    end: Callable[[Any, int, Any, Any], None]
    confirm: Callable[[Any, int, Any, Any], float]


class Identity(Part):
    """Decides whether a new track is one that was lost."""

    @property
    def numbers(self) -> int:
        """How many numbers a session keeps for it."""
        return 0

    @abstractmethod
    def kernels(self, setting: Setting, at: int) -> IdentityKernels:
        """Kernels of this part; its memory of a track begins at column `at`."""


identities: Registry[type[Identity]] = Registry("identity", "fuzzytrack.scan.identity", Identity)
