"""C code of this package compiled and called from Python, to compare it and to measure it."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.interop.c99.build import built
from fuzzytrack.interop.c99.translation import INCLUDES, Translation

__all__ = ["DTYPES", "compiled_functions", "whole_source"]

#: Types of arrays, by the word for the type of number in C.
DTYPES: dict[str, Any] = {"double": np.float64, "float": np.float32}

_PRAGMA = "#if defined(__clang__)\n#pragma STDC FP_CONTRACT OFF\n#endif\n"


def whole_source(*parts: str) -> str:
    """C code with the lines that include headers."""
    return "".join(f"#include <{name}>\n" for name in INCLUDES) + _PRAGMA + "\n".join(parts)


def compiled_functions(
    translations: Sequence[Translation], *, compiler: str | None = None,
    flags: Sequence[str] = ("-O2",),
) -> list[Callable[[ArrayLike], NDArray[Any]]]:  # fmt: skip
    """Functions of arrays that call translated functions, all compiled together.

    Parameters
    ----------
    translations : sequence of Translation
        Each with a name of its own.
    compiler, flags
        As for `fuzzytrack.interop.c99.build.built`.

    Returns
    -------
    list of callable
        Each takes an array of shape (n, numbers in all arguments) and returns one of shape
        (n, numbers in the result), in the type of number of the translation.

    Raises
    ------
    CompilerError
        If there is no compiler, or it does not compile the code.
    """
    text = whole_source(*(part for each in translations for part in _parts(each)))
    library = built(
        text, compiler=compiler, flags=flags, link=any(each.needs for each in translations)
    )
    return [_function(library, each) for each in translations]


def _parts(translation: Translation) -> tuple[str, str]:
    """Definitions of a translation, and a function that calls it again and again."""
    number, name, total = translation.number, translation.name, _total(translation)
    arguments, place = [], 0
    for length in translation.takes:
        arguments.append(f"given + {place}" if length else f"given[{place}]")
        place += length or 1
    call = f"{name}({', '.join([*arguments, *(['found'] if translation.gives else [])])})"
    gives = max(translation.gives, 1)
    return translation.definitions, "\n".join(
        [
            f"extern void {name}_many(int64_t count, const {number} *given, {number} *found);",
            f"void {name}_many(int64_t count, const {number} *given, {number} *found)",
            "{",
            f"    for (int64_t k = 0; k < count; ++k, given += {total}, found += {gives}) {{",
            f"        {call};" if translation.gives else f"        found[0] = {call};",
            "    }",
            "}\n",
        ]
    )


def _total(translation: Translation) -> int:
    return sum(length or 1 for length in translation.takes)


def _function(
    library: ctypes.CDLL, translation: Translation
) -> Callable[[ArrayLike], NDArray[Any]]:
    many = getattr(library, f"{translation.name}_many")
    many.restype = None
    dtype, width = DTYPES[translation.number], _total(translation)

    def call(given: ArrayLike) -> NDArray[Any]:
        rows = np.ascontiguousarray(given, dtype=dtype).reshape(-1, width)
        found = np.empty((len(rows), max(translation.gives, 1)), dtype)
        many(ctypes.c_int64(len(rows)), *(ctypes.c_void_p(a.ctypes.data) for a in (rows, found)))
        return found

    return call
