"""What a function refers to that cannot be compiled, found before it is compiled."""

from __future__ import annotations

import builtins
import dis
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

__all__ = ["foreign_word"]

_ALLOWED = "numbers, tuples, math, and plain functions of these"
_UNKNOWN = object()


def foreign_word(function: FunctionType | Any) -> str | None:
    """First word of a function, or of one that it calls, that stands for something else.

    Parameters
    ----------
    function : function
        A kernel, or the step of a tracker.

    Returns
    -------
    str or None
        A sentence that names file, line and word; None if there is no such word.
    """
    waiting, seen = [function], set()
    while waiting:
        function = waiting.pop()
        if function in seen:
            continue
        seen.add(function)
        scope = {**vars(builtins), **function.__globals__, **_cells(function)}
        for instruction, following in _instructions(function.__code__):
            sentence = _complaint(function, instruction, following, scope)
            if sentence is not None:
                return sentence
            value = scope.get(instruction.argval) if _reads(instruction) else None
            if isinstance(value, FunctionType):
                waiting.append(value)
    return None


def _complaint(
    function: FunctionType, instruction: Any, following: Any, scope: Mapping[str, Any]
) -> str | None:
    """Sentence about one instruction of a function."""
    word = instruction.argval
    if instruction.opname == "IMPORT_NAME":
        what = f"imports {word!r}"
    elif instruction.opname == "STORE_GLOBAL":
        what = f"changes the global variable {word!r}"
    elif instruction.opname == "STORE_DEREF" and word in function.__code__.co_freevars:
        what = f"changes {word!r}, a variable outside of it"
    elif not _reads(instruction) or _fits(scope.get(word, _UNKNOWN)):
        return None
    else:
        what = _use(word, following, scope.get(word, _UNKNOWN))
    file, line = Path(function.__code__.co_filename).name, instruction.positions.lineno
    return (
        f"line {line} of {file}: the function {function.__name__} {what}; it may use {_ALLOWED}: "
        "put what it needs into variables before it, and what it remembers into the memory"
    )


def _use(word: str, following: Any, value: Any) -> str:
    """Words for the use of something that a kernel cannot use."""
    attribute = following is not None and following.opname in ("LOAD_ATTR", "LOAD_METHOD")
    whole = f"{word}.{following.argval}" if attribute else word
    if value is _UNKNOWN:
        return f"uses {word!r}, which is not defined"
    if isinstance(value, ModuleType):
        return f"uses {whole!r} of the module {value.__name__}"
    module = getattr(value, "__module__", None) or type(value).__module__
    if callable(value) and module.partition(".")[0] == "numpy":
        return f"uses {whole!r} of the module numpy"
    kind = "a class" if isinstance(value, type) else f"a {type(value).__name__}"
    return f"uses {whole!r}, where {word!r} is {kind}"


def _reads(instruction: Any) -> bool:
    """Whether a name of a module or of the enclosing function is looked up."""
    return instruction.opname in ("LOAD_GLOBAL", "LOAD_NAME", "LOAD_DEREF")


def _fits(value: Any) -> bool:
    """Whether compiled code can use a value as it stands."""
    if isinstance(value, tuple):
        return all(map(_fits, value))
    if isinstance(value, BuiltinFunctionType | type):
        return value.__module__ in ("builtins", "math")
    # A function that Numba has compiled already keeps the plain one.
    plain = isinstance(value, FunctionType) or hasattr(value, "py_func")
    numbers = isinstance(value, bool | int | float | str | np.generic | np.ndarray)
    return value is None or value is math or plain or numbers


def _cells(function: FunctionType) -> dict[str, Any]:
    """Variables of the enclosing function, by name."""
    found = {}
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        try:
            found[name] = cell.cell_contents
        except ValueError:  # not assigned yet
            found[name] = _UNKNOWN
    return found


def _instructions(code: CodeType) -> Iterator[tuple[Any, Any]]:
    """Instructions of a function and of those inside it, each with the one after it."""
    own = set(code.co_cellvars)
    listed = list(dis.get_instructions(code))
    for instruction, following in zip(listed, [*listed[1:], None], strict=True):
        if instruction.argval not in own or instruction.opname == "LOAD_GLOBAL":
            yield instruction, following
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            for instruction, following in _instructions(constant):
                if instruction.argval not in own:
                    yield instruction, following
