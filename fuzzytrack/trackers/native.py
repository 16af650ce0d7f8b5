"""Compilation of a scalar function and all that it calls, by Numba."""

from __future__ import annotations

import hashlib
import sys
import uuid
from collections.abc import Callable
from types import BuiltinFunctionType, CellType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

__all__ = ["compiled", "fingerprint"]

_LONG_TUPLE = 16
#: How functions are compiled and named here; what another scheme left on disk is not for us.
_SCHEME = 2


class _UnknownContentError(Exception):
    """A value whose content cannot be told."""


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

    known: dict[int, Any] = {}

    def prepare(value: Any) -> Any:
        if isinstance(value, FunctionType):
            if id(value) not in known:
                # Helpers are inlined whatever their size: a call keeps a loop from vectorising.
                inline = value is not function
                free = nogil and not inline
                jit = numba.njit(error_model="numpy", forceinline=inline, nogil=free)
                known[id(value)] = jit(rebuild(value))
            return known[id(value)]
        if isinstance(value, tuple) and len(value) > _LONG_TUPLE:
            return np.array(value, dtype=np.float64)
        return value

    def rebuild(original: FunctionType) -> FunctionType:
        names = _names(original.__code__)
        scope = {n: prepare(v) for n, v in original.__globals__.items() if n in names}
        scope["__builtins__"] = original.__globals__.get("__builtins__", __builtins__)
        scope["__name__"] = original.__globals__.get("__name__", __name__)
        cells = tuple(CellType(prepare(c.cell_contents)) for c in original.__closure__ or ())
        rebuilt = FunctionType(
            original.__code__, scope, original.__name__, original.__defaults__, cells
        )
        # Two functions of one name, one compiled here and one read from disk, would count as one.
        known_as = digest if original is function else None
        content = known_as or fingerprint(original) or uuid.uuid4().hex
        rebuilt.__qualname__ = f"{original.__name__}_{content[:24]}"
        return rebuilt

    dispatcher: Any = prepare(function)
    if digest is not None:
        from fuzzytrack.trackers.kernel_cache import KernelCache

        dispatcher._cache = KernelCache(dispatcher.py_func, digest)
    return dispatcher  # type: ignore[no-any-return]


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
