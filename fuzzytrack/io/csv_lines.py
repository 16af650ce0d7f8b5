"""Rows of CSV by the reader of the standard library: any file, with the line of every error."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from io import BufferedReader, RawIOBase, TextIOWrapper
from itertools import accumulate, islice
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.errors import DataError
from fuzzytrack.io.recognition import Layout, cells_of_lines, is_units_row, usable_lines
from fuzzytrack.io.table import Column
from fuzzytrack.plurals import counted

__all__ = ["CHUNK", "Part", "line_parts", "text_lines"]

# Rows at a time; many more at once keep the garbage collector busy.
CHUNK = 5_000
# Characters of a line, at most.
_LONGEST = 1 << 20


class Part(Protocol):
    """Some rows of a file, in order."""

    @property
    def rows(self) -> NDArray[np.int64]:
        """Their lines in the file."""

    def take(self, columns: Sequence[Column], start: int, stop: int) -> None:
        """Add the cells of some of them to the columns; raises as `Column.take_cells`."""


class _Cells:
    """Rows as cells of text."""

    def __init__(
        self, rows: Sequence[int], cells: Sequence[Sequence[str]], places: dict[str, int]
    ) -> None:
        self.rows = np.array(rows, dtype=np.int64)
        self._rows, self._places = rows, places
        self._cells = list(zip(*cells, strict=True))

    def take(self, columns: Sequence[Column], start: int, stop: int) -> None:
        rows = self._rows[start:stop]
        try:
            for column in columns:
                column.take_cells(self._cells[self._places[column.name]][start:stop], rows)
        except DataError:
            # The error is that of the first row that has one.
            for k, row in enumerate(rows, start):
                for column in columns:
                    cell = self._cells[self._places[column.name]][k]
                    column.empty().take_cells([cell], [row])
            raise  # pragma: no cover


def text_lines(stream: RawIOBase, encoding: str) -> Iterator[str]:
    """Lines of a stream of bytes, with their ends; none is longer than `_LONGEST`."""
    text = TextIOWrapper(BufferedReader(stream, 1 << 16), encoding, newline="")
    return iter(partial(text.readline, _LONGEST), "")


def line_parts(
    lines: Iterable[str], layout: Layout, before: int, counts: dict[str, int]
) -> Iterator[Part]:
    """Parts of rows; those that are blank or hold names or units again are left out.

    Parameters
    ----------
    lines : iterable of str
        Lines of the file, with their ends.
    layout : Layout
        How the file is written.
    before : int
        Lines of the file before these; of those of the whole file the first ones, which hold the
        names, are passed over.
    counts : dict of str to int
        What is left out is added to it.

    Raises
    ------
    DataError
        If a row has too few or too many cells, or is not CSV.
    """
    form = layout.form
    if not before:
        lines = iter(lines)
        before = sum(1 for _ in islice(lines, layout.lines))
    reader = cells_of_lines(usable_lines(lines, form, counts), form.delimiter or ",")
    places = {name: place for place, name in enumerate(layout.names) if name}
    rows_of = _Rows(layout, counts)
    done, failure = 0, None
    while failure is None:
        cells: list[list[str]] = []
        try:
            # What has been read before an error is in the list.
            cells.extend(islice(reader, CHUNK))
        except csv.Error as error:
            failure = DataError(f"{layout.file}: row {before + reader.line_num}: not CSV: {error}")
        if not cells:
            break
        rows: Sequence[int] = range(before + done + 1, before + done + len(cells) + 1)
        if failure is not None or reader.line_num - done != len(cells):  # cells with line breaks
            sizes = (1 + sum(map(_breaks, row)) for row in cells)
            rows = list(accumulate(sizes, initial=before + done))[1:]
        done = rows[-1] - before
        rows, cells, wrong = rows_of.usable(rows, cells)
        failure = wrong or failure
        if cells:
            yield _Cells(rows, cells, places)
    if failure is not None:
        raise failure


def _breaks(cell: str) -> int:
    return cell.count("\n") + cell.count("\r") - cell.count("\r\n")


class _Rows:
    """Which rows hold data, and whether they have the cells that they must have."""

    def __init__(self, layout: Layout, counts: dict[str, int]) -> None:
        self._file, self._counts = layout.file, counts
        self._names, self._given = layout.names, layout.form.columns is not None
        self._delimiter = layout.form.delimiter
        named = [place for place, name in enumerate(layout.names) if name]
        self._first = named[0] if named else 0
        # Cells of a row, at least.
        self._least = named[-1] + 1 if named else 1
        self._after_names = False

    def usable(
        self, rows: Sequence[int], cells: list[list[str]]
    ) -> tuple[Sequence[int], list[list[str]], DataError | None]:
        """Rows of data, all of one width; those before an error, and that error."""
        width = len(self._names)
        failure = None
        widths = set(map(len, cells))
        if 0 in widths:
            # Empty lines, of which there may be very many, are none that anybody has written.
            kept = [k for k, row in enumerate(cells) if row]
            rows, cells = [rows[k] for k in kept], [cells[k] for k in kept]
        if not widths <= {0, width}:
            rows, cells, failure = self._of_one_width(rows, cells)
        firsts = [row[self._first] for row in cells]
        plain = list(map(str.strip, firsts))
        name = self._names[self._first]
        if self._after_names or not all(plain) or name in plain or "\ufeff" + name in plain:
            kept = [k for k, row in enumerate(cells) if self._is_data(row)]
            rows, cells = [rows[k] for k in kept], [cells[k] for k in kept]
        return rows, cells, failure

    def _of_one_width(
        self, rows: Sequence[int], cells: list[list[str]]
    ) -> tuple[Sequence[int], list[list[str]], DataError | None]:
        width = len(self._names)
        kept: list[int] = []
        for k, row in enumerate(cells):
            size = len(row)
            if size != width:
                if not any(map(str.strip, row)):
                    self._count("blank row")
                    continue
                if size < self._least or any(map(str.strip, row[width:])):
                    failure = self._width_error(rows[k], row)
                    return [rows[k] for k in kept], [cells[k] for k in kept], failure
                cells[k] = [*row[:width], *[""] * (width - size)]
            kept.append(k)
        return [rows[k] for k in kept], [cells[k] for k in kept], None

    def _is_data(self, row: Sequence[str]) -> bool:
        if not any(map(str.strip, row)):
            self._count("blank row")
            return False
        after, self._after_names = self._after_names, False
        if self._is_names(row):
            self._after_names = True
            self._count("repeated row of names")
            return False
        if after and is_units_row(row):
            self._count("repeated row of units")
            return False
        return True

    def _is_names(self, row: Sequence[str]) -> bool:
        return all(
            cell.strip().removeprefix("\ufeff") == name
            for cell, name in zip(row, self._names, strict=True)
        )

    def _width_error(self, row: int, cells: Sequence[str]) -> DataError:
        width = len(self._names)
        source = "as `columns` has" if self._given else "as in the header"
        text = f"{self._file}: row {row}: {counted(len(cells), 'cell')}; expected {width}, {source}"
        if self._delimiter == "," and len(cells) > width:
            text += (
                "; if numbers have decimal commas, quotes must be around them, or semicolons "
                "between cells"
            )
        return DataError(text)

    def _count(self, what: str) -> None:
        self._counts[what] = self._counts.get(what, 0) + 1
