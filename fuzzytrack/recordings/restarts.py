"""Tracks that their gate has started again: each start is a new segment of its track."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from fuzzytrack.arrays import Mask
from fuzzytrack.io.piece import Piece

__all__ = ["Restarts"]


class Restarts:
    """Counts the starts of every track, from piece to piece."""

    def __init__(self) -> None:
        self._so_far: Counter[str] = Counter()

    def advance(self, piece: Piece, begins: Mask) -> Piece:
        """Number the segments of a piece anew.

        Parameters
        ----------
        piece : Piece
            The rows of each track in order of time.
        begins : ndarray of bool, shape (n_rows,)
            Rows at which a track starts again.
        """
        if not self._so_far and not begins.any():
            return piece
        codes, names = piece.ids.codes, piece.ids.names
        order = np.argsort(codes, kind="stable")
        # Starts up to each row, over all tracks, less those of the tracks before.
        running = np.cumsum(begins[order])
        starts = np.searchsorted(codes[order], np.arange(len(names)))
        before = np.concatenate([[0], running])[starts]
        more = np.empty(len(codes), dtype=np.int64)
        more[order] = running - before[codes[order]]
        known = np.array([self._so_far[name] for name in names], dtype=np.int64)
        segments = known[codes] + more + (0 if piece.segments is None else piece.segments)
        counts = np.bincount(codes[begins], minlength=len(names))
        self._so_far.update({names[k]: int(counts[k]) for k in np.flatnonzero(counts).tolist()})
        return replace(piece, segments=segments)
