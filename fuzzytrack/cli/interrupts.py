"""Ctrl-C or SIGTERM in a command that must end between two pieces of work, not within one."""

from __future__ import annotations

import signal
from collections.abc import Callable
from typing import Any, TypeVar

__all__ = ["Interrupts"]

_T = TypeVar("_T")


# What Ctrl-C sends, and what service managers and containers send to stop a program.
_SIGNALS = signal.SIGINT, signal.SIGTERM


class Interrupts:
    """Ctrl-C or SIGTERM ends a run between two lines; the second time at once.

    Attributes
    ----------
    wanted : bool
        Whether the user has asked for the end.
    """

    def __init__(self) -> None:
        self.wanted = self._waits = False
        self._before: list[Any] = []

    def __enter__(self) -> Interrupts:
        self._before = [signal.signal(number, self._take) for number in _SIGNALS]
        return self

    def __exit__(self, *_: object) -> None:
        for number, before in zip(_SIGNALS, self._before, strict=True):
            signal.signal(number, before)

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
