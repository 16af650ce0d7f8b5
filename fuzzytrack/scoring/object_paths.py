"""Positions by object: the path of each in the order of time, as pictures show them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.scoring.positions import Positions

__all__ = ["ObjectPaths"]


@dataclass(frozen=True, eq=False)
class ObjectPaths:
    """Paths of objects in flat arrays, one after the other.

    Attributes
    ----------
    names : tuple of str
        Identity of each object.
    edges : ndarray of int, shape (n_objects + 1,)
        Rows at which the objects begin, and at which one more would.
    time : ndarray, shape (n,)
        Times (s), ascending within an object.
    position : ndarray, shape (n, 2)
        Positions (m).
    """

    names: tuple[str, ...]
    edges: NDArray[np.int64]
    time: Array
    position: Array

    def __repr__(self) -> str:
        return summary(self, rows=len(self.time), objects=len(self))

    def __len__(self) -> int:
        """Number of objects."""
        return len(self.names)

    @classmethod
    def of(cls, truth: Any) -> ObjectPaths:
        """Paths of true objects; none if `truth` is None.

        Parameters
        ----------
        truth : Positions, mapping or tuple, or None
            As `fuzzytrack.score` takes it: a tuple (time, id, position), for example.

        Raises
        ------
        TypeError, ValueError
            See `Positions.of`; also if positions have more or fewer than two axes.
        """
        if truth is None:
            return cls((), np.zeros(1, np.int64), np.empty(0), np.empty((0, 2)))
        found = Positions.of(truth, "truth")
        if found.n_axes != 2:
            raise ValueError(f"truth: positions have {found.n_axes} axes; a map needs two")
        names, which = np.unique(found.id, return_inverse=True)
        order = np.lexsort((found.time, which))
        edges = np.searchsorted(which[order], np.arange(len(names) + 1)).astype(np.int64)
        return cls(tuple(map(str, names.tolist())), edges, found.time[order], found.position[order])
