"""AIS: positions of ships from NMEA sentences, with the extra ``ais`` (pyais)."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import reduce
from operator import xor
from typing import IO, Any

from fuzzytrack.errors import DataError
from fuzzytrack.io.byte_stream import ByteStream, open_bytes
from fuzzytrack.io.description import PlotDescription
from fuzzytrack.io.readers import Reader
from fuzzytrack.io.record_source import Losses, RecordSource, Row

__all__ = ["Ais"]

_TYPES = {
    "time": "text",
    "id": "text",
    "lat": "number",
    "lon": "number",
    "sog": "number",
    "cog": "number",
    "heading": "number",
    "accuracy": "number",
    "type": "number",
}
# Messages with the position of a ship.
_POSITIONS = (1, 2, 3, 18, 19, 27)
# From where on values are none, in the units of pyais; speed has fewer bits in message 27.
_ENDS = {"speed": 102.3, "course": 360.0, "heading": 360.0}
_ENDS_27 = {**_ENDS, "speed": 63.0}

# A line is longer only if it is broken.
_LINE = 4_096
# Messages of several sentences that wait for their other parts.
_WAITING = 64

_SENTENCE = re.compile(rb"[!$]..VD[MO],[^*\\]*\*[0-9A-Fa-f]{2}")
_TAG_BLOCK = re.compile(rb"\\([^\\*]*)\*([0-9A-Fa-f]{1,2})\\\s*$")
# A time of reception: seconds since 1970 or smaller units, or ISO 8601.
_TIME = re.compile(
    rb"\d{9,19}(?:\.\d+)?"
    rb"|\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:[.,]\d+)?)?(?:Z|[+-]\d\d:?\d\d)?"
)


class Ais(Reader):
    """Reads messages 1, 2, 3, 18, 19 and 27 of AIS: positions of ships (lat, lon)."""

    suffixes = (".nmea", ".ais", ".nm4")

    def check(self, file: str) -> None:
        """Check that pyais is installed; DataError if not."""
        _import_pyais(file)

    @contextmanager
    def open_source(self, file: str) -> Iterator[RecordSource]:
        """Open a file.

        Raises
        ------
        DataError
            If it has no positions with a time of reception, also later, while it is read.
        OSError
            If it cannot be read.
        """
        messages = _import_pyais(file)
        with open_bytes(file) as stream:
            losses = Losses()
            description = PlotDescription(time="time", id="id", geodetic=("lat", "lon"), wrap=None)
            rows = _rows(stream, messages, losses)
            yield RecordSource(stream, _TYPES, description, rows, losses)


def _import_pyais(file: str) -> Any:
    try:
        from pyais import messages
    except ImportError:
        raise DataError(
            f"{file}: AIS needs pyais, which is not installed; pip install 'fuzzytrack[ais]'"
        ) from None
    return messages


def _rows(stream: ByteStream, messages: Any, losses: Losses) -> Iterator[Row]:
    waiting = _Waiting(losses)
    timed = False
    for number, line in enumerate(_lines(io.BufferedReader(stream)), 1):
        found = _sentence(line, number, messages, losses)
        if found is None:
            continue
        time, sentence = found
        whole = waiting.add(_Part(number, time, sentence))
        if whole is None:
            continue
        place, time = f"line {whole[0].number}", next((p.time for p in whole if p.time), "")
        cells = _position([part.sentence for part in whole], place, messages, losses)
        if cells is None:
            continue
        if not time:
            if not timed:
                raise _no_time(stream.file, number, losses)
            losses.add("positions without a time of reception", place)
            continue
        timed = True
        yield whole[0].number, (time, *cells)
    waiting.give_up()


def _lines(stream: IO[bytes]) -> Iterator[bytes]:
    """Lines; of those that are too long the beginning."""
    while line := stream.readline(_LINE):
        part = line
        while len(part) == _LINE and not part.endswith(b"\n"):
            part = stream.readline(_LINE)
        yield line


def _no_time(file: str, number: int, losses: Losses) -> DataError:
    return DataError(
        f"{file}: row {number}: no time of reception, and the second that a message holds "
        "does not say which minute; record sentences with a tag block (\\c:1700000000*5F\\!AIVDM) "
        f"or with the time before each sentence{''.join(f'; {note}' for note in losses.notes)}"
    )


# -------------------------------------------------------------------- sentences


def _sentence(line: bytes, number: int, messages: Any, losses: Losses) -> tuple[str, Any] | None:
    """Time of reception, empty if there is none, and the sentence of a line; None if broken."""
    place = f"line {number}"
    if not line.strip() or line.lstrip().startswith(b"#"):
        return None
    match = _SENTENCE.search(line)
    if match is None:
        losses.add("lines without a sentence of AIS", place)
        return None
    # A third-party parser of bytes from anywhere: whatever it raises, the line is broken.
    try:
        sentence = messages.NMEASentenceFactory.produce(match.group())
        valid = sentence.is_valid
    except Exception:
        valid = False
    if not valid:
        losses.add("sentences that are broken or have a wrong checksum", place)
        return None
    before, after = line[: match.start()].rstrip(), line[match.end() :]
    block = _TAG_BLOCK.search(before)
    if block is None and before.endswith(b"\\"):
        losses.add("tag blocks that are broken", place, so="not used")
        return "", sentence
    if block is not None:
        text, checksum = block.groups()
        if reduce(xor, text, 0) != int(checksum, 16):
            losses.add("tag blocks with a wrong checksum", place, so="not used")
            return "", sentence
        fields = dict(cell.split(b":", 1) for cell in text.split(b",") if b":" in cell)
        return _time(fields.get(b"c", b"")), sentence
    return _time(before.strip(b" \t,;|")) or _time(after.strip().rpartition(b",")[2]), sentence


def _time(text: bytes) -> str:
    """Time as it is written; empty if it is none."""
    return text.decode("ascii") if _TIME.fullmatch(text) else ""


@dataclass(frozen=True)
class _Part:
    """A sentence, and where it stands."""

    number: int
    time: str
    sentence: Any


@dataclass
class _Waiting:
    """Messages of several sentences of which not all have come."""

    losses: Losses
    parts: dict[tuple[Any, ...], dict[int, _Part]] = field(default_factory=dict)

    def add(self, part: _Part) -> list[_Part] | None:
        """All parts of a message in order, if this is the last of them; otherwise None."""
        sentence = part.sentence
        if sentence.frag_cnt == 1:
            return [part]
        key = (sentence.seq_id, sentence.channel, sentence.frag_cnt, sentence.talker_id)
        known = self.parts.setdefault(key, {})
        if sentence.frag_num in known:
            # Of a message before it, whose other parts never came.
            self._lose(known)
            known.clear()
        known[sentence.frag_num] = part
        if len(known) == sentence.frag_cnt:
            del self.parts[key]
            return [known[number] for number in sorted(known)]
        if len(self.parts) > _WAITING:
            self._lose(self.parts.pop(next(iter(self.parts))))
        return None

    def give_up(self) -> None:
        """Count what is left."""
        for known in self.parts.values():
            self._lose(known)
        self.parts.clear()

    def _lose(self, known: dict[int, _Part]) -> None:
        first = next(iter(known.values()))
        self.losses.add("messages that are incomplete", f"line {first.number}")


# -------------------------------------------------------------------- messages


def _position(
    sentences: list[Any], place: str, messages: Any, losses: Losses
) -> tuple[Any, ...] | None:
    """Cells of a message after the time; None if it holds no position of a ship."""
    try:
        if len(sentences) > 1:
            whole = messages.AISSentence.assemble_from_iterable(sentences)
        else:
            (whole,) = sentences
        if whole.ais_id not in _POSITIONS:
            losses.add("messages of other types", place)
            return None
        message = whole.decode()
        mmsi, lat, lon = int(message.mmsi), float(message.lat), float(message.lon)
    except Exception:  # as in _sentence
        losses.add("messages that cannot be decoded", place)
        return None
    if not (abs(lat) <= 90.0 and abs(lon) <= 180.0):
        # 91 and 181 are not available, more is no place: a missed plot.
        lat = lon = math.nan
    ends = _ENDS_27 if whole.ais_id == 27 else _ENDS
    known = [_known(message, name, end) for name, end in ends.items()]
    return (f"{mmsi:09d}", lat, lon, *known, _known(message, "accuracy", 2.0), float(whole.ais_id))


def _known(message: Any, name: str, end: float) -> float:
    """Value of a message; NaN where there is none."""
    value = getattr(message, name, None)
    return float(value) if value is not None and 0.0 <= float(value) < end else math.nan
