"""Values in C in other forms, and the statements that they need."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from typing import NoReturn

import numpy as np

from fuzzytrack.interop.c99.blocks import Assignment, Block, Line
from fuzzytrack.interop.c99.program import Program
from fuzzytrack.interop.c99.python_source import Definition
from fuzzytrack.interop.c99.values import (
    ATOM,
    BITWISE,
    CHOICE,
    EQUAL,
    LARGEST_INT32,
    LARGEST_INT64,
    NUMBER,
    POSTFIX,
    TRUTH,
    UNARY,
    WHOLE,
    Fixed,
    Form,
    Known,
    Row,
    Scalar,
    Space,
    Value,
    Whole,
    form_of,
    scalar_kind,
)

__all__ = [
    "ConversionWriter",
    "describe",
    "describe_form",
    "flat",
    "inside",
    "operand",
    "whole_constant",
    "wording",
]


class ConversionWriter:
    """Writes values of one function in the forms that are needed, with statements in `block`.

    Parameters
    ----------
    program : Program
        Where helpers and constants are collected.
    definition : Definition
    """

    def __init__(self, program: Program, definition: Definition) -> None:
        self.program = program
        self.definition = definition
        self.variables: dict[str, Value] = {}
        self.local: set[str] = set()
        self.block = Block()
        self.temporaries = 0

    # ------------------------------------------------------------ helpers

    def refuse(self, node: ast.AST, what: str) -> NoReturn:
        """Raise TranslationError about a part of the function."""
        self.definition.refuse(node, what)

    def cost(self, operation: str, times: int = 1) -> None:
        """Count operations in the block that is being written."""
        self.block.costs[operation] += times

    def temporary(self, kind: str, text: str) -> str:
        """Name of a new variable with the value of an expression."""
        self.temporaries += 1
        name = f"t{self.temporaries}"
        self.block.items.append(Assignment(name, kind, text))
        return name

    def held(self, value: Scalar) -> Scalar:
        """The same scalar as a name, which can be written several times."""
        if value.rank == ATOM:
            return value
        name = self.temporary(self.c_kind(value), value.text)
        return Scalar(name, value.kind, ATOM, value.low, value.high)

    def c_kind(self, value: Scalar) -> str:
        """Type in C of a scalar."""
        if value.kind == NUMBER:
            return self.program.number
        if value.kind == TRUTH:
            return "bool"
        return (
            "int32_t" if value.low >= -LARGEST_INT32 and value.high <= LARGEST_INT32 else "int64_t"
        )

    def within(self, block: Block, write: Callable[[], Value]) -> Value:
        """Value of what is written into another block."""
        outer, self.block = self.block, block
        try:
            return write()
        finally:
            self.block = outer

    def value(self, node: ast.expr) -> Value:
        """Value of an expression."""
        raise NotImplementedError

    def statement(self, text: str) -> None:
        """Add a statement to the block."""
        self.block.items.append(Line(text))

    def helper(self, name: str, kind: str, *arguments: Scalar) -> Scalar:
        """Call of a function of `fuzzytrack.interop.c99.arithmetic`."""
        texts = ", ".join(argument.text for argument in arguments)
        return Scalar(f"{self.program.helper(name)}({texts})", kind, POSTFIX)

    # ------------------------------------------------------------ conversions

    def scalar(self, node: ast.AST, value: Value) -> Scalar:
        """A value as a scalar in C."""
        if isinstance(value, Scalar):
            return value
        if isinstance(value, Known):
            kind = scalar_kind(value.value)
            if kind is not None:
                return self._known_scalar(node, value, kind)
        return self.refuse(node, f"uses {describe(value)} where a number is needed")

    def _known_scalar(self, node: ast.AST, value: Known, kind: str) -> Scalar:
        if kind == TRUTH:
            return Scalar("true" if value.value else "false", TRUTH)
        if kind == WHOLE:
            whole = int(value.value)
            if abs(whole) > LARGEST_INT64:
                self.refuse(node, f"uses the integer {whole}; at most 62 bits can be written in C")
            return whole_constant(whole)
        number = float(value.value)
        if value.name and math.isfinite(number):
            return Scalar(self.program.constant(self.definition, node, value.name, number), NUMBER)
        return self.program.literal(self.definition, node, number)

    def number(self, node: ast.AST, value: Value) -> Scalar:
        """A value as a floating-point number in C."""
        if isinstance(value, Known) and scalar_kind(value.value) in (WHOLE, TRUTH):
            value = Known(float(value.value))
        found = self.scalar(node, value)
        if found.kind == NUMBER:
            return found
        text = f"({self.program.number}){inside(found, UNARY)}"
        return Scalar(text, NUMBER, UNARY, found.low, found.high)

    def whole(self, node: ast.AST, value: Value) -> Scalar:
        """A value as an integer in C; refused if it is a number."""
        found = self.scalar(node, value)
        if found.kind == NUMBER:
            self.refuse(node, "uses a floating-point number where an integer is needed")
        if found.kind == TRUTH:
            return Scalar(f"(int32_t){inside(found, UNARY)}", WHOLE, UNARY, 0.0, 1.0)
        return found

    def truth(self, node: ast.AST, value: Value) -> Known | Scalar:
        """Whether a value is true: known now, or a truth value in C."""
        if isinstance(value, Known):
            if isinstance(value.value, np.ndarray):
                self.refuse(node, "uses an array as a condition")
            return Known(bool(value.value))
        if isinstance(value, Row):
            return Known(bool(value.items))
        if not isinstance(value, Scalar):
            return self.refuse(node, f"uses {describe(value)} as a condition")
        if value.kind == TRUTH:
            return value
        self.cost("comparisons")
        zero = "0" if value.kind == WHOLE else self.program.literal(self.definition, node, 0.0).text
        return Scalar(f"{inside(value, EQUAL)} != {zero}", TRUTH, EQUAL)

    def row(self, node: ast.AST, value: Value) -> Row:
        """A value as a tuple."""
        if isinstance(value, Row):
            return value
        if isinstance(value, Known) and isinstance(value.value, tuple):
            return Row(tuple(Known(item) for item in value.value))
        return self.refuse(node, f"uses {describe(value)} where a tuple is needed")

    def converted(self, node: ast.AST, value: Value, form: Form) -> Value:
        """A value in another form that it can have."""
        if isinstance(form, tuple):
            items = self.row(node, value).items
            if len(items) == len(form):
                return Row(
                    tuple(self.converted(node, i, f) for i, f in zip(items, form, strict=True)),
                    value.whole if isinstance(value, Row) and form_of(value) == form else "",
                )
        elif form == NUMBER:
            return self.number(node, value)
        elif form == WHOLE or isinstance(form, Whole):
            return self.whole(node, value)
        elif form == TRUTH:
            found = self.scalar(node, value)
            if found.kind == TRUTH:
                return found
        elif isinstance(form, Fixed) and form_of(value, passed=True) == form:
            return value
        return self.refuse(node, f"uses {describe(value)} where {describe_form(form)} is needed")

    def structure(self, node: ast.AST, value: Value, form: Form) -> str:
        """A tuple as one expression in C: the name of a struct, or a new one."""
        made = self.converted(node, value, form)
        if isinstance(made, Row) and made.whole:
            return made.whole
        texts = [_member(self.scalar(node, leaf)) for leaf in flat(made)]
        kind = self.program.struct(form)
        braces = ("{{", "}}") if self.program.struct_is_array(form) else ("{", "}")
        return f"({kind}){braces[0]}{', '.join(texts)}{braces[1]}"


def _member(value: Scalar) -> str:
    """A value as a member of a struct: C++ does not take an integer for a truth value there."""
    integer = value.kind == TRUTH and value.rank in (BITWISE, CHOICE)
    return f"(bool)({value.text})" if integer else value.text


def flat(value: Value) -> list[Value]:
    """All scalars in a value, in order; what is known now and no number is left out."""
    if isinstance(value, Row):
        return [leaf for item in value.items for leaf in flat(item)]
    fixed = isinstance(value, Known) and scalar_kind(value.value) is None
    return [] if fixed else [value]


def inside(value: Scalar, rank: int) -> str:
    """Text of an operand of an operator of that rank."""
    return f"({value.text})" if value.rank > rank else value.text


def operand(value: Scalar, rank: int, *, last: bool = False) -> str:
    """As `inside`, with parentheses also around another operator that comes first anyway.

    Without them are only operators of the same rank, if they are not in the last operand.
    """
    alone = value.rank <= UNARY or (value.rank == rank and not last)
    return value.text if alone else f"({value.text})"


def whole_constant(value: int) -> Scalar:
    """An integer in C."""
    large = abs(value) > LARGEST_INT32
    text = f"INT64_C({abs(value)})" if large else str(abs(value))
    rank = UNARY if value < 0 else ATOM
    return Scalar(f"-{text}" if value < 0 else text, WHOLE, rank, float(value), float(value))


def describe(value: Value) -> str:
    """Words for a value, for messages."""
    if isinstance(value, Row):
        return f"a tuple of {len(value.items)} values"
    if isinstance(value, Space):
        return "numbers in memory"
    if isinstance(value, Scalar):
        return {NUMBER: "a number", WHOLE: "an integer", TRUTH: "a truth value"}[value.kind]
    kind = type(value.value).__name__
    name = getattr(value.value, "__name__", None) or repr(value.value)
    return f"{name} ({kind})"


def describe_form(form: Form) -> str:
    """Words for a form, for messages."""
    if isinstance(form, tuple):
        return f"a tuple of {len(form)} values"
    words = {NUMBER: "a number", WHOLE: "an integer", TRUTH: "a truth value"}
    return words[form] if isinstance(form, str) else "the same value as elsewhere"


def wording(node: ast.AST) -> str:
    """Words for a part of Python, for messages."""
    special = {
        "ListComp": "a list comprehension", "GeneratorExp": "a generator", "Dict": "a dictionary",
        "List": "a list", "Set": "a set", "Lambda": "a function inside of it",
        "FunctionDef": "a function inside of it", "JoinedStr": "a text", "While": "`while`, a loop "
        "without a constant bound", "Try": "`try`", "Raise": "`raise`", "With": "`with`",
        "Assert": "`assert`", "Delete": "`del`", "In": "`in`", "NotIn": "`not in`",
        "Yield": "`yield`", "Await": "`await`", "Import": "`import`", "ImportFrom": "`import`",
        "Global": "`global`", "Nonlocal": "`nonlocal`", "NamedExpr": "`:=`", "Starred": "`*`",
        "Match": "`match`", "ClassDef": "a class",
    }  # fmt: skip
    kind = type(node).__name__
    return special.get(kind, f"`{kind}`")
