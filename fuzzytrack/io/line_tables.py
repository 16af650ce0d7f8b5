"""Lines of a feed, CSV or JSON, as tables: any lines at any time, once the first ones are known."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from fuzzytrack.errors import DataError
from fuzzytrack.io.csv_lines import line_parts
from fuzzytrack.io.recognition import recognize, usable_lines
from fuzzytrack.io.table import Column, Kind, Table, checked_names, silent
from fuzzytrack.io.text_form import TextForm
from fuzzytrack.tasks import Progress

__all__ = ["CsvLines", "JsonLines", "LineTables", "line_tables"]


class LineTables(Protocol):
    """What is known of a feed by its first lines; see also `fuzzytrack.io.source.Source`."""

    file: str
    types: dict[str, str]
    units: dict[str, str]
    is_json: bool
    #: Lines before the first row.
    begins: int
    #: Columns whose cells were numbers in the first row, where a feed says so.
    numbers: frozenset[str]

    def tables(
        self, kinds: Mapping[str, Kind], rows: int | None, progress: Progress = silent
    ) -> Iterator[Table]:
        """The table of the first rows."""

    def table(self, lines: Sequence[str], first: int, kinds: Mapping[str, Kind]) -> Table:
        """Table of some lines that follow each other.

        Parameters
        ----------
        lines : sequence of str
        first : int
            Where the first of them stands in the feed, counted from 1.
        kinds : mapping of str to Kind
            The columns that are wanted, and what each must hold.

        Raises
        ------
        DataError
            If a line has too few or too many cells, or one that does not hold what it must; names
            line, column and value.
        """


def line_tables(file: str, lines: Sequence[str], form: TextForm) -> LineTables | None:
    """Recognize a feed by its first lines: JSON if the first one begins so, else CSV.

    Parameters
    ----------
    file : str
        Its name, for messages.
    lines : sequence of str
        Its first lines, with their ends.
    form : TextForm
        How it is written, as far as that is known.

    Returns
    -------
    LineTables or None
        None as long as there is no row after the names of the columns.

    Raises
    ------
    DataError
        If the first line neither names columns nor is an object of JSON.
    """
    there = [k for k, line in enumerate(usable_lines(lines, form)) if line.strip()]
    if not there:
        return None
    if form.columns is None and lines[there[0]].lstrip().startswith("{"):
        return JsonLines(file, lines, there[0], form)
    if form.columns is None and len(there) < 2:
        return None
    found = CsvLines(file, lines, form)
    return found if found.begins <= there[-1] else None


class CsvLines:
    """Lines of CSV. A cell ends with its line."""

    is_json = False

    def __init__(self, file: str, lines: Sequence[str], form: TextForm) -> None:
        self._layout = recognize(file, lines, form)
        self.file, self.units = file, self._layout.units
        self.types = dict.fromkeys(self._layout.names, "text")
        self.numbers: frozenset[str] = frozenset()
        self.begins = self._layout.lines
        self._rows = list(lines[self.begins :])

    def tables(
        self, kinds: Mapping[str, Kind], rows: int | None, progress: Progress = silent
    ) -> Iterator[Table]:
        """The table of the first rows."""
        yield self.table(self._rows, self.begins + 1, kinds)

    def table(self, lines: Sequence[str], first: int, kinds: Mapping[str, Kind]) -> Table:
        """Table of some lines; see `LineTables`."""
        for number, line in enumerate(lines, first):
            if '"' in line and line.count('"') % 2:
                raise DataError(
                    f"{self.file}: row {number}: a quote is open at the end of the line"
                )
        columns = [Column(self.file, name, kind, self._layout.form) for name, kind in kinds.items()]
        numbers = []
        # Row 1 would be that of the names.
        for part in line_parts(lines, self._layout, first - 1, {}):
            part.take(columns, 0, len(part.rows))
            numbers.append(part.rows)
        return Table.of(self.file, columns, np.concatenate([np.empty(0, np.int64), *numbers]))


class JsonLines:
    """Lines that are objects of JSON each, with a number, a text or null under each name.

    A name that is missing stands for null.
    """

    is_json = True

    def __init__(self, file: str, lines: Sequence[str], begins: int, form: TextForm) -> None:
        self.file, self._form, self.begins = file, form, begins
        self.units: dict[str, str] = {}
        self._rows = list(lines[begins:])
        first = self._object(lines[begins], begins + 1)
        for name in first:
            self._cell(name, begins + 1, "name")
        self.types = dict.fromkeys(checked_names(list(first), file), "text")
        self.numbers = frozenset(
            name for name, value in first.items() if isinstance(value, int | float)
        )

    def tables(
        self, kinds: Mapping[str, Kind], rows: int | None, progress: Progress = silent
    ) -> Iterator[Table]:
        """The table of the first rows."""
        yield self.table(self._rows, self.begins + 1, kinds)

    def table(self, lines: Sequence[str], first: int, kinds: Mapping[str, Kind]) -> Table:
        """Table of some lines; see `LineTables`."""
        there = [k for k, line in enumerate(lines) if line.strip()]
        texts, rows = [lines[k].strip() for k in there], [first + k for k in there]
        objects = self._objects(texts, rows)
        columns = []
        for name, kind in kinds.items():
            column = Column(self.file, name, kind, self._form)
            values = [each.get(name) for each in objects]
            cells = [self._cell(*each, name) for each in zip(values, rows, strict=True)]
            column.take_cells(cells, rows)
            columns.append(column)
        return Table.of(self.file, columns, np.array(rows, dtype=np.int64))

    def _objects(self, texts: Sequence[str], rows: Sequence[int]) -> list[dict[str, Any]]:
        # All at once takes half the time.
        if all(text[0] == "{" and text[-1] == "}" for text in texts):
            try:
                found = json.loads(f"[{','.join(texts)}]")
            except ValueError:
                found = []
            if len(found) == len(texts) and all(type(each) is dict for each in found):
                return list(found)
        return [self._object(text, row) for text, row in zip(texts, rows, strict=True)]

    def _object(self, text: str, row: int) -> dict[str, Any]:
        try:
            found = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise DataError(f"{self.file}: row {row}: not JSON: {error}") from None
        if not isinstance(found, dict):
            raise DataError(f"{self.file}: row {row}: expected an object of JSON, {{...}}")
        return found

    def _cell(self, value: Any, row: int, name: str) -> str:
        if isinstance(value, str):
            if not (value.isascii() or _is_text(value)):
                raise DataError(
                    f"{self.file}: row {row}, column {name}: {json.dumps(value)[:40]} has half a "
                    "pair of surrogates; expected text"
                )
            return value
        if value is None:
            return ""
        if isinstance(value, int | float) and not isinstance(value, bool):
            return repr(value)
        raise DataError(
            f"{self.file}: row {row}, column {name}: {json.dumps(value)[:40]}; expected a number, "
            "a text or null"
        )


def _is_text(value: str) -> bool:
    """Whether a text can be written; JSON can name halves of characters, which cannot."""
    try:
        value.encode()
    except UnicodeEncodeError:
        return False
    return True
