"""Tables: named columns of numbers and words, from and to CSV and Parquet."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, islice
from pathlib import Path
from typing import IO, Any, Literal

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.files import PathLike, whole_file
from fuzzytrack.tasks import Progress

__all__ = ["Kind", "Progress", "Table", "Words", "read_table", "write_table"]


#: What a column must hold: a number in every row, numbers and gaps, or words.
Kind = Literal["number", "gaps", "word"]
#: Called now and then with the share of the work that is done.

# What stands for a missing number, in lower case.
GAPS = ("", "nan", "na")
EXPECTED = {
    "number": "a finite number",
    "gaps": "a finite number, or an empty cell or nan for a missed plot",
}
# Rows at a time; many more at once keep the garbage collector busy.
CHUNK = 5_000
PARQUET = (".parquet", ".pq")


@dataclass(frozen=True, eq=False)
class Words:
    """Column of words, each kept once.

    Attributes
    ----------
    names : tuple of str
        The different words, in order of first appearance.
    codes : ndarray of int
        For each row the position of its word in `names`.
    """

    names: tuple[str, ...]
    codes: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Table:
    """Some columns of a file.

    Attributes
    ----------
    file : str
        Name of the file, for messages.
    rows : ndarray of int
        Where each row stands in the file, counted from 1; in CSV the line, the header being 1.
    numbers : dict of ndarray
        Columns of numbers, NaN in the gaps.
    words : dict of Words
        Columns of words.
    """

    file: str
    rows: NDArray[np.int64]
    numbers: dict[str, Array]
    words: dict[str, Words]


def read_table(
    path: PathLike,
    wanted: Callable[[tuple[str, ...]], Mapping[str, Kind]],
    progress: Progress | None = None,
) -> Table:
    """Read columns of a CSV or Parquet file.

    Parameters
    ----------
    path : str or path
        Parquet if it ends in ``.parquet`` or ``.pq``, otherwise CSV: UTF-8, separated by commas,
        names in the first row.
    wanted : callable
        From the names of all columns to those wanted, with what they must hold. May raise.
    progress : callable, optional
        Called with the share of the file that has been read.

    Returns
    -------
    Table
        At least one row.

    Raises
    ------
    DataError
        If the file is no such table; names row and column.
    OSError
        If it cannot be read.
    """
    file = os.fspath(path)
    read = _read_parquet if file.lower().endswith(PARQUET) else _read_csv
    table = read(file, wanted, progress or _silent)
    if not len(table.rows):
        raise DataError(f"{file}: holds no rows, only column names")
    return table


def write_table(
    path: PathLike,
    columns: Mapping[str, Sequence[str] | Array],
    inputs: tuple[PathLike, ...] = (),
    progress: Progress | None = None,
) -> None:
    """Write a CSV or Parquet file, whole or not at all.

    Parameters
    ----------
    path : str or path
        Parquet if it ends in ``.parquet`` or ``.pq``, CSV if in ``.csv`` or ``.txt``.
    columns : mapping of str to ndarray or sequence of str
        All of one length. NaN becomes an empty cell.
    inputs : tuple of str or path
        Files that must not be overwritten.
    progress : callable, optional
        Called with the share that has been written.

    Raises
    ------
    DataError
        If the suffix is another, or the file is one of the inputs.
    OSError
        If the file cannot be written.
    """
    write = table_writer(path)
    with whole_file(path, inputs) as draft:
        write(draft, columns, progress or _silent)


def table_writer(path: PathLike) -> Callable[[Path, Mapping[str, Any], Progress], None]:
    """Find the function that writes a file of this name; DataError if there is none."""
    suffix = Path(path).suffix.lower()
    if suffix in PARQUET:
        import_pyarrow(os.fspath(path))
        return write_parquet
    if suffix in (".csv", ".txt"):
        return _write_csv
    raise DataError(f"{path}: cannot write {suffix or 'without suffix'}; .csv or .parquet")


def _silent(share: float) -> None:
    """Progress that nobody watches."""


# -------------------------------------------------------------------- columns


class Column:
    """A wanted column that grows chunk by chunk."""

    def __init__(self, file: str, name: str, kind: Kind) -> None:
        self.file, self.name, self.kind = file, name, kind
        self.parts: list[NDArray[Any]] = []
        self.codes: dict[str, int] = {}

    def take(self, cells: Sequence[str], rows: Sequence[int]) -> None:
        if self.kind == "word":
            words = list(map(str.strip, cells))
            if not all(words):
                raise self.error(rows[words.index("")], "", "some text")
            codes = self.codes
            self.parts.append(np.array([codes.setdefault(word, len(codes)) for word in words]))
            return
        self.parts.append(self._numbers(cells, rows))

    def _numbers(self, cells: Sequence[str], rows: Sequence[int]) -> Array:
        plain = "".join(cells)
        # Python would also take 1_000 and digits of other scripts.
        if plain.isascii() and "_" not in plain:
            try:
                values = np.array(list(map(float, cells)))
            except ValueError:
                pass
            else:
                if np.isfinite(values).all():
                    return values
        return np.array([self._number(cell, row) for cell, row in zip(cells, rows, strict=True)])

    def _number(self, cell: str, row: int) -> float:
        text = cell.strip()
        if self.kind == "gaps" and text.lower() in GAPS:
            return math.nan
        if text.isascii() and "_" not in text:
            try:
                value = float(text)
            except ValueError:
                pass
            else:
                if math.isfinite(value):
                    return value
        raise self.error(row, cell, EXPECTED[self.kind])

    def error(self, row: int, cell: str, expected: str) -> DataError:
        shown = repr(cell if len(cell) <= 40 else cell[:40] + "…") if cell else "an empty cell"
        return DataError(
            f"{self.file}: row {row}, column {self.name}: {shown}; expected {expected}"
        )


def make_table(file: str, columns: Sequence[Column], rows: NDArray[np.int64]) -> Table:
    numbers, words = {}, {}
    for column in columns:
        values = np.concatenate(column.parts) if column.parts else np.empty(0)
        if column.kind == "word":
            words[column.name] = Words(tuple(column.codes), values.astype(np.int64))
        else:
            numbers[column.name] = values
    return Table(file, rows, numbers, words)


def checked_names(names: Sequence[str], file: str) -> tuple[str, ...]:
    if all(map(_numeric, names)):
        raise DataError(f"{file}: row 1: holds numbers; expected the names of the columns")
    doubled = sorted({name for name in names if name and names.count(name) > 1})
    if doubled:
        raise DataError(f"{file}: row 1: two columns are called {doubled[0]!r}; names must differ")
    return tuple(names)


def _numeric(name: str) -> bool:
    try:
        float(name)
    except ValueError:
        return False
    return True


# -------------------------------------------------------------------- CSV


def _read_csv(
    file: str, wanted: Callable[[tuple[str, ...]], Mapping[str, Kind]], progress: Progress
) -> Table:
    with open(file, encoding="utf-8-sig", newline="") as stream:
        reader = csv.reader(stream, strict=True)
        try:
            return _parse_csv(file, stream, reader, wanted, progress)
        except UnicodeDecodeError:
            raise not_utf8(file) from None
        except csv.Error as error:
            raise DataError(f"{file}: row {reader.line_num}: not CSV: {error}") from None


def _parse_csv(
    file: str,
    stream: IO[str],
    reader: Any,
    wanted: Callable[[tuple[str, ...]], Mapping[str, Kind]],
    progress: Progress,
) -> Table:
    header = next((row for row in reader if row), None)
    if header is None:
        raise DataError(f"{file}: is empty; expected a row of column names, then data")
    names = checked_names([name.strip() for name in header], file)
    columns = [Column(file, name, kind) for name, kind in wanted(names).items()]
    places = [names.index(column.name) for column in columns]
    size = os.fstat(stream.fileno()).st_size
    numbers: list[NDArray[np.int64]] = []
    for rows, cells in chunks(file, reader, len(names)):
        for column, place in zip(columns, places, strict=True):
            column.take(cells[place], rows)
        numbers.append(np.array(rows))
        if size:
            progress(min(stream.buffer.tell() / size, 1.0))  # type: ignore[attr-defined]
    return make_table(file, columns, np.concatenate(numbers) if numbers else np.empty(0, dtype=int))


def chunks(
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
                f"{file}: row {rows[wrong]}: {_many(len(cells[wrong]), 'cell')}; expected {width}, "
                "as in the header"
            )
        if cells:
            yield rows, list(zip(*cells, strict=True))


def _many(count: int, word: str) -> str:
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def not_utf8(file: str) -> DataError:
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


def _write_csv(draft: Path, columns: Mapping[str, Any], progress: Progress) -> None:
    length = len(next(iter(columns.values())))
    with open(draft, "x", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns)
        for start in range(0, length, CHUNK):
            part = [cells(column[start : start + CHUNK]) for column in columns.values()]
            writer.writerows(zip(*part, strict=True))
            progress(min((start + CHUNK) / length, 1.0))


def cells(values: Sequence[str] | Array) -> Sequence[Any]:
    if not isinstance(values, np.ndarray):
        return values
    cells: list[Any] = values.tolist()
    for index in np.flatnonzero(np.isnan(values)).tolist():
        cells[index] = None
    return cells


# -------------------------------------------------------------------- Parquet


def import_pyarrow(file: str) -> Any:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise DataError(
            f"{file}: Parquet needs pyarrow, which is not installed; "
            "pip install 'fuzzytrack[parquet]', or use CSV"
        ) from None
    return pyarrow


def _read_parquet(
    file: str, wanted: Callable[[tuple[str, ...]], Mapping[str, Kind]], progress: Progress
) -> Table:
    arrow = import_pyarrow(file)
    with open(file, "rb") as stream:
        try:
            source = arrow.parquet.ParquetFile(stream)
            names = checked_names(source.schema_arrow.names, file)
            columns = [Column(file, name, kind) for name, kind in wanted(names).items()]
            data = source.read([column.name for column in columns])
        # Of a page that is broken, pyarrow says so by an OSError.
        except (arrow.ArrowException, OSError) as error:
            raise DataError(f"{file}: is not a Parquet file that can be read: {error}") from None
    rows = np.arange(1, data.num_rows + 1)
    for column in columns:
        values = data.column(column.name)
        if column.kind == "word" or not is_number(arrow, values.type):
            column.take([_text(value) for value in values.to_pylist()], rows.tolist())
        else:
            column.parts.append(_finite(column, values.to_numpy().astype(np.float64)))
    progress(1.0)
    return make_table(file, columns, rows)


def is_number(arrow: Any, kind: Any) -> bool:
    is_decimal = arrow.types.is_decimal(kind)
    return bool(arrow.types.is_integer(kind) or arrow.types.is_floating(kind) or is_decimal)


def _text(value: object) -> str:
    return "" if value is None else str(value)


def _finite(column: Column, values: Array) -> Array:
    bad = np.isinf(values) if column.kind == "gaps" else ~np.isfinite(values)
    if bad.any():
        row = int(np.argmax(bad))
        raise column.error(row + 1, str(values[row]), EXPECTED[column.kind])
    return values


def write_parquet(draft: Path, columns: Mapping[str, Any], progress: Progress) -> None:
    arrow = import_pyarrow(str(draft))
    table = arrow.table(
        {
            name: arrow.array(values, from_pandas=True)
            if isinstance(values, np.ndarray)
            else values
            for name, values in columns.items()
        }
    )
    arrow.parquet.write_table(table, draft)
    progress(1.0)
