"""Numbers written as text: one rule for rule bases, files of plots and the command line."""

from __future__ import annotations

import math
import re

__all__ = ["as_number", "is_number"]

_NUMERAL = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")


def is_number(text: str) -> bool:
    """Whether a text is a decimal number: digits, maybe with a sign, a point and an exponent.

    Python's `float` also takes underscores, digits of other scripts, ``nan`` and ``infinity``,
    which in a file or a command are mistakes or words.

    Parameters
    ----------
    text : str
        Without blanks around it.
    """
    return _NUMERAL.fullmatch(text) is not None


def as_number(text: str) -> float | None:
    """Number that a text is; None if it is none, or larger than floating-point numbers are.

    Parameters
    ----------
    text : str
        As for `is_number`.
    """
    value = float(text) if is_number(text) else math.inf
    return value if math.isfinite(value) else None
