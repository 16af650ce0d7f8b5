"""C source of a program that checks a header against values of the library."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.interop.c99.c_text import comment_lines, literal
from fuzzytrack.interop.c99.error_bound import ErrorBound
from fuzzytrack.interop.c99.number_types import NumberType
from fuzzytrack.interop.c99.signature import Signature
from fuzzytrack.interop.c99.vectors import Vectors
from fuzzytrack.reprs import summary

__all__ = ["Check", "check_lines", "constant_rows", "infer_check", "selftest_text"]

#: Parts of a step in which expected integers are written.
_PARTS = 256


@dataclass(frozen=True)
class Check:
    """A function that counts wrong values.

    Attributes
    ----------
    function : str
        Its name; it takes nothing and returns an ``unsigned int``.
    values : int
        How many values it compares.
    lines : list of str
        Its definition.
    """

    function: str
    values: int
    lines: list[str]

    def __repr__(self) -> str:
        return summary(self, "function", "values")


def selftest_text(name: str, header: str, number: NumberType, checks: Sequence[Check]) -> str:
    """Source of the program.

    Parameters
    ----------
    name : str
        For the line that is printed.
    header : str
        Name of the header file.
    number : NumberType
    checks : sequence of Check
    """
    unit = f"1/{_PARTS} of a step" if number.whole else "the unit of an output"
    says = re.sub(r"[^A-Za-z0-9_.-]", "_", name)
    lines = [
        *comment_lines(
            [
                ("", f"Self-test of {header}: prints one line, and ends with 0 if all is right."),
                ("", f"Expected values are those of the library. They and bounds are in {unit}."),
            ]
        ),
        *([] if number.whole else ["#include <math.h>"]),
        "#include <stdio.h>",
        f'#include "{header}"',
        "",
        *_is_wrong(number),
        "",
    ]
    for check in checks:
        lines += [*check.lines, ""]
    lines += [
        "int main(void)",
        "{",
        "    unsigned int wrong = 0U;",
        *(f"    wrong += {check.function}();" for check in checks),
        "    if (wrong != 0U) {",
        f'        (void)printf("{says}: %u values are wrong\\n", wrong);',
        "    } else {",
        f'        (void)printf("{says}: {sum(c.values for c in checks)} values are right\\n");',
        "    }",
        "    return (wrong != 0U) ? 1 : 0;",
        "}",
    ]
    return "\n".join(lines) + "\n"


def infer_check(names: Signature, number: NumberType, checked: Vectors, bound: ErrorBound) -> Check:
    """Check of the function of a rule base."""
    count, n_inputs = checked.inputs.shape
    n_outputs = len(names.outputs)
    expected, bounds = _written(number, checked.expected, bound.bounds)
    wide = _wide(number)
    arguments = ", ".join(f"given[row][{k}]" for k in range(n_inputs))
    data = [
        f"/* {', '.join(names.inputs)} */",
        *constant_rows(number.c_type, "given", checked.inputs),
        f"/* {', '.join(names.outputs)} */",
        *constant_rows(wide, "expected", expected),
        f"static const {wide} bound[{n_outputs}] = {{ {', '.join(map(literal, bounds))} }};",
    ]
    body = [
        "unsigned int wrong = 0U;",
        "unsigned int row;",
        "unsigned int k;",
        "",
        f"for (row = 0U; row < {count}U; row++) {{",
        f"    const {names.structure} y = {names.function}({arguments});",
        f"    {number.c_type} found[{n_outputs}];",
        *(f"    found[{k}] = y.{member};" for k, member in enumerate(names.outputs)),
        f"    for (k = 0U; k < {n_outputs}U; k++) {{",
        "        wrong += is_wrong(found[k], expected[row][k], bound[k]);",
        "    }",
        "}",
        "return wrong;",
    ]
    return Check("infer_check", count * n_outputs, check_lines("infer_check", data, body))


def check_lines(function: str, data: list[str], body: list[str]) -> list[str]:
    """Definition of a function that counts wrong values: its data, and what it does."""
    inside = [f"    {line}" if line else "" for line in (*data, *body)]
    return [f"static unsigned int {function}(void)", "{", *inside, "}"]


def _wide(number: NumberType) -> str:
    return "int32_t" if number.whole else number.c_type


def _written(number: NumberType, expected: Any, bounds: Any) -> tuple[Any, list[Any]]:
    """Expected values and bounds as numbers of C."""
    if number.whole:
        exact = np.rint(expected * _PARTS).astype(np.int64)
        return exact, [np.int64(b) for b in np.ceil(bounds * _PARTS)]
    return expected.astype(number.dtype), [number.dtype(b) for b in bounds]


def _is_wrong(number: NumberType) -> list[str]:
    """Function that compares a value."""
    wide = _wide(number)
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
        "    return (((apart <= most) && (apart >= -most)) ||",
        "            ((wanted != wanted) && (found != found))) ? 0U : 1U;",
        "}",
    ]


def constant_rows(c_type: str, name: str, values: Any) -> list[str]:
    """A constant array of two dimensions, a row to a line, its columns aligned."""
    words = [[_word(v) for v in row] for row in values]
    widths = [max(map(len, column)) for column in zip(*words, strict=True)]
    lines = [
        "    { " + ", ".join(w.rjust(n) for w, n in zip(row, widths, strict=True)) + " },"
        for row in words
    ]
    rows, columns = len(words), len(widths)
    return [f"static const {c_type} {name}[{rows}][{columns}] = {{", *lines, "};"]


def _word(value: Any) -> str:
    """A number; those that are none by the macros of <math.h>."""
    if isinstance(value, np.integer) or np.isfinite(value):
        return literal(value)
    sign = "-" if value < 0 else ""
    kind = "float" if isinstance(value, np.float32) else "double"
    return f"({kind})NAN" if np.isnan(value) else f"({kind}){sign}INFINITY"
