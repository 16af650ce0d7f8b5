"""Recordings in pieces, for files larger than memory."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.columns import Columns, choose_columns
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.table import (
    EXPECTED,
    PARQUET,
    Column,
    Kind,
    Progress,
    Table,
    Words,
    checked_names,
    chunks,
    import_pyarrow,
    is_number,
    make_table,
    not_utf8,
)

__all__ = ["ROWS", "Piece", "find_columns", "read_pieces", "recording_files"]


#: Rows of a piece: many enough for compiled code, few enough to be small beside a process.
ROWS = 250_000

# Bytes of a compressed column that are read at a time, however large the row group.
_BUFFER = 1 << 20


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
    """

    ids: Words
    time: Array
    plots: Array
    rows: NDArray[np.int64]
    file: str = ""

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


# -------------------------------------------------------------------- files and columns


def recording_files(path: PathLike) -> tuple[str, ...]:
    """Files of a recording: the file itself, or those of a folder that are Parquet, by name.

    Raises
    ------
    DataError
        If the folder holds none.
    OSError
        If it cannot be read.
    """
    if not os.path.isdir(path):
        return (os.fspath(path),)
    files = sorted(file for file in Path(path).iterdir() if file.suffix.lower() in PARQUET)
    # Drafts of files that are being written begin with a dot.
    found = tuple(str(file) for file in files if file.is_file() and file.name[0] != ".")
    if not found:
        raise DataError(f"{path}: holds no Parquet files ({', '.join(PARQUET)})")
    return found


def find_columns(
    files: Sequence[str],
    *,
    time: str | None = None,
    id: str | None = None,
    axes: Sequence[str] | None = None,
) -> Columns:
    """Find the columns of a recording, and whether all of its files have them.

    Parameters
    ----------
    files : sequence of str
        At least one; several must be Parquet.
    time, id, axes
        As for `fuzzytrack.io.read_tracks`.

    Raises
    ------
    DataError
        If a column is missing, or its type differs between files.
    OSError
        If a file cannot be read.
    """
    first = files[0]
    if len(files) == 1 and not first.lower().endswith(PARQUET):
        return choose_columns(_csv_names(first), first, time, id, axes)
    types = _parquet_types(first)
    columns = choose_columns(tuple(types), first, time, id, axes)
    for file in files[1:]:
        others = _parquet_types(file)
        for name in columns.kinds:
            if name not in others:
                raise DataError(f"{file}: no column {name!r}, which {first} has")
            if others[name] != types[name]:
                raise DataError(
                    f"{file}: column {name}: is {others[name]}; expected {types[name]}, as in "
                    f"{first}"
                )
    return columns


def _csv_names(file: str) -> tuple[str, ...]:
    with open(file, encoding="utf-8-sig", newline="") as stream:
        try:
            return _header(csv.reader(stream, strict=True), file)
        except UnicodeDecodeError:
            raise not_utf8(file) from None
        except csv.Error as error:
            raise DataError(f"{file}: row 1: not CSV: {error}") from None


def _header(reader: Any, file: str) -> tuple[str, ...]:
    header = next((row for row in reader if row), None)
    if header is None:
        raise DataError(f"{file}: is empty; expected a row of column names, then data")
    return checked_names([name.strip() for name in header], file)


def _parquet_types(file: str) -> dict[str, Any]:
    arrow = import_pyarrow(file)
    with open(file, "rb") as stream:
        try:
            schema = arrow.parquet.read_schema(stream)
        # Of a page that is broken, pyarrow says so by an OSError.
        except (arrow.ArrowException, OSError) as error:
            raise DataError(f"{file}: is not a Parquet file that can be read: {error}") from None
    return dict(zip(checked_names(schema.names, file), schema.types, strict=True))


# -------------------------------------------------------------------- pieces


def read_pieces(
    files: Sequence[str],
    columns: Columns,
    *,
    rows: int = ROWS,
    progress: Progress | None = None,
) -> Iterator[Piece]:
    """Read a recording piece by piece, file by file.

    Parameters
    ----------
    files : sequence of str
        CSV or Parquet; see `fuzzytrack.io.table.read_table`.
    columns : Columns
        From `find_columns`.
    rows : int
        Rows of a piece, at most.
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
    if rows < 1:
        raise ValueError(f"rows must be at least 1, got {rows}")
    sizes = [os.path.getsize(file) for file in files]
    total = max(1, sum(sizes))
    before = 0
    for file, size in zip(files, sizes, strict=True):

        def watch(share: float, before: int = before, size: int = size) -> None:
            if progress is not None:
                progress((before + share * size) / total)

        read = _parquet_pieces if file.lower().endswith(PARQUET) else _csv_pieces
        for table in read(file, columns.kinds, rows, watch):
            yield _piece(table, columns)
        before += size


def _piece(table: Table, columns: Columns) -> Piece:
    nobody = Words(("",), np.zeros(len(table.rows), dtype=np.int64))
    return Piece(
        table.words[columns.id] if columns.id else nobody,
        table.numbers[columns.time],
        np.stack([table.numbers[name] for name in columns.axes], axis=1),
        table.rows,
        table.file,
    )


def _csv_pieces(
    file: str, kinds: Mapping[str, Kind], rows: int, progress: Progress
) -> Iterator[Table]:
    with open(file, encoding="utf-8-sig", newline="") as stream:
        size = max(1, os.fstat(stream.fileno()).st_size)
        reader = csv.reader(stream, strict=True)
        try:
            names = _header(reader, file)
            for table in _csv_tables(file, reader, names, kinds, rows):
                yield table
                progress(min(stream.buffer.tell() / size, 1.0))  # type: ignore[attr-defined]
        except UnicodeDecodeError:
            raise not_utf8(file) from None
        except csv.Error as error:
            raise DataError(f"{file}: row {reader.line_num}: not CSV: {error}") from None


def _csv_tables(
    file: str, reader: Any, names: tuple[str, ...], kinds: Mapping[str, Kind], rows: int
) -> Iterator[Table]:
    places = [names.index(name) for name in kinds]
    columns: list[Column] = []
    numbers: list[int] = []
    for found, cells in chunks(file, reader, len(names)):
        for start in range(0, len(found), rows):
            part = found[start : start + rows]
            if len(numbers) + len(part) > rows:
                yield make_table(file, columns, np.array(numbers))
                numbers = []
            if not numbers:
                columns = [Column(file, name, kind) for name, kind in kinds.items()]
            for column, place in zip(columns, places, strict=True):
                column.take(cells[place][start : start + rows], part)
            numbers += part
    if numbers:
        yield make_table(file, columns, np.array(numbers))


def _parquet_pieces(
    file: str, kinds: Mapping[str, Kind], rows: int, progress: Progress
) -> Iterator[Table]:
    arrow = import_pyarrow(file)
    with open(file, "rb") as stream:
        try:
            source = arrow.parquet.ParquetFile(stream, buffer_size=_BUFFER, pre_buffer=False)
            total = max(1, source.metadata.num_rows)
            first = 1
            for batch in source.iter_batches(rows, columns=list(kinds)):
                if not batch.num_rows:
                    continue
                yield _batch_table(file, batch, kinds, np.arange(first, first + batch.num_rows))
                first += batch.num_rows
                progress((first - 1) / total)
        # Of a page that is broken, pyarrow says so by an OSError.
        except (arrow.ArrowException, OSError) as error:
            raise DataError(f"{file}: is not a Parquet file that can be read: {error}") from None


def _batch_table(
    file: str, batch: Any, kinds: Mapping[str, Kind], rows: NDArray[np.int64]
) -> Table:
    arrow = import_pyarrow(file)
    numbers: dict[str, Array] = {}
    words: dict[str, Words] = {}
    for name, kind in kinds.items():
        column, values = Column(file, name, kind), batch.column(name)
        if kind == "word":
            words[name] = _words(column, values, rows)
        elif is_number(arrow, values.type):
            numbers[name] = _finite(column, values, rows)
        else:
            column.take(["" if v is None else str(v) for v in values.to_pylist()], rows.tolist())
            numbers[name] = np.concatenate(column.parts)
    return Table(file, rows, numbers, words)


def _finite(column: Column, values: Any, rows: NDArray[np.int64]) -> Array:
    found: Array = values.to_numpy(zero_copy_only=False).astype(np.float64)
    bad = np.isinf(found) if column.kind == "gaps" else ~np.isfinite(found)
    if bad.any():
        place = int(np.argmax(bad))
        raise column.error(int(rows[place]), str(found[place]), EXPECTED[column.kind])
    return found


def _words(column: Column, values: Any, rows: NDArray[np.int64]) -> Words:
    """Words of a column; only the different ones become Python's."""
    if values.null_count:
        raise column.error(int(rows[int(np.argmax(values.is_null()))]), "", "some text")
    encoded = values.dictionary_encode()
    names = _texts(encoded.dictionary)
    codes = encoded.indices.to_numpy(zero_copy_only=False).astype(np.int64)
    if len(set(names)) < len(names):
        # Words that differ by blanks at their ends only are one.
        position: dict[str, int] = {}
        codes = np.array([position.setdefault(name, len(position)) for name in names])[codes]
        names = list(position)
    if "" in names:
        raise column.error(int(rows[np.argmax(codes == names.index(""))]), "", "some text")
    return Words(tuple(names), codes)


def _texts(values: Any) -> list[str]:
    from pyarrow import compute, string, types

    if types.is_integer(values.type) or types.is_string(values.type):
        found: list[str] = compute.utf8_trim_whitespace(values.cast(string())).to_pylist()
        return found
    return [str(value).strip() for value in values.to_pylist()]
