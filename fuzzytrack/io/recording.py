"""Recordings: the plots of tracks in files, read piece by piece or as whole tracks."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.columns import Columns, choose_columns
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.formats import CSV, PARQUET, open_table
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.source import Source
from fuzzytrack.io.table import Table, Words, no_rows, silent
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress

__all__ = [
    "ROWS",
    "Piece",
    "Recording",
    "Track",
    "find_columns",
    "read_pieces",
    "read_tracks",
    "recording_files",
]


#: Rows of a piece: many enough for compiled code, few enough to be small beside a process.
ROWS = 250_000


@dataclass(frozen=True, eq=False)
class Track:
    """The plots of one track.

    Attributes
    ----------
    id : str
        Identity, as the file spells it; empty if the file names none.
    time : ndarray, shape (n_steps,)
        Times (s), increasing.
    plots : ndarray, shape (n_steps, n_axes)
        Positions, NaN where missed.
    """

    id: str
    time: Array
    plots: Array

    def __repr__(self) -> str:
        return summary(self, "id", "plots")


@dataclass(frozen=True, eq=False)
class Recording:
    """The tracks of a file, in order of first appearance.

    Attributes
    ----------
    file : str
        Name of the file.
    time, id : str
        Names of the columns of time and of identity; the latter empty if there is none.
    axes : tuple of str
        Names of the columns of position.
    tracks : tuple of Track
        At least one, with at least one plot each.
    """

    file: str
    time: str
    id: str
    axes: tuple[str, ...]
    tracks: tuple[Track, ...]

    def __repr__(self) -> str:
        return summary(self, "file", "axes", tracks=len(self.tracks))

    @property
    def columns(self) -> Columns:
        """Columns of the file that are time, identity and position."""
        return Columns(self.time, self.id, self.axes)


# -------------------------------------------------------------------- files and columns


def recording_files(path: PathLike) -> tuple[str, ...]:
    """Files of a recording: the file itself, or those of a folder, Parquet or CSV, by name.

    Raises
    ------
    DataError
        If the folder holds none, or some of both.
    OSError
        If it cannot be read.
    """
    if not os.path.isdir(path):
        return (os.fspath(path),)
    # Drafts of files that are being written begin with a dot.
    files = sorted(file for file in Path(path).iterdir() if file.is_file() and file.name[0] != ".")
    found = {
        name: tuple(str(file) for file in files if file.name.lower().endswith(suffixes))
        for name, suffixes in (("Parquet", PARQUET), ("CSV", CSV))
    }
    if all(found.values()):
        raise DataError(
            f"{path}: holds {Path(found['Parquet'][0]).name} and {Path(found['CSV'][0]).name}; the "
            "files of a folder must all be Parquet, or all CSV"
        )
    if not any(found.values()):
        raise DataError(f"{path}: holds no Parquet and no CSV files")
    return found["Parquet"] or found["CSV"]


def find_columns(
    files: Sequence[str],
    *,
    time: str | None = None,
    id: str | None = None,
    axes: Sequence[str] | None = None,
) -> Columns:
    """Find the columns of a recording, and check that all of its files have them.

    Parameters
    ----------
    files : sequence of str
        At least one.
    time, id, axes
        As for `read_tracks`.

    Raises
    ------
    DataError
        If a column is missing, or its type differs between files.
    OSError
        If a file cannot be read.
    """
    first = files[0]
    with open_table(first) as source:
        types = source.types
    columns = choose_columns(tuple(types), first, time, id, axes)
    for file in files[1:]:
        with open_table(file) as source:
            others = source.types
        for name in columns.kinds:
            if name not in others:
                raise DataError(f"{file}: no column {name!r}, which {first} has")
            if others[name] != types[name]:
                raise DataError(
                    f"{file}: column {name}: is {others[name]}; expected {types[name]}, as in "
                    f"{first}"
                )
    return columns


# -------------------------------------------------------------------- pieces


def read_pieces(
    files: Sequence[str],
    columns: Columns,
    *,
    rows: int | None = ROWS,
    progress: Progress | None = None,
) -> Iterator[Piece]:
    """Read a recording piece by piece, file by file.

    Parameters
    ----------
    files : sequence of str
        CSV or Parquet; see `fuzzytrack.io.formats.open_table`.
    columns : Columns
        From `find_columns`.
    rows : int or None
        Rows of a piece, at most; None makes each file one piece.
    progress : callable, optional
        Called with the share that has been read.

    Yields
    ------
    Piece
        At least one row; no piece of a file without rows.

    Raises
    ------
    DataError
        If a file does not hold such tracks; names row, column and value.
    OSError
        If a file cannot be read.

    Notes
    -----
    Holds one piece, and of a Parquet file about a megabyte a column, at a time, however large the
    row groups are.
    """
    if rows is not None and rows < 1:
        raise ValueError(f"rows must be at least 1, got {rows}")
    sizes = [os.path.getsize(file) for file in files]
    total = max(1, sum(sizes))
    before = 0
    for file, size in zip(files, sizes, strict=True):

        def watch(share: float, before: int = before, size: int = size) -> None:
            if progress is not None:
                progress((before + share * size) / total)

        with open_table(file) as source:
            for table in source.tables(columns.kinds, rows, watch):
                yield _piece(table, columns)
        before += size


def _piece(table: Table, columns: Columns) -> Piece:
    return Piece(
        table.words[columns.id] if columns.id else Words.same("", len(table.rows)),
        table.numbers[columns.time],
        np.stack([table.numbers[name] for name in columns.axes], axis=1),
        table.rows,
        table.file,
    )


# -------------------------------------------------------------------- tracks


def read_tracks(
    path: PathLike,
    *,
    time: str | None = None,
    id: str | None = None,
    axes: Sequence[str] | None = None,
    sort: bool = False,
    progress: Progress | None = None,
) -> Recording:
    """Read the plots of tracks.

    Parameters
    ----------
    path : str or path
        CSV or Parquet; see `fuzzytrack.io.formats.open_table`. Columns that are not named are
        ignored.
    time : str, optional
        Column of time (s); t, t_s, time or time_s unless given.
    id : str, optional
        Column of the identity of tracks, kept as text; one track unless given.
    axes : sequence of str, optional
        Columns of position; x, y, z or x_m, y_m, z_m, those that there are, unless given. An empty
        cell, ``nan`` or ``NA`` is a missed plot.
    sort : bool
        Whether to put plots in order of time.
    progress : callable, optional
        Called with the share of the file that has been read.

    Returns
    -------
    Recording

    Raises
    ------
    DataError
        If the file does not hold such tracks: names row, column, value and what was expected.
    OSError
        If it cannot be read.
    """
    file = os.fspath(path)
    with open_table(file) as source:
        # A file that is a pipe can be opened once only.
        columns = choose_columns(tuple(source.types), file, time, id, axes)
        piece = _whole(source, columns, progress or silent)
    tracks = _tracks(piece, columns, sort)
    return Recording(file, columns.time, columns.id, columns.axes, tracks)


def _whole(source: Source, columns: Columns, progress: Progress) -> Piece:
    """Read a whole file as one piece."""
    for table in source.tables(columns.kinds, None, progress):
        return _piece(table, columns)
    raise no_rows(source.file)


def _tracks(piece: Piece, columns: Columns, sort: bool) -> tuple[Track, ...]:
    """Tracks of a piece, in order of first appearance."""
    ids, times = piece.ids, piece.time
    # Stable: the order of the file within a track.
    order = np.lexsort((times, ids.codes)) if sort else np.argsort(ids.codes, kind="stable")
    codes, times = ids.codes[order], times[order]
    wrong = np.flatnonzero((np.diff(times) <= 0) & (np.diff(codes) == 0)) + 1
    if len(wrong):
        first = wrong[np.argmin(piece.rows[order[wrong]])]
        raise _time_error(piece, columns, order[first - 1], order[first])
    plots = piece.plots[order]
    ends = np.searchsorted(codes, np.arange(len(ids.names) + 1))
    return tuple(
        Track(name, times[start:end], plots[start:end])
        for name, start, end in zip(ids.names, ends[:-1], ends[1:], strict=True)
    )


def _time_error(piece: Piece, columns: Columns, before: int, here: int) -> DataError:
    """Error about the time of a row that is not later than that of the row before."""
    times, rows = piece.time, piece.rows
    id = piece.ids[here]
    whose = f" (id {id!r})" if id else ""
    if times[here] == times[before]:
        # Several tracks in one file look like this when their identities are not read.
        mend = "" if id else "; if these are several tracks, name the column of their id (`id`)"
        what = f"repeats that of row {rows[before]}"
        wanted = f"expected times that differ{mend}"
    else:
        what = f"is earlier than {times[before]:.15g} in row {rows[before]}"
        wanted = "expected increasing times; `sort` puts them in order"
        if not id:
            wanted += ", and `id` names the column that distinguishes tracks"
    return DataError(
        f"{piece.file}: row {rows[here]}, column {columns.time}: time {times[here]:.15g}{whose} "
        f"{what}; {wanted}"
    )
