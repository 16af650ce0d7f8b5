"""Compilation of a scalar function and all that it calls, by Numba."""

from __future__ import annotations

import hashlib
import math
import sys
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "compiled", "entry_point", "fingerprint", "own_numbers", "promise_independent_turns",
    "use_wide_vectors",
]  # fmt: skip

_LONG_TUPLE = 16
#: How functions are compiled and named here; what another scheme left on disk is not for us.
_SCHEME = 4


class _UnknownContentError(Exception):
    """A value whose content cannot be told."""


def use_wide_vectors() -> None:
    """Let the loops of the compiled function that calls this use the widest registers there are.

    Compilers shun those of 512 bits, since other code on the processor may slow down for them; a
    batch of tracks gains more. In plain Python, and with narrower registers, it does nothing.
    """


def promise_independent_turns() -> None:
    """Promise that no turn of the caller's loops touches what another turn does.

    Then two vectors go through a turn at a time, and while one waits for a division the other is
    worked on; the compiler does not find out by itself, since all rows lie in one buffer. It is
    called after the loops, whose last statement must not be a call: the branch back would get lost
    with the check of how the call ended. In plain Python it does nothing.
    """


def own_numbers(count: int) -> Any:
    """Room for some numbers of the calling function's own, filled before it is read.

    A list; compiled, registers: `count` must be fixed when the function is made.
    """
    return [0.0] * count


def compiled(
    function: Callable[..., Any], digest: str | None = None, *, nogil: bool = False
) -> Callable[..., Any]:
    """Compile a plain Python function together with the plain functions that it refers to.

    Schedulers are written in plain Python and refer to helpers through their module and enclosing
    scope. Numba wants those helpers compiled first; this does it, depth first, and turns long
    tuples of numbers into arrays, which compiled code reads faster. Nothing is changed in place.

    Parameters
    ----------
    function : callable
        Function of scalars and tuples, without recursion.
    digest : str, optional
        What the function is known by on disk, see `fingerprint`; without it nothing is kept there.
    nogil : bool
        Whether other threads may run meanwhile.

    Returns
    -------
    callable
        Numba dispatcher; strict IEEE arithmetic, division by zero gives infinity or NaN.
    """
    import numba

    rebuilt = _rebuilt(_Content.of(function, np.float64, digest))
    dispatcher: Any = numba.njit(rebuilt, error_model="numpy", nogil=nogil)
    dispatcher._cache = _kept(rebuilt, digest, dispatcher._cache)
    return dispatcher  # type: ignore[no-any-return]


def entry_point(function: Callable[..., Any], arguments: str, dtype: type = np.float64) -> Any:
    """Compile a plain Python function, likewise, for calls from compiled code by its address.

    Parameters
    ----------
    function : callable
        As for `compiled`. It does not fail, or nobody hears of it.
    arguments : str
        Types of its result and arguments, a letter each: ``v`` nothing, ``i`` integer, ``x``
        number, ``p`` pointer to numbers, which is indexed like an array.
    dtype : type
        The numbers are np.float64 or np.float32. With the latter the numbers in the source are
        rounded too, or everything would be computed in double precision all the same.

    Returns
    -------
    object
        Its ``address`` is valid as long as the object lives. It is kept on disk if its content can
        be told.
    """
    import numba
    from numba.core.ccallback import CFunc

    types: Any = numba.types
    number = numba.from_dtype(np.dtype(dtype))
    kinds = {"v": types.void, "i": types.intp, "x": number, "p": types.CPointer(number)}
    result, *given = (kinds[letter] for letter in arguments)
    digest = fingerprint(function)
    rebuilt = _rebuilt(_Content.of(function, dtype, digest))
    made: Any = CFunc(rebuilt, (tuple(given), result), {}, {"error_model": "numpy"})
    made._cache = _kept(rebuilt, digest, made._cache)
    made.compile()
    return made


def _kept(function: FunctionType, digest: str | None, otherwise: Any) -> Any:
    """Cache on disk for a function that is known by a digest."""
    if digest is None:
        return otherwise
    from fuzzytrack.kernels.cache import KernelCache

    return KernelCache(function, digest)


@dataclass(frozen=True)
class _Content:
    """A function, equal to any that does the same, computed in numbers of some type."""

    digest: str
    dtype: type
    function: FunctionType = field(compare=False)

    @classmethod
    def of(cls, function: Any, dtype: type, digest: str | None = None) -> _Content:
        # What cannot be told is equal to itself alone.
        return cls(digest or fingerprint(function) or uuid.uuid4().hex, dtype, function)


def _rebuilt(content: _Content) -> FunctionType:
    """The function with its helpers compiled and its constants as compiled code has them."""
    original, dtype = content.function, content.dtype
    names = _names(original.__code__)
    scope = {n: _prepared(v, dtype) for n, v in original.__globals__.items() if n in names}
    scope["__builtins__"] = original.__globals__.get("__builtins__", __builtins__)
    scope["__name__"] = original.__globals__.get("__name__", __name__)
    cells = tuple(
        CellType(_prepared(cell.cell_contents, dtype)) for cell in original.__closure__ or ()
    )
    code = original.__code__
    if dtype is not np.float64:
        code = code.replace(co_consts=tuple(_prepared(c, dtype) for c in code.co_consts))
    rebuilt = FunctionType(code, scope, original.__name__, original.__defaults__, cells)
    # Two functions of one name, one compiled here and one read from disk, would count as one.
    kind = np.dtype(dtype).char
    rebuilt.__qualname__ = f"{original.__name__}_{kind}{content.digest[:24]}"
    return rebuilt


def _prepared(value: Any, dtype: type) -> Any:
    if value is use_wide_vectors:
        return _wide_vectors()
    if value is promise_independent_turns:
        from fuzzytrack.kernels.llvm import mark_loops

        return mark_loops
    if value is own_numbers:
        return _own_numbers(dtype)
    if isinstance(value, FunctionType):
        return _helper(_Content.of(value, dtype))
    if isinstance(value, tuple) and len(value) > _LONG_TUPLE:
        return _table(value, dtype)
    if dtype is np.float64:
        return value
    if isinstance(value, tuple):
        return tuple(_prepared(item, dtype) for item in value)
    return _rounded(value, dtype) if isinstance(value, float) else value


def _rounded(value: float, dtype: type) -> Any:
    with np.errstate(over="ignore", under="ignore"):
        number = dtype(value)
    if math.isfinite(value) and (not np.isfinite(number) or (number == 0.0) != (value == 0.0)):
        raise _lacking(value, dtype)
    return number


def _table(values: tuple[Any, ...], dtype: type) -> NDArray[Any]:
    """Numbers as an array; in a table what is too small may count as 0."""
    exact = np.array(values, dtype=np.float64)
    with np.errstate(over="ignore", under="ignore"):
        table: NDArray[Any] = exact.astype(dtype)
    too_large = np.isinf(table) & np.isfinite(exact)
    if too_large.any():
        raise _lacking(exact[too_large][0], dtype)
    return table


def _lacking(value: float, dtype: type) -> ValueError:
    return ValueError(
        f"dtype: this tracker works with {value:g}, which {np.dtype(dtype)} lacks; use float64"
    )


@lru_cache(maxsize=512)
def _helper(content: _Content) -> Any:
    import numba

    # Helpers are inlined whatever their size: a call keeps a loop from vectorising.
    return numba.njit(_rebuilt(content), error_model="numpy", forceinline=True)


@lru_cache(maxsize=1)
def _wide_vectors() -> Any:
    """`use_wide_vectors` for the compiler."""
    from numba import types
    from numba.extending import intrinsic

    def declare(typing_context: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            # llvmlite lists the attributes that it lets through; this one LLVM has only as a text.
            set.add(builder.function.attributes, '"prefer-vector-width"="512"')
            return context.get_dummy_value()

        return types.void(), generate

    return intrinsic(declare)


@lru_cache(maxsize=2)
def _own_numbers(dtype: type) -> Any:
    """`own_numbers` for the compiler."""
    import numba
    from numba.core import cgutils
    from numba.extending import intrinsic

    types: Any = numba.types
    alloca: Any = cgutils.alloca_once
    number = numba.from_dtype(np.dtype(dtype))

    def declare(typing_context: Any, count: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return alloca(builder, context.get_data_type(number), size=count.literal_value)

        return types.CPointer(number)(count), generate

    return intrinsic(prefer_literal=True)(declare)


def fingerprint(function: Callable[..., Any]) -> str | None:
    """Digest of a plain Python function and of all that it refers to.

    Parameters
    ----------
    function : callable

    Returns
    -------
    str or None
        The same for functions that do the same, in any process; None if the function refers to
        something whose content cannot be told.
    """
    import llvmlite
    import numba

    made_by = (_SCHEME, sys.version_info[:2], numba.__version__, llvmlite.__version__)
    digest = hashlib.sha256(repr(made_by).encode())
    try:
        _add(digest, function, {})
    except _UnknownContentError:
        return None
    return digest.hexdigest()


def _add(digest: Any, value: Any, seen: dict[int, int]) -> None:
    """Take in a value, and what it refers to; a function met before by its number."""

    def take(kind: str, content: bytes) -> None:
        # With its length, so that no two sequences of values look the same.
        digest.update(f"{kind} {len(content)}:".encode() + content)

    # Of an intrinsic of Numba, what it is made by.
    value = getattr(value, "_defn", value)
    if isinstance(value, FunctionType):
        if id(value) in seen:
            take("again", str(seen[id(value)]).encode())
            return
        seen[id(value)] = len(seen)
        scope = {n: value.__globals__[n] for n in _names(value.__code__) & set(value.__globals__)}
        cells = tuple(cell.cell_contents for cell in value.__closure__ or ())
        for part in (value.__code__, value.__defaults__, cells, *sorted(scope.items())):
            _add(digest, part, seen)
    elif isinstance(value, CodeType):
        take("code", value.co_code)
        for part in (value.co_names, value.co_varnames, value.co_freevars, value.co_consts):
            _add(digest, part, seen)
    elif isinstance(value, tuple):
        take("tuple", str(len(value)).encode())
        for item in value:
            _add(digest, item, seen)
    elif isinstance(value, np.ndarray):
        take(f"array {value.dtype.str} {value.shape}", value.tobytes())
    elif value is None or isinstance(value, bool | int | float | str | bytes):
        take(type(value).__name__, repr(value).encode())
    elif isinstance(value, ModuleType | BuiltinFunctionType | type):
        take("name", f"{getattr(value, '__module__', '')}.{value.__name__}".encode())
    else:
        raise _UnknownContentError(type(value).__name__)


def _names(code: CodeType) -> set[str]:
    """Names that a function may look up globally, inner functions and generators included."""
    found = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            found |= _names(constant)
    return found
