"""A feed of plots without identities: from lines or datagrams to the lines that answer them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Any, Protocol
from zlib import crc32

from fuzzytrack.errors import DataError
from fuzzytrack.io.datagrams import AsterixDatagrams
from fuzzytrack.io.line_tables import line_tables
from fuzzytrack.io.line_texts import csv_text, json_text
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.table import Kind, Table, no_rows
from fuzzytrack.recordings.live_faults import LiveFaults
from fuzzytrack.recordings.scan_findings import ScanFindings
from fuzzytrack.recordings.scan_plots import ScanPlots
from fuzzytrack.recordings.scan_rows import ScanRows, rows_of
from fuzzytrack.recordings.scan_run import ScannedScan, Scanner, ScanTotals
from fuzzytrack.recordings.scan_stream import ScanStream
from fuzzytrack.recordings.scan_table import ScanTable
from fuzzytrack.trackers.origin import digest_of

__all__ = ["FEED", "ScanFeed"]

#: Name of a feed, for messages.
FEED = "the feed"
# Items by which the scans must be recognized, and how often that is tried.
_MOST_HELD, _TRIED = 4_000, 200
# Part of the period of the scans after which a scan is whole if nothing comes.
_PAUSE = 0.05
# So many faulty rows are left out while the first items are looked at; more are no accident.
_FAULTY = 20
_ROW = re.compile(rf"{FEED}: row (\d+)\b")


class _Tables(Protocol):
    """What reads items of a feed, once the first ones are known."""

    def table(self, items: Any, first: int, kinds: dict[str, Kind]) -> Table:
        """Table of some items."""


class ScanFeed:
    """Items of a feed, lines or datagrams of ASTERIX, and the lines that answer them.

    Parameters
    ----------
    reading : Reading
        How plots are read.
    scanner : ScanTracker
        The scan tracker.
    how : dict
        How they are divided into scans, see `ScanPlots.of`.
    datagrams : bool
        Whether items are datagrams of ASTERIX rather than lines.
    output_columns : sequence of str, optional
        As for `ScanTable.of`.
    tentative : bool
        Whether tentative tracks are reported, too.
    json : bool
        Whether answers are lines of JSON.
    quote_formulas : bool
        As for `fuzzytrack.io.table_writer`.
    tell : callable, optional
        Called with a sentence about a fault; see `LiveFaults`.
    begin : callable, optional
        Called with the plots before the first answer.

    Attributes
    ----------
    items : int
        Items that were taken so far.
    checksum : int
        CRC-32 of their bytes.
    beginning : (int, int)
        How many items say how the others are read, and their CRC-32.
    head : list
        These items, lines as text; blank ones in place of faulty ones.
    scanner : ScanTracker
        The scan tracker.
    stream : ScanStream or None
        The scan tracker; None until it is known how plots become scans.
    totals : ScanTotals
        Counts so far.

    Raises
    ------
    ValueError
        If an option needs the whole recording.
    """

    def __init__(
        self,
        reading: Reading,
        scanner: Scanner,
        how: dict[str, Any] | None = None,
        *,
        datagrams: bool = False,
        output_columns: Sequence[str] | None = None,
        tentative: bool = False,
        json: bool = False,
        quote_formulas: bool = False,
        tell: Callable[[str], None] | None = None,
        begin: Callable[[ScanPlots], None] | None = None,
    ) -> None:
        self._how = dict(how or {})
        _check(reading, self._how)
        self.reading, self.scanner, self._columns = reading, scanner, output_columns
        self._datagrams, self._tentative = datagrams, tentative
        self._json, self._quotes, self._begin = json, quote_formulas, begin
        self.faults = LiveFaults(tell)
        self.items = self.checksum = 0
        self.beginning = (0, 0)
        self.head: list[Any] = []
        self.totals = ScanTotals()
        self.stream: ScanStream | None = None
        self._held: list[Any] = []
        self._tables: _Tables | None = None
        self._table: ScanTable | None = None

    @property
    def begun(self) -> bool:
        """Whether it is known how plots become scans."""
        return self.stream is not None

    @cached_property
    def digest(self) -> str:
        """Digest of the numbers of the scan tracker."""
        return digest_of(self.scanner)

    @property
    def options(self) -> dict[str, str]:
        """What decides on answers, beside the configuration and the feed; for a state."""
        return {
            "reading": repr(self.reading),
            **{name: repr(value) for name, value in self._how.items()},
            "output_columns": repr(self._columns),
            "tentative": repr(self._tentative),
            "json": repr(self._json),
            "quote_formulas": repr(self._quotes),
        }

    @property
    def header(self) -> bytes:
        """Line of the names of the answers; empty if they are JSON."""
        if self._table is None or self._json:
            return b""
        names = self._table.names
        return csv_text({name: [name] for name in names}, names, self._quotes).encode()

    @property
    def pause_after(self) -> float | None:
        """Seconds without an item after which `pause` is due; None if it never is."""
        if self.stream is None or self._how.get("sectors") is not None:
            return None
        period = self.stream.plots.cut.period
        return _PAUSE * period if period > 0 else None

    def push(self, items: Sequence[bytes]) -> bytes:
        """Take items, and give the answers to them.

        Parameters
        ----------
        items : sequence of bytes
            Whole lines with their ends, or datagrams.

        Returns
        -------
        bytes
            Whole lines; `header`, where there is one, belongs before the first of them.

        Raises
        ------
        DataError
            If the first items do not say how plots are read. What is wrong with later ones is
            counted.
        """
        first = self.items + 1
        self.items += len(items)
        self.checksum = crc32(b"".join(items), self.checksum)
        texts = list(items) if self._datagrams else self._texts(items, first)
        if self.stream is None:
            return self._look(texts)
        return self._answers(self._rows(texts, first))

    def pause(self) -> bytes:
        """Answer the scan so far; see `ScanStream.pause`."""
        return b"" if self.stream is None else self._text(self.stream.pause())

    def finish(self) -> bytes:
        """End the feed, and answer what is still held.

        Raises
        ------
        DataError
            If no plot could be used, or the scans could not be recognized.
        """
        answers = b""
        if self.stream is None:
            if not self._held:
                raise no_rows(FEED)
            answers = self._started(last=True)
        assert self.stream is not None
        answers += self._text(self.stream.finish())
        self.stream.plots.findings.check(FEED)
        return answers

    def sentences(self) -> tuple[str, ...]:
        """What was wrong with the feed so far, and what was done about it, in words."""
        found = self.stream.plots.findings.sentences() if self.stream is not None else ()
        lost = self._tables.notes if isinstance(self._tables, AsterixDatagrams) else ()
        return (*self.faults.sentences(), *lost, *found)

    # ---------------------------------------------------------------- the first items

    def _look(self, items: Sequence[Any]) -> bytes:
        """Hold items until they say how plots are read, and which are of one scan."""
        before = len(self._held)
        self._held += items
        recognized = self._how.get("scan") is None and (
            self._how.get("period") is None or self._how.get("sectors") is not None
        )
        # To recognize scans takes many plots; to try it at each would take long.
        if recognized and len(self._held) // _TRIED == before // _TRIED:
            return b""
        return self._started(last=len(self._held) >= _MOST_HELD)

    def _started(self, *, last: bool) -> bytes:
        """Begin with the items so far, if that is possible; it must be with the last of them."""
        head = list(self._held)
        faults: list[DataError] = []
        while True:
            try:
                found = self._recognized(head)
                break
            except DataError as error:
                row = _row_of(error)
                if len(faults) < _FAULTY and not self._datagrams and row is not None:
                    # Row 1 may be the one that names the columns.
                    faults.append(error)
                    head[row - 1] = "\n"
                elif last:
                    raise (faults or [error])[0] from None
                else:
                    return b""
        if found is None:
            if last:
                raise (faults or [no_rows(FEED)])[0]
            return b""
        for fault in faults:
            self.faults.add("faulty", f"{fault}; left out")
        self.beginning = self.items, self.checksum
        self._begin_with(head, *found)
        skip, self._held = 0 if self._datagrams else found[0].begins, []
        return self._answers(self._rows(head[skip:], skip + 1))

    def start(self, head: Sequence[Any]) -> None:
        """Begin with first items, which are those of `head` before.

        Parameters
        ----------
        head : sequence

        Raises
        ------
        DataError
            As `push`.
        """
        found = self._recognized(head)
        if found is None:
            raise no_rows(FEED)
        self._begin_with(head, *found)

    def _begin_with(self, head: Sequence[Any], tables: Any, plots: ScanPlots) -> None:
        self.head, self._tables = list(head), tables
        self._table = ScanTable.of(plots.files.decoder, "", self._columns)
        self.stream = ScanStream(plots, self.scanner, tentative=self._tentative)
        if self._begin is not None:
            self._begin(plots)

    def _recognized(self, head: Sequence[Any]) -> tuple[Any, ScanPlots] | None:
        """What reads the items and how they become scans; None if there is no row yet."""
        tables: Any = (
            AsterixDatagrams(FEED, head)
            if self._datagrams
            else line_tables(FEED, head, self.reading.form)
        )
        return None if tables is None else (tables, ScanPlots.of(tables, self.reading, **self._how))

    # ---------------------------------------------------------------- all items

    def _texts(self, lines: Sequence[bytes], first: int) -> list[str]:
        """Lines as text; an empty one in place of what is none."""
        found = []
        for number, line in enumerate(lines, first):
            try:
                found.append(line.decode("utf-8-sig" if number == 1 else "utf-8"))
            except UnicodeDecodeError:
                self.faults.add("faulty", f"{FEED}: row {number}: is not UTF-8; left out")
                found.append("\n")
        return found

    def _rows(self, items: Sequence[Any], first: int) -> list[ScanRows]:
        """Plots of some items; faulty ones are found by halves, and left out."""
        if not items:
            return []
        assert self._tables is not None
        assert self.stream is not None
        plots, found = self.stream.plots, ScanFindings()
        kinds = {**plots.files.columns.kinds, **plots.columns.kinds}
        limit = plots.files.reading.cleaning.fill_limit
        try:
            table = self._tables.table(items, first, kinds)
            rows = rows_of(table, plots.files.decoder, plots.columns, found, limit)
        except DataError as error:
            if len(items) == 1:
                self.faults.add("faulty", f"{error}; left out")
                return []
            half = len(items) // 2
            return [*self._rows(items[:half], first), *self._rows(items[half:], first + half)]
        plots.findings.impossible.update(found.impossible)
        plots.findings.fills += found.fills
        return [rows] if len(rows) else []

    def _answers(self, pieces: Sequence[ScanRows]) -> bytes:
        assert self.stream is not None
        return b"".join([self._text(self.stream.advance(rows)) for rows in pieces])

    def _text(self, answers: Iterator[Any]) -> bytes:
        """Lines of the reports of some scans."""
        assert self._table is not None
        table, found = self._table, []
        for scan, reports in answers:
            self.totals.add(ScannedScan("", scan, reports))
            if len(reports):
                values = table.values("", reports, typed=False)
                found.append(
                    json_text(values, table.names)
                    if self._json
                    else csv_text(values, table.names, self._quotes)
                )
        return "".join(found).encode()


def _row_of(error: DataError) -> int | None:
    """Row of the feed, after the first, that an error is about."""
    found = _ROW.search(str(error))
    row = int(found[1]) if found else 0
    return row if row > 1 else None


def _check(reading: Reading, how: dict[str, Any]) -> None:
    """Raise ValueError for options that need a whole recording."""
    if reading.sort:
        raise ValueError("sort: needs the whole recording; `lateness` puts late plots in order")
    if reading.format is not None:
        raise ValueError(
            f"format: {reading.format}: a feed is CSV, lines of JSON, or datagrams of ASTERIX; "
            "leave it out"
        )
    for name in ("group", "scans"):
        if how.get(name) is not None:
            raise ValueError(f"{name}: needs the whole recording; not for a feed")
