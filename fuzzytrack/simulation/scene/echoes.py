"""Echoes: what would be plots if a radar could resolve them all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = ["Echoes"]

Whole = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Echoes:
    """Echoes of all scans, those of targets before those of clutter.

    Attributes
    ----------
    scan : ndarray of int, shape (n,)
        Number of the scan.
    time : ndarray, shape (n,)
        When the beam passed it (s).
    place : ndarray, shape (n, 2)
        Where it comes from (m).
    noise : ndarray, shape (n, 2)
        By what it is measured elsewhere (m).
    target_id : ndarray of int, shape (n,)
        Identity of the target; 0 for clutter.
    clutter : ndarray of int, shape (n,)
        Number of the clutter in the scene; -1 for targets.
    state : ndarray of int, shape (n,)
        Row of the target and scan in the truth; -1 for clutter.
    """

    scan: Whole
    time: Array
    place: Array
    noise: Array
    target_id: Whole
    clutter: Whole
    state: Whole

    def __repr__(self) -> str:
        return summary(self, echoes=len(self.scan))

    def where(self, chosen: NDArray[np.bool_]) -> Echoes:
        """Only some of them."""
        return Echoes(*(getattr(self, each.name)[chosen] for each in fields(self)))

    @classmethod
    def joined(cls, parts: Sequence[Echoes]) -> Echoes:
        """Several of them as one, in this order."""
        columns = ([getattr(part, each.name) for part in parts] for each in fields(cls))
        return cls(*(np.concatenate(column) for column in columns))
