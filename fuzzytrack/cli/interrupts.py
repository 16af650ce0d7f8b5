"""Ctrl-C in a command that must end between two pieces of work, and not within one."""

from __future__ import annotations

import signal
from collections.abc import Callable
from typing import Any, TypeVar

__all__ = ["Interrupts"]

_T = TypeVar("_T")


class Interrupts:
    """Ctrl-C ends a run between two lines; the second time at once.

    Attributes
    ----------
    wanted : bool
        Whether the user has asked for the end.
    """

    def __init__(self) -> None:
        self.wanted = self._waits = False
        self._before: Any = None

    def __enter__(self) -> Interrupts:
        self._before = signal.signal(signal.SIGINT, self._take)
        return self

    def __exit__(self, *_: object) -> None:
        signal.signal(signal.SIGINT, self._before)

    def wait(self, until: Callable[[], _T]) -> _T | None:
        """Call a function that waits; None if it is interrupted."""
        try:
            self._waits = True
            return until()
        except KeyboardInterrupt:
            return None
        finally:
            self._waits = False

    def _take(self, *_: object) -> None:
        again, self.wanted = self.wanted, True
        if self._waits or again:
            raise KeyboardInterrupt
