"""Parquet, with the extra ``parquet``: read and written part by part."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.errors import DataError
from fuzzytrack.io.table import Column, Kind, Table, Values, Words, checked_names, silent
from fuzzytrack.io.text_form import PLAIN, TextForm
from fuzzytrack.tasks import Progress

__all__ = [
    "ParquetSource",
    "arrow_table",
    "check",
    "import_pyarrow",
    "open_source",
    "open_target",
    "parquet_writer",
    "words_of",
]

# Bytes of a compressed column that are read at a time, however large the row group.
_BUFFER = 1 << 20


def check(file: str) -> None:
    """Check that pyarrow is installed; DataError if not."""
    import_pyarrow(file)


def import_pyarrow(file: str) -> Any:
    """Import pyarrow, or say how it is installed."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise DataError(
            f"{file}: Parquet needs pyarrow, which is not installed; "
            "pip install 'fuzzytrack[parquet]', or use CSV"
        ) from None
    return pyarrow


# -------------------------------------------------------------------- reading


@contextmanager
def open_source(file: str, form: TextForm = PLAIN) -> Iterator[ParquetSource]:
    """Open a Parquet file.

    Parameters
    ----------
    file : str
        The file.
    form : TextForm, optional
        Only what stands for a missing number is used.

    Raises
    ------
    DataError
        If it is no such file, also later, while it is read.
    OSError
        If it cannot be opened.
    """
    arrow = import_pyarrow(file)
    if form.columns is not None:
        raise DataError(f"{file}: `columns`: a Parquet file has names of its own; leave them out")
    with open(file, "rb") as stream:
        try:
            source = arrow.parquet.ParquetFile(stream, buffer_size=_BUFFER, pre_buffer=False)
            yield ParquetSource(file, source, form)
        # pyarrow reports a page that is broken as an OSError.
        except (arrow.ArrowException, OSError) as error:
            raise DataError(f"{file}: is not a Parquet file that can be read: {error}") from None


class ParquetSource:
    """An open Parquet file; see `fuzzytrack.io.formats.Source`."""

    def __init__(self, file: str, source: Any, form: TextForm = PLAIN) -> None:
        self.file, self.form = file, form
        schema = source.schema_arrow
        self.types = dict(
            zip(checked_names(schema.names, file), map(str, schema.types), strict=True)
        )
        self._source = source

    def tables(
        self, kinds: Mapping[str, Kind], rows: int | None, progress: Progress = silent
    ) -> Iterator[Table]:
        """Read columns, at most so many rows at a time."""
        arrow = import_pyarrow(self.file)
        total = self._source.metadata.num_rows
        done = 0
        for part in self._parts(arrow, list(kinds), rows):
            if not part.num_rows:
                continue
            numbers = np.arange(done + 1, done + part.num_rows + 1)
            columns = [Column(self.file, name, kind, self.form) for name, kind in kinds.items()]
            for column in columns:
                _take(arrow, column, part.column(column.name), numbers)
            yield Table.of(self.file, columns, numbers)
            done += part.num_rows
            progress(done / total)

    def _parts(self, arrow: Any, names: list[str], rows: int | None) -> Iterator[Any]:
        if rows is None:
            yield self._source.read(names)
        else:
            for batch in self._source.iter_batches(rows, columns=names):
                yield arrow.Table.from_batches([batch])


def _take(arrow: Any, column: Column, values: Any, rows: NDArray[np.int64]) -> None:
    """Add what pyarrow has read to a column."""
    if column.kind == "word":
        column.take_words(*_names_and_codes(arrow, values))
    elif column.kind == "time" and (times := _times(arrow, values)) is not None:
        column.take_times(times, rows)
    elif column.kind not in ("time", "text") and _is_number(arrow, values.type):
        column.take_numbers(values.to_numpy().astype(np.float64), rows)
    else:
        cells = ["" if value is None else str(value) for value in values.to_pylist()]
        column.take_cells(cells, rows.tolist())


def _times(arrow: Any, values: Any) -> NDArray[Any] | None:
    """Times as int64, float64 or datetime64, NaN where there is none; None if they are text."""
    kind, types = values.type, arrow.types
    if types.is_date(kind):
        values = values.cast(arrow.timestamp("s" if types.is_date32(kind) else "ms"))
    elif types.is_duration(kind):
        seconds = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}[kind.unit]
        return np.asarray(values.cast(arrow.int64()).to_numpy(), dtype=np.float64) / seconds
    elif types.is_integer(kind) and not values.null_count:
        values = values.cast(arrow.int64())
    elif types.is_integer(kind) or types.is_floating(kind):
        return np.asarray(values.to_numpy(), dtype=np.float64)
    elif not types.is_timestamp(kind):
        return None
    return np.asarray(values.to_numpy())


def _is_number(arrow: Any, kind: Any) -> bool:
    is_decimal = arrow.types.is_decimal(kind)
    return bool(arrow.types.is_integer(kind) or arrow.types.is_floating(kind) or is_decimal)


def _names_and_codes(arrow: Any, values: Any) -> tuple[list[str], NDArray[np.int64]]:
    """Different words of a column, and for each row which; only the former become Python's."""
    if arrow.types.is_dictionary(values.type):
        # A dictionary from a file has an order of its own, and words that are not used.
        values = values.cast(values.type.value_type)
    encoded = values.dictionary_encode().unify_dictionaries()
    codes = [chunk.indices.fill_null(-1).to_numpy() for chunk in encoded.chunks]
    names = _texts(arrow, encoded.chunk(0).dictionary)
    return names, np.concatenate(codes).astype(np.int64)


def _texts(arrow: Any, values: Any) -> list[str]:
    if arrow.types.is_integer(values.type):
        values = values.cast(arrow.string())
    return [str(value) for value in values.to_pylist()]


def words_of(values: Any) -> Words:
    """Column of words as pyarrow has it, none of them missing."""
    import pyarrow

    names, codes = _names_and_codes(pyarrow, values)
    return Words(tuple(names), codes)


# -------------------------------------------------------------------- writing


@contextmanager
def open_target(
    draft: Path,
    types: Mapping[str, str],
    compact: bool,
    progress: Progress,
    quote_formulas: bool = False,
) -> Iterator[Callable[[Values], None]]:
    """Open a Parquet file for writing; see `fuzzytrack.io.formats.Format`.

    What is written at once becomes one row group.
    """
    with parquet_writer(draft, types, compact) as writer:

        def write(values: Values) -> None:
            writer.write_table(arrow_table(writer.schema, values))
            progress(1.0)

        yield write


def parquet_writer(path: Path, types: Mapping[str, str], compact: bool) -> Any:
    """Writer of pyarrow.

    Parameters
    ----------
    path : Path
        The file.
    types : mapping of str to str
        Columns, and their types as Arrow calls them.
    compact : bool
        Whether to look for repeated values in all columns. To look in columns of numbers that all
        differ takes much time; columns of words have repeated values in any case.
    """
    arrow = import_pyarrow(str(path))
    aliases = {name: kind.replace("datetime64", "timestamp") for name, kind in types.items()}
    schema = arrow.schema([(name, arrow.type_for_alias(kind)) for name, kind in aliases.items()])
    words = [name for name, kind in types.items() if kind == "string"]
    return arrow.parquet.ParquetWriter(path, schema, use_dictionary=compact or words or False)


def arrow_table(schema: Any, values: Values) -> Any:
    """Columns as a table of pyarrow; NaN becomes null."""
    import pyarrow

    arrays = [_arrow_column(pyarrow, values[name]) for name in schema.names]
    return pyarrow.Table.from_arrays(arrays, schema=schema)


def _arrow_column(arrow: Any, values: Sequence[str] | NDArray[Any]) -> Any:
    if isinstance(values, Words):
        codes = arrow.array(values.codes.astype(np.int32))
        names = arrow.array(values.names, type=arrow.string())
        return arrow.DictionaryArray.from_arrays(codes, names).cast(arrow.string())
    if isinstance(values, np.ndarray):
        return arrow.array(values, from_pandas=True)
    return arrow.array(values, type=arrow.string())
