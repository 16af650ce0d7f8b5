"""Arithmetic in C that Python has and C99 without its mathematical library has not.

Each piece of text is a function for one type of number, ``TYPE``, whose names begin with ``NAME_``.
Square roots are rounded correctly, so they are those of the processor to the last bit. The errors
of the others were measured, see `BOUNDS`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from fuzzytrack.interop.c99.double_functions import DOUBLE_FUNCTIONS
from fuzzytrack.interop.c99.float_functions import FLOAT_FUNCTIONS

__all__ = ["BOUNDS", "NEEDS", "TYPES", "arithmetic"]

#: Types of number, by the word that a user writes.
TYPES = {"double": "double", "float": "float"}

#: Largest relative errors of functions that are not rounded correctly, in units of 2^-52 for
#: double and 2^-23 for float: of a million arguments none had more, see `tests/fuzz_c99.py`.
#: Results below the normal numbers are within one step of those that there are.
BOUNDS = {
    ("exp", "double"): 0.7, ("exp", "float"): 0.7,
    ("log", "double"): 0.6, ("log", "float"): 0.6,
    ("cos", "double"): 0.8, ("cos", "float"): 0.6,
    ("pow", "double"): 1.3, ("pow", "float"): 1.3,
}  # fmt: skip

#: Functions that a function calls.
NEEDS = {
    "pow": ("exp", "log_parts", "two_to"), "exp": ("two_to",), "log": ("log_parts",),
    "floor_divide": ("remainder",), "modulo": ("remainder",), "floor": ("whole",),
    "ceil": ("whole",), "cos": ("circular",), "sin": ("circular",),
}  # fmt: skip

_SHARED = {
    "minimum": """
/* Python's min: the first of two that are equal or not comparable. */
INLINE TYPE NAME_minimum(TYPE a, TYPE b)
{
    return b < a ? b : a;
}
""",
    "maximum": """
/* Python's max: the first of two that are equal or not comparable. */
INLINE TYPE NAME_maximum(TYPE a, TYPE b)
{
    return b > a ? b : a;
}
""",
    "minimum_whole": """
INLINE int64_t NAME_minimum_whole(int64_t a, int64_t b)
{
    return b < a ? b : a;
}
""",
    "maximum_whole": """
INLINE int64_t NAME_maximum_whole(int64_t a, int64_t b)
{
    return b > a ? b : a;
}
""",
    "absolute": """
INLINE TYPE NAME_absolute(TYPE x)
{
    return x < ZERO ? -x : ZERO + x;
}
""",
    "absolute_whole": """
INLINE int64_t NAME_absolute_whole(int64_t x)
{
    return x >= 0 ? x : (x == INT64_MIN ? INT64_MAX : -x);
}
""",
    "add_whole": """
/* Sum of integers; the nearest integer that there is, where it is too large. */
INLINE int64_t NAME_add_whole(int64_t a, int64_t b)
{
    if (b > 0) {
        return a > INT64_MAX - b ? INT64_MAX : a + b;
    }
    return a < INT64_MIN - b ? INT64_MIN : a + b;
}
""",
    "multiply_whole": """
/* Product of integers; the nearest integer that there is, where it is too large. */
INLINE int64_t NAME_multiply_whole(int64_t a, int64_t b)
{
    bool fits = true;
    if (a > 0) {
        fits = b >= INT64_MIN / a && b <= INT64_MAX / a;
    } else if (a == -1) {
        fits = b != INT64_MIN;
    } else if (a < -1) {
        fits = b >= INT64_MAX / a && b <= INT64_MIN / a;
    }
    return fits ? a * b : ((a < 0) == (b < 0) ? INT64_MAX : INT64_MIN);
}
""",
    "floor_divide_whole": """
/* Python's // of integers, for a divisor other than 0. */
INLINE int64_t NAME_floor_divide_whole(int64_t a, int64_t b)
{
    int64_t quotient;
    if (b == -1) {
        return a == INT64_MIN ? INT64_MAX : -a;
    }
    quotient = a / b;
    return a % b != 0 && (a < 0) != (b < 0) ? quotient - 1 : quotient;
}
""",
    "modulo_whole": """
/* Python's % of integers, for a divisor other than 0. */
INLINE int64_t NAME_modulo_whole(int64_t a, int64_t b)
{
    const int64_t rest = b == -1 ? 0 : a % b;
    return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}
""",
    "place": """
/* Python's index, from the end where it is negative; the nearest one that there is, otherwise. */
INLINE int64_t NAME_place(int64_t index, int64_t length)
{
    int64_t found = index < 0 ? index + length : index;
    found = found < 0 ? 0 : found;
    return found < length ? found : length - 1;
}
""",
    "whole": """
/* Integer toward 0; the nearest integer that there is, and 0 for NaN. */
INLINE int64_t NAME_whole(TYPE x)
{
    if (x >= LIMIT) {
        return INT64_MAX;
    }
    if (x < -LIMIT) {
        return INT64_MIN;
    }
    return x == x ? (int64_t)x : 0;
}
""",
    "floor": """
INLINE int64_t NAME_floor(TYPE x)
{
    const int64_t toward_0 = NAME_whole(x);
    return toward_0 > INT64_MIN && (TYPE)toward_0 > x ? toward_0 - 1 : toward_0;
}
""",
    "ceil": """
INLINE int64_t NAME_ceil(TYPE x)
{
    const int64_t toward_0 = NAME_whole(x);
    return toward_0 < INT64_MAX && (TYPE)toward_0 < x ? toward_0 + 1 : toward_0;
}
""",
    "remainder": """
/* What is left of x after it is divided by y, with the sign of x; exact. */
INLINE TYPE NAME_remainder(TYPE x, TYPE y)
{
    const TYPE size = y < ZERO ? -y : y;
    TYPE rest = x < ZERO ? -x : x;
    TYPE part = size;
    int32_t k;
    if (!(size > ZERO) || !(rest < (TYPE)INFINITY)) {
        return (TYPE)NAN;
    }
    /* Doubling and halving are exact, and so are differences of numbers within a factor of 2. */
    for (k = 0; k < 2200 && part <= rest * HALF; ++k) {
        part = part + part;
    }
    for (; k >= 0; k -= 1) {
        rest = rest >= part ? rest - part : rest;
        part = part * HALF;
    }
    return x < ZERO ? -rest : rest;
}
""",
    "modulo": """
/* Python's % of numbers: it has the sign of the divisor. */
INLINE TYPE NAME_modulo(TYPE x, TYPE y)
{
    const TYPE rest = NAME_remainder(x, y);
    if (rest == ZERO) {
        return y < ZERO ? -ZERO : ZERO;
    }
    return (rest < ZERO) == (y < ZERO) ? rest : rest + y;
}
""",
    "floor_divide": """
/* Python's // of numbers. */
INLINE TYPE NAME_floor_divide(TYPE x, TYPE y)
{
    const TYPE rest = NAME_remainder(x, y);
    TYPE quotient = (x - rest) / y;
    TYPE below;
    if (y == ZERO) {
        return x / y;
    }
    if (rest != ZERO && (rest < ZERO) != (y < ZERO)) {
        quotient = quotient - ONE;
    }
    if (quotient == ZERO) {
        /* With the sign of the exact quotient. */
        return x / y * ZERO;
    }
    /* Whole already, if it is so large, or not finite. */
    if (!(quotient < LARGE && quotient > -LARGE)) {
        return quotient;
    }
    below = (TYPE)(int64_t)quotient;
    below = below > quotient ? below - ONE : below;
    return quotient - below > HALF ? below + ONE : below;
}
""",
    "cos": """
INLINE TYPE NAME_cos(TYPE x)
{
    return NAME_circular(x, 0);
}
""",
    "sin": """
INLINE TYPE NAME_sin(TYPE x)
{
    return NAME_circular(x, 3);
}
""",
    "log": """
/* Natural logarithm. */
INLINE TYPE NAME_log(TYPE x)
{
    TYPE high;
    TYPE low;
    if (!(x > ZERO)) {
        return x == ZERO ? -(TYPE)INFINITY : (TYPE)NAN;
    }
    if (x == (TYPE)INFINITY) {
        return x;
    }
    NAME_log_parts(x, &high, &low);
    return high + low;
}
""",
}

_WORDS = {
    "double": {
        "ZERO": "0.0", "ONE": "1.0", "HALF": "0.5",
        "LIMIT": "9223372036854775808.0", "LARGE": "4503599627370496.0",
    },
    "float": {
        "ZERO": "0.0f", "ONE": "1.0f", "HALF": "0.5f",
        "LIMIT": "9223372036854775808.0f", "LARGE": "8388608.0f",
    },
}  # fmt: skip


def arithmetic(names: Iterable[str], number: str, prefix: str) -> str:
    """Text of functions and of those that they call, each once, before it is called.

    Parameters
    ----------
    names : iterable of str
        ``sqrt``, ``exp`` and so on.
    number : {"double", "float"}
    prefix : str
        What their names begin with.
    """
    wanted: dict[str, None] = {}

    def want(name: str) -> None:
        for needed in NEEDS.get(name, ()):
            want(needed)
        wanted[name] = None

    for name in sorted(names):
        want(name)
    texts = {**_SHARED, **(DOUBLE_FUNCTIONS if number == "double" else FLOAT_FUNCTIONS)}
    text = "".join(texts[name] for name in wanted)
    words = {"INLINE": "FUZZYTRACK_INLINE", "TYPE": TYPES[number], "NAME_": f"{prefix}_"}
    words |= _WORDS[number]
    return re.sub(rf"NAME_|\b(?:{'|'.join(words)})\b", lambda found: words[found[0]], text)
