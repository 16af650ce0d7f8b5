"""Pieces of recordings: rows that are plots of any tracks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.io.table import Words
from fuzzytrack.reprs import summary

__all__ = ["Piece"]


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
    time_cells: Sequence[str] | NDArray[Any] | None = None
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
