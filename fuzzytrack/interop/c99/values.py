"""Values of a function while it is written in C: known now, or computed by C code.

A *form* is the type of a value in C: one of `NUMBER`, `WHOLE` and `TRUTH`; a tuple of forms; a
`Room` of numbers that are read and written by index; or `Fixed`, what is known now and is not
passed in C at all.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

__all__ = [
    "ATOM", "BITWISE", "CHOICE", "COMPARED", "EQUAL", "LARGEST_INT32", "LARGEST_INT64", "LOGICAL",
    "NUMBER", "POSTFIX", "PRODUCT", "SUM", "TRUTH", "UNARY", "WHOLE", "Fixed", "Form", "Known",
    "Room", "Row", "Scalar", "Space", "Value", "Whole", "constant_tuple", "form_of", "joined",
    "leaves", "scalar_kind",
]  # fmt: skip

#: Kinds of scalars: a floating-point number, an integer, a truth value.
NUMBER, WHOLE, TRUTH = "number", "whole", "truth"
_ORDER = (TRUTH, WHOLE, NUMBER)
#: Largest magnitudes of integers that are written as ``int32_t``, and as ``int64_t``, where a bit
#: is left to spare.
LARGEST_INT32, LARGEST_INT64 = 2.0**31 - 1, 2.0**62

#: Ranks of C operators: an operand of a higher rank stands in parentheses.
ATOM, POSTFIX, UNARY, PRODUCT, SUM, COMPARED, EQUAL, BITWISE, LOGICAL, CHOICE = range(10)


@dataclass(frozen=True)
class Room:
    """Form of numbers in memory, `length` of them."""

    length: int


@dataclass(frozen=True)
class Whole:
    """Form of an integer argument within limits."""

    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Fixed:
    """Form of a value that is known now: equal for the same object, or equal constants."""

    value: Any

    def _key(self) -> Any:
        value = self.value
        if isinstance(value, bool | int | float | str | None):
            # 0.0 and -0.0 differ, and NaN is like NaN.
            return type(value).__name__, repr(value)
        if constant_tuple(value):
            return "tuple", repr(value)
        return "object", id(value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Fixed) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())


#: NUMBER, WHOLE or TRUTH; a tuple of forms; Room; Whole; Fixed.
Form = Any


@dataclass(frozen=True)
class Known:
    """A value that is known now.

    Attributes
    ----------
    value : object
    name : str
        Of a number, what it is called where it comes from; empty if it is written out.
    """

    value: Any
    name: str = ""


@dataclass(frozen=True)
class Scalar:
    """An expression in C.

    Attributes
    ----------
    text : str
    kind : str
        `NUMBER`, `WHOLE` or `TRUTH`.
    rank : int
        Rank of its outermost operator.
    low, high : float
        Limits of its value, unless it is NaN.
    """

    text: str
    kind: str
    rank: int = ATOM
    low: float = -math.inf
    high: float = math.inf


@dataclass(frozen=True)
class Row:
    """A tuple.

    Attributes
    ----------
    items : tuple of Value
    whole : str
        Name of the struct in C of which they are members; empty if there is none.
    """

    items: tuple[Value, ...]
    whole: str = ""


@dataclass(frozen=True)
class Space:
    """Numbers in memory: the name of a pointer or an array in C."""

    text: str
    length: int


Value = Known | Scalar | Row | Space


def constant_tuple(value: Any) -> bool:
    """Whether a value is a tuple of numbers, or of such tuples."""
    return type(value) is tuple and all(
        isinstance(item, bool | int | float | np.generic) or constant_tuple(item) for item in value
    )


def scalar_kind(value: Any) -> str | None:
    """Kind of a Python value that is one scalar; None for others."""
    if isinstance(value, bool | np.bool_):
        return TRUTH
    if isinstance(value, int | np.integer):
        return WHOLE
    return NUMBER if isinstance(value, float | np.floating) else None


def form_of(value: Value, *, passed: bool = False) -> Form:
    """Form of a value.

    Parameters
    ----------
    value : Value
    passed : bool
        Whether it is an argument: functions are written for the integers, truth values and
        constant tuples that they are given, and not for floating-point numbers.
    """
    if isinstance(value, Scalar):
        if passed and value.kind == WHOLE and max(-value.low, value.high) < 2.0**31 - 1:
            return Whole(value.low, value.high)
        return value.kind
    if isinstance(value, Space):
        return Room(value.length)
    if isinstance(value, Row):
        forms = (form_of(item, passed=passed) for item in value.items)
        return tuple(WHOLE if isinstance(form, Whole) else form for form in forms)
    kind = scalar_kind(value.value)
    if kind is None and not passed and constant_tuple(value.value):
        return tuple(form_of(Known(item)) for item in value.value)
    return Fixed(value.value) if kind is None or (passed and kind != NUMBER) else kind


def joined(first: Form, second: Form) -> Form | None:
    """Form for values of either form; None if there is none."""
    if first == second:
        return first
    if first in _ORDER and second in _ORDER:
        return max(first, second, key=_ORDER.index)
    if isinstance(first, tuple) and isinstance(second, tuple) and len(first) == len(second):
        parts = [joined(a, b) for a, b in zip(first, second, strict=True)]
        return None if None in parts else tuple(parts)
    return None


def leaves(form: Form) -> Iterator[str]:
    """Kinds of the scalars in a form, in order; what is fixed is left out."""
    if isinstance(form, tuple):
        for part in form:
            yield from leaves(part)
    elif form in _ORDER:
        yield form
