"""ASTERIX: plots and tracks of categories 001, 021, 048 and 062, with the extra ``asterix``.

`fuzzytrack.io.asterix_blocks` finds the records in a file, `fuzzytrack.io.asterix_plots` what they
say of a plot.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain
from typing import ClassVar

from fuzzytrack.io.asterix_blocks import Record, import_asterix, records
from fuzzytrack.io.asterix_plots import CATEGORIES, IDENTITIES, TEXTS, Cells
from fuzzytrack.io.byte_stream import ByteStream, open_bytes
from fuzzytrack.io.readers import Reader
from fuzzytrack.io.record_source import Losses, RecordSource, Row, no_plots
from fuzzytrack.yamltree import suggestion

__all__ = ["Asterix"]

_POSITIONS = ("range", "lat", "x")


@dataclass
class Asterix(Reader):
    """Reads the plots of one category and source, and of one kind of position.

    Parameters
    ----------
    category : int, optional
        1, 21, 48 or 62; unless given, that of the first plot.
    source : str, optional
        Radar or system, its codes as ``SAC/SIC``; unless given, that of the first plot.
    identity : {"auto", "address", "track", "mode_3a", "none"}
        What distinguishes tracks: the address of the aircraft, the track number, the Mode 3/A code,
        or nothing. The default takes of these the first that a record has; of category 062 always
        the track number.
    """

    category: int | None = None
    source: str | None = None
    identity: str = "auto"

    suffixes: ClassVar[tuple[str, ...]] = (".ast", ".asterix", ".cat062")

    def __post_init__(self) -> None:
        if self.category is not None and self.category not in CATEGORIES:
            allowed = ", ".join(map(str, CATEGORIES))
            raise ValueError(f"category: {self.category} cannot be read; allowed: {allowed}")
        words = ("auto", *IDENTITIES, "none")
        if self.identity not in words:
            raise ValueError(
                f"identity: unknown {self.identity!r}{suggestion(self.identity, words)}"
            )

    def check(self, file: str) -> None:
        """Check that libasterix is installed; DataError if not."""
        import_asterix(file)

    @contextmanager
    def open_source(self, file: str) -> Iterator[RecordSource]:
        """Open a file.

        Raises
        ------
        DataError
            If it holds no such plots.
        OSError
            If it cannot be read.
        """
        with open_bytes(file) as stream:
            yield self.source_of(stream, Losses())

    def source_of(self, stream: ByteStream, losses: Losses) -> RecordSource:
        """Plots in the bytes of an open file.

        Parameters
        ----------
        stream : ByteStream
        losses : Losses
            Gets what is left out.

        Raises
        ------
        DataError
            If it holds no such plots.
        """
        plots = self._plots(stream, losses)
        first = next(plots, None)
        if first is None:
            raise no_plots(stream.file, losses)
        record, cells = first
        types = {name: "text" if name in TEXTS else "number" for name in cells}
        rows = _rows(chain((first,), plots), tuple(types))
        description = CATEGORIES[record.category].description(types, "id" in types)
        origin = f"of category {record.category:03d} from source {cells['source']}"
        notes = [f"plots {origin}", *CATEGORIES[record.category].notes]
        return RecordSource(stream, types, description, rows, losses, notes, origin)

    def _plots(self, stream: ByteStream, losses: Losses) -> Iterator[tuple[Record, Cells]]:
        """Records that are plots, all of the category, source and position of the first."""
        chosen: tuple[int, str, str] | None = None
        # Records that name no source have that of the one before.
        last: dict[int, str] = {}
        for record in records(stream, losses):
            cells = CATEGORIES[record.category].cells(record.items)
            source = str(cells["source"] or last.get(record.category, "?"))
            cells["source"] = last[record.category] = source
            position = next((name for name in _POSITIONS if name in cells), "")
            wrong = self._fault(record, cells, position)
            if not wrong and chosen is None:
                chosen = (record.category, source, position)
            if not wrong and chosen != (record.category, source, position):
                wrong = f"records of category {record.category:03d} from source {source}"
                if chosen is not None and chosen[:2] == (record.category, source):
                    wrong = "records with another kind of position"
            if wrong:
                losses.add(wrong, record.place)
                continue
            if math.isnan(_number(cells, position)):
                losses.add("records without a detection", record.place, so="taken as missed")
            yield record, cells

    def _fault(self, record: Record, cells: Cells, position: str) -> str:
        """Why a record is left out; empty if it is not. Gives its identity a cell of its own."""
        category = CATEGORIES[record.category]
        if self.category not in (None, record.category):
            return f"records of category {record.category:03d}"
        if self.source not in (None, cells["source"]):
            return f"records of category {record.category:03d} from source {cells['source']}"
        time = _number(cells, "time")
        # Comparisons with NaN are false.
        if not time < category.wrap:
            return "records without a time" if math.isnan(time) else "records later than midnight"
        if not position:
            return "records without a position"
        if abs(_number(cells, "lat")) > 90.0:
            return "records with a latitude beyond 90°"
        if self.identity == "none":
            return ""
        names = category.identities if self.identity == "auto" else (self.identity,)
        id = next((f"{_MARKS[n]}{cells[n]}" for n in names if cells.get(n) is not None), None)
        if id is None:
            return (
                "records without an identity, which `format` asterix:identity=none takes as "
                "one track"
            )
        cells["id"] = id
        return ""


# Track numbers and codes are told from addresses, and from each other.
_MARKS = {"address": "", "track": "T", "mode_3a": "A"}


def _number(cells: Mapping[str, object], name: str) -> float:
    """Number in a cell; NaN if there is none."""
    value = cells.get(name)
    return value if isinstance(value, float) else math.nan


def _rows(plots: Iterator[tuple[Record, Cells]], names: tuple[str, ...]) -> Iterator[Row]:
    for record, cells in plots:
        yield record.number, [cells.get(name) for name in names]
