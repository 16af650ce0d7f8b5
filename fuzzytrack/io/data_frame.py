"""Columns in memory, as a file of plots: data frames, tables of Arrow, dictionaries and arrays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.errors import DataError
from fuzzytrack.io.table import Column, Kind, Table, checked_names, silent
from fuzzytrack.tasks import Progress

__all__ = ["FrameSource"]

_AXES = ("x", "y", "z")


class FrameSource:
    """Columns in memory; see `fuzzytrack.io.source.Source`.

    Parameters
    ----------
    columns : mapping of str to array_like
        All of one length: numbers, texts, datetimes, datetime64.
    file : str
        What stands for the name of a file, in messages.

    Raises
    ------
    DataError
        If their lengths differ, there are none, or one has more than one value a row.
    """

    def __init__(self, columns: Mapping[str, Any], file: str = "plots") -> None:
        self.file = file
        names = _checked_names(columns, file)
        self._columns = {str(name): _array(values) for name, values in columns.items()}
        for name, values in self._columns.items():
            if values.ndim != 1:
                raise DataError(
                    f"{file}: column {name!r}: shape {values.shape}; expected one value a row"
                )
        self.types = {name: str(self._columns[name].dtype) for name in names}
        lengths = {name: len(values) for name, values in self._columns.items()}
        if len(set(lengths.values())) > 1:
            (least, few), *_, (most, many) = sorted(lengths.items(), key=lambda item: item[1])
            raise DataError(
                f"{file}: column {most!r} has {many} rows, column {least!r} has {few}; all must "
                "have equally many"
            )

    @classmethod
    def of(cls, data: Any) -> FrameSource:
        """Make one of what a user has.

        Parameters
        ----------
        data : data frame, table, mapping, or (time, plots)
            A data frame of pandas or polars, a table of Arrow, a mapping from names to columns; or
            times, shape (n,), and plots, shape (n,) or (n, n_axes), which become the columns t,
            x, y and z.

        Raises
        ------
        TypeError
            If it is something else.
        DataError
            If the columns do not fit.
        """
        if isinstance(data, Mapping):
            return cls(data)
        if isinstance(data, tuple) and len(data) == 2:
            return cls(_of_arrays(*data))
        if hasattr(data, "column_names") and hasattr(data, "column"):  # a table of Arrow
            _checked_names(data.column_names, "plots")
            return cls({name: data.column(name).to_numpy() for name in data.column_names})
        if hasattr(data, "columns") and hasattr(data, "__getitem__"):
            _checked_names(data.columns, "plots")
            return cls({name: data[name] for name in data.columns})
        raise TypeError(
            "plots must be a file, a folder, a data frame, a mapping from names to columns, or "
            f"(time, plots); got {type(data).__name__}"
        )

    def tables(
        self, kinds: Mapping[str, Kind], rows: int | None, progress: Progress = silent
    ) -> Iterator[Table]:
        """Read columns, at most so many rows at a time."""
        total = len(next(iter(self._columns.values())))
        step = rows or max(total, 1)
        for start in range(0, total, step):
            numbers = np.arange(start + 1, min(start + step, total) + 1)
            columns = [Column(self.file, name, kind) for name, kind in kinds.items()]
            for column in columns:
                _take(column, self._columns[column.name][start : start + step], numbers)
            yield Table.of(self.file, columns, numbers)
            progress(min((start + step) / total, 1.0))


def _array(values: Any) -> NDArray[Any]:
    if isinstance(values, np.ma.MaskedArray):
        return _unmasked(values)
    if hasattr(values, "to_numpy"):
        return np.asarray(values.to_numpy())
    return np.asarray(values)


def _unmasked(values: Any) -> NDArray[Any]:
    """Values, with none where they are masked; whole numbers stay exact."""
    if not np.ma.getmaskarray(values).any():
        return np.asarray(values.data)
    nothing: Any = {"f": np.nan, "M": "NaT", "m": "NaT"}.get(values.dtype.kind)
    whole = values if nothing is not None else values.astype(object)
    return np.asarray(np.ma.filled(whole, nothing))


def _checked_names(names: Iterable[Any], file: str) -> list[str]:
    words = [str(name) for name in names]
    if not words:
        raise DataError(f"{file}: holds no columns")
    return list(checked_names(words, file))


def _of_arrays(time: Any, plots: Any) -> dict[str, Any]:
    positions = _array(plots)
    if positions.ndim == 1:
        positions = positions[:, None]
    if positions.ndim != 2 or not 1 <= positions.shape[1] <= 3:
        raise DataError(
            f"plots: shape must be (n,) or (n, n_axes) with 1 to 3 axes, got {positions.shape}"
        )
    return {"t": time, **dict(zip(_AXES, positions.T, strict=False))}


def _take(column: Column, values: NDArray[Any], rows: NDArray[np.int64]) -> None:
    """Add values to a column, by what they are."""
    kind = values.dtype.kind
    if column.kind == "time" and kind in "iufmM":
        column.take_times(values, rows)
    elif column.kind in ("number", "gaps") and kind in "biuf":
        column.take_numbers(values.astype(np.float64), rows)
    else:
        column.take_cells(["" if _is_none(each) else str(each) for each in values], rows.tolist())


def _is_none(value: Any) -> bool:
    # NaN, NaT and the missing value of pandas differ from themselves, or are not to be compared.
    try:
        return value is None or not bool(value == value)
    except TypeError:
        return True
