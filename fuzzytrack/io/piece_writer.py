"""Tables of tracks, written piece by piece."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.files import PathLike, whole_file
from fuzzytrack.io.recording import Piece
from fuzzytrack.io.table import CHUNK, Words, cells, import_pyarrow, table_writer, write_parquet

__all__ = ["OUTPUTS", "piece_writer"]

Values = Mapping[str, Words | Array]

#: What must be known of a track to write it.
OUTPUTS = ("predicted", "filtered", "velocity", "innovation", "gains")


@contextmanager
def piece_writer(
    path: PathLike, columns: Columns, inputs: tuple[PathLike, ...] = ()
) -> Iterator[Callable[[Piece, Mapping[str, Array]], None]]:
    """Write tracks piece by piece; the file appears whole or not at all.

    Parameters
    ----------
    path : str or path
        CSV or Parquet by its suffix.
    columns : Columns
        Of the recording.
    inputs : tuple of str or path
        Files that must not be overwritten.

    Yields
    ------
    callable
        To be called with a piece and the outputs of its rows by name, each shaped as its plots.

    Raises
    ------
    DataError
        If the suffix is unknown, two columns would share a name, or the file is one of the inputs.
    OSError
        If the file cannot be written.

    Notes
    -----
    Columns as `fuzzytrack.recordings.write_tracks` has them, with gamma_NAME always. A piece is one
    row group of a Parquet file.
    """
    names = [name for name, _ in _names(columns)]
    doubled = [name for name in names if names.count(name) > 1]
    if doubled:
        raise DataError(f"{path}: two columns of the output would be {doubled[0]!r}")
    open_table = _parquet if table_writer(path) is write_parquet else _csv
    with whole_file(path, inputs) as draft, open_table(draft, columns) as write:

        def write_piece(piece: Piece, outputs: Mapping[str, Array]) -> None:
            write(_values(columns, piece, outputs))

        yield write_piece


def _names(columns: Columns) -> list[tuple[str, tuple[str, int] | None]]:
    """Columns of the table, and where those come from that are outputs: name and axis."""
    found: list[tuple[str, tuple[str, int] | None]] = []
    if columns.id:
        found.append((columns.id, None))
    found.append((columns.time, None))
    for k, axis in enumerate(columns.axes):
        found.append((axis, None))
        for name in ("predicted", "filtered", "velocity", "innovation"):
            found.append((f"{axis}_{name}", (name, k)))
        for name in ("alpha", "beta", "gamma"):
            found.append((f"{name}_{axis}", (name, k)))
    return found


def _values(columns: Columns, piece: Piece, outputs: Mapping[str, Array]) -> Values:
    values: dict[str, Words | Array] = {columns.time: piece.time}
    if columns.id:
        values[columns.id] = piece.ids
    for k, axis in enumerate(columns.axes):
        values[axis] = piece.plots[:, k]
    for name, source in _names(columns):
        if source is not None:
            output, k = source
            values[name] = outputs[output][:, k]
    return values


@contextmanager
def _parquet(draft: Path, columns: Columns) -> Iterator[Callable[[Values], None]]:
    arrow = import_pyarrow(str(draft))
    schema = arrow.schema(
        [
            (name, arrow.string() if name == columns.id else arrow.float64())
            for name, _ in _names(columns)
        ]
    )
    with column_writer(arrow, draft, schema, columns.id) as writer:

        def write(values: Values) -> None:
            arrays = [arrow_column(arrow, values[name]) for name in schema.names]
            writer.write_table(arrow.Table.from_arrays(arrays, schema=schema))

        yield write


def column_writer(arrow: Any, path: Path, schema: Any, id: str) -> Any:
    """Writer of a Parquet file; a dictionary of numbers that all differ would cost much time."""
    return arrow.parquet.ParquetWriter(path, schema, use_dictionary=[id] if id else False)


def arrow_column(arrow: Any, values: Words | NDArray[Any]) -> Any:
    """Column as pyarrow has it; NaN becomes null."""
    if isinstance(values, Words):
        codes = arrow.array(values.codes.astype(np.int32))
        names = arrow.array(values.names, type=arrow.string())
        return arrow.DictionaryArray.from_arrays(codes, names).cast(arrow.string())
    return arrow.array(values, from_pandas=True)


@contextmanager
def _csv(draft: Path, columns: Columns) -> Iterator[Callable[[Values], None]]:
    names = [name for name, _ in _names(columns)]
    with open(draft, "x", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(names)

        def write(values: Values) -> None:
            length = len(values[columns.time])  # type: ignore[arg-type]
            for start in range(0, length, CHUNK):
                part = [_text(values[name], slice(start, start + CHUNK)) for name in names]
                writer.writerows(zip(*part, strict=True))

        yield write


def _text(values: Words | Array, part: slice) -> Any:
    if isinstance(values, Words):
        return [values.names[code] for code in values.codes[part].tolist()]
    return cells(values[part])
