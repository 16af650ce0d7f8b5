"""The last plot of every track that was used, from piece to piece."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.io.piece import Piece

__all__ = ["KNOWN", "LastPlots", "RowsSince"]

#: How many numbers are known of an identity.
KNOWN = 3

# Segment of a track, time of its last plot (s), and its plots so far, counted up to two.
_Last: TypeAlias = tuple[int, float, int]
_NOTHING: _Last = (-1, math.nan, 0)


@dataclass(frozen=True, eq=False)
class RowsSince:
    """What is known at each row of a piece of the last plot of its track.

    Attributes
    ----------
    seconds : ndarray, shape (n_rows,)
        Time since that plot (s), 0 where the row has one that was used; NaN before the first.
    moving : ndarray of bool, shape (n_rows,)
        Whether there were two plots, from which a velocity is known.
    """

    seconds: Array
    moving: Mask


class LastPlots:
    """The last plots of many tracks, which continue from piece to piece.

    A track begins again with each of its segments. Holds about 200 bytes for each identity.
    """

    def __init__(self) -> None:
        self._last: dict[str, _Last] = {}

    def numbers(self, ids: Sequence[str]) -> Array:
        """What is known of some identities: segment, time and plots, shape (n_ids, `KNOWN`)."""
        return np.array([self._last.get(id, _NOTHING) for id in ids], dtype=np.float64)

    def put(self, ids: Sequence[str], numbers: Array) -> None:
        """Make of some identities known what `numbers` gave."""
        for id, (segment, time, count) in zip(ids, numbers.tolist(), strict=True):
            self._last[id] = int(segment), time, int(count)

    def forget(self, ids: Sequence[str]) -> None:
        """Forget some identities."""
        for id in ids:
            self._last.pop(id, None)

    def advance(self, piece: Piece, used: Mask) -> RowsSince:
        """Take one more piece in.

        Parameters
        ----------
        piece : Piece
        used : ndarray of bool, shape (n_rows,)
            Whether the plot of a row was used.
        """
        n = len(used)
        if not n:
            return RowsSince(np.empty(0), np.empty(0, dtype=np.bool_))
        codes = piece.ids.codes
        segments = np.zeros(n, dtype=np.int64) if piece.segments is None else piece.segments
        order = np.lexsort((segments, codes))
        codes, segments, seen = codes[order], segments[order], used[order]
        times = piece.time[order]
        places = np.arange(n)
        starts = np.flatnonzero(_differs(codes) | _differs(segments))
        group = np.repeat(np.arange(len(starts)), np.diff([*starts, n]))
        before = [self._before(piece, row, segments) for row in order[starts].tolist()]
        carried = np.array([time for _, time, _ in before])
        counted = np.array([count for _, _, count in before], dtype=np.int64)

        last = np.maximum.accumulate(np.where(seen, places, -1))
        here = last >= starts[group]
        since = np.where(here, times[np.maximum(last, 0)], carried[group])
        total = np.cumsum(seen)
        count = counted[group] + total - (total - seen)[starts][group]
        ends = np.append(starts[1:], n) - 1
        for end in ends.tolist():
            found = int(segments[end]), float(since[end]), min(int(count[end]), 2)
            self._last[piece.ids.names[codes[end]]] = found
        back = np.empty(n, dtype=np.int64)
        back[order] = places
        return RowsSince((times - since)[back], (count >= 2)[back])

    def _before(self, piece: Piece, row: int, segments: NDArray[np.int64]) -> _Last:
        """The last plot before the piece of the track of a row; of none in another segment."""
        last = self._last.get(piece.ids[row], _NOTHING)
        segment = 0 if piece.segments is None else int(piece.segments[row])
        return last if last[0] == segment else _NOTHING


def _differs(values: NDArray[np.int64]) -> Mask:
    """Where a value differs from the one before; the first one does."""
    found = np.ones(len(values), dtype=np.bool_)
    found[1:] = values[1:] != values[:-1]
    return found
