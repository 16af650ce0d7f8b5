"""Compiled code that functions share which differ only in numbers.

Compiling takes a second or so, a run of some hundred tracks a millisecond. So a search for the
numbers of a tracker compiles once, and writes the numbers of each trial into memory.
"""

from __future__ import annotations

import uuid
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from types import FunctionType
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.kernels.compile import compiled, dispatcher, entry_point
from fuzzytrack.kernels.rebuild import LONG_TUPLE, fingerprint, rebuilt, table

__all__ = ["SharedCode"]

# In place of the types of arguments: those of arrays are found when the code is called.
_ARRAYS = "arrays"

#: Called with the number that comes next in a function, or those of a tuple; returns what takes
#: their place.
Take = Callable[[tuple[float, ...]], tuple[Any, ...]]


@dataclass(eq=False)
class SharedCode:
    """Compiled functions; those that are the same but for their floats are compiled once.

    Floats that differ between these functions are read from memory, the others stay constants. So
    the results are the same to the last bit as those of code that is compiled for each function.

    Notes
    -----
    The code for a function is that of the last one of its kind for which `entry_point` was called:
    use one at a time, in one thread.
    """

    _kinds: dict[str, _Kind] = field(default_factory=dict, init=False, repr=False)

    @property
    def is_empty(self) -> bool:
        """Whether no function was seen yet."""
        return not self._kinds

    def learn(self, function: Callable[..., Any]) -> None:
        """Note the numbers of a function, so that the code serves all that were noted before it."""
        self._kind(function)

    def entry_point(
        self, function: Callable[..., Any], arguments: str, dtype: type = np.float64
    ) -> Any:
        """Code for a function; see `fuzzytrack.kernels.compile.entry_point`."""
        kind = self._kind(function) if dtype is np.float64 else None
        if kind is None:
            return entry_point(function, arguments, dtype)
        if arguments not in kind.codes:
            kind.codes[arguments] = kind.compiled(function, arguments)
        return kind.codes[arguments]

    def compiled(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Code for a function of arrays that makes none; see `fuzzytrack.kernels.compile.compiled`.

        That of a single function is the one which `compiled` keeps on disk without `allocates`.
        """
        kind = self._kind(function)
        if kind is None:
            return compiled(function, allocates=False)
        if _ARRAYS not in kind.codes:
            kind.codes[_ARRAYS] = kind.of_arrays(function)
        return kind.codes[_ARRAYS]  # type: ignore[no-any-return]

    def _kind(self, function: Any) -> _Kind | None:
        """Functions of this kind, with the numbers of this one in memory; None if unknown."""
        digest = fingerprint(function, numbers=False)
        if digest is None:
            return None
        numbers = _numbers(function)
        kind = self._kinds.setdefault(digest, _Kind(np.array(numbers)))
        kind.take(np.array(numbers))
        return kind


@dataclass(eq=False)
class _Kind:
    """Functions that are the same but for their numbers.

    Attributes
    ----------
    first : ndarray
        Numbers of the first one that was seen.
    differ : set of int
        Those that differ between the functions seen.
    memory : ndarray
        The numbers of the last one.
    codes : dict
        By the types of arguments, the code for those that differ.
    """

    first: Array
    differ: set[int] = field(default_factory=set)
    memory: Array = field(init=False)
    codes: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.memory = self.first.copy()

    def take(self, numbers: Array) -> None:
        """Put the numbers of a function into memory; code that lacks some of them is dropped."""
        differ = {*np.flatnonzero(_bits(numbers) != _bits(self.first)).tolist()} - self.differ
        if differ:
            self.differ |= differ
            self.codes.clear()
        self.memory[:] = numbers

    def compiled(self, function: Any, arguments: str) -> Any:
        """Code that reads the numbers that differ from memory."""
        if not self.differ:
            return entry_point(function, arguments)
        return _compiled(function, arguments, self.memory, self.differ)

    def of_arrays(self, function: Any) -> Callable[..., Any]:
        """The same for a function of arrays, which is called from Python."""
        if not self.differ:
            return compiled(function, allocates=False)
        reading = _reading(function, self.memory, self.differ, allocates=False)
        return dispatcher(reading, allocates=False)


def _bits(numbers: Array) -> Any:
    """Bit patterns: zeros of two signs are different numbers, and NaN is the same as itself."""
    return numbers.view(np.int64)


def _numbers(function: FunctionType) -> list[float]:
    """All floats that a function refers to, in an order that does not depend on their values."""
    found: list[float] = []

    def take(numbers: tuple[float, ...]) -> tuple[float, ...]:
        found.extend(numbers)
        return numbers

    _rebuilt(function, take, lambda copy: copy, {})
    return found


def _compiled(
    function: FunctionType, arguments: str, memory: Array, differ: Collection[int]
) -> Any:
    from fuzzytrack.kernels.llvm import c_function

    return c_function(_reading(function, memory, differ), arguments, np.float64, None)


def _reading(
    function: FunctionType, memory: Array, differ: Collection[int], allocates: bool = True
) -> FunctionType:
    """Copy of a function that reads the numbers that differ from memory."""
    from fuzzytrack.kernels.llvm import inlined
    from fuzzytrack.kernels.slots import Slot

    mark, place = uuid.uuid4().hex, 0

    def take(numbers: tuple[float, ...]) -> tuple[Any, ...]:
        nonlocal place
        places = range(place, place + len(numbers))
        place = places.stop
        # All of a tuple alike, since it may be indexed by a variable.
        if not any(k in differ for k in places):
            return numbers
        return tuple(Slot(memory.ctypes.data + k * memory.itemsize) for k in places)

    def helper(copy: FunctionType) -> Any:
        # Code is linked by name.
        copy.__qualname__ = f"{copy.__name__}_{mark}_{place}"
        return inlined(copy, allocates)

    copy: FunctionType = _rebuilt(function, take, helper, {}).py_func
    return copy


def _rebuilt(
    function: FunctionType, take: Take, finish: Callable[[FunctionType], Any], known: dict[int, Any]
) -> Any:
    """Copy of a function, and of all that it calls, with other numbers in place.

    Parameters
    ----------
    function : function
    take : callable
        Called with every float as a tuple of one, and with tuples of floats, in an order that
        depends on the functions only.
    finish : callable
        Called with every copy; what it returns is called in its place.
    known : dict
        What was returned for functions that were met before, by their identity.
    """
    from fuzzytrack.kernels.llvm import word_for_compiler

    def replace(value: Any) -> Any:
        if isinstance(value, FunctionType):
            if id(value) not in known:
                word = word_for_compiler(value, np.float64)
                known[id(value)] = word or _rebuilt(value, take, finish, known)
            return known[id(value)]
        if type(value) is float:
            return take((value,))[0]
        if not isinstance(value, tuple):
            return value
        if len(value) > LONG_TUPLE:
            return table(value, np.float64)
        if all(type(item) is float for item in value):
            return take(value)
        return tuple(map(replace, value))

    return finish(rebuilt(function, replace))
