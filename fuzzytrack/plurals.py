"""Counts in messages: a number and a noun in the form that goes with it."""

from __future__ import annotations

__all__ = ["counted"]


def counted(count: float, noun: str, several: str | None = None) -> str:
    """A number and its noun: ``1 run``, ``2 runs``.

    Parameters
    ----------
    count : float
        Written without decimals.
    noun : str
        For exactly one.
    several : str, optional
        For other numbers; the noun with an s unless given.
    """
    number = f"{count:.0f}"
    return f"{number} {noun if number == '1' else several or f'{noun}s'}"
