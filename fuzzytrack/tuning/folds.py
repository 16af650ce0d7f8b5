"""Folds: which plots a tracker is tuned on, and on which it is judged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.tuning.data import TuningData

__all__ = ["Folds", "make_folds"]

# Fewer tracks are cut into blocks of time instead.
_LEAST_TRACKS = 3
# Blocks of each track.
_BLOCKS = 20


@dataclass(frozen=True, eq=False)
class Folds:
    """Units of data, each of them tracks or blocks of time, and the fold of each.

    Attributes
    ----------
    kind : {"tracks", "blocks of time"}
        What a unit is.
    units : tuple of ndarray of int, shape (n_steps, n_tracks)
        For each batch of the data the unit of each scored plot, and -1 for others.
    fold : ndarray of int, shape (n_units,)
        In which fold a unit is held out.
    plots : ndarray of int, shape (n_units,)
        Number of scored plots of each unit.
    group : ndarray of int, shape (n_units,)
        The group of the tracks of each unit.
    """

    kind: str
    units: tuple[NDArray[np.int64], ...]
    fold: NDArray[np.int64]
    plots: NDArray[np.int64]
    group: NDArray[np.int64]

    def __repr__(self) -> str:
        return summary(self, "kind", "fold")

    @property
    def number(self) -> int:
        """Number of folds."""
        return int(self.fold.max()) + 1

    def by_unit(self, values: list[Array]) -> Array:
        """Sum, over the scored plots of each unit, of a value of each plot, by batches."""
        total = np.zeros(len(self.fold))
        for units, value in zip(self.units, values, strict=True):
            inside = units >= 0
            total += np.bincount(units[inside], value[inside], len(total))
        return total


def make_folds(data: TuningData, folds: int, seed: int) -> Folds:
    """Folds by track, or by time if there are fewer than three tracks.

    Parameters
    ----------
    data : TuningData
    folds : int
        Number of folds, at least 2; no more than there are tracks.
    seed : int
        Seed of the order in which tracks are divided among folds.

    Raises
    ------
    ValueError
        If there are fewer than two folds.
    """
    if folds < 2:
        raise ValueError(f"folds must be at least 2, got {folds}")
    by_time = len(data.tracks) < _LEAST_TRACKS
    own = [_blocks(track.scored) if by_time else _whole(track.scored) for track in data.tracks]
    counts = [int(units.max(initial=-1)) + 1 for units in own]
    starts = np.cumsum([0, *counts])
    units = []
    for batch in data.batches:
        found = np.full(batch.scored.shape, -1, dtype=np.int64)
        for column, member in enumerate(batch.members.tolist()):
            mine = own[member]
            found[: len(mine), column] = np.where(mine >= 0, mine + starts[member], -1)
        units.append(found)
    number = int(starts[-1])
    # Blocks in turn, so that every fold has some of every part of a track.
    order = np.arange(number) if by_time else np.random.default_rng(seed).permutation(number)
    fold = np.empty(number, dtype=np.int64)
    fold[order] = np.arange(number) % min(folds, number)
    plots = np.bincount(np.concatenate([u[u >= 0] for u in units]), minlength=number)
    group = np.repeat([track.group for track in data.tracks], counts)
    return Folds("blocks of time" if by_time else "tracks", tuple(units), fold, plots, group)


def _whole(scored: NDArray[np.bool_]) -> NDArray[np.int64]:
    return np.where(scored, 0, -1).astype(np.int64)


def _blocks(scored: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Blocks of as many scored plots each, in order."""
    count = int(scored.sum())
    number = np.minimum((np.cumsum(scored) - 1) * _BLOCKS // max(count, 1), _BLOCKS - 1)
    return np.where(scored, number, -1).astype(np.int64)
