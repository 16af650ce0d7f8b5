"""Work in threads that does not come to an end."""

import asyncio
import contextlib
import gc
import threading
import weakref

import numpy as np
import pytest
from waiting import PATIENCE

from fuzzytrack.studio import threads
from fuzzytrack.studio.threads import Threads


def test_what_hangs_is_given_up_and_not_begun_without_end(monkeypatch):
    monkeypatch.setattr(threads, "SECONDS", 0.01)
    monkeypatch.setattr(threads, "_MOST_STUCK", 2)
    go = threading.Event()

    def late():
        go.wait(PATIENCE)
        raise KeyError("nobody hears of this")

    async def work():
        found = Threads()
        for _ in range(2):
            with pytest.raises(ValueError, match=r"this took longer than 0\.01 s"):
                await found.run(late)
        with pytest.raises(ValueError, match="busy with work that does not end"):
            await found.run(late)
        go.set()
        monkeypatch.setattr(threads, "SECONDS", 60.0)
        for _ in range(1000):
            try:
                return await found.run(lambda: "done")
            except ValueError:
                await asyncio.sleep(0.01)
        return None

    assert asyncio.run(work()) == "done"


def test_what_is_raised_arrives():
    def wrong():
        raise KeyError("x")

    with pytest.raises(KeyError, match="x"):
        asyncio.run(Threads().run(wrong))


def test_what_was_at_work_when_an_error_was_raised_is_freed_at_once():
    kept = []

    def wrong():
        large = np.zeros(1000)
        kept.append(weakref.ref(large))
        raise ValueError("too large")

    async def work():
        # `pytest.raises` would keep the error.
        with contextlib.suppress(ValueError):
            await Threads().run(wrong)

    before = set(threading.enumerate())
    gc.disable()
    try:
        asyncio.run(work())
        # The thread holds its error until it ends, which may be after it was taken in here.
        for thread in set(threading.enumerate()) - before:
            thread.join()
        assert kept[0]() is None
    finally:
        gc.enable()
