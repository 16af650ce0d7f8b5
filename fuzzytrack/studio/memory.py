"""How the process of the server keeps memory that it has freed."""

from __future__ import annotations

import contextlib
import ctypes

__all__ = ["give_back_at_once"]

# M_TRIM_THRESHOLD of glibc's malloc.h, and the bytes that a heap may keep at its end.
_TRIM_THRESHOLD, _KEPT = -1, 2**20


def give_back_at_once() -> None:
    """Let memory go back to the system as soon as it is freed, where the C library is glibc.

    Notes
    -----
    Each command of a page has a thread of its own, and glibc has up to eight heaps a core for
    threads. It gives the end of a heap back when more than a threshold is free there. Unless it is
    set, the threshold rises with the largest block that was freed so far, to 64 MiB, for each heap:
    after 70,000 random messages 34 MiB were in use, and 220 MiB free but kept. A threshold that is
    set stays, and blocks of more than 128 KiB, as arrays are, do not come from a heap at all.
    """
    with contextlib.suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).mallopt(_TRIM_THRESHOLD, _KEPT)
