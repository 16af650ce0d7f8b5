"""Compilation of a scalar function and all that it calls, by Numba."""

from __future__ import annotations

from collections.abc import Callable
from types import CellType, CodeType, FunctionType
from typing import Any

import numpy as np

__all__ = ["compiled"]

_LONG_TUPLE = 16


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a plain Python function together with the plain functions that it refers to.

    Schedulers are written in plain Python and refer to helpers through their module and enclosing
    scope. Numba wants those helpers compiled first; this does it, depth first, and turns long
    tuples of numbers into arrays, which compiled code reads faster. Nothing is changed in place.

    Parameters
    ----------
    function : callable
        Function of scalars and tuples, without recursion.

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
                jit = numba.njit(error_model="numpy", forceinline=inline)
                known[id(value)] = jit(rebuild(value))
            return known[id(value)]
        if isinstance(value, tuple) and len(value) > _LONG_TUPLE:
            return np.array(value, dtype=np.float64)
        return value

    def rebuild(original: FunctionType) -> FunctionType:
        names = _global_names(original.__code__)
        scope = {n: prepare(v) for n, v in original.__globals__.items() if n in names}
        scope["__builtins__"] = original.__globals__.get("__builtins__", __builtins__)
        scope["__name__"] = original.__globals__.get("__name__", __name__)
        cells = tuple(CellType(prepare(c.cell_contents)) for c in original.__closure__ or ())
        return FunctionType(
            original.__code__, scope, original.__name__, original.__defaults__, cells
        )

    dispatcher: Callable[..., Any] = prepare(function)
    return dispatcher


def _global_names(code: CodeType) -> set[str]:
    """Names that a function may look up globally, inner functions and generators included."""
    names = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            names |= _global_names(constant)
    return names
