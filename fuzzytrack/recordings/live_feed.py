"""A feed of lines tracked as they come: from the bytes of plots to those of the answers."""

from __future__ import annotations

from codecs import BOM_UTF8
from collections.abc import Callable, Sequence
from functools import cached_property
from zlib import crc32

import numpy as np

from fuzzytrack.errors import DataError
from fuzzytrack.io.columns import Columns, choose_columns
from fuzzytrack.io.decoder import joined_cells
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.first_rows import frame_of
from fuzzytrack.io.line_tables import LineTables, line_tables
from fuzzytrack.io.line_texts import csv_text, json_text
from fuzzytrack.io.piece import Piece, joined
from fuzzytrack.io.plot_files import PlotFiles, Survey
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recognition import recognize
from fuzzytrack.io.table import no_rows
from fuzzytrack.io.times import Clock
from fuzzytrack.recordings.judging import GateWidth
from fuzzytrack.recordings.live import LiveTracks, check_rules
from fuzzytrack.recordings.live_faults import LiveFaults
from fuzzytrack.recordings.preparation import prepare_surveyed
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_lane_tracker
from fuzzytrack.trackers.origin import digest_of

__all__ = ["FEED", "LiveFeed"]

#: Name of a feed, for messages.
FEED = "the feed"

# Greatest time and standard deviation (s, m); 30,000 years, and six astronomical units.
_MOST = 1e12
# Lines that may come before the first one with a place on earth, about which all others are.
_HELD = 10_000
_NO_NOISE = "the noise of plots is not estimated from a feed; `sigma` gives it"


class LiveFeed:
    r"""Lines of plots, and the lines that answer them.

    Parameters
    ----------
    reading : Reading
        How the plots are read.
    tracker : Tracker or str, optional
        As for `fuzzytrack.track`; without it ``maneuver``, or ``stiffness-damping`` if the reading
        does not say how noisy the plots are, since a feed cannot be surveyed.
    gate : float, "auto" or None
        As for `fuzzytrack.track`.
    lateness, forget
        As for `LiveTracks`.
    json : bool or None
        Whether answers are lines of JSON; unless given, if the feed is.
    quote_formulas : bool
        As for `fuzzytrack.io.table_writer`.
    tell : callable, optional
        Called with a sentence about a fault; see `LiveFaults`.
    begin : callable, optional
        Called with the tracks before the first answer.

    Attributes
    ----------
    lines : int
        Lines that were taken so far.
    checksum : int
        CRC-32 of their bytes.
    beginning : (int, int)
        How many lines say how the others are read, and their CRC-32.
    head : list of str
        The first lines, which say how the others are read; blank ones in place of faulty ones.
    tracks : LiveTracks or None
        The tracks; None until the first row has come.
    read : Findings
        What was left out or taken as missed while lines were read.

    Raises
    ------
    ValueError
        If an option needs the whole recording.

    Examples
    --------
    >>> feed = LiveFeed(Reading(), "fixed:alpha=0.5:beta=0.2")
    >>> feed.push([b"time,x\n", b"0,10\n", b"1,12\n"]).decode().splitlines()[1][:16]
    '1,12.0,,12.0,2.0'
    >>> feed.push([b"2,what?\n"]), feed.sentences()
    (b'', ('1 faulty line, left out',))
    """

    def __init__(
        self,
        reading: Reading,
        tracker: Tracker | str | None = None,
        *,
        gate: GateWidth = "auto",
        lateness: float = 0.0,
        forget: float | None = None,
        json: bool | None = None,
        quote_formulas: bool = False,
        tell: Callable[[str], None] | None = None,
        begin: Callable[[LiveTracks], None] | None = None,
    ) -> None:
        _check_reading(reading)
        check_rules(reading.cleaning, lateness, forget)
        # A tracker that cannot go on must not be found out by the first plot.
        if tracker is not None:
            as_lane_tracker(tracker)
        self._named = tracker
        self.reading, self.gate, self.lateness, self.forget = reading, gate, lateness, forget
        self._json, self._quotes, self._begin = json, quote_formulas, begin
        self.faults = LiveFaults(tell)
        self.lines = self.checksum = 0
        self.head: list[str] = []
        self.beginning = (0, 0)
        self.tracks: LiveTracks | None = None
        self._tables: LineTables | None = None
        self._columns: Columns | None = None
        self.read = Findings()

    @property
    def begun(self) -> bool:
        """Whether there was a row."""
        return self.tracks is not None

    @property
    def pause_after(self) -> None:
        """Answers do not wait for other lines."""
        return None

    @property
    def is_json(self) -> bool:
        """Whether answers are lines of JSON; False as long as that is not known."""
        if self._json is not None:
            return self._json
        return self._tables is not None and self._tables.is_json

    @cached_property
    def digest(self) -> str:
        """Digest of the parameters of the tracker, once there is one."""
        assert self.tracks is not None
        return digest_of(self.tracks.prepared.tracker)

    @property
    def options(self) -> dict[str, str]:
        """What decides on answers, beside the tracker and the feed; for a state."""
        return {
            "reading": repr(self.reading),
            "gate": str(self.gate),
            "lateness": repr(float(self.lateness)),
            "forget": repr(self.forget),
            "json": repr(self._json),
            "quote_formulas": repr(self._quotes),
        }

    @property
    def header(self) -> bytes:
        """Line of the names of the answers; empty if they are JSON."""
        if self.tracks is None or self.is_json:
            return b""
        names = self.tracks.names
        return csv_text({name: [name] for name in names}, names, self._quotes).encode()

    def push(self, lines: Sequence[bytes]) -> bytes:
        """Take lines, and give the answers to them.

        Parameters
        ----------
        lines : sequence of bytes
            Whole lines, with their ends.

        Returns
        -------
        bytes
            Whole lines; `header`, where there is one, belongs before the first of them.

        Raises
        ------
        DataError
            If the first lines do not say how plots are read. What is wrong with later ones is
            counted.
        """
        first, before = self.lines + 1, self.checksum
        self.lines += len(lines)
        self.checksum = crc32(b"".join(lines), self.checksum)
        texts = self._texts(lines, first)
        if self.tracks is not None:
            return self._answers(texts, first)
        for k, text in enumerate(texts):
            if self._look(text):
                assert self._tables is not None
                begins = self._tables.begins
                self.beginning = len(self.head), crc32(b"".join(lines[: k + 1]), before)
                held = self._answers(self.head[begins:], begins + 1)
                return held + self._answers(texts[k + 1 :], first + k + 1)
        return b""

    def pause(self) -> bytes:
        """Nothing waits for other lines."""
        return b""

    def finish(self) -> bytes:
        """End the feed, which nothing waits for; DataError if no row could be answered."""
        if self.tracks is None:
            if self._columns is None and not self.faults.counts:
                # Raises what is wrong with the first lines, if anything is.
                recognize(FEED, self.head, self.reading.form)
            raise no_rows(FEED)
        return b""

    def findings(self) -> Findings:
        """What was left out or put right so far, notes included."""
        found = Findings()
        if self.tracks is not None:
            found.merge(self.tracks.prepared.findings)
            found.merge(self.tracks.findings())
        found.merge(self.read)
        return found

    def sentences(self) -> tuple[str, ...]:
        """What was wrong with the feed so far, and what was done about it, in words."""
        return (*self.faults.sentences(), *self.findings().sentences())

    # ---------------------------------------------------------------- the first lines

    def _look(self, text: str) -> bool:
        """Look at a line before there are tracks; whether it makes a beginning."""
        self.head.append(text)
        if self._tables is None:
            self._tables = line_tables(FEED, self.head, self.reading.form)
            if self._tables is None:
                return False
        if self._columns is None:
            said, names = self.reading.description, tuple(self._tables.types)
            self._columns = choose_columns(names, FEED, said, self._tables.units)
        if not self._is_beginning(text, len(self.head)):
            return False
        self.start(self.head)
        return True

    def _is_beginning(self, text: str, number: int) -> bool:
        """Whether a line has what is needed to read the others; what is faulty is left out."""
        assert self._tables is not None
        assert self._columns is not None
        columns, said = self._columns, self.reading.description
        try:
            table = self._tables.table([text], number, columns.kinds)
            if not len(table.rows):
                return False
            cells, unit = joined_cells(table, columns), self._tables.units.get(columns.time)
            clock = Clock.of(cells, unit=said.time_unit, name=columns.time, unit_of_name=unit)
            clock.seconds(cells, table.rows, FEED, columns.time)
            if abs(clock.origin) > _MOST * 1e9:
                raise DataError(f"{FEED}: row {number}: a time beyond {_MOST:g} s")
        except ValueError as error:
            self._leave_out(number, str(error))
            return False
        if columns.id and not len(table.with_words(columns.id).rows):
            self.read.unnamed += 1
            self.head[number - 1] = "\n"
            return False
        try:
            frame_of(columns, said, table)
        except DataError:
            if number > _HELD:
                raise
            return False
        return True

    def _leave_out(self, number: int, why: str) -> None:
        self.faults.add("faulty", f"{why}; left out")
        if self.tracks is None:
            # Lines keep their numbers.
            self.head[number - 1] = "\n"

    def start(self, head: Sequence[str]) -> None:
        """Begin with first lines, which are those of `head` before.

        Parameters
        ----------
        head : sequence of str

        Raises
        ------
        DataError, ValueError
            As `push`.
        """
        self.head = list(head)
        self._tables = line_tables(FEED, self.head, self.reading.form)
        assert self._tables is not None
        files = PlotFiles.of((self._tables,), self.reading).with_survey(Survey())
        known = files.decoder.noise_is_known or self._named is not None
        ready = prepare_surveyed(
            files, Survey(missing="" if known else _NO_NOISE), self._named, self.gate
        )
        ready.findings.note(files.notes)
        self.tracks = LiveTracks(
            ready, lateness=self.lateness, forget=self.forget, faults=self.faults
        )
        if self._begin is not None:
            self._begin(self.tracks)

    # ---------------------------------------------------------------- all lines

    def _texts(self, lines: Sequence[bytes], first: int) -> list[str]:
        """Lines as text; an empty one in place of what is none."""
        if first == 1 and lines:
            lines = [lines[0].removeprefix(BOM_UTF8), *lines[1:]]
        try:
            return [line.decode() for line in lines]
        except UnicodeDecodeError:
            return [self._text(*each) for each in enumerate(lines, first)]

    def _text(self, number: int, line: bytes) -> str:
        try:
            return line.decode()
        except UnicodeDecodeError as error:
            byte = line[error.start]
            self.faults.add(
                "faulty", f"{FEED}: row {number}: byte 0x{byte:02x} is not UTF-8; left out"
            )
            return "\n"

    def _answers(self, texts: Sequence[str], first: int) -> bytes:
        """Answers to some lines."""
        assert self.tracks is not None
        pieces = self._pieces(texts, first)
        if not pieces:
            return b""
        answers = self.tracks.push(joined(pieces))
        names = self.tracks.names
        if self.is_json:
            return json_text(answers.columns, names, self._numbers).encode()
        return csv_text(answers.columns, names, self._quotes).encode()

    @property
    def _numbers(self) -> frozenset[str]:
        """Columns that are numbers in JSON although they are passed on as text."""
        assert self._tables is not None
        assert self.tracks is not None
        files = self.tracks.prepared.files
        if self._tables.is_json:
            return self._tables.numbers
        is_number = files.decoder.clock.form == "number"
        return frozenset([files.columns.time] if is_number else [])

    def _pieces(self, texts: Sequence[str], first: int) -> list[Piece]:
        """Plots of some lines; faulty ones are found by halves, and left out."""
        if not texts:
            return []
        assert self._tables is not None
        assert self.tracks is not None
        files, found = self.tracks.prepared.files, Findings()
        try:
            piece = files.piece_of(self._tables.table(texts, first, files.columns.kinds), found)
        except DataError as error:
            if len(texts) == 1:
                self._leave_out(first, str(error))
                return []
            half = len(texts) // 2
            return [*self._pieces(texts[:half], first), *self._pieces(texts[half:], first + half)]
        self.read.unnamed += found.unnamed
        self.read.impossible.update(found.impossible)
        piece = self._within_reason(piece)
        return [piece] if len(piece) else []

    def _within_reason(self, piece: Piece) -> Piece:
        """Plots without those whose numbers would end the run, since they cannot be squared."""
        times = np.abs(piece.time)
        bad = (times > _MOST) | ((times < 1 / _MOST) & (times > 0.0))
        if piece.sigma is not None:
            deviations = np.nan_to_num(piece.sigma, nan=1.0)
            bad |= ((deviations > _MOST) | (deviations < 1 / _MOST)).any(axis=1)
        if not bad.any():
            return piece
        for row in piece.rows[bad].tolist():
            what = f"a time or a standard deviation beyond {_MOST:g}, or below {1 / _MOST:g}"
            self._leave_out(row, f"{FEED}: row {row}: {what}")
        return piece.take(~bad)


def _check_reading(reading: Reading) -> None:
    """Raise ValueError for options that need a whole recording, or are not those of a feed."""
    if reading.sort:
        raise ValueError("sort: needs the whole recording; `lateness` puts late plots in place")
    if reading.format is not None:
        raise ValueError(f"format: {reading.format}: a feed is CSV or lines of JSON; leave it out")
    if reading.description.sigma == "auto":
        raise ValueError("sigma: auto needs the whole recording; give the standard deviation")
