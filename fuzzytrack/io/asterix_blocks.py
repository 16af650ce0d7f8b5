"""Records in the bytes of an ASTERIX file: blocks found, decoded by libasterix, losses counted.

A block is its category (one byte), its length (two bytes) and its records. A block is taken for
one if its length leads to the next one or to the end of the file, or if all of its records can be
decoded; what lies between blocks is broken. Of a block that cannot be decoded to its end, the
records before the place are kept.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from fuzzytrack.errors import DataError
from fuzzytrack.io.byte_stream import ByteStream
from fuzzytrack.io.record_source import Losses

__all__ = ["CATEGORIES", "Record", "import_asterix", "records"]

#: Categories that are decoded.
CATEGORIES = (1, 21, 48, 62)

_BYTES = 1 << 20
# Bytes in which a block and the head of the next one certainly lie.
_AHEAD = 1 << 17
# The head of a block, and a record of one byte.
_SHORTEST = 4
# In use, and not among the categories that libasterix knows.
_OTHERS = (3, 30, 31, 33, 252, 253)
# libasterix copies all bytes that follow at each step; no record is longer.
_RECORD = 4_096
# Bytes that may be decoded in vain, and one more for each that has been read: so time grows with
# the file, whatever it holds.
_IN_VAIN = 8_192
# Category 021 before edition 1.0 has other items in other places: what each record must have now,
# and what each had to have then.
_CHANGED = 21
_MUST, _MUST_OLD = ("010", "040", "080"), ("010", "030", "040")
_OLD_BLOCKS = "blocks of category 021 in an edition before 1.0, which are not read"
_CAPTURES = (b"\xd4\xc3\xb2\xa1", b"\xa1\xb2\xc3\xd4", b"\x4d\x3c\xb2\xa1", b"\n\r\r\n")


@dataclass(frozen=True, eq=False)
class Record:
    """A record of one of the `CATEGORIES`.

    Attributes
    ----------
    category : int
    number : int
        Where it stands among the records of the file, counted from 1.
    place : str
        Byte where its block begins, for messages.
    items : Record of libasterix
        Its data items.
    """

    category: int
    number: int
    place: str
    items: Any


def import_asterix(file: str) -> tuple[Any, Any]:
    """Import libasterix, or say how it is installed."""
    try:
        from asterix import base, generated
    except ImportError:
        raise DataError(
            f"{file}: ASTERIX needs libasterix, which is not installed; "
            "pip install 'fuzzytrack[asterix]'; if asterix_decoder is installed, whose module has "
            "the same name, remove it first"
        ) from None
    return base, generated


def records(stream: ByteStream, losses: Losses) -> Iterator[Record]:
    """Decode the records of a file.

    Parameters
    ----------
    stream : ByteStream
        The open file.
    losses : Losses
        Gets what cannot be decoded, and blocks of other categories.

    Yields
    ------
    Record

    Raises
    ------
    DataError
        If libasterix is not installed, or the file is a capture of packets.
    """
    decoder = _Decoder(*import_asterix(stream.file))
    bytes_of = _Bytes(stream, decoder.known)
    if bytes_of.data[:4] in _CAPTURES:
        raise DataError(
            f"{stream.file}: is a capture of network packets (pcap); write the payload of its "
            "packets to a file"
        )
    number = vain = 0
    while bytes_of.fill():
        start, end = bytes_of.position, bytes_of.block_end(bytes_of.position)
        offset = bytes_of.offset
        place = f"byte {offset}"
        certain = end is not None and bytes_of.is_start(end)
        if end is None or not (certain or end - start <= _IN_VAIN + offset - vain):
            losses.add("bytes that are no block", place, bytes_of.skip())
            continue
        category, body = bytes_of.data[start], bytes_of.data[start + 3 : end]
        found, used = decoder.decode(category, body)
        if not certain and (found is None or used < len(body)):
            vain += used + _SHORTEST
            losses.add("bytes that are no block", place, bytes_of.skip())
            continue
        bytes_of.position = end
        if category == _CHANGED and decoder.is_old(body, found, used):
            losses.add(_OLD_BLOCKS, place)
            continue
        if found is None:
            losses.add(f"blocks of category {category:03d}", place)
            continue
        for items in found:
            number += 1
            yield Record(category, number, place, items)
        if used < len(body):
            losses.add("bytes that are no record", f"byte {offset + 3 + used}", len(body) - used)


class _Bytes:
    """The bytes of a file, some at a time, and where blocks begin in them.

    Attributes
    ----------
    data : bytes
        Those that are held.
    position : int
        The next one of these to be read.
    """

    def __init__(self, stream: ByteStream, known: frozenset[int]) -> None:
        self._stream, self._known = stream, known
        self._before = 0
        self._ended = False
        self.data, self.position = b"", 0
        self.fill()

    @property
    def offset(self) -> int:
        """Where `position` is in the file, counted from 0."""
        return self._before + self.position

    def fill(self) -> bool:
        """Read until a block and the next head are held; False at the end of the file."""
        if not self._ended and len(self.data) - self.position < _AHEAD:
            parts = [self.data[self.position :]]
            length = len(parts[0])
            while length < _AHEAD and not self._ended:
                part = self._stream.read(_BYTES)
                self._ended = not part
                parts.append(part)
                length += len(part)
            self._before += self.position
            self.data, self.position = b"".join(parts), 0
        return self.position < len(self.data)

    def block_end(self, start: int) -> int | None:
        """End of the block that begins at a place; None if none begins there."""
        data = self.data
        if start + _SHORTEST > len(data) or data[start] not in self._known:
            return None
        length = data[start + 1] << 8 | data[start + 2]
        return start + length if _SHORTEST <= length <= len(data) - start else None

    def is_start(self, place: int) -> bool:
        """Whether a block begins at a place, or the file ends there."""
        return place == len(self.data) or self.block_end(place) is not None

    def skip(self) -> int:
        """Go on to the next place that looks like a block; the number of bytes left out."""
        before = self.offset
        self.position += 1  # the byte there is known to begin none
        while self.fill():
            stop = len(self.data) if self._ended else len(self.data) - _AHEAD + 1
            for place in range(self.position, stop):
                end = self.block_end(place)
                if end is not None and (self.data[place] in CATEGORIES or self.is_start(end)):
                    self.position = place
                    return self.offset - before
            self.position = stop
        return self.offset - before


class _Decoder:
    """Records of blocks, decoded by the newest edition of each category that libasterix has."""

    def __init__(self, base: Any, generated: Any) -> None:
        self._base = base
        editions = generated.manifest["CATS"]
        self.known = frozenset((*editions, *_OTHERS))
        newest = {category: editions[category][-1] for category in CATEGORIES}
        self._old = [each.cv_record for each in editions[_CHANGED] if each.cv_edition < (1, 0)]
        self._records = {
            category: newest[category].cv_record for category in CATEGORIES if category != 1
        }
        self._plot, self._track = (newest[1].cv_uap.spec(kind) for kind in ("plot", "track"))

    def decode(self, category: int, body: bytes) -> tuple[list[Any] | None, int]:
        """Records of a block, and the number of bytes that they fill; None if not decoded."""
        if category not in CATEGORIES:
            return None, 0
        return self._decoded(self._records.get(category), body)

    def is_old(self, body: bytes, found: list[Any] | None, used: int) -> bool:
        """Whether only an edition that is not read explains a block of category 021 to its end.

        The others are `found` and `used` as `decode` gave them.
        """
        if used == len(body) and _all_have(_MUST, found):
            return False
        for kind in self._old:
            older, length = self._decoded(kind, body)
            if length == len(body) and _all_have(_MUST_OLD, older):
                return True
        return False

    def _decoded(self, kind: Any, body: bytes) -> tuple[list[Any], int]:
        """Records of one kind that follow each other, and the number of bytes that they fill."""
        found = []
        position = 0
        while position < len(body):
            record, length = self._record(kind, body[position : position + _RECORD])
            if record is None:
                break
            found.append(record)
            position += length
        return found, position

    def _record(self, kind: Any, part: bytes) -> tuple[Any, int]:
        """Record that begins with these bytes, and its length; None if there is none."""
        kind = kind or self._plot_or_track(part)
        # A third-party parser of bytes from anywhere: whatever it raises, these are no record.
        try:
            result = kind.parse(
                self._base.ParsingMode.StrictParsing, self._base.Bits.from_bytes(part)
            )
        except Exception:
            return None, 0
        if isinstance(result, ValueError) or result[0].is_empty():
            return None, 0
        record, rest = result
        return record, len(part) - len(rest) // 8

    def _plot_or_track(self, part: bytes) -> Any:
        """Plot or track of category 001, which have different items: the first bit of I001/020."""
        fields = next((place for place, byte in enumerate(part, 1) if not byte & 1), len(part))
        has_source, has_kind = part[0] & 0x80, part[0] & 0x40
        place = fields + (2 if has_source else 0)
        if has_kind and place < len(part) and part[place] & 0x80:
            return self._track
        return self._plot


def _all_have(items: tuple[str, ...], found: list[Any] | None) -> bool:
    return all(record.get_item(item) is not None for record in found or () for item in items)
