"""Objects as the types of JSON and arrays, and back; only objects of classes that are named."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["PlainValues"]

_SEVERAL: dict[str, Any] = {"list": list, "tuple": tuple, "set": set}


class PlainValues:
    """Writes objects as values of JSON and arrays, and reads them; it runs no code of a file.

    Parameters
    ----------
    classes : tuple of type
        Those of the objects; they are read by `__setstate__`, or by their attributes.
    parts : mapping of str to object
        Objects that are not written, since whoever reads has them: by name.
    arrays : dict of ndarray
        Where arrays are written to, and read from.
    """

    def __init__(
        self,
        classes: tuple[type, ...],
        parts: Mapping[str, object],
        arrays: dict[str, NDArray[Any]],
    ) -> None:
        self._classes = {each.__name__: each for each in classes}
        self._parts = dict(parts)
        self._names = {id(part): name for name, part in parts.items()}
        self._arrays = arrays

    def written(self, value: Any) -> Any:
        """A value in the types of JSON; TypeError if it is of another class."""
        if id(value) in self._names:
            return {"part": self._names[id(value)]}
        if value is None or isinstance(value, bool | int | float | str):
            return value
        if isinstance(value, np.generic) and not isinstance(value, np.void):
            return value.item()
        if isinstance(value, np.ndarray):
            name = f"array_{len(self._arrays)}"
            self._arrays[name] = value.copy()
            return {"array": name}
        if isinstance(value, bytes):
            return {"bytes": value.decode("latin-1")}
        if isinstance(value, list | tuple | set):
            return {type(value).__name__: [self.written(each) for each in value]}
        if isinstance(value, deque):
            return {"deque": [self.written(each) for each in value], "most": value.maxlen}
        if isinstance(value, dict):
            pairs = [[self.written(key), self.written(value[key])] for key in value]
            return {"dict": pairs}
        if self._classes.get(type(value).__name__) is not type(value):
            raise TypeError(f"a {type(value).__name__} cannot be written")
        has_state = hasattr(type(value), "__setstate__")
        state: Any = value.__getstate__() if has_state else vars(value)
        return {"class": type(value).__name__, "state": self.written(dict(state))}

    def read(self, value: Any) -> Any:
        """The value that was written; KeyError, TypeError or ValueError if it is damaged."""
        if not isinstance(value, dict):
            return value
        kind, inner = next(iter(value.items()))
        if kind == "part":
            return self._parts[inner]
        if kind == "array":
            return self._arrays[inner]
        if kind == "bytes":
            return inner.encode("latin-1")
        if kind == "deque":
            return deque(map(self.read, inner), value["most"])
        if kind in _SEVERAL:
            return _SEVERAL[kind](map(self.read, inner))
        if kind == "dict":
            return {self.read(key): self.read(each) for key, each in inner}
        made = self._classes[inner]
        state = self.read(value["state"])
        found: Any = object.__new__(made)
        if hasattr(made, "__setstate__"):
            found.__setstate__(state)
        else:
            vars(found).update(state)
        return found
