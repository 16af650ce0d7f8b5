"""Which tracker a state comes from: its text, and a digest of its parameters."""

from __future__ import annotations

import dataclasses
import hashlib
import numbers
from collections.abc import Mapping
from functools import cached_property
from types import BuiltinFunctionType, FunctionType, MethodType
from typing import Any

import numpy as np

from fuzzytrack.kernels.rebuild import fingerprint

__all__ = ["Origin", "digest_of"]


class Origin:
    """The tracker that a state comes from.

    Text and digest are found when they are needed: for a state that is given to another tracker
    object, or that is pickled. What is pickled are these two, without the tracker.

    Parameters
    ----------
    tracker : object
        An immutable tracker.

    Attributes
    ----------
    text : str
        Its `repr`.
    digest : str
        Of its parameters, the same in all processes.
    """

    def __init__(self, tracker: object) -> None:
        self._tracker: object | None = tracker

    def __repr__(self) -> str:
        return f"<Origin: {self.text}>"

    def __reduce__(self) -> tuple[Any, tuple[str, str]]:
        return _restored, (self.text, self.digest)

    @cached_property
    def text(self) -> str:
        """The `repr` of the tracker."""
        return repr(self._tracker)

    @cached_property
    def digest(self) -> str:
        """Digest of the tracker's parameters."""
        return digest_of(self._tracker)

    def is_same(self, other: object) -> bool:
        """Whether another state comes from a tracker with equal parameters."""
        if self is other:
            return True
        if not isinstance(other, Origin):
            return False
        one, two = self._tracker, other._tracker
        if one is not None and (one is two or (type(one) is type(two) and one == two)):
            return True
        return self.digest == other.digest


def _restored(text: str, digest: str) -> Origin:
    """Origin out of a pickle."""
    origin = Origin(None)
    vars(origin).update(text=text, digest=digest)
    return origin


def digest_of(value: object) -> str:
    """Digest of a value by its content, the same in all processes and for equal dataclasses.

    Parameters
    ----------
    value : object
        Dataclasses count by the fields by which they are compared, other objects by what they are
        pickled with; functions by what they refer to.
    """
    found = hashlib.sha256()
    _add(found, value, set())
    return found.hexdigest()[:32]


def _add(found: Any, value: object, within: set[int]) -> None:
    """Add a value to a digest; `within` are the objects that it is a part of."""
    if isinstance(value, np.ndarray) and value.dtype != object:
        _say(found, "array", value.dtype.str, value.shape, np.ascontiguousarray(value).tobytes())
    elif isinstance(value, numbers.Real):
        # Numbers that are equal have one digest, whatever their type; -0.0 is 0.0.
        number = float(value)
        _say(found, "number", (number + 0.0).hex() if number == value else repr(value))
    elif value is None or isinstance(value, str | bytes | complex):
        _say(found, "word", str.__str__(value) if isinstance(value, str) else value)
    elif isinstance(value, FunctionType):
        _say(found, "function", fingerprint(value) or value.__qualname__)
    elif isinstance(value, type | BuiltinFunctionType):
        _say(found, "name", value.__qualname__)
    elif id(value) in within:
        _say(found, "itself")
    else:
        _add_parts(found, value, within | {id(value)})


def _add_parts(found: Any, value: object, within: set[int]) -> None:
    """Add an object that has parts."""
    if isinstance(value, tuple | list):
        _say(found, "sequence", len(value))
        for part in value:
            _add(found, part, within)
    elif isinstance(value, Mapping | set | frozenset):
        pairs = value.items() if isinstance(value, Mapping) else ((part, None) for part in value)
        _say(found, "unordered", sorted(_digest_of_part(pair, within) for pair in pairs))
    elif isinstance(value, MethodType):
        _say(found, "method", value.__func__.__qualname__)
        _add(found, value.__self__, within)
    else:
        _say(found, "object", type(value).__qualname__)
        for name, part in _parts(value).items():
            _say(found, name)
            _add(found, part, within)


def _digest_of_part(value: object, within: set[int]) -> str:
    part = hashlib.sha256()
    _add(part, value, within)
    return part.hexdigest()


def _parts(value: object) -> dict[str, Any]:
    """Parts by which an object is compared, or with which it is pickled."""
    if dataclasses.is_dataclass(value):
        return {f.name: getattr(value, f.name) for f in dataclasses.fields(value) if f.compare}
    state = value.__getstate__()
    slots: object = None
    if isinstance(state, tuple) and len(state) == 2:
        state, slots = state
    parts = {**(state if isinstance(state, dict) else {"": state}), **_as_dict(slots)}
    # What is kept of a computation is no part.
    kept = {name for name in parts if isinstance(getattr(type(value), name, None), cached_property)}
    return {name: parts[name] for name in sorted(parts) if name not in kept}


def _as_dict(slots: object) -> dict[str, Any]:
    return slots if isinstance(slots, dict) else {}


def _say(found: Any, *words: object) -> None:
    """Add words to a digest, so that no others give the same bytes."""
    text = repr(words).encode()
    found.update(f"{len(text)}:".encode() + text)
