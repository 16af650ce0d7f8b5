"""Files of plots sorted into partitions by the identity of their tracks."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from typing import Any

import numpy as np

from fuzzytrack.io.files import PathLike, whole_file
from fuzzytrack.io.parquet import arrow_table, import_pyarrow, parquet_writer, words_of
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.plot_files import ROWS

__all__ = ["partition_of", "read_partition", "write_partitions"]

# Columns of a file of partitions; those of the recording may have any names.
_ROW, _CELL = "row", "time_cell"


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
    rows = 0
    with whole_file(path) as draft, ExitStack() as stack:
        writer: Any = None
        for piece in pieces:
            if writer is None:
                types = _types(_values(piece))
                writer = stack.enter_context(parquet_writer(draft, types, compact=False))
            for table in _parts(writer.schema, piece, partitions):
                writer.write_table(table)
            rows += len(piece)
        if writer is None:
            nothing = _values(Piece.of([], [], np.empty((0, n_axes))))
            stack.enter_context(parquet_writer(draft, _types(nothing), compact=False))
    return rows


def _axes(n_axes: int, what: str = "axis") -> list[str]:
    return [f"{what}_{k}" for k in range(n_axes)]


def _values(piece: Piece) -> dict[str, Any]:
    """Columns of a piece; those that it does not have are left out."""
    values: dict[str, Any] = {"id": piece.ids, _ROW: piece.rows, "time": piece.time}
    n_axes = piece.plots.shape[1]
    values |= {name: piece.plots[:, k] for k, name in enumerate(_axes(n_axes))}
    if piece.sigma is not None:
        values |= {name: piece.sigma[:, k] for k, name in enumerate(_axes(n_axes, "sigma"))}
    if piece.time_cells is not None:
        values[_CELL] = piece.time_cells
    return values


def _types(values: Mapping[str, Any]) -> dict[str, str]:
    """Names of the columns, and their types as Arrow calls them."""
    return {name: _type(column) for name, column in values.items()}


def _type(column: Any) -> str:
    if not isinstance(column, np.ndarray):
        return "string"
    if column.dtype.kind == "M":
        return f"timestamp[{np.datetime_data(column.dtype)[0]}]"
    return str(column.dtype.name)


def _parts(schema: Any, piece: Piece, partitions: int) -> Iterator[Any]:
    """Rows of each partition of a piece."""
    of_name = np.array([partition_of(name, partitions) for name in piece.ids.names], dtype=np.int64)
    of_row = of_name[piece.ids.codes]
    order = np.argsort(of_row, kind="stable")
    whole = arrow_table(schema, _values(piece.take(order)))
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
    with open(path, "rb") as stream:
        source = arrow.parquet.ParquetFile(stream, pre_buffer=False)
        groups: list[int] = []
        waiting = 0

        def piece() -> Piece:
            return _piece(source.read_row_groups(groups), n_axes, file)

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


def _piece(table: Any, n_axes: int, file: str) -> Piece:
    there = table.column_names

    def stacked(names: Sequence[str]) -> Any:
        return np.stack([table.column(name).to_numpy() for name in names], axis=1)

    sigma = _axes(n_axes, "sigma")
    cells = table.column(_CELL) if _CELL in there else None
    if cells is not None:
        cells = cells.to_pylist() if str(cells.type) == "string" else cells.to_numpy()
    return Piece(
        words_of(table.column("id")),
        table.column("time").to_numpy(),
        stacked(_axes(n_axes)),
        table.column(_ROW).to_numpy(),
        file,
        sigma=stacked(sigma) if sigma[0] in there else None,
        time_cells=cells,
    )
