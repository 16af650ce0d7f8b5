"""Variables of a function in C: their names, their forms, and assignments to them."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator
from itertools import count

from fuzzytrack.interop.c99.calls import CallWriter
from fuzzytrack.interop.c99.conversions import describe
from fuzzytrack.interop.c99.identifiers import c_identifier
from fuzzytrack.interop.c99.program import Program
from fuzzytrack.interop.c99.python_source import Definition
from fuzzytrack.interop.c99.values import (
    NUMBER,
    TRUTH,
    WHOLE,
    Fixed,
    Form,
    Known,
    Row,
    Scalar,
    Space,
    Value,
    form_of,
    joined,
)

__all__ = ["AssignmentWriter", "WriteAgain", "is_temporary"]

_WIDENINGS = 3

#: Functions that C code calls by name, beside words of C.
_WORDS = frozenset({"memcpy", "memset", "own_numbers"})


class WriteAgain(Exception):  # noqa: N818 - not an error: a form was found that is wider
    """A variable or a result has another form than was thought; write the function again."""


class AssignmentWriter(CallWriter):
    """Writes the assignments of one function.

    Parameters
    ----------
    program : Program
    definition : Definition
    """

    def __init__(self, program: Program, definition: Definition) -> None:
        super().__init__(program, definition)
        #: Names in C by those in Python.
        self.c_names: dict[str, str] = {}
        #: Names in C of variables that have another one than in Python.
        self.names: dict[str, str] = {}
        #: Forms of variables, as far as they are known.
        self.found: dict[str, Form] = {}
        #: Limits of integer variables, and how often they were made wider.
        self.limits: dict[str, tuple[float, float, int]] = {}
        #: Names in C of numbers in memory that are changed.
        self.changed: set[str] = set()
        self.inside_choice = 0
        #: The call whose value is that of the whole statement.
        self.whole_call: ast.AST | None = None
        self.stores = _stores(definition)

    def scalar_kinds(self) -> dict[str, str]:
        """Types in C of scalars whose limits are not known."""
        return {NUMBER: self.program.number, WHOLE: "int64_t", TRUTH: "bool"}

    def c_name(self, name: str) -> str:
        """Name of a variable in C: no word of C, no name of the program, and no other variable."""
        if name not in self.c_names:
            written = c_identifier(name)
            taken = {*self.c_names.values(), *_WORDS, self.program.name}
            while (
                written in taken
                or is_temporary(written)
                or written.startswith(f"{self.program.name}_")
            ):
                written += "_"
            self.c_names[name] = written
        return self.c_names[name]

    def _statement_value(self, node: ast.expr) -> Value:
        """Value of a statement; a call that changes numbers in memory can be nothing less."""
        self.whole_call = node
        return self.value(node)

    def _assign_statement(self, node: ast.Assign) -> bool:
        value = self._statement_value(node.value)
        if len(node.targets) > 1:
            # Computed once, before any of them is assigned.
            value = self._held(node, value)
        for target in node.targets:
            self._bind(target, value)
        return False

    def _annassign_statement(self, node: ast.AnnAssign) -> bool:
        if node.value is not None:
            self._bind(node.target, self._statement_value(node.value))
        return False

    def _augassign_statement(self, node: ast.AugAssign) -> bool:
        before: ast.expr
        if isinstance(node.target, ast.Name):
            before = ast.copy_location(ast.Name(node.target.id, ast.Load()), node.target)
        elif isinstance(node.target, ast.Subscript):
            before = ast.copy_location(
                ast.Subscript(node.target.value, node.target.slice, ast.Load()), node.target
            )
        else:
            return bool(self.refuse(node, "changes an attribute"))
        value = self.binary(node, node.op, self.value(before), self.value(node.value))
        self._bind(node.target, value)
        return False

    def _bind(self, target: ast.expr, value: Value) -> None:
        """Assign a value to a target: a name, names, or a place in memory."""
        if isinstance(target, ast.Name):
            self.assign(target, target.id, value)
        elif isinstance(target, ast.Tuple | ast.List):
            self._unpack(target, value)
        elif isinstance(target, ast.Subscript):
            owner = self.value(target.value)
            if not isinstance(owner, Space) or isinstance(target.slice, ast.Slice):
                self.refuse(target, f"changes a part of {describe(owner)}")
            place = self.place(target, self.value(target.slice), owner.length)
            number = self.number(target, value)
            self.changed.add(owner.text)
            self.statement(f"{owner.text}[{place}] = {number.text};")
        else:
            self.refuse(target, "changes an attribute")

    def _unpack(self, target: ast.Tuple | ast.List, value: Value) -> None:
        row = self.row(target, value)
        items = list(row.items)
        names = [part.id for part in ast.walk(target) if isinstance(part, ast.Name)]
        written = {self.names.get(name, self.c_name(name)) for name in names}
        if not row.whole and any(written & _words_of(item) for item in items):
            # All are computed before the first one is assigned.
            items = [self._held(target, item) for item in items]
        stars = [k for k, part in enumerate(target.elts) if isinstance(part, ast.Starred)]
        if stars:
            first, after = stars[0], len(target.elts) - stars[0] - 1
            if len(items) >= first + after:
                end = len(items) - after
                items = [*items[:first], Row(tuple(items[first:end])), *items[end:]]
        if len(items) != len(target.elts):
            self.refuse(target, f"takes {len(target.elts)} values out of {len(items)}")
        for part, item in zip(target.elts, items, strict=True):
            self._bind(part.value if isinstance(part, ast.Starred) else part, item)

    def _held(self, node: ast.AST, value: Value) -> Value:
        """The same value in variables that stay as they are."""
        if isinstance(value, Scalar):
            return Scalar(
                self.temporary(self.c_kind(value), value.text), value.kind, 0, value.low, value.high
            )
        if isinstance(value, Row):
            return Row(tuple(self._held(node, item) for item in value.items))
        return value

    def assign(self, node: ast.AST, name: str, value: Value) -> None:
        """Assign a value to a variable."""
        once = self.stores[name] == 1
        if isinstance(value, Space) or (isinstance(value, Known) and once):
            if isinstance(value, Space) and not once:
                self.refuse(node, f"assigns to {name!r}, numbers in memory, more than once")
            self.variables[name] = value
            return
        form, written = form_of(value), self.names.get(name, self.c_name(name))
        if joined(self.found.get(written, form), form) is None and not self.inside_choice:
            # As a variable of its own: what was there before is not used any more.
            taken = {*map(self.c_name, self.local), *self.names.values()}
            written = next(w for k in count(2) if (w := f"{self.c_name(name)}_{k}") not in taken)
            self.names[name] = written
        wider = joined(self.found.get(written, form), form)
        if wider is None:
            self.refuse(node, f"assigns {describe(value)} to {name!r}, which is something else")
        if self.found.setdefault(written, wider) != wider:
            self.found[written] = wider
            raise WriteAgain
        if isinstance(wider, tuple) and any(isinstance(leaf, Fixed) for leaf in _all_leaves(wider)):
            if not once:
                self.refuse(node, f"assigns {describe(value)} to {name!r} more than once")
            self.variables[name] = self._held(node, value)
            return
        if isinstance(wider, Fixed):
            self.variables[name] = value
            return
        self.assign_form(node, written, value, wider)
        self.variables[name] = self.variable(written, wider)
        if wider == WHOLE:
            self.variables[name] = self.within_limits(written, self.whole(node, value))
        if once and isinstance(value, Scalar) and wider == NUMBER:
            self.variables[name] = Scalar(written, NUMBER, 0, value.low, value.high)

    def within_limits(self, name: str, value: Scalar) -> Scalar:
        """An integer variable with the limits of all values that it gets.

        They are made wider until they hold; what grows again and again has none.
        """
        low, high, times = self.limits.setdefault(name, (value.low, value.high, 0))
        if value.low < low or value.high > high:
            low, high = min(low, value.low), max(high, value.high)
            if times >= _WIDENINGS:
                low, high = -math.inf, math.inf
            self.limits[name] = (low, high, times + 1)
            raise WriteAgain
        return Scalar(name, WHOLE, 0, low, high)


def is_temporary(name: str) -> bool:
    """Whether a name is that of a temporary variable."""
    return re.fullmatch(r"t\d+|own_\d+", name) is not None


def _words_of(value: Value) -> set[str]:
    """Names in the text of a value."""
    if isinstance(value, Row):
        return {word for item in value.items for word in _words_of(item)}
    return set(re.findall(r"\w+", value.text)) if isinstance(value, Scalar) else set()


def _stores(definition: Definition) -> dict[str, int]:
    """How often each local variable is assigned to; a parameter has a value before that."""
    counts: dict[str, int] = {}
    node = definition.node
    parameters = {each.arg for each in definition.parameters}

    def add(part: ast.AST) -> None:
        if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
            counts[part.id] = counts.get(part.id, 0) + 1 + (part.id in parameters)
        for child in ast.iter_child_nodes(part):
            add(child)

    for statement in [] if isinstance(node, ast.Lambda) else node.body:
        add(statement)
    return counts


def _all_leaves(form: Form) -> Iterator[Form]:
    if isinstance(form, tuple):
        for part in form:
            yield from _all_leaves(part)
    else:
        yield form
