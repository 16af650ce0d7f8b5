"""C source of a program that checks a header against values of the library."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from fuzzytrack.interop.c99.c_text import comment_lines, literal
from fuzzytrack.interop.c99.error_bound import ErrorBound
from fuzzytrack.interop.c99.number_types import NumberType
from fuzzytrack.interop.c99.signature import Signature
from fuzzytrack.interop.c99.vectors import Vectors

__all__ = ["selftest_text"]

#: Parts of a step in which expected integers are written.
_PARTS = 256


def selftest_text(
    name: str,
    header: str,
    names: Signature,
    number: NumberType,
    checked: Vectors,
    bound: ErrorBound,
    more: str = "",
) -> str:
    """Source of the program.

    Parameters
    ----------
    name : str
        Name of the rule base, for the line that is printed.
    header : str
        Name of the header file.
    names : Signature
    number : NumberType
    checked : Vectors
    bound : ErrorBound
    more : str
        Definition of a function ``PREFIX_filter_check`` that returns how many values of a filter
        are wrong; empty for none.
    """
    count, n_inputs = checked.inputs.shape
    n_outputs = len(names.outputs)
    expected, bounds = _written(number, checked.expected, bound.bounds)
    wide = "int32_t" if number.whole else number.c_type
    unit = f"1/{_PARTS} of a step" if number.whole else "the unit of an output"
    says = re.sub(r"[^A-Za-z0-9_.-]", "_", name)
    lines = [
        *comment_lines(
            [
                ("", f"Self-test of {header}: prints one line, and ends with 0 if all is right."),
                (
                    "",
                    f"Expected values are those of the library; they and the bounds are in {unit}.",
                ),
            ]
        ),
        *([] if number.whole else ["#include <math.h>"]),
        "#include <stdio.h>",
        f'#include "{header}"',
        "",
        f"/* {', '.join(names.inputs)} */",
        *_rows(number.c_type, "given", f"[{count}][{n_inputs}]", checked.inputs),
        "",
        f"/* {', '.join(names.outputs)} */",
        *_rows(wide, "expected", f"[{count}][{n_outputs}]", expected),
        "",
        f"static const {wide} bound[{n_outputs}] = {{ {', '.join(map(literal, bounds))} }};",
        "",
    ]
    if more:
        lines += [more.rstrip(), ""]
    arguments = ", ".join(f"given[row][{k}]" for k in range(n_inputs))
    lines += [
        *_is_wrong(number, wide),
        "",
        "int main(void)",
        "{",
        "    unsigned int wrong = 0U;",
        "    unsigned int row;",
        "    unsigned int k;",
        f"    for (row = 0U; row < {count}U; row++) {{",
        f"        const {names.structure} y = {names.function}({arguments});",
        f"        {number.c_type} found[{n_outputs}];",
        *(f"        found[{k}] = y.{member};" for k, member in enumerate(names.outputs)),
        f"        for (k = 0U; k < {n_outputs}U; k++) {{",
        "            wrong += is_wrong(found[k], expected[row][k], bound[k]);",
        "        }",
        "    }",
        *([f"    wrong += (unsigned int){names.prefix}_filter_check();"] if more else []),
        "    if (wrong != 0U) {",
        f'        (void)printf("{says}: %u values are wrong\\n", wrong);',
        "    } else {",
        f'        (void)printf("{says}: {count * n_outputs} values are right\\n");',
        "    }",
        "    return (wrong != 0U) ? 1 : 0;",
        "}",
    ]
    return "\n".join(lines) + "\n"


def _written(number: NumberType, expected: Any, bounds: Any) -> tuple[Any, list[Any]]:
    """Expected values and bounds as numbers of C."""
    if number.whole:
        exact = np.rint(expected * _PARTS).astype(np.int64)
        return exact, [np.int64(b) for b in np.ceil(bounds * _PARTS)]
    # Half a unit in the last place more: the expected value is rounded too.
    return expected.astype(number.dtype), [number.dtype(b) for b in bounds]


def _is_wrong(number: NumberType, wide: str) -> list[str]:
    head = f"static unsigned int is_wrong({number.c_type} found, {wide} wanted, {wide} most)"
    if number.whole:
        return [
            "/* Whether a value differs from the wanted one by more than its bound. */",
            head,
            "{",
            f"    const int32_t apart = ((int32_t)found * {_PARTS}) - wanted;",
            "    return ((apart > most) || (apart < -most)) ? 1U : 0U;",
            "}",
        ]
    return [
        "/* Whether a value is farther from the wanted one than its bound, or only one is NaN. */",
        head,
        "{",
        f"    const {wide} apart = found - wanted;",
        "    const int near = (apart <= most) && (apart >= -most);",
        "    const int both = (wanted != wanted) && (found != found);",
        "    return ((near != 0) || (both != 0)) ? 0U : 1U;",
        "}",
    ]


def _rows(c_type: str, name: str, shape: str, values: Any) -> list[str]:
    """A constant array of two dimensions, a row to a line, its columns aligned."""
    words = [[_word(v) for v in row] for row in values]
    widths = [max(map(len, column)) for column in zip(*words, strict=True)]
    lines = [
        "    { " + ", ".join(w.rjust(n) for w, n in zip(row, widths, strict=True)) + " },"
        for row in words
    ]
    return [f"static const {c_type} {name}{shape} = {{", *lines, "};"]


def _word(value: Any) -> str:
    """A number; those that are none by the macros of <math.h>."""
    if isinstance(value, np.integer) or np.isfinite(value):
        return literal(value)
    sign = "-" if value < 0 else ""
    kind = "float" if isinstance(value, np.float32) else "double"
    return f"({kind})NAN" if np.isnan(value) else f"({kind}){sign}INFINITY"
