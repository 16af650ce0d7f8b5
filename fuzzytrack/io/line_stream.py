"""Lines of a pipe as they come: what is there, at once, and never half a line."""

from __future__ import annotations

import os
import select
from collections import deque

__all__ = ["LineStream"]

# Bytes that are read at a time, lines that are given at a time, and bytes of a line at most. More
# lines at once would have them wait for one another; what is longer is no plot.
_READ, _LINES, _LONGEST = 1 << 16, 500, 1 << 20


class LineStream:
    """Lines of an open file, pipe or socket.

    Parameters
    ----------
    descriptor : int
        Number of the open file.

    Attributes
    ----------
    ended : bool
        Whether its end has been reached.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._lines: deque[bytes] = deque()
        self._rest = b""
        self.ended = False

    def take(self, timeout: float | None = None) -> list[bytes] | None:
        """Take the lines that are there, and wait for some if there are none.

        Parameters
        ----------
        timeout : float, optional
            How long to wait (s); unless given, until some come.

        Returns
        -------
        list of bytes or None
            Whole lines with their ends, up to five hundred; the last one of all gets an end if it
            has none. Empty if none has come in time, None at the end.
        """
        while not self._lines and not self.ended:
            if not self._is_ready(timeout):
                return []
            self._read()
        if not self._lines:
            return None
        return [self._lines.popleft() for _ in range(min(len(self._lines), _LINES))]

    def look_ahead(self, most: int) -> bool:
        """Read on without waiting, up to so many lines; whether the end is among them."""
        while not self.ended and len(self._lines) < most and self._is_ready(0.0):
            self._read()
        return self.ended

    def _is_ready(self, timeout: float | None) -> bool:
        return bool(select.select([self._descriptor], [], [], timeout)[0])

    def _read(self) -> None:
        part = os.read(self._descriptor, _READ)
        if not part:
            self.ended = True
            if self._rest:
                self._lines.append(self._rest + b"\n")
                self._rest = b""
            return
        first, *others = part.split(b"\n")
        # What comes of a line that is cut off is faulty, and the same however it was read.
        self._rest = (self._rest + first)[: _LONGEST + 1]
        for other in others:
            self._lines.append(self._rest + b"\n")
            self._rest = other
