"""Datagrams of a radar as they come: a UDP port, and blocks of ASTERIX in them as tables."""

from __future__ import annotations

import io
import re
import select
import socket
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

from fuzzytrack.errors import DataError
from fuzzytrack.io.asterix import Asterix
from fuzzytrack.io.byte_stream import ByteStream
from fuzzytrack.io.record_source import Losses, RecordSource
from fuzzytrack.io.table import Kind, Table, silent
from fuzzytrack.tasks import Progress

__all__ = ["AsterixDatagrams", "DatagramStream", "is_address"]

_ADDRESS = re.compile(r"udp://(127(?:\.\d{1,3}){3}|localhost):(\d{1,5})", re.ASCII)
# Datagrams that are given at a time, and bytes of one at most.
_MANY, _LONGEST = 500, 1 << 16
# Bytes of the category and the length of a block.
_HEAD = 3
# What the system is asked to keep while plots are tracked; it may keep less.
_BUFFER = 1 << 22


def is_address(text: str) -> bool:
    """Whether a text names a port rather than a file."""
    return text.startswith("udp://")


class DatagramStream:
    """Datagrams of a port of this computer. An empty one is the end.

    Parameters
    ----------
    address : str
        ``udp://127.0.0.1:PORT``; any free port for 0.

    Raises
    ------
    ValueError
        If it is no such address. Only loopback addresses are listened to.
    OSError
        If the port is taken.
    """

    def __init__(self, address: str) -> None:
        found = _ADDRESS.fullmatch(address)
        if found is None or not 0 <= int(found[2]) < 1 << 16:
            raise ValueError(f"{address}: expected udp://127.0.0.1:PORT, a port of this computer")
        self._host = found[1]
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
            self._socket.bind((found[1], int(found[2])))
            self._socket.setblocking(False)
        except OSError as error:
            self._socket.close()
            raise OSError(error.errno, error.strerror, address) from None
        self.ended = False

    @property
    def port(self) -> int:
        """Number of the port."""
        return int(self._socket.getsockname()[1])

    @property
    def address(self) -> str:
        """What it listens to, as it is given, with the number of the port."""
        return f"udp://{self._host}:{self.port}"

    def take(self, timeout: float | None = None) -> list[bytes] | None:
        """Take the datagrams that are there, and wait for some if there are none.

        Parameters
        ----------
        timeout : float, optional
            How long to wait (s); unless given, until some come.

        Returns
        -------
        list of bytes or None
            Up to five hundred; empty if none has come in time, None at the end.
        """
        if self.ended:
            return None
        if not select.select([self._socket], [], [], timeout)[0]:
            return []
        found: list[bytes] = []
        with suppress(BlockingIOError):
            while len(found) < _MANY:
                part = self._socket.recv(_LONGEST)
                if not part:
                    self.ended = True
                    break
                found.append(part)
        return found or (None if self.ended else [])

    def close(self) -> None:
        """Give the port back."""
        self._socket.close()


class AsterixDatagrams:
    """Blocks of ASTERIX as tables; see `fuzzytrack.io.source.Source`.

    All plots are of the category, source and kind of position of the first one.

    Parameters
    ----------
    file : str
        Name of the feed, for messages.
    datagrams : sequence of bytes
        The first ones, at least one of them with a plot.
    category, source
        As for `fuzzytrack.io.asterix.Asterix`.

    Raises
    ------
    DataError
        If none of them holds a plot, or libasterix is not installed.
    """

    def __init__(
        self,
        file: str,
        datagrams: Sequence[bytes],
        category: int | None = None,
        source: str | None = None,
    ) -> None:
        self.file, self._first = file, list(datagrams)
        self._losses, self._taken = Losses(), 0
        self._reader = Asterix(category, source, "none")
        first = self._opened(self._first, Losses())
        self.types, self.description, self.origin = first.types, first.description, first.origin
        number, origin = re.findall(r"category (\d+) from source (.+)", first.origin)[0]
        self._reader = Asterix(int(number), origin, "none")

    @property
    def notes(self) -> list[str]:
        """What was left out so far."""
        return [f"{self.file}: {note}" for note in self._losses.notes]

    def tables(
        self, kinds: Mapping[str, Kind], rows: int | None, progress: Progress = silent
    ) -> Iterator[Table]:
        """The table of the first datagrams, in which nothing is counted: `table` gets them, too."""
        (table,) = self._opened(self._first, Losses()).tables(kinds, None)
        yield table

    def table(self, datagrams: Sequence[bytes], first: int, kinds: Mapping[str, Kind]) -> Table:
        """Table of some datagrams.

        Parameters
        ----------
        datagrams : sequence of bytes
        first : int
            Number of the first of their plots.
        kinds : mapping of str to Kind
            The columns that are wanted, and what each must hold.

        Raises
        ------
        DataError
            If none of them holds a plot.
        """
        losses = Losses()
        try:
            source = self._opened(datagrams, losses)
        except DataError:
            # Several are tried again in parts, and counted then.
            if len(datagrams) == 1:
                self._count(1, losses)
            raise
        unknown = {name for name in kinds if name not in source.types}
        if unknown:
            raise DataError(f"{self.file}: a datagram of plots without {', '.join(unknown)}")
        (table,) = source.tables(kinds, None)
        self._count(len(datagrams), losses)
        table.rows[:] += first - 1
        return table

    def _count(self, datagrams: int, losses: Losses) -> None:
        self._taken += datagrams
        self._losses.extend(losses)

    def _opened(self, datagrams: Sequence[bytes], losses: Losses) -> RecordSource:
        """Source of the datagrams, up to where a block does not end in one."""
        kept: list[bytes] = []
        for number, datagram in enumerate(datagrams, self._taken + 1):
            end = _end_of_blocks(datagram)
            kept.append(datagram[:end])
            if end < len(datagram):
                place = f"datagram {number}, byte {end}"
                losses.add("ends of datagrams that are no whole block", place)
        stream = ByteStream(self.file, io.BytesIO(b"".join(kept)))
        return self._reader.source_of(stream, losses)


def _end_of_blocks(datagram: bytes) -> int:
    """Bytes of the whole blocks at the beginning: each begins with its category and its length."""
    end = 0
    while end + _HEAD <= len(datagram):
        length = int.from_bytes(datagram[end + 1 : end + _HEAD], "big")
        if not _HEAD <= length <= len(datagram) - end:
            break
        end += length
    return end
