"""Where lines are written as they come: standard output, or a file to which they are added."""

from __future__ import annotations

import os

from fuzzytrack.errors import DataError
from fuzzytrack.io.files import check_output

__all__ = ["LineTarget"]

_STANDARD_OUTPUT = 1


class LineTarget:
    """An open file that grows, or standard output.

    Parameters
    ----------
    path : str or None
        The file; standard output unless given.

    Attributes
    ----------
    written : int
        Bytes that it has.
    """

    def __init__(self, path: str | None) -> None:
        self.path, self.written = path, 0
        self._needs_header = True
        self._is_new = False
        self._descriptor = _STANDARD_OUTPUT
        if path is not None:
            check_output(path)
            self._is_new = not os.path.exists(path)
            self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
            self.written = os.lseek(self._descriptor, 0, os.SEEK_END)

    def resume(self, written: int) -> None:
        """Cut a file back to a length that it had.

        Parameters
        ----------
        written : int
            Its bytes then; standard output stays as it is.

        Raises
        ------
        DataError
            If it is shorter than that.
        """
        if self.path is None:
            return
        if self.written < written:
            raise DataError(
                f"{self.path}: has {self.written} bytes, and the state knows of {written}; name "
                "the same file, or remove the state to begin anew"
            )
        os.ftruncate(self._descriptor, written)
        self.written = os.lseek(self._descriptor, 0, os.SEEK_END)

    def write(self, header: bytes, lines: bytes) -> None:
        """Write lines at once; the header goes before them where nothing has been written yet.

        Parameters
        ----------
        header : bytes
            The first line of the file; empty if it has none.
        lines : bytes
            Whole lines; none at the end of a feed without answers.

        Raises
        ------
        DataError
            If the file begins with another line.
        OSError
            If they cannot be written; BrokenPipeError if the reader of the pipe has gone.
        """
        if self._needs_header:
            self._needs_header = False
            if self.path is not None and self.written:
                self._check_header(header)
            else:
                lines = header + lines
        rest = memoryview(lines)
        try:
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]
        except OSError as error:
            raise OSError(error.errno, error.strerror, self.path or "standard output") from None
        self.written += len(lines)

    def close(self) -> None:
        """Close the file; one that it has made is removed if `write` was never called."""
        if self.path is not None:
            os.close(self._descriptor)
            if self._is_new and self._needs_header:
                os.unlink(self.path)

    def _check_header(self, header: bytes) -> None:
        os.lseek(self._descriptor, 0, os.SEEK_SET)
        start = os.read(self._descriptor, len(header))
        os.lseek(self._descriptor, 0, os.SEEK_END)
        if start != header:
            raise DataError(
                f"{self.path}: holds something else than these answers; name another file"
            )
