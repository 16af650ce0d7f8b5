"""Python loops as loops in C with a constant limit, or as their turns one after another."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import NoReturn

from fuzzytrack.interop.c99.assignments import AssignmentWriter
from fuzzytrack.interop.c99.blocks import Block, Nest
from fuzzytrack.interop.c99.python_source import Definition
from fuzzytrack.interop.c99.values import (
    NUMBER,
    POSTFIX,
    WHOLE,
    Known,
    Row,
    Scalar,
    Value,
    form_of,
)

__all__ = ["LoopWriter"]

_LONGEST_UNROLLED = 4
_LARGEST_COUNT = 2**31 - 2


class LoopWriter(AssignmentWriter):
    """Writes the loops of one function."""

    def statements(self, nodes: list[ast.stmt]) -> bool:
        """Write statements; whether they end the function."""
        raise NotImplementedError

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
            self.statements(node.body)
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
            if self.statements(node.body):
                self.refuse(node, "returns out of a loop")

    def _break_statement(self, node: ast.Break) -> bool:
        self.statement("break;")
        return False

    def _continue_statement(self, node: ast.Continue) -> bool:
        self.statement("continue;")
        return False


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
