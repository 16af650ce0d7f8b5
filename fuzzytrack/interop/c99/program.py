"""A C program that is written function by function: its constants, structs and functions."""

from __future__ import annotations

import ast
import math
import re
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from types import FunctionType

import numpy as np

from fuzzytrack.interop.c99.arithmetic import TYPES, arithmetic
from fuzzytrack.interop.c99.blocks import Block, Costs
from fuzzytrack.interop.c99.identifiers import is_free_name
from fuzzytrack.interop.c99.python_source import Definition, FloatRangeError
from fuzzytrack.interop.c99.values import (
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
    Value,
    leaves,
)
from fuzzytrack.kernels.rebuild import rounded, table

__all__ = ["Program", "Written", "number_text"]

#: Functions of C's mathematical library that Python's `math` has with the same meaning.
_LIBRARY = frozenset(
    {"acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "copysign", "cos",
     "cosh", "erf", "erfc", "exp2", "expm1", "fmod", "hypot", "log10", "log1p", "log2", "sin",
     "sinh", "tan", "tanh"}
)  # fmt: skip


_LINE = 100
#: Functions of C that compilers know.
_TAKEN = _LIBRARY | {
    "abs", "ceil", "exp", "fabs", "floor", "log", "memcpy", "memset", "pow", "round", "sqrt",
    "trunc",
}  # fmt: skip


@dataclass(frozen=True)
class Written:
    """A function in C.

    Attributes
    ----------
    name : str
    text : str
        Its definition.
    result : Form
        Fixed(None) for none.
    used : tuple of bool
        For each parameter in C, whether it is there; those that nothing reads are not.
    writes : tuple of bool
        For each parameter in C, whether the numbers in memory to which it points are changed.
    costs : Counter
        Operations of a call.
    """

    name: str
    text: str
    result: Form
    used: tuple[bool, ...]
    writes: tuple[bool, ...]
    costs: Costs


class Program:
    """Collects the parts of a C program.

    Parameters
    ----------
    name : str
        What all names of the program begin with.
    number : {"double", "float"}
        Its type of number.
    libm : collection of str
        Functions of C's mathematical library that it may call.
    taken : collection of str
        Names that are used already.
    """

    def __init__(
        self, name: str, number: str = "double", libm: Sequence[str] = (),
        taken: Sequence[str] = (),
    ) -> None:  # fmt: skip
        if not is_free_name(name) or name in _TAKEN:
            raise ValueError(
                f"name must be a name in C (letters, digits, _) that has no meaning there, got "
                f"{name!r}"
            )
        if number not in TYPES:
            raise ValueError(f"number: unknown {number!r}; one of {', '.join(TYPES)}")
        self.name = name
        self.number = TYPES[number]
        self.libm = frozenset(libm)
        if unknown := sorted(self.libm - _LIBRARY):
            raise ValueError(f"libm: unknown {unknown[0]!r}; one of {', '.join(sorted(_LIBRARY))}")
        self.constants: dict[str, tuple[float, ...] | float] = {}
        self.structs: dict[tuple[str, ...], str] = {}
        self.helpers: set[str] = set()
        self.needs: set[str] = set()
        self.functions: list[str] = []
        self._names: set[str] = {name, *taken}
        #: Functions by what they are in Python, and the forms of their arguments.
        self.written: dict[tuple[FunctionType, tuple[Form, ...]], Written] = {}
        self.being_written: list[FunctionType] = []

    # ------------------------------------------------------------ text

    def definitions(self) -> str:
        """All of it as C text, without ``#include`` lines."""
        functions, words = self._used_functions()
        self.constants = {name: v for name, v in self.constants.items() if name in words}
        parts = [
            "#ifndef FUZZYTRACK_INLINE\n#define FUZZYTRACK_INLINE static inline\n#endif\n",
            *(self._struct_text(kinds) for kinds, name in self.structs.items() if name in words),
            *(self._constant_text(name) for name in self.constants),
            arithmetic(
                [name for name in self.helpers if f"{self.name}_{name}" in words],
                self.number, self.name,
            ).strip("\n"),
            *functions,
        ]  # fmt: skip
        text = "\n\n".join(part.strip("\n") for part in parts if part) + "\n"
        return "\n".join(_wrapped(line) for line in text.split("\n"))

    def _used_functions(self) -> tuple[list[str], set[str]]:
        """Functions that the last one calls, and the words in them; others were left over."""
        used, words = [], set(re.findall(r"\w+", self.functions[-1]))
        for text in reversed(self.functions):
            head = re.search(r"(\w+)\(", text.partition("*/\n")[2] or text)
            if text is self.functions[-1] or (head is not None and head[1] in words):
                used.append(text)
                words |= set(re.findall(r"\w+", text))
        return used[::-1], words

    @property
    def constants_bytes(self) -> int:
        """Size of the constants that are in tables, and of those that have names."""
        size = 8 if self.number == "double" else 4
        return sum(
            len(v) * (4 if _integers(v) else size) if isinstance(v, tuple) else size
            for v in self.constants.values()
        )

    def _struct_text(self, kinds: tuple[str, ...]) -> str:
        name = self.structs[kinds]
        if set(kinds) == {NUMBER}:
            members = [f"{self.number} v[{len(kinds)}];"]
        else:
            types = {NUMBER: self.number, WHOLE: "int64_t", TRUTH: "bool"}
            members = [f"{types[kind]} f{k};" for k, kind in enumerate(kinds)]
        return "\n".join(["typedef struct {", *(f"    {m}" for m in members), f"}} {name};"])

    def _constant_text(self, name: str) -> str:
        value = self.constants[name]
        if isinstance(value, float):
            return f"static const {self.number} {name} = {self.digits(value)};"
        kind, write = ("int32_t", str) if _integers(value) else (self.number, self.digits)
        lines, line = [], "   "
        for number in value:
            piece = f" {write(number)},"
            if len(line) + len(piece) > 100:
                lines.append(line)
                line = "   "
            line += piece
        head = f"static const {kind} {name}[{len(value)}] = {{"
        return "\n".join([head, *lines, line.rstrip(","), "};"])

    def origin(self, definition: Definition) -> str:
        """Where a function comes from, for a comment."""
        if definition.file.startswith("<"):
            return f"{definition.file.strip('<>')}: {definition.name}"
        function = definition.function
        words = f"{function.__module__}: {function.__qualname__}".replace(".<locals>", "")
        return words.replace("*/", "").replace("<lambda>", "lambda")

    # ------------------------------------------------------------ numbers

    def digits(self, value: float) -> str:
        """A number, written out."""
        return number_text(value, self.number)

    def _checked(self, definition: Definition, node: ast.AST, value: float) -> float:
        if self.number == "float":
            try:
                rounded(value, np.float32)
            except ValueError:
                what = f"works with {value:g}, which float lacks; use double"
                definition.refuse(node, what, FloatRangeError)
        return value

    def literal(self, definition: Definition, node: ast.AST, value: float) -> Scalar:
        """A number, written out."""
        text = self.digits(self._checked(definition, node, value))
        rank = UNARY if text[0] in "-(" else 0
        return Scalar(text, NUMBER, rank, value, value)

    def constant(self, definition: Definition, node: ast.AST, name: str, value: float) -> str:
        """Name of a constant."""
        return self._constant(name, self._checked(definition, node, value))

    def table(
        self, definition: Definition, node: ast.AST, name: str, values: Sequence[float]
    ) -> str:
        """Name of an array of constants: numbers, or integers of 32 bits."""
        if self.number == "float" and not _integers(values):
            try:
                table(tuple(values), np.float32)
            except ValueError:
                what = "works with numbers that float lacks; use double"
                definition.refuse(node, what, FloatRangeError)
        return self._constant(name, tuple(values))

    def _constant(self, name: str, value: float | tuple[float, ...]) -> str:
        base = written = f"{self.name}_{_ascii(name).strip('_')}"
        count = 1
        while written in self._names:
            if repr(self.constants.get(written)) == repr(value):
                return written
            count += 1
            written = f"{base}_{count}"
        self._names.add(written)
        self.constants[written] = value
        return written

    # ------------------------------------------------------------ tuples

    def struct(self, form: Form) -> str:
        """Type in C of a tuple; empty if it has nothing that C code has to know."""
        kinds = tuple(leaves(form))
        if not kinds:
            return ""
        if kinds not in self.structs:
            alike = set(kinds) == {NUMBER}
            mixed = sum(set(known) != {NUMBER} for known in self.structs) + 1
            name = f"{self.name}_" + (f"numbers{len(kinds)}" if alike else f"values{mixed}")
            self.structs[kinds] = name
            self._names.add(name)
        return self.structs[kinds]

    def struct_is_array(self, form: Form) -> bool:
        """Whether all values of a tuple are numbers."""
        return set(leaves(form)) == {NUMBER}

    def members(self, name: str, form: tuple[Form, ...]) -> Row:
        """A tuple that is a struct in C."""
        array = self.struct_is_array(form)
        count = 0

        def part(form: Form) -> Value:
            nonlocal count
            if isinstance(form, tuple):
                return Row(tuple(part(inner) for inner in form))
            if isinstance(form, Fixed):
                return Known(form.value)
            text = f"{name}.v[{count}]" if array else f"{name}.f{count}"
            count += 1
            return Scalar(text, form, POSTFIX)

        return Row(tuple(part(inner) for inner in form), name if self.struct(form) else "")

    def has_result(self, form: Form) -> bool:
        """Whether a function with such a result returns something in C."""
        return any(True for _ in leaves(form))

    def result_kind(self, form: Form) -> str:
        """Type in C of a result."""
        if isinstance(form, tuple):
            return self.struct(form) or "void"
        if isinstance(form, Fixed):
            return "void"
        return {NUMBER: self.number, WHOLE: "int64_t", TRUTH: "bool"}[form]

    def empty_values(self, block: Block) -> dict[str, str]:
        """Initializers of variables by their types in C."""
        simple = {self.number: self.digits(0.0), "bool": "false", "int32_t": "0", "int64_t": "0"}
        return {each.kind: simple.get(each.kind, "{0}") for each in block.assignments()}

    # ------------------------------------------------------------ functions

    def helper(self, name: str) -> str:
        """Name of a function of `fuzzytrack.interop.c99.arithmetic`."""
        self.helpers.add(name)
        return f"{self.name}_{name}"

    def library(self, definition: Definition, node: ast.AST, name: str) -> str:
        """Name of a function of C's mathematical library, if it may be used."""
        if name not in _LIBRARY:
            definition.refuse(node, f"calls math.{name}, which C99 code is not written for")
        if name not in self.libm:
            definition.refuse(
                node,
                f"calls math.{name}, which C99 has in its mathematical library only (-lm); "
                f"an exported header does without it, `compiled_c` takes libm=({name!r},)",
            )
        self.needs.add(name)
        return name + ("f" if self.number == "float" else "")

    def function_name(self, definition: Definition) -> str:
        """A name in C for a function."""
        base = name = f"{self.name}_{_ascii(definition.name).strip('_')}"
        count = 1
        while name in self._names:
            count += 1
            name = f"{base}_{count}"
        self._names.add(name)
        return name


def number_text(value: float, number: str) -> str:
    """A number as an expression of a type of number."""
    if math.isnan(value):
        return f"({number})NAN"
    if math.isinf(value):
        return f"{'-' if value < 0 else ''}({number})INFINITY"
    text = str(np.float32(value)) if number == "float" else repr(value)
    text = text if any(c in text for c in ".e") else f"{text}.0"
    return text + ("f" if number == "float" else "")


def _integers(values: Sequence[float]) -> bool:
    return all(isinstance(value, int) for value in values)


def _wrapped(line: str) -> str:
    """A line of C in lines of at most 100 characters, where it has spaces."""
    if len(line) <= _LINE or line.lstrip().startswith(("/*", "#")):
        return line
    indent = " " * (len(line) - len(line.lstrip()) + 4)
    return "\n".join(
        textwrap.wrap(
            line.strip(), _LINE, initial_indent=indent[4:], subsequent_indent=indent,
            break_long_words=False, break_on_hyphens=False,
        )
    )  # fmt: skip


def _ascii(name: str) -> str:
    return "".join(c if c.isascii() and (c.isalnum() or c == "_") else f"u{ord(c):x}" for c in name)
