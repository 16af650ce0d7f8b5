"""Tables: named columns of numbers and words, and the checks of their cells.

Common to all formats of files; `fuzzytrack.io.csv` and `fuzzytrack.io.parquet` read and write
tables.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.text_form import MISSING, PLAIN, TextForm
from fuzzytrack.numerals import as_number, is_number
from fuzzytrack.reprs import summary

__all__ = [
    "Cells",
    "Column",
    "Kind",
    "Table",
    "Values",
    "Words",
    "checked_names",
    "no_rows",
    "silent",
]

#: What a column that is read must hold: a number in every row; numbers and gaps; words, of which
#: some may be empty; times as they are written, none missing; any text.
Kind = Literal["number", "gaps", "word", "time", "text"]

#: Cells as they were read: text, or from files that have types an array of int64, float64 or
#: datetime64.
Cells = Sequence[str] | NDArray[Any]

_EXPECTED = {
    "number": "a finite number",
    "gaps": "a finite number, or an empty cell or nan for a missed plot",
    "word": "text",
    "time": "a time",
    "text": "text",
}


# Numbers with a decimal point, a decimal comma, and with marks between thousands.
_POINT = re.compile(r"[+-]?(?:\d+\.\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_COMMA = re.compile(r"[+-]?(?:\d+,\d*|,\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(?:[ ,.']\d{3})+(?:[.,]\d*)?", re.ASCII)


@dataclass(frozen=True, eq=False)
class Words(Sequence[str]):
    """Column of words, each different word kept once.

    Attributes
    ----------
    names : tuple of str
        The different words, in order of first appearance.
    codes : ndarray of int, shape (n_rows,)
        For each row the position of its word in `names`.
    """

    names: tuple[str, ...]
    codes: NDArray[np.int64]

    def __repr__(self) -> str:
        return summary(self, "names", "codes")

    @classmethod
    def same(cls, word: str, count: int) -> Words:
        """Column of one word in all rows."""
        return cls((word,), np.zeros(count, dtype=np.int64))

    def __len__(self) -> int:
        """Rows of the column."""
        return len(self.codes)

    @overload
    def __getitem__(self, key: int) -> str: ...
    @overload
    def __getitem__(self, key: slice) -> list[str]: ...
    def __getitem__(self, key: int | slice) -> str | list[str]:
        """Word of a row, or words of some rows."""
        if isinstance(key, slice):
            return [self.names[code] for code in self.codes[key].tolist()]
        return self.names[int(self.codes[key])]


#: Columns to be written, by name and all of one length; NaN stands for an empty cell.
Values = Mapping[str, Sequence[str] | NDArray[Any]]


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
    cells : dict of (sequence of str or ndarray)
        Columns of times and of any text, as they were read: text without blanks around it, or in
        files that have types an array of int64, float64 or datetime64.
    """

    file: str
    rows: NDArray[np.int64]
    numbers: dict[str, Array]
    words: dict[str, Words]
    cells: dict[str, Cells] = field(default_factory=dict)

    def __repr__(self) -> str:
        return summary(self, "file", "numbers", "words", "cells", rows=len(self.rows))

    @classmethod
    def of(cls, file: str, columns: Sequence[Column], rows: NDArray[np.int64]) -> Table:
        """Table of columns that have been read."""
        numbers, words, cells = {}, {}, {}
        for column in columns:
            if column.kind == "word":
                words[column.name] = column.words()
            elif column.kind in ("time", "text"):
                cells[column.name] = column.cells()
            else:
                numbers[column.name] = column.numbers()
        return cls(file, rows, numbers, words, cells)

    def with_words(self, name: str) -> Table:
        """Rows that have a word in a column; the table itself if all have.

        Parameters
        ----------
        name : str
            Column of words.
        """
        column = self.words[name]
        if "" not in column.names:
            return self
        chosen = np.flatnonzero(column.codes != column.names.index(""))
        cells: dict[str, Cells] = {
            name: found[chosen]
            if isinstance(found, np.ndarray)
            else [found[place] for place in chosen.tolist()]
            for name, found in self.cells.items()
        }
        return Table(
            self.file,
            self.rows[chosen],
            {name: values[chosen] for name, values in self.numbers.items()},
            {name: _taken(each, chosen) for name, each in self.words.items()},
            cells,
        )


def _taken(words: Words, places: NDArray[np.int64]) -> Words:
    """Words of some rows, with no other names."""
    used, codes = np.unique(words.codes[places], return_inverse=True)
    return Words(tuple(words.names[code] for code in used.tolist()), codes.astype(np.int64))


class Column:
    """A column that is being read, part by part, with the checks of its cells.

    Parameters
    ----------
    file, name : str
        File and column, for messages.
    kind : {"number", "gaps", "word", "time", "text"}
        What its cells must hold.
    form : TextForm, optional
        What stands for a missing number.
    """

    def __init__(self, file: str, name: str, kind: Kind, form: TextForm = PLAIN) -> None:
        self.file, self.name, self.kind, self.form = file, name, kind, form
        self._parts: list[Any] = []
        self._codes: dict[str, int] = {}

    def empty(self) -> Column:
        """A column with the same checks of which nothing has been read."""
        return Column(self.file, self.name, self.kind, self.form)

    def numbers(self) -> Array:
        """All numbers read so far."""
        return np.concatenate(self._parts) if self._parts else np.empty(0)

    def words(self) -> Words:
        """All words read so far."""
        codes = np.concatenate(self._parts) if self._parts else np.empty(0)
        return Words(tuple(self._codes), codes.astype(np.int64))

    def cells(self) -> Cells:
        """All cells read so far, as they were."""
        if all(isinstance(part, np.ndarray) for part in self._parts):
            return self.numbers()
        return list(chain.from_iterable(self._parts))

    def take_cells(self, cells: Sequence[str], rows: Sequence[int]) -> None:
        """Add cells of text.

        Raises
        ------
        DataError
            If one does not hold what it must; names its row.
        """
        if self.kind in ("word", "time", "text"):
            words = list(map(str.strip, cells))
            if self.kind == "time" and not all(words):
                raise self.error(rows[words.index("")], "")
            if self.kind == "time" and self.form.decimal == ",":
                words = [
                    word if _COMMA.fullmatch(word) is None else word.replace(",", ".")
                    for word in words
                ]
            if self.kind != "word":
                self._parts.append(words)
                return
            codes = self._codes
            self._parts.append(np.array([codes.setdefault(word, len(codes)) for word in words]))
            return
        self._parts.append(self._numbers(cells, rows))

    def take_numbers(self, values: Array, rows: NDArray[np.int64]) -> None:
        """Add cells of numbers, NaN in the gaps; raises as `take_cells`."""
        bad = np.isinf(values) if self.kind == "gaps" else ~np.isfinite(values)
        self._refuse(bad, values, rows)
        self._parts.append(self._with_gaps(values))

    def take_times(self, values: NDArray[Any], rows: NDArray[np.int64]) -> None:
        """Add times of int64, float64 or datetime64; raises as `take_cells`."""
        self._refuse(~np.isfinite(values), values, rows)
        self._parts.append(values)

    def take_words(self, names: Sequence[str], codes: NDArray[np.int64]) -> None:
        """Add words: the different ones, and for each row which.

        Every one of the names is used; a negative code stands for an empty cell.
        """
        words = [name.strip() for name in names]
        if (codes < 0).any():
            # The last place is that of negative codes.
            words.append("")
        known = self._codes
        position = np.array([known.setdefault(word, len(known)) for word in words], dtype=np.int64)
        self._parts.append(position[codes])

    def _refuse(
        self, bad: NDArray[np.bool_], values: NDArray[Any], rows: NDArray[np.int64]
    ) -> None:
        if bad.any():
            place = int(np.argmax(bad))
            raise self.error(int(rows[place]), str(values[place]))

    def _with_gaps(self, values: Array) -> Array:
        """Numbers, NaN for those that stand for none."""
        codes = self.form.missing_numbers
        if codes and self.kind == "gaps":
            return np.where(np.isin(values, codes), math.nan, values)
        return values

    def _numbers(self, cells: Sequence[str], rows: Sequence[int]) -> Array:
        return self._with_gaps(self._plain_numbers(cells, rows))

    def _plain_numbers(self, cells: Sequence[str], rows: Sequence[int]) -> Array:
        plain = "\n".join(cells)
        # What else Python takes, `as_number` does not.
        if plain.isascii() and "_" not in plain:
            texts = cells
            if self.form.decimal == "," and plain.count("\n") == len(cells) - 1:
                texts = plain.replace(".", "?").replace(",", ".").split("\n")
            try:
                values = np.array(list(map(float, texts)))
            except ValueError:
                pass
            else:
                if np.isfinite(values).all():
                    return values
        return np.array([self._number(cell, row) for cell, row in zip(cells, rows, strict=True)])

    def _number(self, cell: str, row: int) -> float:
        text = cell.strip()
        if self.kind == "gaps" and text.lower() in self.form.missing:
            return math.nan
        plain = text
        if self.form.decimal == ",":
            plain = text.replace(".", "?").replace(",", ".")
        value = as_number(plain)
        if value is None:
            raise self.error(row, cell)
        return value

    def error(self, row: int, cell: str) -> DataError:
        """Error about a cell that does not hold what it must."""
        shown = repr(cell if len(cell) <= 40 else cell[:40] + "…") if cell else "an empty cell"
        remedy = self._remedy(cell.strip()) if self.kind in ("number", "gaps") else ""
        return DataError(
            f"{self.file}: row {row}, column {self.name}: {shown}; expected "
            f"{_EXPECTED[self.kind]}{remedy}"
        )

    def _remedy(self, text: str) -> str:
        """What to do about a cell that is no number."""
        if self.form.decimal == "," and "." in text and _POINT.fullmatch(text):
            return "; numbers of this file have decimal commas (`decimal`)"
        if _COMMA.fullmatch(text):
            return "; `decimal` says that numbers have decimal commas"
        if _THOUSANDS.fullmatch(text):
            return "; thousands must not be separated"
        return ""


def checked_names(names: Sequence[str], file: str) -> tuple[str, ...]:
    """Names of the columns of a file.

    Raises
    ------
    DataError
        If they are numbers, or two are the same.
    """
    cells = [name.strip() for name in names]
    if any(map(is_number, cells)) and all(is_number(c) or c.lower() in MISSING for c in cells):
        raise DataError(f"{file}: row 1: holds numbers; expected the names of the columns")
    doubled = sorted({name for name in names if name and names.count(name) > 1})
    if doubled:
        raise DataError(f"{file}: row 1: two columns are called {doubled[0]!r}; names must differ")
    return tuple(names)


def no_rows(file: str) -> DataError:
    """Error about a file that holds only the names of its columns."""
    return DataError(f"{file}: holds no rows, only column names")


def silent(share: float) -> None:
    """Progress that is not shown."""
