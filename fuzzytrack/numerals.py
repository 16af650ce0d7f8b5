"""Numbers written as text: one rule for rule bases, files of plots and the command line."""

from __future__ import annotations

import math
import re

__all__ = ["as_number", "is_number"]

_NUMERAL = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")


def is_number(text: str) -> bool:
    """Whether a text is a decimal number: digits, maybe with a sign, a point and an exponent.

    `float` of Python also accepts underscores, digits of other scripts, ``nan`` and ``infinity``.
    In a file or a command these are mistakes, or words with a meaning of their own.

    Parameters
    ----------
    text : str
        Blanks around it do not count.
    """
    return _NUMERAL.fullmatch(text.strip()) is not None


def as_number(text: str) -> float | None:
    """Number that a text stands for; None if it is no number, or too large for a float.

    Parameters
    ----------
    text : str
        As for `is_number`.
    """
    value = float(text) if is_number(text) else math.inf
    return value if math.isfinite(value) else None
