"""Pieces of recordings: rows that are plots of any tracks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.table import Cells, Words
from fuzzytrack.reprs import summary

__all__ = ["Piece", "check_finite", "joined", "joined_cells", "place_of"]


@dataclass(frozen=True, eq=False)
class Piece:
    """Some rows of a recording: the plots of any tracks, those of one track in order of time.

    Attributes
    ----------
    ids : Words
        Identity of the track of each row, as text.
    time : ndarray, shape (n_rows,)
        Times (s).
    plots : ndarray, shape (n_rows, n_axes)
        Positions (m), NaN where missed.
    rows : ndarray of int, shape (n_rows,)
        Where the rows stand in the file, counted from 1.
    file : str
        Name of the file, for messages; empty if there is none.
    sigma : ndarray, shape (n_rows, n_axes), optional
        Standard deviations of the plots (m), where each plot has its own; NaN where unknown.
    time_cells : sequence of str or ndarray, length n_rows, optional
        Times as the file has them, which a file of tracks repeats; without them it has `time`.
    segments : ndarray of int, shape (n_rows,), optional
        Which part of its track each row belongs to, counted from 0: a track that was not seen for
        long begins again. Without them no track is divided.
    """

    ids: Words
    time: Array
    plots: Array
    rows: NDArray[np.int64]
    file: str = ""
    sigma: Array | None = None
    time_cells: Cells | None = None
    segments: NDArray[np.int64] | None = None

    def __repr__(self) -> str:
        return summary(self, "file", "ids", "plots")

    @classmethod
    def of(cls, ids: ArrayLike, time: ArrayLike, plots: ArrayLike) -> Piece:
        """Make a piece of arrays.

        Parameters
        ----------
        ids : array_like, shape (n_rows,)
            Identities, numbers or text.
        time : array_like, shape (n_rows,)
            Times (s).
        plots : array_like, shape (n_rows, n_axes)
            Positions (m), NaN where missed.

        Raises
        ------
        ValueError
            If the shapes do not fit.
        """
        marks, times = np.asarray(ids), np.asarray(time, dtype=np.float64)
        positions = np.asarray(plots, dtype=np.float64)
        if positions.ndim != 2 or not positions.shape[1]:
            raise ValueError(f"plots: shape must be (n_rows, n_axes), got {positions.shape}")
        for name, values in (("ids", marks), ("time", times)):
            if values.shape != positions.shape[:1]:
                raise ValueError(
                    f"{name}: shape {values.shape} does not fit plots of shape {positions.shape}; "
                    f"{positions.shape[:1]} does"
                )
        names, codes = np.unique(marks, return_inverse=True)
        words = Words(tuple(map(str, names.tolist())), codes.astype(np.int64))
        return cls(words, times, positions, np.arange(1, len(times) + 1))

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.time)

    @property
    def tracks(self) -> Words:
        """Which track each row belongs to: its identity, and its segment from the second one on."""
        if self.segments is None or not self.segments.any():
            return self.ids
        # In order of first appearance, as identities are.
        _, first, codes = np.unique(
            self.ids.codes * (int(self.segments.max()) + 1) + self.segments,
            return_index=True,
            return_inverse=True,
        )
        order = np.argsort(first)
        place = np.empty(len(order), dtype=np.int64)
        place[order] = np.arange(len(order))
        names = (
            f"{self.ids[row]}\0{self.segments[row]}" if self.segments[row] else self.ids[row]
            for row in first[order].tolist()
        )
        return Words(tuple(names), place[codes])

    def take(self, places: NDArray[Any]) -> Piece:
        """Rows of this piece.

        Parameters
        ----------
        places : ndarray of int or bool
            Positions of the rows, or for each row whether it is taken.
        """
        cells = self.time_cells
        if cells is not None and not isinstance(cells, np.ndarray):
            chosen = np.flatnonzero(places) if places.dtype == bool else places
            cells = [cells[place] for place in chosen.tolist()]
        elif cells is not None:
            cells = cells[places]
        return replace(
            self,
            ids=Words(self.ids.names, self.ids.codes[places]),
            time=self.time[places],
            plots=self.plots[places],
            rows=self.rows[places],
            sigma=None if self.sigma is None else self.sigma[places],
            time_cells=cells,
            segments=None if self.segments is None else self.segments[places],
        )


def joined(pieces: Sequence[Piece]) -> Piece:
    """Pieces as one; the file of the first one stands for all."""
    if len(pieces) == 1:
        return pieces[0]
    names: dict[str, int] = {}
    codes = []
    for piece in pieces:
        new = np.array([names.setdefault(name, len(names)) for name in piece.ids.names])
        codes.append(new[piece.ids.codes])

    def one(name: str) -> Any:
        parts = [getattr(piece, name) for piece in pieces]
        return None if any(part is None for part in parts) else np.concatenate(parts)

    return Piece(
        Words(tuple(names), np.concatenate(codes)),
        one("time"),
        one("plots"),
        one("rows"),
        pieces[0].file,
        sigma=one("sigma"),
        time_cells=joined_cells([piece.time_cells for piece in pieces]),
        segments=one("segments"),
    )


def joined_cells(parts: Sequence[Cells | None]) -> Cells | None:
    """Cells of pieces, one after the other; None if a piece has none."""
    arrays = [part for part in parts if isinstance(part, np.ndarray)]
    if len(arrays) == len(parts):
        return np.concatenate(arrays)
    if any(part is None for part in parts):
        return None
    return [str(cell) for part in parts if part is not None for cell in part]


def check_finite(piece: Piece) -> None:
    """Raise a DataError for the first time or plot that is infinite; names its row."""
    for name, bad, wanted in (
        ("time", ~np.isfinite(piece.time), "a finite number"),
        ("plot", np.isinf(piece.plots).any(axis=1), "finite numbers, or NaN where missed"),
    ):
        if bad.any():
            row = int(np.argmax(bad))
            value = piece.time[row] if name == "time" else piece.plots[row]
            raise DataError(f"{place_of(piece, row)}: {name} {value}; expected {wanted}")


def place_of(piece: Piece, row: int) -> str:
    """File and row of a row of a piece, for messages."""
    place = f"row {piece.rows[row]}"
    return f"{piece.file}: {place}" if piece.file else place
