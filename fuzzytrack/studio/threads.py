"""Threads for work that may take long, or never end, beside the loop that answers the page."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable
from typing import TypeVar

from fuzzytrack.studio.limits import SECONDS

__all__ = ["Threads"]

# Threads that may be stuck before no more are begun.
_MOST_STUCK = 8

T = TypeVar("T")


class Threads:
    """Daemon threads, one for each piece of work.

    A pool would wait at its end for work that hangs, and hand no thread to other work meanwhile.
    """

    def __init__(self) -> None:
        self._stuck = 0

    async def run(self, function: Callable[[], T]) -> T:
        """What a function returns, or raises, in a thread of its own.

        Raises
        ------
        ValueError
            If it takes longer than it may, or too much other work has not come to an end.
        """
        if self._stuck >= _MOST_STUCK:
            raise ValueError("the server is busy with work that does not end; start it again")
        loop = asyncio.get_running_loop()
        future: asyncio.Future[T] = loop.create_future()

        def work(future: asyncio.Future[T]) -> None:
            try:
                found = function()
            except BaseException as failure:
                _tell(loop, _fail, future, failure)
            else:
                _tell(loop, _give, future, found)
            finally:
                del future

        threading.Thread(target=work, args=(future,), daemon=True).start()
        try:
            async with asyncio.timeout(SECONDS):
                return await asyncio.shield(future)
        except TimeoutError:
            if future.done():
                raise
            self._stuck += 1
            future.add_done_callback(self._ended)
            raise ValueError(f"this took longer than {SECONDS:g} s, and was given up") from None
        finally:
            # An error refers to the frames that it has passed, and their future to the error: all
            # would stay, with the arrays of the work, until garbage is collected.
            del future

    def _ended(self, future: asyncio.Future[T]) -> None:
        self._stuck -= 1
        if not future.cancelled():
            # An error that nobody waits for any more would be logged.
            future.exception()


def _tell(loop: asyncio.AbstractEventLoop, tell: Callable[..., None], *arguments: object) -> None:
    with contextlib.suppress(RuntimeError):  # the server has ended meanwhile
        loop.call_soon_threadsafe(tell, *arguments)


def _give(future: asyncio.Future[T], found: T) -> None:
    if not future.done():
        future.set_result(found)


def _fail(future: asyncio.Future[T], failure: BaseException) -> None:
    if not future.done():
        future.set_exception(failure)
