"""A C program that is written function by function: its constants, structs and functions."""

from __future__ import annotations

import ast
import math
import re
import textwrap
from collections.abc import Sequence
from types import FunctionType

import numpy as np

from fuzzytrack.interop.c99.arithmetic import TYPES, arithmetic
from fuzzytrack.interop.c99.blocks import Assignment, Block
from fuzzytrack.interop.c99.calls import CallWriter
from fuzzytrack.interop.c99.expressions import ExpressionWriter
from fuzzytrack.interop.c99.function_writer import FunctionWriter, Written
from fuzzytrack.interop.c99.python_source import Definition, definition_of
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
    Space,
    Value,
    form_of,
    leaves,
)
from fuzzytrack.kernels.rebuild import rounded, table

__all__ = ["Program"]

#: Functions of C's mathematical library that Python's `math` has with the same meaning.
_LIBRARY = frozenset(
    {"acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "copysign", "cos",
     "cosh", "erf", "erfc", "exp2", "expm1", "fmod", "hypot", "log10", "log1p", "log2", "sin",
     "sinh", "tan", "tanh"}
)  # fmt: skip


_LINE = 100


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
    """

    def __init__(self, name: str, number: str = "double", libm: Sequence[str] = ()) -> None:
        if not (name.isascii() and name.isidentifier()):
            raise ValueError(f"name must be a name in C (letters, digits, _), got {name!r}")
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
        self._names: set[str] = {name}
        self._written: dict[tuple[FunctionType, tuple[Form, ...]], Written] = {}
        self._being_written: list[FunctionType] = []

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
        sizes = (len(v) if isinstance(v, tuple) else 1 for v in self.constants.values())
        return sum(sizes) * (8 if self.number == "double" else 4)

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
            return f"static const {self.number} {name} = {self._digits(value)};"
        lines, line = [], "   "
        for number in value:
            piece = f" {self._digits(number)},"
            if len(line) + len(piece) > 100:
                lines.append(line)
                line = "   "
            line += piece
        head = f"static const {self.number} {name}[{len(value)}] = {{"
        return "\n".join([head, *lines, line.rstrip(","), "};"])

    def origin(self, definition: Definition) -> str:
        """Where a function comes from, for a comment."""
        if definition.file.startswith("<"):
            return f"{definition.file.strip('<>')}: {definition.name}"
        function = definition.function
        words = f"{function.__module__}: {function.__qualname__}".replace(".<locals>", "")
        return words.replace("*/", "").replace("<lambda>", "lambda")

    # ------------------------------------------------------------ numbers

    def _digits(self, value: float) -> str:
        if math.isnan(value):
            return f"({self.number})NAN"
        if math.isinf(value):
            return f"{'-' if value < 0 else ''}({self.number})INFINITY"
        text = str(np.float32(value)) if self.number == "float" else repr(value)
        text = text if any(c in text for c in ".e") else f"{text}.0"
        return text + ("f" if self.number == "float" else "")

    def _checked(self, writer: ExpressionWriter, node: ast.AST, value: float) -> float:
        if self.number == "float":
            try:
                rounded(value, np.float32)
            except ValueError:
                writer.refuse(node, f"works with {value:g}, which float lacks; use double")
        return value

    def literal(self, writer: ExpressionWriter, node: ast.AST, value: float) -> Scalar:
        """A number, written out."""
        text = self._digits(self._checked(writer, node, value))
        rank = UNARY if text[0] in "-(" else 0
        return Scalar(text, NUMBER, rank, value, value)

    def constant(self, writer: ExpressionWriter, node: ast.AST, name: str, value: float) -> str:
        """Name of a constant."""
        return self._constant(name, self._checked(writer, node, value))

    def table(self, writer: ExpressionWriter, node: ast.AST, name: str, values: list[float]) -> str:
        """Name of an array of constants."""
        if self.number == "float":
            try:
                table(tuple(values), np.float32)
            except ValueError:
                writer.refuse(node, "works with numbers that float lacks; use double")
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
        simple = {self.number: self._digits(0.0), "bool": "false", "int32_t": "0", "int64_t": "0"}
        return {each.kind: simple.get(each.kind, "{0}") for each in block.assignments()}

    # ------------------------------------------------------------ functions

    def helper(self, name: str) -> str:
        """Name of a function of `fuzzytrack.interop.c99.arithmetic`."""
        self.helpers.add(name)
        return f"{self.name}_{name}"

    def library(self, writer: ExpressionWriter, node: ast.AST, name: str) -> str:
        """Name of a function of C's mathematical library, if it may be used."""
        if name not in _LIBRARY:
            writer.refuse(node, f"calls math.{name}, which C99 code is not written for")
        if name not in self.libm:
            writer.refuse(
                node,
                f"calls math.{name}, which C99 has in its mathematical library only (-lm); allow "
                f"it with libm=({name!r},)",
            )
        self.needs.add(name)
        return name + ("f" if self.number == "float" else "")

    def call(
        self, writer: CallWriter, node: ast.Call, function: FunctionType, given: Sequence[Value]
    ) -> Value:
        """Value of a call, with the function written first if it is new."""
        forms = tuple(form_of(value, passed=True) for value in given)
        if any(function is other for other in self._being_written):
            writer.refuse(node, f"calls {function.__name__}, which calls itself")
        written = self.function(function, forms)
        texts, k = [], 0
        for value, form in zip(given, forms, strict=True):
            if isinstance(form, Fixed) or (isinstance(form, tuple) and not self.struct(form)):
                continue
            if written.writes[k]:
                assert isinstance(value, Space)
                self._allow_change(writer, node, value)
            if written.used[k]:
                texts.append(self._argument(writer, node, value, form))
            k += 1
        writer.block.costs.update(written.costs)
        writer.cost("calls")
        return self._result(writer, written, f"{written.name}({', '.join(texts)})")

    def _allow_change(self, writer: CallWriter, node: ast.Call, value: Space) -> None:
        """See that what is computed before a call is computed before it in C, too."""
        assert isinstance(writer, FunctionWriter)
        if writer.whole_call is not node:
            writer.refuse(node, "changes numbers in memory in the midst of a statement")
        writer.changed.add(value.text)

    def _argument(self, writer: CallWriter, node: ast.Call, value: Value, form: Form) -> str:
        if isinstance(value, Space):
            return value.text
        if isinstance(form, tuple):
            return writer.structure(node, value, form)
        return writer.scalar(node, writer.converted(node, value, form)).text

    def _result(self, writer: CallWriter, written: Written, call: str) -> Value:
        if not self.has_result(written.result):
            if any(written.writes):
                writer.statement(f"{call};")
            form = written.result
            return self.members("", form) if isinstance(form, tuple) else Known(form.value)
        kind = self.result_kind(written.result)
        if isinstance(written.result, tuple):
            name = writer.temporary(kind, call)
            self._keep(writer, written)
            return self.members(name, written.result)
        if any(written.writes):
            name = writer.temporary(kind, call)
            self._keep(writer, written)
            return Scalar(name, written.result)
        return Scalar(call, written.result, POSTFIX)

    def _keep(self, writer: CallWriter, written: Written) -> None:
        """Let a call that changes numbers in memory stay, even if nothing reads its result."""
        last = writer.block.items[-1]
        assert isinstance(last, Assignment)
        last.used = any(written.writes)

    def function(self, function: FunctionType, forms: tuple[Form, ...]) -> Written:
        """A function in C for arguments of given forms."""
        key = (function, forms)
        if key not in self._written:
            definition = definition_of(function)
            self._being_written.append(function)
            try:
                name = self._function_name(definition)
                self._written[key] = FunctionWriter(self, definition, name, forms).written()
            finally:
                self._being_written.pop()
            self.functions.append(self._written[key].text)
        return self._written[key]

    def _function_name(self, definition: Definition) -> str:
        base = name = f"{self.name}_{_ascii(definition.name).strip('_')}"
        count = 1
        while name in self._names:
            count += 1
            name = f"{base}_{count}"
        self._names.add(name)
        return name


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
