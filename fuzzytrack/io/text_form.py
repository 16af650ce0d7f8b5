"""The form of a text file: how cells are separated, numbers written and missing numbers marked."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from fuzzytrack.numerals import as_number

__all__ = ["DELIMITERS", "MISSING", "PLAIN", "TextForm"]

#: What stands for a missing number in any file, in lower case.
MISSING = frozenset(
    (
        *("", "nan", "+nan", "-nan", "1.#qnan", "na", "n/a", "n.a.", "<na>", "#n/a", "#na", "nat"),
        *("null", "nil", "none", "missing", "\\n", "-", "--", "---", "?", "."),
    )
)

#: What may separate cells.
DELIMITERS = (",", ";", "\t", "|", " ")
_DECIMALS = (".", ",")
_COMMENT = re.compile(r"[#%!/*$&@~^:]{0,2}")


@dataclass(frozen=True, kw_only=True)
class TextForm:
    r"""How a text file is written; what is None is recognized.

    Attributes
    ----------
    delimiter : str or None
        What separates cells: comma, semicolon, tab, ``|``, or a blank, which stands for any number
        of blanks.
    decimal : str or None
        Decimal point or comma.
    na : tuple of str
        What stands for a missing number beside `MISSING`, in upper or lower case; numbers among
        them, such as -999, stand for all that equal them.
    comment : str
        Lines that begin with it are left out; if it is empty, none are.
    columns : tuple of str or None
        Names of the columns of a file whose first row holds none; None takes them from the first
        row.

    Raises
    ------
    ValueError
        If they are no such values.
    """

    delimiter: str | None = None
    decimal: str | None = None
    na: tuple[str, ...] = ()
    comment: str = "#"
    columns: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        if self.delimiter is not None and self.delimiter not in DELIMITERS:
            raise ValueError(
                f"delimiter: must be a comma, semicolon, tab, '|' or blank, got {self.delimiter!r}"
            )
        if self.decimal is not None and self.decimal not in _DECIMALS:
            raise ValueError(f"decimal: must be '.' or ',', got {self.decimal!r}")
        if not isinstance(self.comment, str) or not _COMMENT.fullmatch(self.comment):
            raise ValueError(f"comment: must be one or two marks as '#', got {self.comment!r}")
        for name in ("na", "columns"):
            values = getattr(self, name)
            if values is not None:
                object.__setattr__(self, name, _texts(name, values))
        if self.columns is not None and not self.columns:
            raise ValueError("columns: needs at least one name")

    @cached_property
    def missing(self) -> frozenset[str]:
        """All that stands for a missing number, in lower case."""
        return MISSING | {token.strip().lower() for token in self.na}

    @cached_property
    def missing_numbers(self) -> tuple[float, ...]:
        """Numbers that stand for a missing one."""
        found = map(as_number, self.na)
        return tuple(value for value in found if value is not None)


def _texts(argument: str, values: object) -> tuple[str, ...]:
    if isinstance(values, Iterable) and not isinstance(values, str):
        found = tuple(values)
        if all(isinstance(each, str) for each in found):
            return found
    raise ValueError(f"{argument}: must be several texts, got {values!r}")


#: The form of a file of which nothing is known.
PLAIN = TextForm()
