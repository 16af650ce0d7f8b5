"""Bytes of a file from its beginning: plain, compressed, or of standard input."""

from __future__ import annotations

import io
import os
import stat
import sys
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import IO, Any

from fuzzytrack.errors import DataError

__all__ = ["STANDARD_INPUT", "ByteStream", "open_bytes"]

#: Name under which standard input is read.
STANDARD_INPUT = "-"

_GZIP, _ZSTD = b"\x1f\x8b", b"\x28\xb5\x2f\xfd"


class ByteStream(io.RawIOBase):
    """Bytes of a file that is read once, in order; bytes can be put back.

    Parameters
    ----------
    file : str
        Name of the file, for messages.
    raw : file
        The file itself, which says how much of it has been read.
    """

    def __init__(self, file: str, raw: IO[bytes]) -> None:
        super().__init__()
        self.file = file
        self._raw, self._stream = raw, raw
        self._back = b""
        self._place = 0
        #: Bytes of the file, before they are decompressed; 0 if that is not known, as of a pipe.
        self.size = _size(raw)
        self.compressed = False

    def readable(self) -> bool:
        """Whether it can be read: always."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Read some bytes; their number, 0 at the end."""
        if self._back:
            part = self._back[self._place : self._place + len(buffer)]
            self._place += len(part)
            if self._place >= len(self._back):
                self._back, self._place = b"", 0
        else:
            part = self._next(len(buffer))
        buffer[: len(part)] = part
        return len(part)

    def take(self, count: int) -> bytes:
        """Read so many bytes; fewer only at the end."""
        parts = []
        while count > 0 and (part := self.read(count)):
            parts.append(part)
            count -= len(part)
        return parts[0] if len(parts) == 1 else b"".join(parts)

    def put_back(self, part: bytes) -> None:
        """Make bytes the next ones that are read."""
        self._back, self._place = part + self._back[self._place :], 0

    def share(self) -> float | None:
        """Share of the file that has been read; None if its size is not known."""
        return min(self._raw.tell() / self.size, 1.0) if self.size else None

    def decompress(self) -> None:
        """Read what is compressed, as its first bytes say, as what it was before."""
        start = self.take(4)
        self.put_back(start)
        if start[:2] == _GZIP:
            import gzip

            unpacked: Any = gzip.GzipFile(fileobj=_Whole(self._back, self._raw))
        elif start == _ZSTD:
            unpacked = _zstd(self.file, _Whole(self._back, self._raw))
        else:
            return
        self._back, self._stream, self.compressed = b"", unpacked, True

    def _next(self, count: int) -> bytes:
        if not self.compressed:
            return self._stream.read(count)
        try:
            return self._stream.read(count)
        except MemoryError:
            raise
        # Modules for zstd have errors of their own, and one of them raises OSError.
        except Exception as error:
            why = str(error).rstrip(".")
            raise DataError(f"{self.file}: cannot be decompressed: {why}") from None


class _Whole(io.RawIOBase):
    """A file with its first bytes, which have been read, before it."""

    def __init__(self, start: bytes, rest: IO[bytes]) -> None:
        super().__init__()
        self._start, self._rest = start, rest

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        part = self._start[: len(buffer)] or self._rest.read(len(buffer))
        self._start = self._start[len(buffer) :]
        buffer[: len(part)] = part
        return len(part)


class _Frames:
    """Frames of Zstandard, one after the other; the last one must be complete.

    A stream of the package ends where its bytes end, also in the middle of a number.
    """

    def __init__(self, raw: IO[bytes] | io.RawIOBase, decompressor: Any) -> None:
        self._raw, self._decompressor = raw, decompressor
        self._frame: Any = None
        self._packed, self._unpacked, self._place = b"", b"", 0

    def read(self, count: int) -> bytes:
        """Read at most so many bytes; none at the end."""
        while self._place >= len(self._unpacked):
            packed = self._packed or self._raw.read(_PACKED)
            if not packed:
                if self._frame is not None:
                    raise EOFError("the file ends before its last frame does")
                return b""
            if self._frame is None:
                self._frame = self._decompressor.decompressobj()
            self._unpacked, self._place = self._frame.decompress(packed), 0
            self._packed = b""
            if self._frame.eof:
                self._packed, self._frame = self._frame.unused_data, None
        part: bytes = self._unpacked[self._place : self._place + count]
        self._place += len(part)
        return part


# Bytes that are decompressed at a time; they may become 30 000 times as many.
_PACKED = 1024


@contextmanager
def open_bytes(file: str) -> Iterator[ByteStream]:
    """Open a file; what gzip or Zstandard has compressed is decompressed.

    Parameters
    ----------
    file : str
        ``-`` is standard input. It can be opened again, as can any pipe: what was read is kept,
        from 16 MB on in a temporary file.

    Raises
    ------
    DataError
        If it is compressed and cannot be decompressed, also later, while it is read.
    OSError
        If it cannot be read.
    """
    if file == STANDARD_INPUT:
        raw = getattr(sys.stdin, "buffer", None)
        if raw is None:
            raise DataError(f"{file}: there is no standard input of bytes; name a file")
        yield _stream("standard input", _Replay(_kept((id(raw),), lambda: raw)))
    elif stat.S_ISFIFO(os.stat(file).st_mode):
        found = os.stat(file)
        key = (file, found.st_dev, found.st_ino)
        yield _stream(file, _Replay(_kept(key, lambda: _opened_pipe(file))))
    else:
        with open(file, "rb") as raw:
            yield _stream(file, raw)


def _stream(file: str, raw: Any) -> ByteStream:
    stream = ByteStream(file, raw)
    stream.decompress()
    return stream


class _Kept:
    """What has been read of a pipe, and the rest of it."""

    def __init__(self, raw: Any) -> None:
        # Few need it, and it imports much.
        from tempfile import SpooledTemporaryFile

        self._raw = raw
        self._spool = SpooledTemporaryFile(_IN_MEMORY)  # noqa: SIM115
        weakref.finalize(self, self._spool.close)
        self._length = 0

    def read(self, place: int, count: int) -> bytes:
        """Some bytes at a place that is at most where reading has come."""
        if place < self._length:
            self._spool.seek(place)
            return self._spool.read(min(count, self._length - place))
        part: bytes = self._raw.read(count)
        self._spool.seek(self._length)
        self._spool.write(part)
        self._length += len(part)
        return part


class _Replay(io.RawIOBase):
    """A pipe from its beginning."""

    def __init__(self, kept: _Kept) -> None:
        super().__init__()
        self._kept, self._place = kept, 0

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        part = self._kept.read(self._place, len(buffer))
        self._place += len(part)
        buffer[: len(part)] = part
        return len(part)


# Bytes of a pipe that are kept in memory, and the pipes that are kept.
_IN_MEMORY = 1 << 24
_KEPT: dict[tuple[object, ...], _Kept] = {}


def _opened_pipe(file: str) -> Any:
    """A pipe that is closed without a warning when nothing refers to it."""
    number = os.open(file, os.O_RDONLY)
    pipe = os.fdopen(number, "rb", closefd=False)
    weakref.finalize(pipe, os.close, number)
    return pipe


def _kept(key: tuple[object, ...], opened: Callable[[], Any]) -> _Kept:
    if key not in _KEPT:
        _KEPT.clear()
        _KEPT[key] = _Kept(opened())
    return _KEPT[key]


def _size(raw: IO[bytes]) -> int:
    try:
        return os.fstat(raw.fileno()).st_size if raw.seekable() else 0
    except (OSError, AttributeError):
        return 0


def _zstd(file: str, raw: Any) -> Any:
    try:
        import zstandard
    except ImportError:
        pass
    else:
        return _Frames(raw, zstandard.ZstdDecompressor())
    try:
        import pyarrow
    except ImportError:
        raise DataError(
            f"{file}: Zstandard needs a package that is not installed; "
            "pip install 'fuzzytrack[zst]', or decompress the file"
        ) from None
    return pyarrow.CompressedInputStream(pyarrow.PythonFile(raw, mode="r"), "zstd")
