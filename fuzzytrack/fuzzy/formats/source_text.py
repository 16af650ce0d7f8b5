"""Text of a file of another program: its lines, and errors with places in it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from fuzzytrack.errors import Location, RuleBaseError
from fuzzytrack.numerals import as_number
from fuzzytrack.yamltree import quoted

__all__ = ["MAX_BYTES", "PlacedText", "SourceText", "located"]

#: Largest file that is read.
MAX_BYTES = 1024 * 1024
#: Largest magnitude of a number in a rule base.
_LARGEST = 1e100

_FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\x85\u2028\u2029\ufeff]")


@dataclass(frozen=True)
class PlacedText:
    """A part of a line, and where it starts; lines and columns count from 1."""

    text: str
    line: int
    column: int


class SourceText:
    """Lines of a file, and errors about them.

    Parameters
    ----------
    text : str or bytes
        At most 1 MiB. Bytes are UTF-8, with a byte order mark or without; in what is no UTF-8,
        bytes beyond ASCII are taken for Latin-1, as older programs wrote them.
    file : str
        Name for messages.

    Raises
    ------
    RuleBaseError
        If the text is too large, is no text, or contains control characters.
    """

    def __init__(self, text: str | bytes, file: str) -> None:
        self.file = file
        size = len(text) if isinstance(text, bytes) else len(text.encode("utf-8", "replace"))
        if size > MAX_BYTES:
            raise self.error(1, 1, f"the file has more than {MAX_BYTES:,} bytes")
        if isinstance(text, bytes):
            text = self._decoded(text)
        self.lines = re.split("\r\n|\r|\n", text.removeprefix("\ufeff"))
        for number, line in enumerate(self.lines, start=1):
            found = _FORBIDDEN.search(line)
            if found is not None:
                code = ord(found.group())
                raise self.error(
                    number,
                    found.start() + 1,
                    f"the character U+{code:04X} may not be in a text; remove it, or give a text",
                )

    def _decoded(self, text: bytes) -> str:
        if text[:2] in (b"\xff\xfe", b"\xfe\xff"):
            raise self.error(1, 1, "the file is UTF-16; save it as UTF-8")
        try:
            return text.decode("utf-8")
        except UnicodeDecodeError:
            return text.decode("latin-1")

    def error(self, line: int, column: int, message: str) -> RuleBaseError:
        """Error about a place; lines and columns count from 1."""
        return RuleBaseError(message, Location(self.file, line, column))

    def place(self, line: int, column: int = 1) -> Location:
        """A place in the file."""
        return Location(self.file, line, column)

    def number(self, word: str, place: Location, role: str) -> float:
        """Read a finite number.

        Parameters
        ----------
        word : str
        place : Location
            Where it stands.
        role : str
            What it is, for messages.
        """
        value = as_number(word)
        if value is None or abs(value) > _LARGEST:
            raise RuleBaseError(
                f"{role}: {quoted(word)} must be a finite number up to 1e100", place
            )
        return value


@contextmanager
def located(place: Location) -> Iterator[None]:
    """Give errors about a rule base that have no place this one."""
    try:
        yield
    except RuleBaseError as error:
        if error.location is not None:
            raise
        raise RuleBaseError(error.message, place) from None
