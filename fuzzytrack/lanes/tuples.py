"""Tuples of numbers that lie apart in a buffer, read and written by compiled code.

Compiled code cannot fill a tuple in a loop: its length and every place in it must be known when it
is compiled. So the functions here are made for a length, each out of that for one number less.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

__all__ = ["gather", "scatter"]


def gather(count: int, stride: int) -> Callable[[Any, int], tuple[float, ...]]:
    """Function ``f(buffer, start)`` that reads `count` numbers, `stride` apart, into a tuple."""
    if count == 0:

        def nothing(buffer: Any, start: int) -> tuple[float, ...]:
            return ()

        return nothing

    before, offset = gather(count - 1, stride), (count - 1) * stride

    def one_more(buffer: Any, start: int) -> tuple[float, ...]:
        return (*before(buffer, start), buffer[start + offset])

    return one_more


def scatter(count: int, stride: int) -> Callable[[Any, int, tuple[float, ...], bool], None]:
    """Function ``f(buffer, start, values, write)`` that writes a tuple to places `stride` apart.

    Unless `write`, it leaves them as they are.
    """
    if count == 0:

        def nothing(buffer: Any, start: int, values: tuple[float, ...], write: bool) -> None:
            return

        return nothing

    before, last, offset = scatter(count - 1, stride), count - 1, (count - 1) * stride

    def one_more(buffer: Any, start: int, values: tuple[float, ...], write: bool) -> None:
        before(buffer, start, values, write)
        buffer[start + offset] = values[last] if write else buffer[start + offset]

    return one_more
