"""Messages between the page and the server: requests, answers, surfaces and events."""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import FileError
from fuzzytrack.json_types import plain

__all__ = ["Layers", "MessageError", "Request", "answer", "error", "event", "read_request"]

_MOST = 2**32 - 1


class MessageError(ValueError):
    """A message that is no request.

    Parameters
    ----------
    message : str
        What is wrong.
    seq : int or None
        Its number, if that much can be read.
    """

    def __init__(self, message: str, seq: int | None = None) -> None:
        super().__init__(message)
        self.seq = seq


@dataclass(frozen=True)
class Request:
    """What a page asks for.

    Attributes
    ----------
    seq : int
        Number that the answer repeats.
    command : str
    arguments : dict
        As they were sent.
    """

    seq: int
    command: str
    arguments: dict[str, Any]


@dataclass(frozen=True, eq=False)
class Layers:
    """Surfaces on one grid, for a binary message.

    Attributes
    ----------
    values : ndarray, shape (layers, rows, columns)
        A row for each value of the second input, a column for each of the first; NaN where no rule
        fires.
    """

    values: Array

    def message(self, seq: int) -> bytes:
        """Header of six numbers (seq, rows, columns, layers, 0, 0), and the values, float32."""
        layers, rows, columns = self.values.shape
        head = struct.pack("<6I", seq, rows, columns, layers, 0, 0)
        return head + np.ascontiguousarray(self.values, dtype="<f4").tobytes()


def read_request(text: str) -> Request:
    """Read a request: ``{"seq": 12, "command": "set_cell", "arguments": {...}}``.

    Raises
    ------
    MessageError
        If it is something else.
    """
    try:
        found = json.loads(text, parse_constant=_no_constant)
    except (ValueError, RecursionError):
        raise MessageError("the message is no JSON") from None
    if not isinstance(found, dict):
        raise MessageError("the message is no JSON object")
    seq = found.get("seq")
    if type(seq) is not int or not 0 <= seq <= _MOST:
        raise MessageError(f"seq: needs a whole number from 0 to {_MOST}")
    command, arguments = found.get("command"), found.get("arguments", {})
    if not isinstance(command, str):
        raise MessageError("command: needs the name of a command", seq)
    if not isinstance(arguments, dict):
        raise MessageError("arguments: needs a JSON object", seq)
    return Request(seq, command, arguments)


def _no_constant(word: str) -> None:
    raise ValueError(word)


def answer(seq: int, result: Mapping[str, Any]) -> str:
    """Answer to a request; None for numbers that are not finite."""
    return _text({"seq": seq, "result": plain(result)})


# A word of a request that a refusal quotes, with what stays of it.
_LONG = re.compile(r"(\S{60})\S{60,}(\S{20})")


def error(seq: int | None, failure: BaseException | str, named: Callable[[str], str] = str) -> str:
    """Answer to a request that cannot be done: a sentence, and the place if it is in a text.

    Parameters
    ----------
    seq : int or None
    failure : exception or str
    named : callable, optional
        Puts names of files in the place of paths.
    """
    where = getattr(failure, "location", None)
    # The file of a text in the editor has no name that helps.
    said = failure.message if isinstance(failure, FileError) else str(failure)
    said = _LONG.sub(r"\1…\2", named(said))
    place = {"line": where.line, "column": where.column} if where else None
    return _text({"seq": seq, "error": said, "where": place})


def event(kind: str, **content: Any) -> str:
    """Message that no request asked for."""
    return _text({"event": kind, **plain(content)})


def _text(content: Mapping[str, Any]) -> str:
    # A lone surrogate, which a page may have sent, cannot be written as UTF-8.
    return json.dumps(content, allow_nan=False, separators=(",", ":"))
