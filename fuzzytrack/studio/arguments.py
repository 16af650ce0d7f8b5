"""Arguments of a command, each checked when it is read."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from fuzzytrack.errors import FileError

__all__ = ["Arguments", "renamed"]

_LONGEST = 131_072
_MOST_ITEMS = 10_000
_NEEDED: Any = object()


class Arguments:
    """Arguments of a command, as a page sent them.

    Parameters
    ----------
    given : mapping of str to JSON value
    within : str
        What stands before the names of arguments in messages.

    Notes
    -----
    Each method takes the name of an argument and, unless it is needed, its default, and raises a
    ValueError that names the argument and what is allowed.
    """

    def __init__(self, given: Mapping[str, Any], within: str = "") -> None:
        self._given = given
        self._within = within

    def __contains__(self, name: str) -> bool:
        return self._given.get(name) is not None

    def is_text(self, name: str) -> bool:
        """Whether an argument is given as a text."""
        return isinstance(self._given.get(name), str)

    def is_list(self, name: str) -> bool:
        """Whether an argument is given as a list."""
        return isinstance(self._given.get(name), list)

    def objects(self, name: str) -> list[Arguments]:
        """A list of objects, at least one, each read as arguments."""
        self._missing(name, _NEEDED, "a list of objects")
        found = self._items(name, "a list of objects")
        if not found or not all(isinstance(each, dict) for each in found):
            raise self._wrong(name, "needs a list of objects, at least one")
        return [Arguments(each, f"{self._within}{name}: ") for each in found]

    def text(self, name: str, default: Any = _NEEDED, longest: int = _LONGEST) -> Any:
        """A text of at most so many characters."""
        if self._missing(name, default, "a text"):
            return default
        found = self._given[name]
        if not isinstance(found, str):
            raise self._wrong(name, "needs a text")
        if len(found) > longest:
            raise self._wrong(name, f"{len(found)} characters; at most {longest}")
        if any("\ud800" <= c <= "\udfff" for c in found):
            raise self._wrong(name, "has half a character (a lone surrogate); type it anew")
        return found

    def texts(self, name: str, default: Any = _NEEDED) -> Any:
        """A list of texts, at least one."""
        if self._missing(name, default, "a list of texts"):
            return default
        found = self._items(name, "a list of texts")
        if not found or not all(isinstance(each, str) for each in found):
            raise self._wrong(name, "needs a list of texts, at least one")
        return list(found)

    def choice(self, name: str, allowed: Sequence[str], default: Any = _NEEDED) -> Any:
        """One of some words."""
        found = self.text(name, default)
        if found is not default and found not in allowed:
            raise self._wrong(name, f"unknown {found[:40]!r}; one of {', '.join(allowed)}")
        return found

    def flag(self, name: str) -> bool:
        """Whether; no unless given."""
        found = self._given.get(name)
        if found is not None and not isinstance(found, bool):
            raise self._wrong(name, "needs true or false")
        return bool(found)

    def whole(self, name: str, low: int, high: int, default: Any = _NEEDED) -> Any:
        """A whole number within limits."""
        kind = f"a whole number from {low} to {high}"
        if self._missing(name, default, kind):
            return default
        found = self._given[name]
        if isinstance(found, float) and found.is_integer():
            found = int(found)
        if type(found) is not int or not low <= found <= high:
            raise self._wrong(name, f"needs {kind}, got {_short(found)}")
        return found

    def number(self, name: str, default: Any = _NEEDED) -> Any:
        """A finite number."""
        if self._missing(name, default, "a number"):
            return default
        return self._number(name, self._given[name])

    def numbers(self, name: str, default: Any = _NEEDED) -> Any:
        """A list of finite numbers."""
        if self._missing(name, default, "a list of numbers"):
            return default
        return [self._number(name, each) for each in self._items(name, "a list of numbers")]

    def simple(self, name: str, default: Any = _NEEDED) -> Any:
        """A text, a finite number, or a list of either."""
        kind = "a text, a number, or a list of them"
        if self._missing(name, default, kind):
            return default
        found = self._given[name]
        if not isinstance(found, list):
            return self._text_or_number(name, found)
        return [self._text_or_number(name, each) for each in self._items(name, kind)]

    def points(self, name: str, default: Any = _NEEDED) -> Any:
        """A list of pairs of finite numbers."""
        if self._missing(name, default, "a list of points [x, y]"):
            return default
        found = self._items(name, "a list of points [x, y]")
        if not all(isinstance(each, list) and len(each) == 2 for each in found):
            raise self._wrong(name, "needs a list of points [x, y]")
        return [[self._number(name, x), self._number(name, y)] for x, y in found]

    def numbers_by_name(self, name: str) -> dict[str, float]:
        """An object of finite numbers."""
        found = self._given.get(name)
        if not isinstance(found, dict):
            raise self._wrong(name, "needs an object with a number for each name")
        return {str(key): self._number(f"{name}: {key[:40]}", each) for key, each in found.items()}

    def texts_by_name(self, name: str) -> dict[str, str]:
        """An object of texts."""
        found = self._given.get(name)
        if not isinstance(found, dict) or not all(isinstance(v, str) for v in found.values()):
            raise self._wrong(name, "needs an object with a text for each name")
        return found

    def _missing(self, name: str, default: Any, kind: str) -> bool:
        if name in self:
            return False
        if default is _NEEDED:
            raise self._wrong(name, f"is missing; needs {kind}")
        return True

    def _wrong(self, name: str, why: str) -> ValueError:
        return ValueError(f"{self._within}{name}: {why}")

    def _text_or_number(self, name: str, found: Any) -> str | float:
        if not isinstance(found, str):
            return self._number(name, found)
        return Arguments({name: found}, self._within).text(name)  # type: ignore[no-any-return]

    def _number(self, name: str, found: Any) -> float:
        if isinstance(found, bool) or not isinstance(found, int | float):
            raise self._wrong(name, f"needs numbers, got {_short(found)}")
        try:
            value = float(found)
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):
            raise self._wrong(name, "needs finite numbers")
        return value

    def _items(self, name: str, kind: str) -> list[Any]:
        found = self._given[name]
        if not isinstance(found, list):
            raise self._wrong(name, f"needs {kind}")
        if len(found) > _MOST_ITEMS:
            raise self._wrong(name, f"{len(found)} items; at most {_MOST_ITEMS}")
        return found


def _short(found: Any) -> str:
    text = repr(found)
    return text if len(text) <= 40 else f"{text[:37]}..."


@contextmanager
def renamed(**names: str | None) -> Iterator[None]:
    """Name arguments in refusals as a page does.

    Parameters
    ----------
    **names : str or None
        By the name that a refusal begins with: that of the page's argument; None if it has none.

    Raises
    ------
    ValueError
        What is raised inside.
    """
    try:
        yield
    except ValueError as failure:
        said = failure.message if isinstance(failure, FileError) else str(failure)
        word, colon, rest = said.partition(": ")
        if not colon or word not in names:
            raise
        said = f"{names[word]}: {rest}" if names[word] else rest
        if isinstance(failure, FileError):
            raise type(failure)(said, failure.location) from None
        raise ValueError(said) from None
