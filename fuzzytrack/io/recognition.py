"""How a text file is written, recognized by its first lines: encoding, separators, names, units."""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, islice
from typing import Any

from fuzzytrack.errors import DataError
from fuzzytrack.io.column_names import is_unit, unit_of
from fuzzytrack.io.table import checked_names
from fuzzytrack.io.text_form import DELIMITERS, MISSING, TextForm
from fuzzytrack.plurals import counted

__all__ = [
    "HEAD",
    "Layout",
    "cells_of_lines",
    "encoding_of",
    "is_units_row",
    "recognize",
    "usable_lines",
]

#: Bytes at the beginning of a file that are looked at.
HEAD = 1 << 18
# Rows that are looked at.
_ROWS = 50
# Lines that are looked at together.
_BATCH = 1000

_BYTE_ORDER_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    # Begins as that of UTF-16 does.
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_NAMES = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "'|'", " ": "blanks"}

_WITH_POINT = re.compile(r"[+-]?(?:\d+\.\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_WITH_COMMA = re.compile(r"[+-]?(?:\d+,\d*|,\d+)(?:[eE][+-]?\d+)?", re.ASCII)
# What may be a decimal comma, or a comma between thousands.
_EITHER = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII)
_WHOLE = re.compile(r"[+-]?\d+(?:[eE][+-]?\d+)?", re.ASCII)
_DATE_OR_CLOCK = re.compile(r"\d{1,4}([-/.:])\d{1,2}\1\d{1,4}\S*(?: .*)?", re.ASCII)
# A spreadsheet's own word for the separator.
_SEPARATOR = re.compile(r"sep=(.)\s*", re.IGNORECASE)
# Missing numbers that begin as comments do.
_NO_COMMENT = re.compile(r"\s*#n/?a\s*(?:[,;\t|]|$)", re.IGNORECASE)


@dataclass(frozen=True, kw_only=True)
class Layout:
    """What the first lines of a text file say about it.

    Attributes
    ----------
    file : str
        Its name, for messages.
    form : TextForm
        The form, with delimiter and decimal mark.
    names : tuple of str
        Names of the columns; those of columns without a name are empty.
    units : dict of str to str
        Units by the names of columns, if there is a row of them under that of the names.
    lines : int
        Lines before the first row of data.
    comments : int
        How many of them are comments.
    """

    file: str
    form: TextForm
    names: tuple[str, ...]
    units: dict[str, str]
    lines: int
    comments: int


def encoding_of(file: str, head: bytes) -> str:
    """Encoding of a text by its byte order mark; UTF-8 if it has none.

    Raises
    ------
    DataError
        If it looks like UTF-16 without a mark.
    """
    for mark, encoding in _BYTE_ORDER_MARKS:
        if head.startswith(mark):
            return encoding
    if head[:64].count(0) > len(head[:64]) // 3:
        raise DataError(
            f"{file}: row 1: is not UTF-8, and UTF-16 only with a byte order mark; "
            "save the file as UTF-8"
        )
    return "utf-8"


# -------------------------------------------------------------------- lines and cells


def usable_lines(
    lines: Iterable[str], form: TextForm, counts: dict[str, int] | None = None
) -> Iterator[str]:
    """Lines for the reader of the standard library; an empty one for each comment.

    Parameters
    ----------
    lines : iterable of str
        Lines with their ends.
    form : TextForm
        What is a comment, and whether blanks separate cells.
    counts : dict of str to int, optional
        Comments are added to ``counts["comment line"]``.
    """
    lines = iter(lines)
    return chain.from_iterable(
        _usable(batch, form, counts) for batch in iter(lambda: list(islice(lines, _BATCH)), [])
    )


def _usable(batch: list[str], form: TextForm, counts: dict[str, int] | None) -> list[str]:
    mark = form.comment
    if mark and mark in "".join(batch):
        for k, line in enumerate(batch):
            if line.lstrip(" ").startswith(mark) and not _NO_COMMENT.match(line):
                batch[k] = "\n"
                if counts is not None:
                    counts["comment line"] = counts.get("comment line", 0) + 1
    if form.delimiter == " ":
        return [" ".join(line.split()) + "\n" for line in batch]
    return batch


def cells_of_lines(lines: Iterable[str], delimiter: str) -> Any:
    """Reader of the standard library over lines."""
    return csv.reader(lines, delimiter=delimiter, strict=True, skipinitialspace=True)


# -------------------------------------------------------------------- recognition


def recognize(file: str, lines: Sequence[str], form: TextForm) -> Layout:
    """Recognize how a text file is written.

    Parameters
    ----------
    file : str
        Its name, for messages.
    lines : sequence of str
        Its first lines, with their ends.
    form : TextForm
        What is known already.

    Raises
    ------
    DataError
        If it has no row of names where there must be one, or may be read in two ways; says what to
        do about it.
    """
    first = 0
    if lines and form.delimiter is None and (found := _SEPARATOR.fullmatch(lines[0])):
        first = 1
        if found[1] in DELIMITERS:
            form = replace(form, delimiter=found[1])
    counts: dict[str, int] = {}
    while (
        first < len(lines)
        and not next(usable_lines(lines[first : first + 1], form, counts)).strip()
    ):
        first += 1
    if first == len(lines):
        raise _is_empty(file)
    sample = lines[first:]
    delimiter = form.delimiter or _delimiter(file, sample, form, first + 1)
    form = replace(form, delimiter=delimiter)
    rows = _rows(sample, form)
    if not rows:
        # Rows of blank cells, or the error of a row that is not CSV.
        reader = cells_of_lines(usable_lines(sample, form), delimiter)
        try:
            for _ in reader:
                pass
        except csv.Error as error:
            where = f"{file}: row {first + reader.line_num}"
            raise DataError(f"{where}: not CSV: {error}") from None
        raise _is_empty(file)
    units: dict[str, str] = {}
    if form.columns is None:
        (header, end), *rows = rows
        names = _names(file, header, first + 1)
        taken = first + end
        if rows and is_units_row(rows[0][0]):
            (row, end), *rows = rows
            units = {
                name: unit_of(cell)
                for name, cell in zip(names, row, strict=False)
                if name and cell.strip() and not _is_zone(cell)
            }
            taken = first + end
    else:
        names, taken = checked_names(form.columns, f"{file}: `columns`"), first
        if len(rows[0][0]) < len(names) or any(cell.strip() for cell in rows[0][0][len(names) :]):
            raise DataError(
                f"{file}: row {first + 1}: {counted(len(rows[0][0]), 'cell')} between "
                f"{_NAMES[delimiter]}, but `columns` names {len(names)}"
            )
    if form.decimal is None:
        form = replace(form, decimal=_decimal([cell for row, _ in rows for cell in row], delimiter))
    return Layout(
        file=file,
        form=form,
        names=names,
        units=units,
        lines=taken,
        comments=counts.get("comment line", 0),
    )


def _is_empty(file: str) -> DataError:
    return DataError(f"{file}: is empty; expected a row of column names, then data")


def is_units_row(row: Sequence[str]) -> bool:
    """Whether a row holds units of columns: at least one, and nothing else."""
    cells = [cell.strip() for cell in row if cell.strip() not in ("", "-") and not _is_zone(cell)]
    return bool(cells) and all(map(is_unit, cells))


def _is_zone(cell: str) -> bool:
    """Whether a cell of a row of units says of a column that its dates are of Greenwich."""
    return cell.strip().strip("[](){}<>").lower() in ("utc", "gmt", "z")


def _rows(lines: Sequence[str], form: TextForm) -> list[tuple[list[str], int]]:
    """Rows that are not blank, each with the number of its last line."""
    reader = cells_of_lines(usable_lines(lines, form), form.delimiter or ",")
    found: list[tuple[list[str], int]] = []
    try:
        for row in reader:
            if row and any(map(str.strip, row)):
                found.append((row, reader.line_num))
            if len(found) > _ROWS:
                break
    # What is no CSV becomes an error where the row is read.
    except csv.Error:
        pass
    return found


def _delimiter(file: str, lines: Sequence[str], form: TextForm, row: int) -> str:
    """What separates the cells: that by which all rows have the cells that the first one has."""
    head = lines[0].strip()
    found = [mark for mark in DELIMITERS[:-1] if mark in head]
    if not found:
        return " " if " " in head else ","
    if len(found) == 1:
        return found[0]
    tried = {mark: _rows(lines, replace(form, delimiter=mark)) for mark in found}
    wide = [mark for mark in found if not tried[mark] or len(tried[mark][0][0]) > 1]
    if len(wide) < 2:
        return (wide or found)[0]
    fits = [mark for mark in wide if _fits(tried[mark], form)]
    if len(fits) == 1:
        return fits[0]
    marks = " and ".join(_NAMES[mark] for mark in fits or wide)
    raise DataError(f"{file}: row {row}: {marks} are there; `delimiter` says which separates cells")


def _fits(rows: Sequence[tuple[Sequence[str], int]], form: TextForm) -> bool:
    if not rows:
        return False
    width = len(rows[0][0]) if form.columns is None else len(form.columns)
    return all(
        len(row) == width or (len(row) > width and not any(map(str.strip, row[width:])))
        for row, _ in rows
    )


def _names(file: str, header: Sequence[str], row: int) -> tuple[str, ...]:
    names = [name.strip() for name in header]
    named = [name for name in names if name]
    if named and all(map(_is_data, named)):
        raise DataError(
            f"{file}: row {row}: holds numbers; expected the names of the columns "
            "(`columns` gives them names)"
        )
    return checked_names(names, file)


def _is_data(cell: str) -> bool:
    """Whether a cell is a number, a time or a missing number, and so no name."""
    if cell.lower() in MISSING:
        return True
    return any(form.fullmatch(cell) for form in (_WHOLE, _WITH_POINT, _WITH_COMMA, _DATE_OR_CLOCK))


def _decimal(cells: Sequence[str], delimiter: str) -> str:
    """Decimal mark of numbers: a comma if no other reading is possible."""
    texts = [cell.strip() for cell in cells]
    commas = [text for text in texts if "," in text and _WITH_COMMA.fullmatch(text)]
    if not commas or any(map(_WITH_POINT.fullmatch, texts)):
        return "."
    # With a point the first such cell is refused, and the message says what may be meant.
    return "." if all(map(_EITHER.fullmatch, commas)) else ","
