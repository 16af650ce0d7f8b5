"""Python expressions as C expressions."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from fuzzytrack.interop.c99.blocks import Assignment, Block, Line, Nest, worst
from fuzzytrack.interop.c99.conversions import (
    ConversionWriter,
    describe,
    inside,
    operand,
    whole_constant,
)
from fuzzytrack.interop.c99.python_source import plain_function
from fuzzytrack.interop.c99.values import (
    ATOM,
    BITWISE,
    CHOICE,
    COMPARED,
    EQUAL,
    LOGICAL,
    NUMBER,
    POSTFIX,
    PRODUCT,
    SUM,
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
    constant_tuple,
    form_of,
    joined,
    scalar_kind,
)

__all__ = ["ExpressionWriter"]

_ARITHMETIC: dict[type, tuple[str, int, str, Callable[[Any, Any], Any]]] = {
    ast.Add: ("+", SUM, "additions", operator.add),
    ast.Sub: ("-", SUM, "additions", operator.sub),
    ast.Mult: ("*", PRODUCT, "multiplications", operator.mul),
    ast.Div: ("/", PRODUCT, "divisions", operator.truediv),
    ast.FloorDiv: ("//", PRODUCT, "divisions", operator.floordiv),
    ast.Mod: ("%", PRODUCT, "divisions", operator.mod),
    ast.Pow: ("**", PRODUCT, "powers", operator.pow),
}
_COMPARISONS: dict[type, tuple[str, int, Callable[[Any, Any], Any]]] = {
    ast.Lt: ("<", COMPARED, operator.lt),
    ast.LtE: ("<=", COMPARED, operator.le),
    ast.Gt: (">", COMPARED, operator.gt),
    ast.GtE: (">=", COMPARED, operator.ge),
    ast.Eq: ("==", EQUAL, operator.eq),
    ast.NotEq: ("!=", EQUAL, operator.ne),
}
_TRUTHS: dict[type, tuple[str, Callable[[Any, Any], Any]]] = {
    ast.BitAnd: ("&", operator.and_),
    ast.BitOr: ("|", operator.or_),
    ast.BitXor: ("^", operator.xor),
}
_INT32, _INT64 = 2.0**31 - 1, 2.0**62
#: Powers up to this one are products.
_LARGEST_POWER = 8


class ExpressionWriter(ConversionWriter):
    """Writes the expressions of one function."""

    # ------------------------------------------------------------ expressions

    def value(self, node: ast.expr) -> Value:
        """Value of an expression."""
        write = getattr(self, f"_{type(node).__name__.lower()}", None)
        if write is None:
            return self.refuse(node, f"uses {wording(node)}, which C99 code is not written for")
        found: Value = write(node)
        return found

    def _constant(self, node: ast.Constant) -> Value:
        return Known(node.value)

    def _name(self, node: ast.Name) -> Value:
        if node.id in self.local:
            if node.id not in self.variables:
                return self.refuse(node, f"uses {node.id!r} before it has a value")
            return self.variables[node.id]
        try:
            found = self.definition.outer(node.id)
        except KeyError:
            return self.refuse(node, f"uses {node.id!r}, which is not defined")
        function = plain_function(found)
        if function is not None:
            return Known(function)
        allowed = found is None or found is math or isinstance(found, str | np.ndarray)
        kind = scalar_kind(found)
        if kind is not None:
            return Known(found.item() if isinstance(found, np.generic) else found, node.id)
        if constant_tuple(found) or _tuple_of_functions(found):
            return Known(found, node.id)
        if allowed or getattr(found, "__module__", None) in ("builtins", "math"):
            return Known(found, node.id)
        module = getattr(found, "__module__", None) or type(found).__module__
        return self.refuse(
            node,
            f"uses {node.id!r} ({type(found).__name__} of {module}), which has no form in C; it "
            "may use numbers, tuples, math, and plain functions of these",
        )

    def _attribute(self, node: ast.Attribute) -> Value:
        owner = self.value(node.value)
        if isinstance(owner, Known) and owner.value is math and hasattr(math, node.attr):
            return Known(getattr(math, node.attr))
        return self.refuse(
            node, f"uses the attribute {node.attr!r}; only those of math can be used"
        )

    def _tuple(self, node: ast.Tuple) -> Value:
        items: list[Value] = []
        for part in node.elts:
            if isinstance(part, ast.Starred):
                items += self.row(part, self.value(part.value)).items
            else:
                items.append(self.value(part))
        known = [item.value for item in items if isinstance(item, Known)]
        return Known(tuple(known)) if len(known) == len(items) else Row(tuple(items))

    def _unaryop(self, node: ast.UnaryOp) -> Value:
        operand = self.value(node.operand)
        if isinstance(node.op, ast.Not):
            truth = self.truth(node.operand, operand)
            if isinstance(truth, Known):
                return Known(not truth.value)
            return Scalar(f"!{inside(truth, UNARY)}", TRUTH, UNARY)
        if isinstance(node.op, ast.Invert):
            return self.refuse(node, "uses ~, which C99 code is not written for")
        positive = isinstance(node.op, ast.UAdd)
        if isinstance(operand, Known) and scalar_kind(operand.value) is not None:
            return Known(+operand.value if positive else -operand.value)
        found = self.scalar(node.operand, operand)
        found = found if found.kind == NUMBER else self.whole(node.operand, found)
        if positive:
            return found
        if found.kind == WHOLE and self.c_kind(found) == "int64_t":
            return self._whole_operation(node, "*", found, whole_constant(-1))
        return Scalar(f"-{inside(found, POSTFIX)}", found.kind, UNARY, -found.high, -found.low)

    def _binop(self, node: ast.BinOp) -> Value:
        left, right = self.value(node.left), self.value(node.right)
        return self.binary(node, node.op, left, right)

    def binary(self, node: ast.AST, op: ast.operator, left: Value, right: Value) -> Value:
        """Value of an operation on two values."""
        if type(op) in _TRUTHS:
            return self._truths(node, *_TRUTHS[type(op)], left, right)
        if type(op) not in _ARITHMETIC:
            return self.refuse(node, f"uses {wording(op)}, which C99 code is not written for")
        sign, rank, kind, compute = _ARITHMETIC[type(op)]
        if isinstance(left, Known) and isinstance(right, Known):
            try:
                return Known(compute(left.value, right.value))
            except TypeError as error:
                return self.refuse(node, f"cannot compute {sign} of constants: {error}")
            except ArithmeticError:
                # C goes on with infinity or NaN.
                left = Known(float(left.value))
        sequences = [v for v in (left, right) if isinstance(v, Row) or _known_tuple(v)]
        if sequences:
            return self._tuple_operation(node, sign, left, right)
        if sign == "**":
            return self._power(node, left, right)
        first, second = self.scalar(node, left), self.scalar(node, right)
        if NUMBER not in (first.kind, second.kind) and sign != "/":
            first, second = self.whole(node, first), self.whole(node, second)
            return self._whole_operation(node, sign, first, second)
        first, second = self.number(node, left), self.number(node, right)
        self.cost(kind)
        if sign in ("//", "%"):
            name = "floor_divide" if sign == "//" else "modulo"
            return self.helper(name, NUMBER, first, second)
        # Products in sums stand in parentheses, too: rules for critical systems ask for it.
        text = f"{operand(first, rank)} {sign} {operand(second, rank, last=True)}"
        return Scalar(text, NUMBER, rank)

    def _truths(
        self,
        node: ast.AST,
        sign: str,
        compute: Callable[[Any, Any], Any],
        left: Value,
        right: Value,
    ) -> Value:
        if isinstance(left, Known) and isinstance(right, Known):
            return Known(compute(left.value, right.value))
        first, second = self.scalar(node, left), self.scalar(node, right)
        if first.kind != TRUTH or second.kind != TRUTH:
            return self.refuse(node, f"uses {sign} of what are not both truth values")
        for known, other in ((left, second), (right, first)):
            if isinstance(known, Known) and sign != "^":
                # True & x and False | x are x; False & x and True | x are known.
                return other if bool(known.value) == (sign == "&") else Known(bool(known.value))
        first, second = (
            Scalar(f"({v.text})", TRUTH) if v.rank > UNARY else v
            for v in (self._without_call(first), self._without_call(second))
        )
        return Scalar(f"{first.text} {sign} {second.text}", TRUTH, BITWISE)

    def _without_call(self, value: Scalar) -> Scalar:
        """The same without calls of functions, since both sides of a bitwise operator are done."""
        return self.held(value) if "(" in value.text else value

    def _whole_operation(self, node: ast.AST, sign: str, a: Scalar, b: Scalar) -> Value:
        """Operation on integers, whose limits decide on the types in C."""
        if sign in ("//", "%"):
            if b.low != b.high or b.low == 0.0:
                return self.refuse(
                    node, f"uses {sign} of integers with a divisor that is not a constant"
                )
            name = "floor_divide_whole" if sign == "//" else "modulo_whole"
            found = self.helper(name, WHOLE, a, b)
            if sign == "%":
                ends = (0.0, b.low - 1) if b.low > 0 else (b.low + 1, 0.0)
                if abs(b.low) <= _INT32:
                    return Scalar(f"(int32_t){found.text}", WHOLE, UNARY, *ends)
            return found
        # What adds 0 or multiplies by 1 is left out: places in memory are written so.
        if sign == "*" and b.low == b.high == 1.0:
            return a
        if sign == "*" and a.low == a.high == 1.0:
            return b
        if sign in "+-" and b.low == b.high == 0.0:
            return a
        if sign == "+" and a.low == a.high == 0.0:
            return b
        corners = [_corner(sign, x, y) for x in (a.low, a.high) for y in (b.low, b.high)]
        low, high = min(corners), max(corners)
        rank = PRODUCT if sign == "*" else SUM
        if max(-low, high) <= _INT32:
            text = f"{operand(a, rank)} {sign} {operand(b, rank, last=True)}"
            return Scalar(text, WHOLE, rank, low, high)
        if max(-low, high) <= _INT64:
            text = f"(int64_t){inside(a, UNARY)} {sign} {operand(b, rank, last=True)}"
            return Scalar(text, WHOLE, rank, low, high)
        if sign == "-":
            b = self.helper("multiply_whole", WHOLE, b, whole_constant(-1))
        return self.helper("multiply_whole" if sign == "*" else "add_whole", WHOLE, a, b)

    def _tuple_operation(self, node: ast.AST, sign: str, left: Value, right: Value) -> Value:
        if sign == "+":
            return Row((*self.row(node, left).items, *self.row(node, right).items))
        if sign == "*":
            for sequence, times in ((left, right), (right, left)):
                if isinstance(times, Known) and isinstance(times.value, int):
                    return Row(self.row(node, sequence).items * times.value)
        return self.refuse(node, f"uses {sign} of a tuple, which C99 code is not written for")

    def _power(self, node: ast.AST, left: Value, right: Value) -> Value:
        base, exponent = self.scalar(node, left), right.value if isinstance(right, Known) else None
        if (
            exponent is not None
            and float(exponent).is_integer()
            and 1 <= exponent <= _LARGEST_POWER
        ):
            if isinstance(exponent, float) or base.kind == NUMBER:
                base = self.number(node, base)
            base = self.held(base)
            product: Value = base
            for _ in range(int(exponent) - 1):
                product = self.binary(node, ast.Mult(), product, base)
            return product
        if base.kind != NUMBER and isinstance(exponent, int):
            return self.refuse(
                node, f"uses an integer to the power of {exponent}; 1 to {_LARGEST_POWER} can be"
            )
        return self.function_of_math(node, "pow", self.number(node, left), self.number(node, right))

    def _boolop(self, node: ast.BoolOp) -> Value:
        both = isinstance(node.op, ast.And)
        return self._junction(node, node.values, both)

    def _junction(self, node: ast.BoolOp, nodes: Sequence[ast.expr], both: bool) -> Value:
        """``a and b and …``, or with ``or``: values are computed only as far as they decide."""
        first = self.value(nodes[0])
        if len(nodes) == 1:
            return first
        truth = self.truth(nodes[0], first)
        if isinstance(truth, Known):
            return self._junction(node, nodes[1:], both) if truth.value == both else first
        held = first
        if isinstance(first, Scalar) and first.kind != TRUTH:
            held = self.held(first)
            truth = self.truth(nodes[0], held)
        assert isinstance(truth, Scalar)
        rest_block = Block()
        rest = self.within(rest_block, lambda: self._junction(node, nodes[1:], both))
        if form_of(held) == TRUTH and form_of(rest) == TRUTH and not rest_block.items:
            self.block.costs += rest_block.costs
            second = self.scalar(node, rest)
            parts = [inside(each, UNARY) for each in (truth, second)]
            return Scalar((" && " if both else " || ").join(parts), TRUTH, LOGICAL)
        other = Block()
        branches = ((rest_block, rest), (other, held))
        return self.choice(node, truth, *(branches if both else branches[::-1]))

    def _compare(self, node: ast.Compare) -> Value:
        operands = [self.value(each) for each in (node.left, *node.comparators)]
        parts: list[Value] = []
        for k, op in enumerate(node.ops):
            if k > 0 and isinstance(operands[k], Scalar):
                # The middle of a chain is written twice.
                operands[k] = self.held(self.scalar(node, operands[k]))
            parts.append(self._comparison(node, op, operands[k], operands[k + 1]))
        if any(isinstance(part, Known) and not part.value for part in parts):
            return Known(False)
        unknown = [part for part in parts if isinstance(part, Scalar)]
        if len(unknown) < 2:
            return unknown[0] if unknown else Known(True)
        texts = [inside(part, UNARY) for part in unknown]
        return Scalar(" && ".join(texts), TRUTH, LOGICAL)

    def _comparison(self, node: ast.Compare, op: ast.cmpop, left: Value, right: Value) -> Value:
        if isinstance(op, ast.Is | ast.IsNot):
            known = [isinstance(v, Known) and v.value is None for v in (left, right)]
            if not any(known):
                return self.refuse(node, "uses `is` of other things than None")
            return Known(all(known) == isinstance(op, ast.Is))
        if type(op) not in _COMPARISONS:
            return self.refuse(node, f"uses {wording(op)}, which C99 code is not written for")
        sign, rank, compute = _COMPARISONS[type(op)]
        if isinstance(left, Known) and isinstance(right, Known):
            return Known(bool(compute(left.value, right.value)))
        first, second = self.scalar(node, left), self.scalar(node, right)
        if NUMBER in (first.kind, second.kind):
            first, second = self.number(node, left), self.number(node, right)
        elif first.kind != second.kind:
            first, second = self.whole(node, first), self.whole(node, second)
        if first.kind != NUMBER and first.text == second.text:
            # Compilers warn of it. A number is compared with itself to find NaN.
            return Known(bool(compute(0, 0)))
        self.cost("comparisons")
        return Scalar(f"{inside(first, UNARY)} {sign} {inside(second, UNARY)}", TRUTH, rank)

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
        return Scalar(name, WHOLE, ATOM, min(value.low, -_INT64), max(value.high, _INT64))

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

    # ------------------------------------------------------------ places in tuples and in memory

    def _subscript(self, node: ast.Subscript) -> Value:
        owner = self.value(node.value)
        if isinstance(node.slice, ast.Slice):
            return self._slice(node, owner)
        index = self.value(node.slice)
        if isinstance(owner, Space):
            return Scalar(f"{owner.text}[{self.place(node, index, owner.length)}]", NUMBER, POSTFIX)
        if isinstance(owner, Known) and isinstance(owner.value, np.ndarray):
            return self._of_array(node, owner, index)
        items = self.row(node, owner).items
        if isinstance(index, Known):
            try:
                return items[operator.index(index.value)]
            except (IndexError, TypeError):
                return self.refuse(
                    node, f"uses place {index.value!r} of a tuple of {len(items)} values"
                )
        if not items:
            return self.refuse(node, "uses a place of an empty tuple")
        place = self.place(node, index, len(items))
        numbers = [item.value for item in items if isinstance(item, Known)]
        kinds = {*map(scalar_kind, numbers)}
        if isinstance(owner, Known) and kinds == {WHOLE} and max(map(abs, numbers)) <= _INT32:
            table = self.program.table(self.definition, node, owner.name or "table", numbers)
            limits = float(min(numbers)), float(max(numbers))
            return Scalar(f"{table}[{place}]", WHOLE, POSTFIX, *limits)
        if isinstance(owner, Known) and kinds == {NUMBER}:
            table = self.program.table(self.definition, node, owner.name or "table", numbers)
            return Scalar(f"{table}[{place}]", NUMBER, POSTFIX)
        form = form_of(owner)
        if isinstance(owner, Row) and set(form) == {NUMBER}:
            whole = owner.whole or self.temporary(
                self.program.struct(form), self.structure(node, owner, form)
            )
            return Scalar(f"{whole}.v[{place}]", NUMBER, POSTFIX)
        return self.refuse(node, "uses a place, not known before, of a tuple of other things")

    def _of_array(self, node: ast.Subscript, owner: Known, index: Value) -> Value:
        array = owner.value
        places = self.row(node, index).items if _is_tuple(index) else (index,)
        if array.dtype.kind not in "fiub" or len(places) != array.ndim:
            return self.refuse(node, "uses an array other than by one index for each axis")
        flat_place: Value = Known(0)
        for length, place in zip(array.shape, places, strict=True):
            one = self.place_value(node, place, length)
            scaled = self.binary(node, ast.Mult(), flat_place, Known(length))
            flat_place = self.binary(node, ast.Add(), scaled, one)
        numbers = [float(x) for x in array.ravel()]
        if isinstance(flat_place, Known):
            return Known(numbers[flat_place.value])
        table = self.program.table(self.definition, node, owner.name or "table", numbers)
        return Scalar(f"{table}[{self.scalar(node, flat_place).text}]", NUMBER, POSTFIX)

    def place(self, node: ast.AST, index: Value, length: int) -> str:
        """Text of an index, inside of so many numbers."""
        return self.scalar(node, self.place_value(node, index, length)).text

    def place_value(self, node: ast.AST, index: Value, length: int) -> Value:
        """An index, inside of so many numbers: proved by its limits, or forced."""
        if isinstance(index, Known):
            if not -length <= index.value < length:
                self.refuse(node, f"uses place {index.value} of {length} numbers")
            return Known(int(index.value) % length)
        found = self.whole(node, index)
        if found.low >= 0 and found.high < length:
            return Known(int(found.low)) if found.low == found.high else found
        self.cost("comparisons", 3)
        forced = self.helper("place", WHOLE, found, whole_constant(length))
        return Scalar(forced.text, WHOLE, forced.rank, 0.0, length - 1.0)

    def _slice(self, node: ast.Subscript, owner: Value) -> Value:
        assert isinstance(node.slice, ast.Slice)
        ends = []
        for part in (node.slice.lower, node.slice.upper, node.slice.step):
            end = Known(None) if part is None else self.value(part)
            if not isinstance(end, Known):
                return self.refuse(node, "uses a part of a tuple whose ends are not constants")
            ends.append(end.value)
        if isinstance(owner, Known) and isinstance(owner.value, tuple):
            return Known(owner.value[slice(*ends)])
        return Row(self.row(node, owner).items[slice(*ends)])

    # ------------------------------------------------------------ calls

    def helper(self, name: str, kind: str, *arguments: Scalar) -> Scalar:
        """Call of a function of `fuzzytrack.interop.c99.arithmetic`."""
        texts = ", ".join(argument.text for argument in arguments)
        return Scalar(f"{self.program.helper(name)}({texts})", kind, POSTFIX)

    def function_of_math(self, node: ast.AST, name: str, *arguments: Scalar) -> Scalar:
        """Call of a function with that name in Python's and in C's mathematical library."""
        self.cost(name)
        own = name in ("sqrt", "exp", "log", "pow", "cos", "sin") and name not in self.program.libm
        texts = ", ".join(argument.text for argument in arguments)
        function = (
            self.program.helper(name) if own else self.program.library(self.definition, node, name)
        )
        return Scalar(f"{function}({texts})", NUMBER, POSTFIX)

    def statement(self, text: str) -> None:
        """Add a statement to the block."""
        self.block.items.append(Line(text))


def _corner(sign: str, x: float, y: float) -> float:
    if sign == "*":
        return 0.0 if 0.0 in (x, y) else x * y
    total = x + y if sign == "+" else x - y
    return total if total == total else math.inf


def _known_tuple(value: Value) -> bool:
    return isinstance(value, Known) and isinstance(value.value, tuple)


def _is_tuple(value: Value) -> bool:
    return isinstance(value, Row) or _known_tuple(value)


def _tuple_of_functions(value: Any) -> bool:
    return type(value) is tuple and all(
        plain_function(item) is not None or scalar_kind(item) or constant_tuple(item)
        for item in value
    )


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
