"""Compilation of a scalar function and all that it calls, by Numba."""

from __future__ import annotations

import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from types import FunctionType
from typing import Any

import numpy as np

from fuzzytrack.kernels.rebuild import LONG_TUPLE, fingerprint, rebuilt, rounded, table

__all__ = ["compiled", "dispatcher", "entry_point"]


def compiled(
    function: Callable[..., Any], *, nogil: bool = False, allocates: bool = True
) -> Callable[..., Any]:
    """Compile a plain Python function together with the plain functions that it refers to.

    Helpers are found in the function's module and enclosing scope; they are compiled first. The
    words of `fuzzytrack.kernels.language` become instructions to the compiler. The original
    functions stay as they are.

    Parameters
    ----------
    function : callable
        Function of scalars, tuples and arrays, without recursion.
    nogil : bool
        Whether other threads may run meanwhile.
    allocates : bool
        Whether it makes or returns arrays. One that does not need not count who uses its arrays,
        which inner loops would do at every call of a helper.

    Returns
    -------
    callable
        Numba dispatcher; strict IEEE arithmetic, division by zero gives infinity or NaN. Its code
        is kept on disk, unless the content of the function cannot be determined, see
        `fuzzytrack.kernels.rebuild.fingerprint`.
    """
    from fuzzytrack.kernels.llvm import keep_on_disk

    content = _Content.of(function, np.float64)
    copy = _prepared_copy(content, allocates)
    made = dispatcher(copy, nogil=nogil, allocates=allocates)
    keep_on_disk(made, content.digest and content.digest + _mark(allocates))
    return made


def dispatcher(
    function: Callable[..., Any], *, nogil: bool = False, allocates: bool = True
) -> Callable[..., Any]:
    """Numba dispatcher of a function whose helpers are compiled already; kept on no disk."""
    import numba

    options: Any = {} if allocates else {"_nrt": False}
    made: Any = numba.njit(function, error_model="numpy", nogil=nogil, **options)
    return made  # type: ignore[no-any-return]


def entry_point(function: Callable[..., Any], arguments: str, dtype: type = np.float64) -> Any:
    """Compile a plain Python function, as `compiled` does, for calls by its address.

    Parameters
    ----------
    function : callable
        As for `compiled`. It must not raise: its caller cannot see an exception.
    arguments : str
        Types of its result and arguments, a letter each: ``v`` nothing, ``i`` integer, ``x``
        number, ``p`` pointer to numbers, which is indexed like an array.
    dtype : type
        The type of its numbers, np.float64 or np.float32. With float32 the numbers in its source
        are rounded, too: a single one in double precision would make all arithmetic double.

    Returns
    -------
    object
        Its ``address`` is valid as long as the object exists. Its code is kept on disk as that of
        `compiled`.

    Raises
    ------
    ValueError
        If a number in the source is too large or too small for `dtype`.
    """
    from fuzzytrack.kernels.llvm import c_function

    content = _Content.of(function, dtype)
    return c_function(_prepared_copy(content), arguments, dtype, content.digest)


@dataclass(frozen=True)
class _Content:
    """A function and the type of number that it is compiled for.

    Equal to another one if both functions have the same content; if it cannot be determined, only
    to itself.

    Attributes
    ----------
    digest : str or None
        Of the content and the type of number.
    dtype : type
    name : str
        Part of the name of the compiled code.
    function : function
    """

    digest: str | None
    dtype: type
    name: str
    function: FunctionType = field(compare=False)

    @classmethod
    def of(cls, function: Any, dtype: type) -> _Content:
        digest, kind = fingerprint(function), np.dtype(dtype).char
        name = f"{kind}{(digest or uuid.uuid4().hex)[:24]}"
        return cls(None if digest is None else kind + digest, dtype, name, function)


def _mark(allocates: bool) -> str:
    """Part of what code is kept by, and of its name."""
    return "" if allocates else "_borrowing"


def _prepared_copy(content: _Content, allocates: bool = True) -> FunctionType:
    """Copy of a function with compiled helpers, and constants as compiled code needs them."""
    dtype = content.dtype
    copy = rebuilt(
        content.function,
        lambda value: _prepared(value, dtype, allocates),
        literals=dtype is not np.float64,
    )
    # Code is linked by name, and Numba numbers functions of one name within a process only: code
    # that was compiled here could be taken for other code that was read from disk.
    copy.__qualname__ = f"{content.function.__name__}_{content.name}{_mark(allocates)}"
    return copy


def _prepared(value: Any, dtype: type, allocates: bool) -> Any:
    from fuzzytrack.kernels.llvm import word_for_compiler

    if isinstance(value, FunctionType):
        return word_for_compiler(value, dtype) or _helper(_Content.of(value, dtype), allocates)
    if isinstance(value, tuple) and len(value) > LONG_TUPLE:
        return table(value, dtype)
    if dtype is np.float64:
        return value
    if isinstance(value, tuple):
        return tuple(_prepared(item, dtype, allocates) for item in value)
    return rounded(value, dtype) if isinstance(value, float) else value


@lru_cache(maxsize=512)
def _helper(content: _Content, allocates: bool) -> Any:
    from fuzzytrack.kernels.llvm import inlined

    return inlined(_prepared_copy(content, allocates), allocates)
