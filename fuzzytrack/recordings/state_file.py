"""The file of the state of a live run, which is saved while lines are answered."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from threading import Thread

from fuzzytrack.io.files import check_output
from fuzzytrack.recordings.run_state import RunState

__all__ = ["StateFile"]

# Seconds between two saves at least, and the greatest part of the time that they may take.
_EVERY, _SHARE = 5.0, 0.005


class StateFile:
    """A file that is written in the background.

    Parameters
    ----------
    path : str
        Its name.

    Attributes
    ----------
    path : str
        Its name.
    has_changed : bool
        Whether lines were taken since it was saved.
    """

    def __init__(self, path: str) -> None:
        self.path, self.has_changed = path, False
        check_output(path)
        # When it is saved next; the first time at once.
        self._next = -math.inf
        self._thread: Thread | None = None
        self._failure: OSError | None = None

    @property
    def due_in(self) -> float | None:
        """Seconds until it must be saved; None if nothing has changed."""
        if not self.has_changed:
            return None
        return max(0.0, self._next - time.monotonic())

    def save(self, made: Callable[[], RunState]) -> None:
        """Begin to save it; OSError if it could not be saved the last time.

        Parameters
        ----------
        made : callable
            Makes the state, which is written while the run goes on.
        """
        failure = self._joined()
        begin = time.monotonic()
        state = made()
        end = time.monotonic()
        self.has_changed, self._next = False, end + max(_EVERY, (end - begin) / _SHARE)
        self._thread = Thread(target=self._write, args=(state,))
        self._thread.start()
        if failure is not None:
            raise failure

    def wait(self) -> None:
        """Wait until it is saved; OSError if that has failed."""
        failure = self._joined()
        if failure is not None:
            raise failure

    def _joined(self) -> OSError | None:
        """Why the last save has failed, once it has ended."""
        if self._thread is not None:
            self._thread.join()
            self._thread = None
        failure, self._failure = self._failure, None
        return failure

    def _write(self, state: RunState) -> None:
        try:
            state.save(self.path)
        except OSError as error:
            self._failure = error
