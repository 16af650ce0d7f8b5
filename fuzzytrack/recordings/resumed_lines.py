"""Lines of a feed that is sent again from its beginning: those that were taken are passed over."""

from __future__ import annotations

from collections.abc import Sequence
from zlib import crc32

from fuzzytrack.errors import DataError
from fuzzytrack.recordings.live_feed import FEED
from fuzzytrack.recordings.run_state import RunState

__all__ = ["ResumedLines"]


class ResumedLines:
    """Passes over the lines that a state has taken, and checks that they are the same.

    Parameters
    ----------
    state : RunState
    """

    def __init__(self, state: RunState) -> None:
        self._state, self._passed, self._checksum = state, 0, 0

    def new(self, lines: Sequence[bytes]) -> list[bytes]:
        """Take lines, and give those that are new.

        Parameters
        ----------
        lines : sequence of bytes

        Raises
        ------
        DataError
            If a line that was taken is another one now; as early as the first lines show it.
        """
        if self._passed == self._state.lines:
            return list(lines)
        # The first lines are looked at by themselves.
        begins, checksum = self._state.beginning
        rest = self._pass(lines, begins, checksum)
        return self._pass(rest, self._state.lines, self._state.checksum)

    def finish(self) -> None:
        """End the feed; DataError if it was shorter than what was taken of it."""
        if self._passed < self._state.lines:
            raise DataError(
                f"{FEED}: ends after {self._passed} lines, of which {self._state.lines} were taken "
                "before; send it again from its beginning, or give `feed` onward if it goes on"
            )

    def _pass(self, lines: Sequence[bytes], until: int, checksum: int) -> list[bytes]:
        count = max(0, min(len(lines), until - self._passed))
        if count:
            self._checksum = crc32(b"".join(lines[:count]), self._checksum)
            self._passed += count
            if self._passed == until and self._checksum != checksum:
                raise DataError(
                    f"{FEED}: its first {until} lines are not those that were taken before; send "
                    "it again from its beginning, or give `feed` onward if it goes on"
                )
        return list(lines[count:])
