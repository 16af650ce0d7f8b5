"""Errors and warnings of the package, derived from ``ValueError`` and ``UserWarning``."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "CacheWarning",
    "DataError",
    "FileError",
    "Location",
    "NoRuleFiresWarning",
    "PluginError",
    "PluginWarning",
    "RuleBaseError",
    "ScenarioError",
    "Word",
]


@dataclass(frozen=True)
class Location:
    """Where a word stands in a file; lines and columns count from 1."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


class Word(str):
    """A word read from a file, with its place there; otherwise an ordinary string.

    Parameters
    ----------
    text : str
        The word.
    location : Location or None
        Place in the file.
    """

    location: Location | None

    def __new__(cls, text: str, location: Location | None = None) -> Word:
        """Make the word; ``str`` is filled when it is made, not in ``__init__``."""
        word = super().__new__(cls, text)
        word.location = location
        return word


class FileError(ValueError):
    """A text that cannot be used; names the place of the mistake and what was allowed.

    Parameters
    ----------
    message : str
        What is wrong, with the offending word and the allowed ones.
    location : Location or None
        Place in the file; None for what was built in Python.
    """

    def __init__(self, message: str, location: Location | None = None) -> None:
        super().__init__(f"{location}: {message}" if location else message)
        self.message = message
        self.location = location

    def __reduce__(self) -> tuple[type[FileError], tuple[str, Location | None]]:
        return type(self), (self.message, self.location)


class RuleBaseError(FileError):
    """A rule base that cannot be used."""


class ScenarioError(FileError):
    """A scenario of a simulation that cannot be used."""


class PluginError(FileError):
    """A script of plug-ins that cannot be loaded."""


class DataError(ValueError):
    """A data file or measurement array that cannot be tracked; names row and column."""


class NoRuleFiresWarning(UserWarning):
    """No rule fires at some inputs, so the output there is NaN."""


class PluginWarning(UserWarning):
    """A plug-in was skipped: it could not be loaded, or its name is taken."""


class CacheWarning(UserWarning):
    """Compiled code could not be kept on disk, so that every process compiles it again."""
