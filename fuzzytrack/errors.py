"""Errors and warnings of the package, derived from ``ValueError`` and ``UserWarning``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

__all__ = [
    "CacheWarning",
    "DataError",
    "FileError",
    "Location",
    "NoRuleFiresWarning",
    "PluginError",
    "PluginWarning",
    "PrecisionWarning",
    "RuleBaseError",
    "ScannerError",
    "ScenarioError",
    "TrackWarning",
    "Word",
    "in_one_sentence",
]


@dataclass(frozen=True)
class Location:
    """Where a word stands in a file; lines and columns count from 1."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"

    @classmethod
    def of_function(cls, function: Callable[..., Any]) -> Location | None:
        """Place of the definition of a function or method; None for what has no source."""
        code = getattr(function, "__code__", None)
        return None if code is None else cls(code.co_filename, code.co_firstlineno, 1)


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


class ScannerError(FileError):
    """A configuration of a scan tracker that cannot be used."""


class PluginError(FileError):
    """A script of plug-ins that cannot be loaded, or a plug-in that cannot be used."""


class DataError(ValueError):
    """A data file or measurement array that cannot be tracked; names row and column."""


class NoRuleFiresWarning(UserWarning):
    """No rule fires at some inputs, so the output there is NaN."""


class PluginWarning(UserWarning):
    """A plug-in was skipped: it could not be loaded, or its name is taken."""


class PrecisionWarning(UserWarning):
    """A filter in single precision errs by much, compared with the noise of its plots."""


class TrackWarning(UserWarning):
    """The gains of a run do not suit the times of its plots: they make tracks mostly noise."""


class CacheWarning(UserWarning):
    """Compiled code could not be kept on disk, so that every process compiles it again."""


def in_one_sentence(error: BaseException) -> str:
    """Type and message of an error; of a message of many lines, the first one that says why."""
    lines = [line for line in str(error).splitlines() if line.strip()]
    # Numba begins with the stage of the compiler, once for each function around the mistake.
    reasons = [line for line in lines if not line.startswith("Failed in nopython mode pipeline")]
    return ": ".join([type(error).__name__, *reasons[:1]])
