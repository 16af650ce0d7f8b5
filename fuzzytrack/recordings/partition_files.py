"""Files of plots sorted into partitions by the identity of their tracks."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from fuzzytrack.io.columns import Columns
from fuzzytrack.io.files import PathLike, whole_file
from fuzzytrack.io.parquet import arrow_table, import_pyarrow, parquet_writer, words_of
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.recording import ROWS
from fuzzytrack.io.table import Words

__all__ = ["partition_of", "read_partition", "write_partitions"]

# Columns of a file of partitions; those of the recording may have any names.
_ROW = "row"


def partition_of(id: str, partitions: int) -> int:
    """Partition that a track belongs to, the same on any computer."""
    return zlib.crc32(id.encode()) % partitions


def write_partitions(path: PathLike, pieces: Iterable[Piece], n_axes: int, partitions: int) -> int:
    """Write a Parquet file in which the rows of each partition can be read by themselves.

    Parameters
    ----------
    path : str or path
        The file; it appears whole or not at all.
    pieces : iterable of Piece
        Of one file of a recording.
    n_axes : int
        Axes of the plots.
    partitions : int
        Number of partitions.

    Returns
    -------
    int
        Number of rows.

    Notes
    -----
    Each piece becomes as many row groups as there are partitions, empty ones included: row group
    k·partitions + p holds the rows of partition p of piece k, in their order.
    """
    columns = _columns(n_axes)
    types = {columns.id: "string", _ROW: "int64", columns.time: "float64"}
    types |= dict.fromkeys(columns.axes, "float64")
    with whole_file(path) as draft, parquet_writer(draft, types, compact=False) as writer:
        rows = 0
        for piece in pieces:
            rows += len(piece.time)
            for table in _parts(writer.schema, columns, piece, partitions):
                writer.write_table(table)
    return rows


def _columns(n_axes: int) -> Columns:
    return Columns("time", "id", tuple(f"axis_{k}" for k in range(n_axes)))


def _parts(schema: Any, columns: Columns, piece: Piece, partitions: int) -> Iterator[Any]:
    """Rows of each partition of a piece."""
    of_name = np.array([partition_of(name, partitions) for name in piece.ids.names], dtype=np.int64)
    of_row = of_name[piece.ids.codes]
    order = np.argsort(of_row, kind="stable")
    values = {
        columns.id: Words(piece.ids.names, piece.ids.codes[order]),
        _ROW: piece.rows[order],
        columns.time: piece.time[order],
        **{name: piece.plots[order, k] for k, name in enumerate(columns.axes)},
    }
    whole = arrow_table(schema, values)
    ends = np.cumsum(np.bincount(of_row, minlength=partitions)).tolist()
    for start, end in zip([0, *ends[:-1]], ends, strict=True):
        yield whole.slice(start, end - start)


def read_partition(
    path: PathLike,
    n_axes: int,
    partition: int,
    partitions: int,
    *,
    file: str,
    rows: int = ROWS,
) -> Iterator[Piece]:
    """Read one partition of a file of partitions, piece by piece.

    Parameters
    ----------
    path : str or path
        From `write_partitions`.
    n_axes, partitions : int
        As they were there.
    partition : int
        Which of them, from 0.
    file : str
        Name of the file that was sorted, for messages.
    rows : int
        Rows of a piece, at most; but a row group at least.

    Yields
    ------
    Piece
        At least one row; `rows` are those of the file that was sorted.
    """
    arrow = import_pyarrow(str(path))
    columns = _columns(n_axes)
    with open(path, "rb") as stream:
        source = arrow.parquet.ParquetFile(stream, pre_buffer=False)
        groups: list[int] = []
        waiting = 0

        def piece() -> Piece:
            return _piece(source.read_row_groups(groups), columns, file)

        for group in range(partition, source.num_row_groups, partitions):
            count = source.metadata.row_group(group).num_rows
            if groups and waiting + count > rows:
                yield piece()
                groups, waiting = [], 0
            if count:
                groups.append(group)
                waiting += count
        if groups:
            yield piece()


def _piece(table: Any, columns: Columns, file: str) -> Piece:
    words = words_of(table.column(columns.id))
    plots = np.stack([table.column(name).to_numpy() for name in columns.axes], axis=1)
    rows = table.column(_ROW).to_numpy()
    return Piece(words, table.column(columns.time).to_numpy(), plots, rows, file)
