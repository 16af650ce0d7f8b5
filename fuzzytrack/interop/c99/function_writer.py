"""A Python function as a C function: its statements."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Iterator, Sequence
from itertools import count
from types import FunctionType
from typing import NoReturn

from fuzzytrack.interop.c99.blocks import Assignment, Block, Nest, worst
from fuzzytrack.interop.c99.calls import CallWriter
from fuzzytrack.interop.c99.conversions import describe
from fuzzytrack.interop.c99.expressions import wording
from fuzzytrack.interop.c99.identifiers import c_identifier
from fuzzytrack.interop.c99.program import Program, Written
from fuzzytrack.interop.c99.python_source import Definition, definition_of
from fuzzytrack.interop.c99.values import (
    NUMBER,
    POSTFIX,
    TRUTH,
    WHOLE,
    Fixed,
    Form,
    Known,
    Room,
    Row,
    Scalar,
    Space,
    Value,
    Whole,
    form_of,
    joined,
)

__all__ = ["FunctionWriter", "written_function"]

_LONGEST_UNROLLED = 4
_WIDENINGS = 3
_LARGEST_COUNT = 2**31 - 2

#: Functions that C code calls by name, beside words of C.
_WORDS = frozenset({"memcpy", "memset", "own_numbers"})


class _Again(Exception):  # noqa: N818 - not an error: a form was found that is wider
    """A variable or a result has another form than was thought; write the function again."""


class FunctionWriter(CallWriter):
    """Writes one function, for arguments of given forms.

    Parameters
    ----------
    program : Program
    definition : Definition
    name : str
        Its name in C.
    forms : tuple of Form
        Forms of its arguments.
    """

    def __init__(
        self, program: Program, definition: Definition, name: str, forms: tuple[Form, ...]
    ) -> None:
        super().__init__(program, definition)
        self.name = name
        self.forms = forms
        #: Names in C by those in Python.
        self.c_names: dict[str, str] = {}
        #: Forms of variables, and of the result, as far as they are known.
        self.found: dict[str, Form] = {}
        self.result: Form | None = None
        #: Limits of integer variables, and how often they were made wider.
        self.limits: dict[str, tuple[float, float, int]] = {}
        self.changed: set[str] = set()
        self.inside_choice = 0
        #: The call whose value is that of the whole statement.
        self.whole_call: ast.AST | None = None
        self.stores = _stores(definition)

    def written(self) -> Written:
        """The function in C."""
        while True:
            try:
                return self._write()
            except _Again:
                continue

    def _write(self) -> Written:
        self.block, self.temporaries = Block(), 0
        self.variables = {}
        #: Names in C of variables that have another one than in Python.
        self.names: dict[str, str] = {}
        self.changed = set()
        self.inside_choice = 0
        names = [each.arg for each in self.definition.parameters]
        if self.definition.node.args.vararg:
            names.append(self.definition.node.args.vararg.arg)
        names += [each.arg for each in self.definition.node.args.kwonlyargs]
        self.local = {*names, *self.stores}
        parameters: list[tuple[str, str]] = []
        for name, form in zip(names, self.forms, strict=True):
            self._take(name, form, parameters)
        ended = self._statements(self.definition.body)
        if not ended:
            if self.result not in (None, Fixed(None)):
                self.refuse(self.definition.node, "returns a value on some of its ways only")
            self.result = Fixed(None)
        assert self.result is not None
        self.block.without_unused()
        words = self.block.words()
        used = tuple(words[name] > 0 or self._assigned(name) for name, _ in parameters)
        writes = tuple(name in self.changed for name, _ in parameters)
        shown = [
            f"{'' if changes or kind[-1] != '*' else 'const '}{kind}{name}"
            for (name, kind), is_used, changes in zip(parameters, used, writes, strict=True)
            if is_used
        ]
        taken = frozenset(name for name, _ in parameters)
        lines = self.block.lines(self.program.empty_values(self.block), taken)
        kind = self.program.result_kind(self.result)
        text = "\n".join(
            [
                f"/* {self.program.origin(self.definition)} */",
                *_signature(f"FUZZYTRACK_INLINE {kind} {self.name}(", shown),
                "{",
                *(f"    {line}" for line in lines),
                "}",
            ]
        )
        return Written(self.name, text, self.result, used, writes, self.block.costs)

    def _assigned(self, name: str) -> bool:
        return any(each.name == name for each in self.block.assignments())

    def _take(self, name: str, form: Form, parameters: list[tuple[str, str]]) -> None:
        """Make a parameter known as a variable."""
        written = self.c_name(name)
        if isinstance(form, Fixed):
            self.variables[name] = Known(form.value)
            if name in self.stores:
                self.assign(self.definition.node, name, Known(form.value))
            return
        if isinstance(form, Room):
            self.variables[name] = Space(written, form.length)
            parameters.append((written, f"{self.program.number} *"))
            return
        if isinstance(form, tuple):
            self.variables[name] = self.program.members(written, form)
            if self.program.struct(form):
                parameters.append((written, f"{self.program.struct(form)} "))
        elif isinstance(form, Whole):
            parameters.append((written, "int32_t "))
            self.limits[written] = (form.low, form.high, 0)
            self.variables[name] = Scalar(written, WHOLE, 0, form.low, form.high)
            form = WHOLE
        else:
            self.variables[name] = Scalar(written, form)
            parameters.append((written, f"{self.scalar_kinds()[form]} "))
            if form == WHOLE:
                self.limits[written] = (-math.inf, math.inf, 0)
        self.found.setdefault(written, form)

    def scalar_kinds(self) -> dict[str, str]:
        """Types in C of scalars whose limits are not known."""
        return {NUMBER: self.program.number, WHOLE: "int64_t", TRUTH: "bool"}

    def c_name(self, name: str) -> str:
        """Name of a variable in C: no word of C, no name of the program, and no other variable."""
        if name not in self.c_names:
            written = c_identifier(name)
            taken = {*self.c_names.values(), *_WORDS, self.program.name}
            while written in taken or _new(written) or written.startswith(f"{self.program.name}_"):
                written += "_"
            self.c_names[name] = written
        return self.c_names[name]

    # ------------------------------------------------------------ statements

    def _statements(self, nodes: list[ast.stmt]) -> bool:
        """Write statements; whether they end the function."""
        for node in nodes:
            write = getattr(self, f"_{type(node).__name__.lower()}_statement", None)
            if write is None:
                self.refuse(node, f"uses {wording(node)}, which C99 code is not written for")
            elif write(node):
                return True
        return False

    def _statement_value(self, node: ast.expr) -> Value:
        """Value of a statement; a call that changes numbers in memory can be nothing less."""
        self.whole_call = node
        return self.value(node)

    def _pass_statement(self, node: ast.Pass) -> bool:
        return False

    def _expr_statement(self, node: ast.Expr) -> bool:
        if isinstance(node.value, ast.Call):
            self._statement_value(node.value)
        elif not isinstance(node.value, ast.Constant):
            self.refuse(node, "has a statement without effect")
        return False

    def _return_statement(self, node: ast.Return) -> bool:
        value = Known(None) if node.value is None else self._statement_value(node.value)
        if isinstance(value, Space):
            self.refuse(node, "returns numbers in memory")
        form = form_of(value)
        wider = form if self.result is None else joined(self.result, form)
        if wider is None:
            self.refuse(node, f"returns {describe(value)}, and elsewhere something else")
        if self.result is not None and wider != self.result:
            self.result = wider
            raise _Again
        self.result = wider
        if not self.program.has_result(wider):
            self.statement("return;") if self.inside_choice else None
        elif isinstance(wider, tuple):
            text, last = self.structure(node, value, wider), self.block.items[-1:]
            if last and isinstance(last[0], Assignment) and last[0].name == text and _new(text):
                text = last[0].text
                self.block.items.pop()
            self.statement(f"return {text};")
        else:
            found = self.scalar(node, self.converted(node, value, wider))
            self.statement(f"return {found.text};")
        return True

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
            raise _Again
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
            raise _Again
        return Scalar(name, WHOLE, 0, low, high)

    def _if_statement(self, node: ast.If) -> bool:
        condition = self.truth(node.test, self.value(node.test))
        if isinstance(condition, Known):
            return self._statements(node.body if condition.value else node.orelse)
        then, other = Block(), Block()
        self.inside_choice += 1
        before = dict(self.variables)
        ends = self._in(then, node.body)
        after_then, self.variables = self.variables, before
        ends_too = self._in(other, node.orelse)
        self.inside_choice -= 1
        # What either branch has assigned is a variable from here on.
        self.variables = {**after_then, **self.variables}
        self.block.costs += worst(then.costs, other.costs)
        heads, blocks = [f"if ({condition.text})", "else"], [then, other]
        if not other.items:
            heads, blocks = heads[:1], blocks[:1]
        self.block.items.append(Nest(heads, blocks))
        return ends and ends_too

    def _in(self, block: Block, nodes: list[ast.stmt]) -> bool:
        outer, self.block = self.block, block
        try:
            return self._statements(nodes)
        finally:
            self.block = outer

    # ------------------------------------------------------------ other functions

    def called(self, node: ast.Call, function: FunctionType, given: Sequence[Value]) -> Value:
        """Value of a call, with the function written first if it is new."""
        forms = tuple(form_of(value, passed=True) for value in given)
        if any(function is other for other in self.program.being_written):
            self.refuse(node, f"calls {function.__name__}, which calls itself")
        written = written_function(self.program, function, forms)
        texts, k = [], 0
        for value, form in zip(given, forms, strict=True):
            if isinstance(form, Fixed) or (
                isinstance(form, tuple) and not self.program.struct(form)
            ):
                continue
            if written.writes[k]:
                # What is computed before a call must be computed before it in C, too.
                if self.whole_call is not node:
                    self.refuse(node, "changes numbers in memory in the midst of a statement")
                assert isinstance(value, Space)
                self.changed.add(value.text)
            if written.used[k]:
                texts.append(self._argument(node, value, form))
            k += 1
        self.block.costs.update(written.costs)
        self.cost("calls")
        return self._result_of(written, f"{written.name}({', '.join(texts)})")

    def _argument(self, node: ast.Call, value: Value, form: Form) -> str:
        if isinstance(value, Space):
            return value.text
        if isinstance(form, tuple):
            return self.structure(node, value, form)
        return self.scalar(node, self.converted(node, value, form)).text

    def _result_of(self, written: Written, call: str) -> Value:
        form, changes = written.result, any(written.writes)
        if not self.program.has_result(form):
            if changes:
                self.statement(f"{call};")
            return self.program.members("", form) if isinstance(form, tuple) else Known(form.value)
        if not isinstance(form, tuple) and not changes:
            return Scalar(call, form, POSTFIX)
        name = self.temporary(self.program.result_kind(form), call)
        last = self.block.items[-1]
        assert isinstance(last, Assignment)
        # A call that changes numbers in memory stays, even if nothing reads its result.
        last.used = changes
        return self.variable(name, form)

    # ------------------------------------------------------------ loops

    def _for_statement(self, node: ast.For) -> bool:
        if node.orelse:
            self.refuse(node, "uses `else` of a loop, which C99 code is not written for")
        if not isinstance(node.target, ast.Name):
            self.refuse(node, "takes more than one value in a loop")
            return False
        if _read_outside(self.definition, node, node.target.id):
            self.refuse(node, f"uses {node.target.id!r} after its loop")
        if _is_range(node.iter):
            ends = self._range(node)
            if ends is not None:
                self._counted(node, *ends)
            return False
        value = self.value(node.iter)
        row = self.row(node.iter, value)
        many = len(row.items) > _LONGEST_UNROLLED
        if many and isinstance(value, Row) and row.whole and set(form_of(value)) == {NUMBER}:
            # A copy, since the loop may change the tuple.
            whole = self.temporary(self.program.struct(form_of(value)), row.whole)
            index = self.temporary_name()
            item = Scalar(f"{whole}.v[{index}]", NUMBER, POSTFIX)
            self._loop(node, index, 0, len(row.items), lambda: self._bind(node.target, item))
        else:
            self._unrolled(node, row.items)
        return False

    def temporary_name(self) -> str:
        """Name of a new variable."""
        self.temporaries += 1
        return f"t{self.temporaries}"

    def _range(self, node: ast.For) -> tuple[int, Value, int] | None:
        """Start, end and step of a range; the end may be a value with an upper limit."""
        assert isinstance(node.iter, ast.Call)
        given = [self.value(each) for each in node.iter.args]
        if not 1 <= len(given) <= 3 or node.iter.keywords:
            return self._no_range(node)
        zero, one = Known(0), Known(1)
        start, end, step = (*given, one)[:3] if len(given) > 1 else (zero, given[0], one)
        if not (isinstance(start, Known) and isinstance(step, Known) and step.value):
            return self._no_range(node)
        if not isinstance(end, Known):
            limit = self.whole(node.iter, end)
            if limit.high > _LARGEST_COUNT or step.value < 0:
                return self._no_range(node)
            end = limit
        return int(start.value), end, int(step.value)

    def _no_range(self, node: ast.For) -> NoReturn:
        self.refuse(node.iter, "has a loop whose number of turns has no constant limit")

    def _counted(self, node: ast.For, start: int, end: Value, step: int) -> None:
        if isinstance(end, Known):
            turns = range(start, int(end.value), step)
            if len(turns) < 2:
                self._unrolled(node, tuple(Known(k) for k in turns))
                return
        assert isinstance(node.target, ast.Name)
        name = self.c_name(node.target.id)
        limit = self.whole(node, end)
        extremes = (start, limit.high - 1) if step > 0 else (limit.low + 1, start)
        self.variables[node.target.id] = Scalar(name, WHOLE, 0, *map(float, extremes))
        self._loop(node, name, start, end, lambda: None, step)

    def _loop(
        self, node: ast.For, name: str, start: int, end: int | Value, begin: Callable[[], None],
        step: int = 1,
    ) -> None:  # fmt: skip
        body = Block()
        assert isinstance(node.target, ast.Name)
        # A loop over numbers of a tuple assigns to its variable in each turn.
        if name == self.c_name(node.target.id) and _assigned_in(node.body, node.target.id):
            self.refuse(node, f"changes {node.target.id!r} in its loop")
        limit = self.whole(node, Known(end) if isinstance(end, int) else end)
        text, highest = limit.text, limit.high
        if limit.low != limit.high:
            # The number of turns does not change when the loop changes what it was computed of.
            text = self.temporary(self.c_kind(limit), text)
        head = f"for (int32_t {name} = {start}; {name} {'<' if step > 0 else '>'} {text}; "
        turn = f"++{name}" if step == 1 else f"{name} += {step}"
        self.inside_choice += 1

        def write() -> Value:
            begin()
            self._statements(node.body)
            return Known(None)

        self.within(body, write)
        self.inside_choice -= 1
        turns = max(0, -(-(int(highest) - start) // step))
        for operation, done in body.costs.items():
            self.cost(operation, done * turns)
        self.block.items.append(Nest([f"{head}{turn})"], [body]))

    def _unrolled(self, node: ast.For, items: tuple[Value, ...]) -> None:
        if any(isinstance(each, ast.Break | ast.Continue) for each in ast.walk(node)):
            self.refuse(node, "leaves a loop that C99 code does not have")
        assert isinstance(node.target, ast.Name)
        name = node.target.id
        if _assigned_in(node.body, name):
            self.refuse(node, f"changes {name!r} in its loop")
        # All are computed before the loop, which may change what they are made of.
        for item in [self._held(node, item) for item in items]:
            self.variables[name] = item
            if self._statements(node.body):
                self.refuse(node, "returns out of a loop")

    def _break_statement(self, node: ast.Break) -> bool:
        self.statement("break;")
        return False

    def _continue_statement(self, node: ast.Continue) -> bool:
        self.statement("continue;")
        return False


def written_function(program: Program, function: FunctionType, forms: tuple[Form, ...]) -> Written:
    """A function in C for arguments of given forms, which becomes a part of the program."""
    key = (function, forms)
    if key not in program.written:
        definition = definition_of(function)
        program.being_written.append(function)
        try:
            name = program.function_name(definition)
            program.written[key] = FunctionWriter(program, definition, name, forms).written()
        finally:
            program.being_written.pop()
        program.functions.append(program.written[key].text)
    return program.written[key]


def _new(name: str) -> bool:
    """Whether a name is that of a temporary variable."""
    return re.fullmatch(r"t\d+|own_\d+", name) is not None


def _words_of(value: Value) -> set[str]:
    """Names in the text of a value."""
    if isinstance(value, Row):
        return {word for item in value.items for word in _words_of(item)}
    return set(re.findall(r"\w+", value.text)) if isinstance(value, Scalar) else set()


def _signature(head: str, parameters: list[str]) -> list[str]:
    """Head of a function in lines of at most 100 characters."""
    lines, line = [], head
    for k, parameter in enumerate(parameters or ["void"]):
        piece = parameter + (", " if k + 1 < len(parameters) else ")")
        if len(line) + len(piece) > 96 and line.strip():
            lines.append(line.rstrip())
            line = "    "
        line += piece
    return [*lines, line]


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


def _is_range(node: ast.expr) -> bool:
    return (
        isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "range"
    )


def _assigned_in(nodes: list[ast.stmt], name: str) -> bool:
    return any(
        isinstance(part, ast.Name) and part.id == name and isinstance(part.ctx, ast.Store)
        for node in nodes
        for part in ast.walk(node)
    )


def _read_outside(definition: Definition, loop: ast.For, name: str) -> bool:
    """Whether a variable is read outside of the loops that count it."""

    def read(part: ast.AST) -> bool:
        if (
            isinstance(part, ast.For)
            and isinstance(part.target, ast.Name)
            and part.target.id == name
        ):
            return False
        if isinstance(part, ast.Name) and part.id == name and isinstance(part.ctx, ast.Load):
            return True
        return any(read(child) for child in ast.iter_child_nodes(part))

    return any(read(statement) for statement in definition.body)


def _all_leaves(form: Form) -> Iterator[Form]:
    if isinstance(form, tuple):
        for part in form:
            yield from _all_leaves(part)
    else:
        yield form
