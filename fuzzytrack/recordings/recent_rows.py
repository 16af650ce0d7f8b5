"""The last rows of a track of a live feed, so that a late one can be put in its place."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fuzzytrack.io.piece import Piece
from fuzzytrack.io.table import Words

__all__ = ["EVERY", "RecentRows", "Row", "piece_of_rows", "row_of"]

#: Rows between those before which the numbers of a track are kept. What lies between is run again,
#: which takes little more time for eight rows than for one, and an eighth of the memory.
EVERY = 8


@dataclass(slots=True)
class Row:
    """A row of a track, and what was answered.

    Attributes
    ----------
    time : float
        Its time (s), counted on where the clock of the feed starts again at 0.
    plot : tuple of float
        Position as it came (m), NaN where missed.
    sigma : tuple of float or None
        Standard deviations of the plot (m), if it has its own.
    cell : object
        Its time as it came, if that is known.
    line : int
        Line of the feed.
    answer : bytes
        Digest of the answer.
    revision : int
        How often the answer was written again.
    before : bytes or None
        Numbers of the track before this row, in some rows; see `LiveTracks`.
    """

    time: float
    plot: tuple[float, ...]
    sigma: tuple[float, ...] | None
    cell: Any
    line: int
    answer: bytes = b""
    revision: int = 0
    before: bytes | None = None


@dataclass(slots=True)
class RecentRows:
    """Rows of a track in order of time, no older than needed.

    Attributes
    ----------
    rows : list of Row
        The first one has the numbers of the track before it.
    since : int
        Rows at the end, from the last one on that has these numbers.
    """

    rows: list[Row] = field(default_factory=list)
    since: int = 0

    @classmethod
    def of(cls, rows: list[Row]) -> RecentRows:
        """Rows in order of time, as another one had them."""
        last = max(k for k, row in enumerate(rows) if row.before is not None)
        return cls(rows, len(rows) - last)

    @property
    def is_due(self) -> bool:
        """Whether the next row needs the numbers before it."""
        return not self.rows or self.since >= EVERY

    def add(self, row: Row) -> None:
        """Add the newest row."""
        self.since = 1 if row.before is not None else self.since + 1
        self.rows.append(row)

    def at(self, time: float) -> Row | None:
        """Row of a time, if there is one."""
        place = self._place(time)
        found = place < len(self.rows) and self.rows[place].time == time
        return self.rows[place] if found else None

    def insert(self, row: Row) -> tuple[int, int]:
        """Put a late row in its place.

        Returns
        -------
        first, place : int
            The row from which the track must be run again, and the late row.
        """
        rows, place = self.rows, self._place(row.time)
        if place < len(rows):
            # The numbers before the row that follows are those before the late row now.
            row.before, rows[place].before = rows[place].before, None
        rows.insert(place, row)
        for later in rows[place + 1 :]:
            later.before = None
        first = place
        while rows[first].before is None:
            first -= 1
        self.since = len(rows) - first
        return first, place

    def prune(self, horizon: float) -> None:
        """Drop rows that no late row at `horizon` (s) or later needs."""
        rows = self.rows
        if len(rows) < 2 or rows[1].time >= horizon:
            return
        last = self._place(horizon)
        while last and (last == len(rows) or rows[last].before is None):
            last -= 1
        del rows[:last]

    def _place(self, time: float) -> int:
        return bisect_left(self.rows, time, key=lambda row: row.time)


def row_of(piece: Piece, k: int) -> Row:
    """A row of a piece."""
    sigma = None if piece.sigma is None else tuple(piece.sigma[k].tolist())
    cell = None if piece.time_cells is None else piece.time_cells[k]
    plot = tuple(piece.plots[k].tolist())
    return Row(float(piece.time[k]), plot, sigma, cell, int(piece.rows[k]))


def piece_of_rows(
    ids: Sequence[str], counts: Sequence[int], rows: Sequence[Row], file: str
) -> Piece:
    """Rows of some tracks as a piece, one track after the other."""
    return Piece(
        Words(tuple(ids), np.repeat(np.arange(len(ids)), counts)),
        np.array([row.time for row in rows]),
        np.array([row.plot for row in rows]),
        np.array([row.line for row in rows], dtype=np.int64),
        file,
        sigma=None if rows[0].sigma is None else np.array([row.sigma for row in rows]),
        time_cells=None if rows[0].cell is None else [row.cell for row in rows],
    )
