"""Python operators as C operators: arithmetic, comparisons, and what joins truth values."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Sequence
from typing import Any

from fuzzytrack.interop.c99.blocks import Block
from fuzzytrack.interop.c99.choices import ChoiceWriter
from fuzzytrack.interop.c99.conversions import inside, operand, whole_constant, wording
from fuzzytrack.interop.c99.values import (
    BITWISE,
    COMPARED,
    EQUAL,
    LARGEST_INT32,
    LARGEST_INT64,
    LOGICAL,
    NUMBER,
    POSTFIX,
    PRODUCT,
    SUM,
    TRUTH,
    UNARY,
    WHOLE,
    Known,
    Row,
    Scalar,
    Value,
    form_of,
    scalar_kind,
)

__all__ = ["OperationWriter"]

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
#: Powers up to this one are products.
_LARGEST_POWER = 8


class OperationWriter(ChoiceWriter):
    """Writes the operations of one function."""

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
                if abs(b.low) <= LARGEST_INT32:
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
        if max(-low, high) <= LARGEST_INT32:
            text = f"{operand(a, rank)} {sign} {operand(b, rank, last=True)}"
            return Scalar(text, WHOLE, rank, low, high)
        if max(-low, high) <= LARGEST_INT64:
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

    def function_of_math(self, node: ast.AST, name: str, *arguments: Scalar) -> Scalar:
        """Call of a function with that name in Python's and in C's mathematical library."""
        self.cost(name)
        own = name in ("sqrt", "exp", "log", "pow", "cos", "sin") and name not in self.program.libm
        texts = ", ".join(argument.text for argument in arguments)
        function = (
            self.program.helper(name) if own else self.program.library(self.definition, node, name)
        )
        return Scalar(f"{function}({texts})", NUMBER, POSTFIX)

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


def _corner(sign: str, x: float, y: float) -> float:
    if sign == "*":
        return 0.0 if 0.0 in (x, y) else x * y
    total = x + y if sign == "+" else x - y
    return total if total == total else math.inf


def _known_tuple(value: Value) -> bool:
    return isinstance(value, Known) and isinstance(value.value, tuple)
