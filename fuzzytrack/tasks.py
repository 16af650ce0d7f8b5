"""Long work: how it reports its progress."""

from __future__ import annotations

from collections.abc import Callable

__all__ = ["Progress"]

#: Called with the share of the work that is done, 0 to 1.
Progress = Callable[[float], None]
