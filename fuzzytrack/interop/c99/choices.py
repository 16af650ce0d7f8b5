"""Values in C that depend on a condition, and the variables that get them."""

from __future__ import annotations

import ast
from functools import partial

from fuzzytrack.interop.c99.blocks import Assignment, Block, Nest, worst
from fuzzytrack.interop.c99.conversions import ConversionWriter, describe, inside
from fuzzytrack.interop.c99.values import (
    ATOM,
    CHOICE,
    LARGEST_INT64,
    NUMBER,
    TRUTH,
    UNARY,
    WHOLE,
    Fixed,
    Form,
    Known,
    Row,
    Scalar,
    Value,
    form_of,
    joined,
)

__all__ = ["ChoiceWriter"]


class ChoiceWriter(ConversionWriter):
    """Writes choices between values of one function."""

    def _ifexp(self, node: ast.IfExp) -> Value:
        condition = self.truth(node.test, self.value(node.test))
        if isinstance(condition, Known):
            return self.value(node.body if condition.value else node.orelse)
        first, second = Block(), Block()
        then = self.within(first, lambda: self.value(node.body))
        other = self.within(second, lambda: self.value(node.orelse))
        return self.choice(node, condition, (first, then), (second, other))

    def choice(
        self,
        node: ast.AST,
        condition: Scalar,
        then: tuple[Block, Value],
        other: tuple[Block, Value],
    ) -> Value:
        """One value or the other, each with the statements that compute it."""
        form = joined(form_of(then[1]), form_of(other[1]))
        if form is None:
            return self.refuse(
                node, f"gives {describe(then[1])} or {describe(other[1])}; both must be alike"
            )
        self.block.costs += worst(then[0].costs, other[0].costs)
        if isinstance(form, Fixed):
            return then[1]
        if not (then[0].items or other[0].items):
            condition = self.held(condition) if isinstance(form, tuple) else condition
            return self._select(node, condition, then[1], other[1], form)
        result, name = self._result(form)
        for block, value in (then, other):
            self.within(block, partial(self.assign_form, node, name, value, form))
        heads = [f"if ({condition.text})", "else"]
        self.block.items.append(Nest(heads, [then[0], other[0]]))
        return result

    def _select(
        self, node: ast.AST, condition: Scalar, then: Value, other: Value, form: Form
    ) -> Value:
        if isinstance(form, tuple):
            pairs = zip(self.row(node, then).items, self.row(node, other).items, form, strict=True)
            return Row(tuple(self._select(node, condition, a, b, part) for a, b, part in pairs))
        if isinstance(form, Fixed):
            return then
        self.cost("choices")
        a = self.scalar(node, self.converted(node, then, form))
        b = self.scalar(node, self.converted(node, other, form))
        text = " ".join((inside(condition, UNARY), "?", inside(a, UNARY), ":", inside(b, UNARY)))
        return Scalar(text, form, CHOICE, min(a.low, b.low), max(a.high, b.high))

    def within_limits(self, name: str, value: Scalar) -> Scalar:
        """An integer variable with the limits of all values that it gets."""
        return Scalar(
            name, WHOLE, ATOM, min(value.low, -LARGEST_INT64), max(value.high, LARGEST_INT64)
        )

    def _result(self, form: Form) -> tuple[Value, str]:
        """A variable that is assigned to later, and its name."""
        self.temporaries += 1
        name = f"t{self.temporaries}"
        return self.variable(name, form), name

    def variable(self, name: str, form: Form) -> Value:
        """Value of a variable in C."""
        if isinstance(form, tuple):
            return self.program.members(name, form)
        return Scalar(name, form) if not isinstance(form, Fixed) else Known(form.value)

    def assign_form(self, node: ast.AST, name: str, value: Value, form: Form) -> Value:
        """Assign a value to a variable of a form."""
        if isinstance(form, tuple):
            if self.program.struct(form):
                text = self.structure(node, value, form)
                self.block.items.append(Assignment(name, self.program.struct(form), text))
        elif not isinstance(form, Fixed):
            found = self.scalar(node, self.converted(node, value, form))
            whole = self.c_kind(self.within_limits(name, found)) if form == WHOLE else ""
            kind = {NUMBER: self.program.number, TRUTH: "bool", WHOLE: whole}[form]
            self.block.items.append(Assignment(name, kind, found.text))
        return value
