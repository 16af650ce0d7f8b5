"""CSV: read part by part, with the line of every error, and written part by part."""

from __future__ import annotations

import codecs
import csv
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BufferedReader, StringIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.errors import DataError
from fuzzytrack.io.byte_stream import ByteStream, open_bytes
from fuzzytrack.io.csv_blocks import block_parts, is_large, parser
from fuzzytrack.io.csv_lines import CHUNK, Part, line_parts, text_lines
from fuzzytrack.io.recognition import HEAD, encoding_of, recognize
from fuzzytrack.io.table import Column, Kind, Table, Values, silent
from fuzzytrack.io.text_form import PLAIN, TextForm
from fuzzytrack.io.track_text import iso_times
from fuzzytrack.numerals import is_number
from fuzzytrack.plurals import counted
from fuzzytrack.tasks import Progress

__all__ = ["CsvSource", "check", "csv_rows", "open_source", "open_target"]


def check(file: str) -> None:
    """Do nothing: CSV needs no other package."""


# -------------------------------------------------------------------- reading


@contextmanager
def open_source(file: str, form: TextForm = PLAIN) -> Iterator[CsvSource]:
    """Open a CSV file, plain or compressed.

    Parameters
    ----------
    file : str
        ``-`` is standard input.
    form : TextForm, optional
        How it is written; what is None there is recognized by the first lines.

    Raises
    ------
    DataError
        If it is no such file, also later, while it is read; names the row.
    OSError
        If it cannot be read.
    """
    with open_bytes(file) as stream:
        try:
            yield CsvSource(stream, form)
        except UnicodeDecodeError as error:
            raise _not_text(stream, error) from None


class CsvSource:
    """An open CSV file; see `fuzzytrack.io.source.Source`."""

    def __init__(self, stream: ByteStream, form: TextForm) -> None:
        self.file, self._stream = stream.file, stream
        head = stream.take(HEAD)
        stream.put_back(head)
        self.encoding = encoding_of(self.file, head)
        self._layout = recognize(self.file, _first_lines(self.file, head, self.encoding), form)
        self.form, self.units = self._layout.form, self._layout.units
        # Several columns may have no name.
        self.types = dict.fromkeys(self._layout.names, "text")
        self._left_out = {"comment line": self._layout.comments}

    @property
    def notes(self) -> list[str]:
        """What has been left out of the file so far, and why."""
        plural = {f"repeated row of {of}": f"repeated rows of {of}" for of in ("names", "units")}
        return [
            f"{self.file}: {counted(count, what, plural.get(what))} left out"
            for what, count in self._left_out.items()
            if count
        ]

    def tables(
        self, kinds: Mapping[str, Kind], rows: int | None, progress: Progress = silent
    ) -> Iterator[Table]:
        """Read columns, so many rows at a time."""
        # Of the table that is being read.
        columns: list[Column] = []
        found: list[NDArray[np.int64]] = []
        waiting = 0
        for part in self._parts(kinds):
            start, size = 0, len(part.rows)
            while start < size:
                if not waiting:
                    columns = [
                        Column(self.file, name, kind, self.form) for name, kind in kinds.items()
                    ]
                stop = size if rows is None else min(size, start + rows - waiting)
                part.take(columns, start, stop)
                found.append(part.rows[start:stop])
                waiting += stop - start
                start = stop
                if waiting == rows:
                    yield Table.of(self.file, columns, np.concatenate(found))
                    found, waiting = [], 0
            if (share := self._stream.share()) is not None:
                progress(share)
        if waiting:
            yield Table.of(self.file, columns, np.concatenate(found))

    def _parts(self, kinds: Mapping[str, Kind]) -> Iterator[Part]:
        """Rows of the file, in the way that is fastest."""
        layout, counts = self._layout, self._left_out
        in_blocks = self.encoding[:5] == "utf-8" and self.form.delimiter != " "
        if in_blocks and is_large(self._stream) and parser() is not None:
            return block_parts(self._stream, layout, kinds, counts)
        return line_parts(text_lines(self._stream, self.encoding), layout, 0, counts)


def _first_lines(file: str, head: bytes, encoding: str) -> list[str]:
    """Lines of the beginning of a file, as far as they are whole."""
    is_whole = len(head) < HEAD
    text = codecs.getincrementaldecoder(encoding)().decode(head, is_whole)
    lines = list(StringIO(text, newline=""))
    if not is_whole and len(lines) == 1:
        raise DataError(f"{file}: row 1: is longer than {HEAD} bytes; expected names of columns")
    return lines if is_whole else lines[:-1]


def _not_text(source: ByteStream, error: UnicodeDecodeError) -> DataError:
    """Error about bytes that are not text, with their row if the file can be read again."""
    file = source.file
    if error.encoding[:5] != "utf-8":
        return DataError(
            f"{file}: is not {error.encoding.upper()}: {error.reason}; save it as UTF-8"
        )
    if os.path.isfile(file):
        with open_bytes(file) as stream:
            for number, line in enumerate(BufferedReader(stream), 1):
                try:
                    line.decode("utf-8")
                except UnicodeDecodeError as found:
                    byte = line[found.start]
                    return DataError(
                        f"{file}: row {number}: byte 0x{byte:02x} is not UTF-8; "
                        "save the file as UTF-8"
                    )
    return DataError(f"{file}: is not UTF-8; save it as UTF-8")


# -------------------------------------------------------------------- writing


# What a spreadsheet takes for the beginning of a formula; with a character more, for text.
_FORMULA = re.compile(r"\s*[=+\-@\t\r＝＋－＠]")


@contextmanager
def open_target(
    draft: Path,
    types: Mapping[str, str],
    compact: bool,
    progress: Progress,
    quote_formulas: bool = False,
) -> Iterator[Callable[[Values], None]]:
    """Open a CSV file for writing; see `fuzzytrack.io.formats.Format`."""
    quoted = _without_formulas if quote_formulas else list
    with open(draft, "x", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(quoted(list(types)))

        def write(values: Values) -> None:
            columns = [values[name] for name in types]
            length = len(columns[0])
            for start in range(0, length, CHUNK):
                part = [column[start : start + CHUNK] for column in columns]
                writer.writerows(csv_rows(part, quote_formulas))
                progress(min((start + CHUNK) / length, 1.0))

        yield write


def csv_rows(
    columns: Sequence[Sequence[str] | NDArray[Any]], quote_formulas: bool = False
) -> Iterable[tuple[Any, ...]]:
    """Rows of columns as `csv.writer` takes them; NaN is an empty cell.

    Parameters
    ----------
    columns : sequence of (sequence of str or ndarray)
        All of one length.
    quote_formulas : bool
        As for `fuzzytrack.io.table_writer`.
    """
    quoted = _without_formulas if quote_formulas else list
    return zip(*(_cells(column, quoted) for column in columns), strict=True)


def _without_formulas(words: Sequence[str]) -> list[str]:
    """Words, with an apostrophe before those that a spreadsheet would run as a formula."""
    return [f"'{word}" if _FORMULA.match(word) and not is_number(word) else word for word in words]


def _cells(
    values: Sequence[str] | NDArray[Any], quoted: Callable[[Sequence[str]], list[str]]
) -> Sequence[Any]:
    if not isinstance(values, np.ndarray):
        return quoted(values)
    if values.dtype.kind == "b":
        return ["true" if value else "false" for value in values.tolist()]
    cells: list[Any] = iso_times(values) if values.dtype.kind == "M" else values.tolist()
    for index in np.flatnonzero(np.isnan(values)).tolist():
        cells[index] = None
    return cells
