"""Copies of plain Python functions with other values in place, and the content of a function.

A function that is compiled needs compiled helpers, and constants of the type of number that it
works with; one whose operations are counted needs constants and helpers that count. Both are copies
of the original, which stays as it is.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, ModuleType, NoneType
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["LONG_TUPLE", "fingerprint", "rebuilt", "rounded", "table"]

#: Longer tuples become arrays, which compiled code reads faster.
LONG_TUPLE = 16

#: Packages whose version is known wherever a fingerprint is used: the name of what is in them is
#: enough. What is in any other module may be changed without a change of its name.
_KNOWN_BY_NAME = {"builtins", "math", "numba", "llvmlite"}


class _UnknownContentError(Exception):
    """A value whose content cannot be determined."""


def rebuilt(
    function: FunctionType, replace: Callable[[Any], Any], *, literals: bool = True
) -> FunctionType:
    """Copy of a function in which the values that it refers to are replaced.

    Parameters
    ----------
    function : function
    replace : callable
        Gets each value of the function's globals and enclosing scope and returns the one that
        the copy refers to. For helpers it may call `rebuilt` again.
    literals : bool
        Whether numbers and tuples that are written in the function's own source are replaced, too.

    Returns
    -------
    function
    """
    code = function.__code__
    names = _names(code)
    scope = {name: replace(v) for name, v in function.__globals__.items() if name in names}
    for name in ("__builtins__", "__name__"):
        if name in function.__globals__:
            scope[name] = function.__globals__[name]
    cells = tuple(CellType(replace(cell.cell_contents)) for cell in function.__closure__ or ())
    if literals:
        code = code.replace(co_consts=tuple(map(replace, code.co_consts)))
    return FunctionType(code, scope, function.__name__, function.__defaults__, cells)


def rounded(value: float, dtype: type) -> Any:
    """A number in another type of number.

    Raises
    ------
    ValueError
        If a number is too large or too small for that type.
    """
    with np.errstate(over="ignore", under="ignore"):
        number = dtype(value)
    if math.isfinite(value) and (not np.isfinite(number) or (number == 0.0) != (value == 0.0)):
        raise _not_in(dtype, value)
    return number


def table(values: tuple[Any, ...], dtype: type) -> NDArray[Any]:
    """Numbers as an array in a type of number; those too small for it become 0.

    Raises
    ------
    ValueError
        If a number is too large for that type.
    """
    exact = np.array(values, dtype=np.float64)
    with np.errstate(over="ignore", under="ignore"):
        numbers: NDArray[Any] = exact.astype(dtype)
    too_large = np.isinf(numbers) & np.isfinite(exact)
    if too_large.any():
        raise _not_in(dtype, exact[too_large][0])
    return numbers


def _not_in(dtype: type, value: float) -> ValueError:
    return ValueError(
        f"dtype: this tracker works with {value:g}, which {np.dtype(dtype)} lacks; use float64"
    )


def fingerprint(function: Callable[..., Any], *, numbers: bool = True) -> str | None:
    """Digest of a plain Python function and of all that it refers to.

    Parameters
    ----------
    function : callable
    numbers : bool
        Whether the values of floats count that `rebuilt` gives to its argument `replace`, by
        themselves or in a tuple of up to `LONG_TUPLE` values. Those of others always count.

    Returns
    -------
    str or None
        The same for functions that do the same, in any process with the same versions of Python,
        Numba and llvmlite. None if the function refers to something whose content cannot be
        determined: a module other than `math`, a class, an object.
    """
    digest = hashlib.sha256()
    try:
        _add(digest, function, {}, numbers)
    except _UnknownContentError:
        return None
    return digest.hexdigest()


def _add(digest: Any, value: Any, seen: dict[int, int], numbers: bool) -> None:
    """Add the content of a value, and of what it refers to, to a digest.

    A function that was met before is added by its number in `seen`, since functions may refer to
    one another in a circle.
    """

    def take(kind: str, content: bytes) -> None:
        # With its length, so that no two sequences of values look the same.
        digest.update(f"{kind} {len(content)}:".encode() + content)

    # Of an intrinsic of Numba, the function that generates its code.
    value = getattr(value, "_defn", value)
    if isinstance(value, FunctionType):
        if id(value) in seen:
            take("again", str(seen[id(value)]).encode())
            return
        seen[id(value)] = len(seen)
        scope = {n: value.__globals__[n] for n in _names(value.__code__) & set(value.__globals__)}
        cells = tuple(cell.cell_contents for cell in value.__closure__ or ())
        take("cells", str(len(cells)).encode())
        for part in (value.__code__, *cells, *sorted(scope.items())):
            _add(digest, part, seen, numbers)
        _add(digest, value.__defaults__, seen, True)
    elif isinstance(value, CodeType):
        take("code", value.co_code + value.co_exceptiontable)
        for part in (value.co_names, value.co_varnames, value.co_freevars):
            _add(digest, part, seen, numbers)
        take("constants", str(len(value.co_consts)).encode())
        for part in value.co_consts:
            _add(digest, part, seen, numbers or isinstance(part, CodeType))
    elif type(value) is tuple:
        take("tuple", str(len(value)).encode())
        for item in value:
            _add(digest, item, seen, numbers or len(value) > LONG_TUPLE)
    elif isinstance(value, np.ndarray) and not value.dtype.hasobject:
        take(f"array {value.dtype.str} {value.shape}", value.tobytes())
    elif type(value) is float and not numbers:
        take("number", b"")
    elif type(value) in (NoneType, bool, int, float, str, bytes):
        take(type(value).__name__, repr(value).encode())
    elif _home(value) in _KNOWN_BY_NAME:
        take("name", f"{getattr(value, '__module__', '')}.{value.__name__}".encode())
    else:
        raise _UnknownContentError(type(value).__name__)


def _home(value: Any) -> str | None:
    """Top-level package of a module, or of a class or built-in function; None for other values."""
    if isinstance(value, ModuleType):
        return value.__name__.partition(".")[0]
    if isinstance(value, type | BuiltinFunctionType):
        return str(value.__module__).partition(".")[0]
    return None


def _names(code: CodeType) -> set[str]:
    """Names that a function may look up globally, inner functions and generators included.

    Names of attributes are among them: the bytecode does not tell them apart here.
    """
    found = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            found |= _names(constant)
    return found
