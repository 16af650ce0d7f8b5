"""Tables read and written, in the format that the name of the file says.

Files are read by the readers of `fuzzytrack.io.readers`; recordings, their columns and their errors
come from `fuzzytrack.io.recording`, which uses `Source` only. A format in which tables are written
is a module that has the functions of `Format`, and a line in ``_FORMATS``.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Protocol

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io import csv, parquet
from fuzzytrack.io.files import PathLike, check_output, whole_file
from fuzzytrack.io.readers import Reader, make_reader, reader_of, readers
from fuzzytrack.io.source import Source
from fuzzytrack.io.table import Kind, Table, Values, no_rows, silent
from fuzzytrack.io.text_form import PLAIN, TextForm
from fuzzytrack.tasks import Progress

__all__ = [
    "CSV",
    "PARQUET",
    "CsvReader",
    "Format",
    "ParquetReader",
    "check_table",
    "open_table",
    "read_table",
    "table_writer",
    "write_table",
]


#: Suffixes of Parquet files.
PARQUET = (".parquet", ".pq")
#: Suffixes of CSV files, plain and compressed.
CSV = tuple(kind + packed for kind in (".csv", ".tsv") for packed in ("", ".gz", ".zst"))


class Format(Protocol):
    """What a module of this package offers for a format in which tables are written."""

    def check(self, file: str, /) -> None:
        """Raise a DataError if what the format needs is not installed."""

    def open_target(
        self,
        draft: Path,
        types: Mapping[str, str],
        compact: bool,
        progress: Progress,
        quote_formulas: bool,
        /,
    ) -> AbstractContextManager[Callable[[Values], None]]:
        """Open a file that is written; the arguments are those of `table_writer`."""


@readers.register("csv")
class CsvReader(Reader):
    """Reads CSV."""

    suffixes = CSV

    def open_source(self, file: str) -> AbstractContextManager[Source]:
        """Open a file; see `fuzzytrack.io.csv`."""
        return csv.open_source(file, self.form)


@readers.register("parquet")
class ParquetReader(Reader):
    """Reads Parquet, with the extra ``parquet``."""

    suffixes = PARQUET

    def check(self, file: str) -> None:
        """Check that pyarrow is installed."""
        parquet.check(file)

    def open_source(self, file: str) -> AbstractContextManager[Source]:
        """Open a file; see `fuzzytrack.io.parquet`."""
        return parquet.open_source(file, self.form)


for _reader in ("Ais", "Asterix", "Gpx", "Mot"):
    readers.register_later(_reader.lower(), f"fuzzytrack.io.{_reader.lower()}:{_reader}")

# Formats by the suffixes of the files that are written in them.
_FORMATS: dict[tuple[str, ...], Format] = {PARQUET: parquet, (".csv", ".txt"): csv}


def open_table(
    file: str, form: TextForm | None = None, *, format: str | None = None
) -> AbstractContextManager[Source]:
    """Open a file that is read.

    Parameters
    ----------
    file : str
        Its name says its format, unless `format` is given; what no reader knows is CSV, and so is
        text to whose columns `form` gives names.
    form : TextForm, optional
        How cells, numbers and missing numbers of text are written; recognized unless given.
    format : str, optional
        Name of the format, as in `readers`, maybe with parameters: ``asterix:category=62``.

    Raises
    ------
    ValueError
        If there is no such format; lists those that there are.
    DataError
        If the file is no such table, also later, while it is read.
    OSError
        If it cannot be read.
    """
    form = form or PLAIN
    reader = make_reader(format) if format is not None else reader_of(file) or CsvReader()
    if format is None and form.columns is not None and not isinstance(reader, ParquetReader):
        reader = CsvReader()
    reader.form = form
    return reader.open_source(file)


def _format_of_output(path: PathLike, others: Sequence[str] = ()) -> Format:
    suffix = Path(path).suffix.lower()
    for suffixes, found in _FORMATS.items():
        if suffix in suffixes:
            found.check(os.fspath(path))
            return found
    *first, last = (".csv", ".parquet", *others)
    raise DataError(
        f"{path}: cannot write {suffix or 'without suffix'}; {', '.join(first)} or {last}"
    )


def check_table(
    path: PathLike, inputs: tuple[PathLike, ...] = (), *, others: Sequence[str] = ()
) -> None:
    """Check that a table can be written, before the work is done.

    Parameters
    ----------
    path : str or path
        The file to be written; it need not exist.
    inputs : tuple of str or path
        Files that must not be overwritten.
    others : sequence of str
        Suffixes of what else the caller writes, for the message.

    Raises
    ------
    DataError
        If the suffix is that of no format, or the file is one of the inputs.
    OSError
        If the file cannot be written.
    """
    _format_of_output(path, others)
    check_output(path, inputs)


def read_table(
    path: PathLike,
    wanted: Callable[[tuple[str, ...]], Mapping[str, Kind]],
    progress: Progress | None = None,
) -> Table:
    """Read columns of a CSV or Parquet file.

    Parameters
    ----------
    path : str or path
        See `open_table`.
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
    with open_table(file) as source:
        for table in source.tables(wanted(tuple(source.types)), None, progress or silent):
            return table
        raise no_rows(file)


@contextmanager
def table_writer(
    path: PathLike,
    types: Mapping[str, str],
    inputs: tuple[PathLike, ...] = (),
    *,
    compact: bool = False,
    quote_formulas: bool = False,
    progress: Progress | None = None,
) -> Iterator[Callable[[Values], None]]:
    """Write a CSV or Parquet file part by part; it appears whole or not at all.

    Parameters
    ----------
    path : str or path
        Parquet if it ends in ``.parquet`` or ``.pq``, CSV if in ``.csv`` or ``.txt``.
    types : mapping of str to str
        Names of the columns, and their types: ``string``, or that of an array, as ``float64``.
    inputs : tuple of str or path
        Files that must not be overwritten.
    compact : bool
        Whether a small file is worth more time: in Parquet, numbers that repeat are stored once.
    quote_formulas : bool
        Whether, in CSV, an apostrophe is put before text that a spreadsheet would run as a formula,
        as identities that begin with ``=``. Numbers stay as they are.
    progress : callable, optional
        Called with the share of a part that has been written.

    Yields
    ------
    callable
        To be called with the columns of some rows.

    Raises
    ------
    DataError, OSError
        See `check_table`.
    """
    found = _format_of_output(path)
    with (
        whole_file(path, inputs) as draft,
        found.open_target(draft, types, compact, progress or silent, quote_formulas) as write,
    ):
        yield write


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
    DataError, OSError
        See `check_table`.
    """
    types = {
        name: values.dtype.name if isinstance(values, np.ndarray) else "string"
        for name, values in columns.items()
    }
    with table_writer(path, types, inputs, compact=True, progress=progress) as write:
        write(columns)
