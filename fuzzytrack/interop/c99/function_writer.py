"""A Python function as a C function."""

from __future__ import annotations

import ast
import math
from collections.abc import Sequence
from types import FunctionType

from fuzzytrack.interop.c99.assignments import WriteAgain, is_temporary
from fuzzytrack.interop.c99.blocks import Assignment, Block, Nest, worst
from fuzzytrack.interop.c99.conversions import describe, wording
from fuzzytrack.interop.c99.loops import LoopWriter
from fuzzytrack.interop.c99.program import Program, Written
from fuzzytrack.interop.c99.python_source import Definition, definition_of
from fuzzytrack.interop.c99.values import (
    POSTFIX,
    WHOLE,
    Fixed,
    Form,
    Known,
    Room,
    Scalar,
    Space,
    Value,
    Whole,
    form_of,
    joined,
)

__all__ = ["FunctionWriter", "written_function"]


class FunctionWriter(LoopWriter):
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
        #: Form of the result, as far as it is known.
        self.result: Form | None = None

    def written(self) -> Written:
        """The function in C."""
        while True:
            try:
                return self._write()
            except WriteAgain:
                continue

    def _write(self) -> Written:
        self.block, self.temporaries = Block(), 0
        self.variables = {}
        self.names = {}
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
        ended = self.statements(self.definition.body)
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

    # ------------------------------------------------------------ statements

    def statements(self, nodes: list[ast.stmt]) -> bool:
        """Write statements; whether they end the function."""
        for node in nodes:
            write = getattr(self, f"_{type(node).__name__.lower()}_statement", None)
            if write is None:
                self.refuse(node, f"uses {wording(node)}, which C99 code is not written for")
            elif write(node):
                return True
        return False

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
            raise WriteAgain
        self.result = wider
        if not self.program.has_result(wider):
            self.statement("return;") if self.inside_choice else None
        elif isinstance(wider, tuple):
            text, last = self.structure(node, value, wider), self.block.items[-1:]
            if (
                last
                and isinstance(last[0], Assignment)
                and last[0].name == text
                and is_temporary(text)
            ):
                text = last[0].text
                self.block.items.pop()
            self.statement(f"return {text};")
        else:
            found = self.scalar(node, self.converted(node, value, wider))
            self.statement(f"return {found.text};")
        return True

    def _if_statement(self, node: ast.If) -> bool:
        condition = self.truth(node.test, self.value(node.test))
        if isinstance(condition, Known):
            return self.statements(node.body if condition.value else node.orelse)
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
            return self.statements(nodes)
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
