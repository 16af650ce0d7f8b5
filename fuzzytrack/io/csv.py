"""CSV: read part by part, with the line of every error, and written part by part."""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import accumulate, islice
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.errors import DataError
from fuzzytrack.io.table import Column, Kind, Table, Values, checked_names, silent
from fuzzytrack.io.text_form import PLAIN, TextForm
from fuzzytrack.plurals import counted
from fuzzytrack.tasks import Progress

__all__ = ["CsvSource", "check", "open_source", "open_target"]

# Rows at a time; many more at once keep the garbage collector busy.
CHUNK = 5_000


def check(file: str) -> None:
    """Do nothing: CSV needs no other package."""


# -------------------------------------------------------------------- reading


@contextmanager
def open_source(file: str, form: TextForm = PLAIN) -> Iterator[CsvSource]:
    """Open a CSV file: UTF-8, separated by commas, names in the first row.

    Raises
    ------
    DataError
        If it is no such file, also later, while it is read; names the row.
    OSError
        If it cannot be read.
    """
    with open(file, encoding="utf-8-sig", newline="") as stream:
        reader = csv.reader(stream, strict=True)
        try:
            yield CsvSource(file, stream, reader, form)
        except UnicodeDecodeError:
            raise _not_utf8(file) from None
        except csv.Error as error:
            raise DataError(f"{file}: row {reader.line_num}: not CSV: {error}") from None


class CsvSource:
    """An open CSV file; see `fuzzytrack.io.formats.Source`."""

    def __init__(self, file: str, stream: IO[str], reader: Any, form: TextForm) -> None:
        self.file, self.form = file, form
        self.units: dict[str, str] = {}
        self.notes: list[str] = []
        # Several columns may have no name.
        self._names = _header(reader, file)
        self.types = dict.fromkeys(self._names, "text")
        self._stream, self._reader = stream, reader

    def tables(
        self, kinds: Mapping[str, Kind], rows: int | None, progress: Progress = silent
    ) -> Iterator[Table]:
        """Read columns, at most so many rows at a time."""
        places = [self._names.index(name) for name in kinds]
        # Of the table that is being read.
        columns: list[Column] = []
        found: list[NDArray[np.int64]] = []
        waiting = 0
        size = os.fstat(self._stream.fileno()).st_size
        for lines, cells in _chunks(self.file, self._reader, len(self._names)):
            step = rows or len(lines)
            for start in range(0, len(lines), step):
                part = lines[start : start + step]
                if rows is not None and waiting + len(part) > rows:
                    yield Table.of(self.file, columns, np.concatenate(found))
                    found, waiting = [], 0
                if not found:
                    columns = [
                        Column(self.file, name, kind, self.form) for name, kind in kinds.items()
                    ]
                for column, place in zip(columns, places, strict=True):
                    column.take_cells(cells[place][start : start + step], part)
                found.append(np.array(part))
                waiting += len(part)
            # What is no ordinary file, as a pipe, has no size.
            if size:
                progress(min(self._stream.buffer.tell() / size, 1.0))  # type: ignore[attr-defined]
        if found:
            yield Table.of(self.file, columns, np.concatenate(found))


def _header(reader: Any, file: str) -> tuple[str, ...]:
    header = next((row for row in reader if row), None)
    if header is None:
        raise DataError(f"{file}: is empty; expected a row of column names, then data")
    return checked_names([name.strip() for name in header], file)


def _chunks(
    file: str, reader: Any, width: int
) -> Iterator[tuple[Sequence[int], list[tuple[str, ...]]]]:
    """Row numbers and columns of some rows at a time; blank lines are left out."""
    before = reader.line_num
    while cells := list(islice(reader, CHUNK)):
        rows: Sequence[int] = range(before + 1, reader.line_num + 1)
        if len(rows) != len(cells):  # cells with line breaks
            lines = (1 + sum(cell.count("\n") for cell in row) for row in cells)
            rows = list(accumulate(lines, initial=before))[1:]
        before = reader.line_num
        widths = set(map(len, cells))
        if 0 in widths:
            kept = [k for k, row in enumerate(cells) if row]
            rows, cells = [rows[k] for k in kept], [cells[k] for k in kept]
            widths.discard(0)
        if not widths <= {width}:
            wrong = next(k for k, row in enumerate(cells) if len(row) != width)
            raise DataError(
                f"{file}: row {rows[wrong]}: {counted(len(cells[wrong]), 'cell')}; "
                f"expected {width}, as in the header"
            )
        if cells:
            yield rows, list(zip(*cells, strict=True))


def _not_utf8(file: str) -> DataError:
    with open(file, "rb") as stream:
        for number, line in enumerate(stream, 1):
            try:
                line.decode("utf-8")
            except UnicodeDecodeError as error:
                byte = line[error.start]
                return DataError(
                    f"{file}: row {number}: byte 0x{byte:02x} is not UTF-8; save the file as UTF-8"
                )
    return DataError(f"{file}: is not UTF-8; save the file as UTF-8")  # pragma: no cover


# -------------------------------------------------------------------- writing


@contextmanager
def open_target(
    draft: Path, types: Mapping[str, str], compact: bool, progress: Progress
) -> Iterator[Callable[[Values], None]]:
    """Open a CSV file for writing; see `fuzzytrack.io.formats.Format`."""
    with open(draft, "x", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(types)

        def write(values: Values) -> None:
            columns = [values[name] for name in types]
            length = len(columns[0])
            for start in range(0, length, CHUNK):
                part = [_cells(column[start : start + CHUNK]) for column in columns]
                writer.writerows(zip(*part, strict=True))
                progress(min((start + CHUNK) / length, 1.0))

        yield write


def _cells(values: Sequence[str] | NDArray[Any]) -> Sequence[Any]:
    if not isinstance(values, np.ndarray):
        return values
    cells: list[Any] = values.tolist()
    for index in np.flatnonzero(np.isnan(values)).tolist():
        cells[index] = None
    return cells
