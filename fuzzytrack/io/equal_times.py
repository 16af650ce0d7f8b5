"""Plots of one track at equal times, which become one plot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.io.angles import unwrapped
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.table import Words

__all__ = ["EqualTimes", "Merging"]

#: Which plot stands for those at one time.
Merging = Literal["first", "last", "mean"]
Places = NDArray[np.int64]


class EqualTimes:
    """Merges the plots of a track that have equal times, from piece to piece.

    The last time of each track is held back until a later one has come, so its rows may be in the
    next piece.

    Parameters
    ----------
    merging : {"first", "last", "mean"}
        Which plot stands for all; rows without a plot do not count beside one with a plot. The mean
        is one for each axis, of positions and of standard deviations: plots at one time often have
        one error.
    turn : float, optional
        Full circle of positions that are bare angles, whose mean is taken the shorter way.

    Attributes
    ----------
    copies, merged : int
        Rows so far that were exact copies, and others that have become part of another one.
    """

    def __init__(self, merging: Merging, turn: float | None = None) -> None:
        self.merging, self.turn = merging, turn
        self.copies = self.merged = 0
        self._held: Piece | None = None

    def advance(self, piece: Piece) -> Piece:
        """Add a piece, and take the rows whose times are complete.

        Parameters
        ----------
        piece : Piece
        """
        if self._held is not None and len(self._held):
            piece = _joined(self._held, piece)
        order, begins = _groups(piece)
        codes = piece.ids.codes[order[begins]]
        # Groups of a track follow each other: the last is the one before another track's.
        is_last = np.append(codes[1:] != codes[:-1], True)
        group = np.cumsum(begins) - 1
        open_rows = np.zeros(len(piece), dtype=bool)
        open_rows[order] = is_last[group]
        self._held = piece.take(open_rows)
        return self._merged(piece.take(~open_rows))

    def finish(self) -> Piece | None:
        """Take the rows that were held back; None if there were no pieces."""
        held, self._held = self._held, None
        return None if held is None else self._merged(held)

    def _merged(self, piece: Piece) -> Piece:
        order, begins = _groups(piece)
        sizes = np.diff(np.append(np.flatnonzero(begins), len(piece)))
        if (sizes == 1).all():
            return piece
        group = np.cumsum(begins) - 1
        distinct = _distinct(piece.plots[order], group)
        self.copies += len(piece) - len(distinct)
        self.merged += len(distinct) - len(sizes)
        order, group = order[distinct], group[distinct]
        chosen = order[_chosen(piece.plots[order], group, self.merging)]
        if self.merging == "mean":
            sigma = piece.sigma
            plots = piece.plots.copy()
            measured = plots[order]
            if self.turn is not None:
                measured = unwrapped(measured[:, 0], group, self.turn)[:, np.newaxis]
            plots[chosen] = _means(measured, group)
            if sigma is not None:
                sigma = sigma.copy()
                sigma[chosen] = _means(sigma[order], group)
            piece = replace(piece, plots=plots, sigma=sigma)
        return piece.take(np.sort(chosen))


def _groups(piece: Piece) -> tuple[Places, NDArray[np.bool_]]:
    """Rows track by track, and where in this order another track or time begins."""
    codes = piece.ids.codes
    order = np.argsort(codes, kind="stable")
    codes, times = codes[order], piece.time[order]
    begins = np.ones(len(order), dtype=bool)
    begins[1:] = (codes[1:] != codes[:-1]) | (times[1:] != times[:-1])
    return order, begins


def _distinct(plots: Array, group: Places) -> Places:
    """Places of the rows that are no copies of one before in their group, in order."""
    # NaN is equal to NaN here, as lexsort puts it last.
    order = np.lexsort((*plots.T, group))
    one, other = plots[order[1:]], plots[order[:-1]]
    same = ((one == other) | (np.isnan(one) & np.isnan(other))).all(axis=1)
    copies = np.zeros(len(group), dtype=bool)
    copies[order[1:]] = same & (group[order[1:]] == group[order[:-1]])
    return np.flatnonzero(~copies)


def _chosen(plots: Array, group: Places, merging: Merging) -> Places:
    """Place of the row of each group that stays; in the mean it has the time cell of the first."""
    places = np.arange(len(group))
    empty = np.isnan(plots).all(axis=1) if merging != "mean" else np.zeros(len(group), dtype=bool)
    order = np.lexsort((-places if merging == "last" else places, empty, group))
    return np.asarray(order[np.append(True, np.diff(group[order]) != 0)])


def _means(values: Array, group: Places) -> Array:
    """Mean of each group and axis, of what is not NaN; added in the order of the rows."""
    known = ~np.isnan(values)
    means = np.empty((int(group[-1]) + 1, values.shape[1]))
    for axis in range(values.shape[1]):
        there = known[:, axis]
        size = len(means)
        sums = np.bincount(group[there], values[there, axis], size)
        counts = np.bincount(group[there], minlength=size)
        # Of one value itself.
        means[:, axis] = np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)
    return means


def _joined(one: Piece, other: Piece) -> Piece:
    """Rows of two pieces; they are taken for rows of the second one's file."""
    codes = {name: code for code, name in enumerate(one.ids.names)}
    known = np.array(
        [codes.setdefault(name, len(codes)) for name in other.ids.names], dtype=np.int64
    )
    cells: Sequence[str] | NDArray[Any] | None = None
    if one.time_cells is not None and other.time_cells is not None:
        if isinstance(one.time_cells, np.ndarray) and isinstance(other.time_cells, np.ndarray):
            cells = np.concatenate([one.time_cells, other.time_cells])
        else:
            cells = [*one.time_cells, *other.time_cells]
    sigma = None
    if one.sigma is not None and other.sigma is not None:
        sigma = np.concatenate([one.sigma, other.sigma])
    return Piece(
        Words(tuple(codes), np.concatenate([one.ids.codes, known[other.ids.codes]])),
        np.concatenate([one.time, other.time]),
        np.concatenate([one.plots, other.plots]),
        np.concatenate([one.rows, other.rows]),
        other.file,
        sigma,
        cells,
    )
