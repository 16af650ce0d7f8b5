"""Sources of formats that are read record by record: rows made into tables, losses counted."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np

from fuzzytrack.errors import DataError
from fuzzytrack.io.byte_stream import ByteStream
from fuzzytrack.io.description import PlotDescription
from fuzzytrack.io.table import Column, Kind, Table, silent
from fuzzytrack.tasks import Progress

__all__ = ["Losses", "RecordSource", "no_plots"]

#: Where a record stands in its file, counted from 1, and its cells: a number, a text or None.
Row = tuple[int, Sequence[Any]]

# Records at a time.
_CHUNK = 5_000


class Losses:
    """What was left out of a file, or taken for something else: how often, and where first."""

    def __init__(self) -> None:
        self._counts: dict[tuple[str, str], int] = {}
        self._first: dict[tuple[str, str], str] = {}
        self._texts: list[str] = []

    def add(self, what: str, place: str, count: int = 1, *, so: str = "left out") -> None:
        """Count something.

        Parameters
        ----------
        what : str
            What it is, in the plural: "messages without a position".
        place : str
            Where it is: "line 3".
        count : int
            How many.
        so : str
            What became of it.
        """
        key = (so, what)
        self._counts[key] = self._counts.get(key, 0) + count
        self._first.setdefault(key, place)

    def extend(self, others: Losses) -> None:
        """Count those of another part of the file."""
        for key, count in others._counts.items():
            so, what = key
            self.add(what, others._first[key], count, so=so)
        self._texts += others._texts

    def say(self, text: str) -> None:
        """Tell of something that cannot be counted."""
        self._texts.append(text)

    @property
    def notes(self) -> list[str]:
        """All of it in words."""
        counts = [
            f"{what}: {count} {so}, first at {self._first[so, what]}"
            for (so, what), count in self._counts.items()
        ]
        return counts + self._texts


class RecordSource:
    """An open file of records; see `fuzzytrack.io.source.Source`.

    Parameters
    ----------
    stream : ByteStream
        The open file.
    types : mapping of str to str
        Names of the columns, and their types: "number" or "text".
    description : PlotDescription
        What the columns are.
    rows : iterator of Row
        The records, in the order of `types`.
    losses : Losses
        Grows while the rows are read.
    remarks : sequence of str
        Further notes about the file as a whole.
    origin : str
        Where the plots come from, if files of other origins do not fit to them.
    """

    def __init__(
        self,
        stream: ByteStream,
        types: Mapping[str, str],
        description: PlotDescription,
        rows: Iterator[Row],
        losses: Losses,
        remarks: Sequence[str] = (),
        origin: str = "",
    ) -> None:
        self.file, self.types, self.description = stream.file, dict(types), description
        self.origin = origin
        self._stream, self._rows, self._losses, self._remarks = stream, rows, losses, remarks

    @property
    def notes(self) -> list[str]:
        """What is worth a word about what has been read so far, and what was left out."""
        return [f"{self.file}: {note}" for note in (*self._remarks, *self._losses.notes)]

    def tables(
        self, kinds: Mapping[str, Kind], rows: int | None, progress: Progress = silent
    ) -> Iterator[Table]:
        """Read columns, at most so many rows at a time; see `fuzzytrack.io.source.Source`."""
        columns: list[Column] = []
        places: list[int] = []
        found = False
        while part := list(islice(self._rows, min(_CHUNK, (rows or sys.maxsize) - len(places)))):
            if not places:
                columns = [Column(self.file, name, kind) for name, kind in kinds.items()]
            self._take(columns, part)
            places.extend(place for place, _ in part)
            found = True
            if (share := self._stream.share()) is not None:
                progress(share)
            if rows is not None and len(places) == rows:
                yield Table.of(self.file, columns, np.array(places))
                places = []
        if places:
            yield Table.of(self.file, columns, np.array(places))
        if not found:
            raise no_plots(self.file, self._losses)

    def _take(self, columns: Sequence[Column], part: Sequence[Row]) -> None:
        """Add some rows to columns."""
        names = list(self.types)
        places = np.array([place for place, _ in part], dtype=np.int64)
        for column in columns:
            index = names.index(column.name)
            cells = [cells[index] for _, cells in part]
            if self.types[column.name] != "number" or column.kind in ("word", "text"):
                column.take_cells(list(map(_text, cells)), places.tolist())
            elif column.kind == "time":
                column.take_times(np.array(cells, dtype=np.float64), places)
            else:
                column.take_numbers(np.array(cells, dtype=np.float64), places)


def no_plots(file: str, losses: Losses) -> DataError:
    """Error about a file of which nothing is left."""
    why = "; ".join(losses.notes)
    return DataError(f"{file}: holds no plots{': ' + why if why else ''}")


def _text(cell: float | str | None) -> str:
    """Text of a cell; empty if there is nothing in it."""
    if cell is None or cell != cell:
        return ""
    return cell if isinstance(cell, str) else f"{cell:.15g}"
