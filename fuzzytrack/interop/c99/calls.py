"""Calls in Python as calls in C: of Python's own functions, of `math`, and of other functions."""

from __future__ import annotations

import ast
import builtins
import inspect
import math
from collections.abc import Callable, Sequence
from types import FunctionType
from typing import Any

from fuzzytrack.interop.c99.conversions import describe
from fuzzytrack.interop.c99.expressions import ExpressionWriter
from fuzzytrack.interop.c99.python_source import plain_function
from fuzzytrack.interop.c99.values import (
    CHOICE,
    EQUAL,
    NUMBER,
    POSTFIX,
    TRUTH,
    UNARY,
    WHOLE,
    Known,
    Row,
    Scalar,
    Space,
    Value,
)
from fuzzytrack.kernels import language

__all__ = ["CallWriter"]

#: Instructions to a compiler, which C code does without.
_INSTRUCTIONS = (
    language.use_wide_vectors, language.promise_independent_turns, language.read_soon,
)  # fmt: skip

_INT64 = 2.0**63


class CallWriter(ExpressionWriter):
    """Writes the calls of one function."""

    def _call(self, node: ast.Call) -> Value:
        called = self.value(node.func)
        if not isinstance(called, Known):
            return self.refuse(node, f"calls {describe(called)}")
        function = called.value
        if function in _INSTRUCTIONS:
            return Known(None)
        arguments: list[Value] = []
        for part in node.args:
            if isinstance(part, ast.Starred):
                arguments += self.row(part, self.value(part.value)).items
            else:
                arguments.append(self.value(part))
        named = {}
        for word in node.keywords:
            if word.arg is None:
                return self.refuse(node, "passes arguments by **")
            named[word.arg] = self.value(word.value)
        if function is language.own_numbers:
            return self._own_numbers(node, *arguments)
        plain = plain_function(function)
        if plain is not None:
            return self._function(node, plain, arguments, named)
        return self._built_in(node, function, arguments, named)

    def _own_numbers(self, node: ast.Call, count: Value) -> Space:
        if not isinstance(count, Known) or not isinstance(count.value, int):
            return self.refuse(node, "asks for numbers of its own without a constant count")
        self.temporaries += 1
        name = f"own_{self.temporaries}" if self.temporaries > 1 else "own_numbers"
        zero = self.program.literal(self.definition, node, 0.0).text
        self.statement(f"{self.program.number} {name}[{max(count.value, 1)}] = {{{zero}}};")
        return Space(name, count.value)

    # ------------------------------------------------------------ other functions

    def _function(
        self, node: ast.Call, function: Any, arguments: list[Value], named: dict[str, Value]
    ) -> Value:
        signature = inspect.signature(function)
        try:
            bound = signature.bind(*arguments, **named)
        except TypeError as error:
            return self.refuse(node, f"calls {function.__name__} with other arguments: {error}")
        given: list[Value] = []
        for name, parameter in signature.parameters.items():
            if parameter.kind is parameter.VAR_POSITIONAL:
                given.append(Row(tuple(bound.arguments.get(name, ()))))
            elif parameter.kind is parameter.VAR_KEYWORD:
                return self.refuse(node, f"calls {function.__name__}, which takes **{name}")
            else:
                given.append(bound.arguments.get(name, Known(parameter.default)))
        return self.called(node, function, given)

    def called(self, node: ast.Call, function: FunctionType, given: Sequence[Value]) -> Value:
        """Value of a call of another function in C."""
        raise NotImplementedError

    # ------------------------------------------------------------ Python's own functions

    def _built_in(
        self, node: ast.Call, function: Any, arguments: list[Value], named: dict[str, Value]
    ) -> Value:
        name = getattr(function, "__name__", repr(function))
        if named:
            return self.refuse(node, f"calls {name} with an argument by its name")
        module = getattr(function, "__module__", "")
        if module == "math":
            return self._of_math(node, function, arguments)
        write = getattr(self, f"_{name}_of", None)
        if write is None or getattr(builtins, name, None) is not function:
            return self.refuse(node, f"calls {name}, which C99 code is not written for")
        try:
            found: Value = write(node, *arguments)
        except TypeError as error:
            if "positional argument" not in str(error):
                raise
            return self.refuse(node, f"calls {name} with {len(arguments)} arguments")
        return found

    def _folded(self, function: Callable[..., Any], *arguments: Value) -> Value | None:
        """Result of a function if all its arguments are known."""
        values = [argument.value for argument in arguments if isinstance(argument, Known)]
        if len(values) < len(arguments):
            return None
        try:
            return Known(function(*values))
        except (ArithmeticError, TypeError, ValueError):
            return None

    def _min_of(self, node: ast.Call, *arguments: Value) -> Value:
        return self._extreme(node, min, arguments)

    def _max_of(self, node: ast.Call, *arguments: Value) -> Value:
        return self._extreme(node, max, arguments)

    def _extreme(
        self, node: ast.Call, function: Callable[..., Any], arguments: tuple[Value, ...]
    ) -> Value:
        if len(arguments) == 1:
            arguments = self.row(node, arguments[0]).items
        if not arguments:
            return self.refuse(node, f"calls {function.__name__} without values")
        found = self._folded(lambda *values: function(values), *arguments)
        if found is not None:
            return found
        scalars = [self.scalar(node, argument) for argument in arguments]
        numbers = any(scalar.kind == NUMBER for scalar in scalars)
        convert = self.number if numbers else self.whole
        name = f"{function.__name__}imum" + ("" if numbers else "_whole")
        result = convert(node, arguments[0])
        for argument in arguments[1:]:
            other = convert(node, argument)
            low, high = function(result.low, other.low), function(result.high, other.high)
            call = self.helper(name, result.kind, result, other)
            self.cost("choices")
            self.cost("comparisons")
            if not numbers and max(-low, high) < 2.0**31:
                call = Scalar(f"(int32_t){call.text}", WHOLE, UNARY)
            result = Scalar(call.text, call.kind, call.rank, low, high)
        return result

    def _abs_of(self, node: ast.Call, x: Value) -> Value:
        found = self._folded(abs, x)
        if found is not None:
            return found
        scalar = self.scalar(node, x)
        if scalar.kind == NUMBER:
            return self.helper("absolute", NUMBER, scalar)
        return self.helper("absolute_whole", WHOLE, self.whole(node, x))

    def _int_of(self, node: ast.Call, x: Value) -> Value:
        return self._folded(int, x) or self._toward(node, "whole", x, math.trunc)

    def _toward(
        self, node: ast.Call, name: str, x: Value, rounded: Callable[[float], int]
    ) -> Value:
        """Integer next to a number."""
        scalar = self.scalar(node, x)
        if scalar.kind != NUMBER:
            return self.whole(node, x)
        self.cost("conversions")
        found = self.helper(name, WHOLE, scalar)
        # NaN becomes 0.
        low, high = min(scalar.low, 0.0), max(scalar.high, 0.0)
        if max(-low, high) < 2.0**31 - 1:
            return Scalar(
                f"(int32_t){found.text}", WHOLE, UNARY, float(rounded(low)), float(rounded(high))
            )
        return Scalar(found.text, WHOLE, POSTFIX, -_INT64, _INT64)

    def _float_of(self, node: ast.Call, x: Value) -> Value:
        return self._folded(float, x) or self.number(node, x)

    def _bool_of(self, node: ast.Call, x: Value) -> Value:
        return self.truth(node, x)

    def _len_of(self, node: ast.Call, x: Value) -> Value:
        return Known(x.length if isinstance(x, Space) else len(self.row(node, x).items))

    def _round_of(self, node: ast.Call, x: Value) -> Value:
        found = self._folded(round, x)
        if found is not None:
            return found
        value = self.held(self.number(node, x))
        half = self.program.literal(self.definition, node, 0.5)
        below = self.held(self.helper("floor", WHOLE, value))
        self.cost("conversions")
        self.cost("comparisons", 2)
        self.cost("additions")
        rest = self.temporary(
            self.program.number, f"{value.text} - ({self.program.number}){below.text}"
        )
        up = f"{rest} > {half.text} || ({rest} == {half.text} && {below.text} % 2 != 0)"
        added = f"{self.program.helper('add_whole')}({below.text}, 1)"
        return Scalar(f"({up}) ? {added} : {below.text}", WHOLE, CHOICE, -_INT64, _INT64)

    def _sum_of(self, node: ast.Call, x: Value) -> Value:
        total: Value = Known(0)
        for item in self.row(node, x).items:
            total = self.binary(node, ast.Add(), total, item)
        return total

    def _tuple_of(self, node: ast.Call, x: Value) -> Value:
        return self.row(node, x)

    # ------------------------------------------------------------ math

    def _of_math(self, node: ast.Call, function: Any, arguments: list[Value]) -> Value:
        found = self._folded(function, *arguments)
        if found is not None:
            return found
        name = function.__name__
        if name in ("floor", "ceil", "trunc") and len(arguments) == 1:
            helper = "whole" if name == "trunc" else name
            return self._toward(node, helper, arguments[0], function)
        numbers = [self.number(node, argument) for argument in arguments]
        if len(numbers) == 1:
            (x,) = numbers
            if name == "fabs":
                return self.helper("absolute", NUMBER, x)
            if name in ("isnan", "isfinite", "isinf"):
                return self._kind_of_number(node, name, x)
        if len(numbers) != (2 if name in _OF_TWO else 1):
            return self.refuse(node, f"calls math.{name} with {len(numbers)} arguments")
        return self.function_of_math(node, name, *numbers)

    def _kind_of_number(self, node: ast.Call, name: str, x: Scalar) -> Scalar:
        held = self.held(x).text
        self.cost("comparisons", 2)
        if name == "isnan":
            return Scalar(f"{held} != {held}", TRUTH, EQUAL)
        infinity = self.program.literal(self.definition, node, math.inf).text
        if name == "isinf":
            return Scalar(f"({held} == {infinity} || {held} == -{infinity})", TRUTH)
        return Scalar(f"({held} < {infinity} && {held} > -{infinity})", TRUTH)


#: Functions of `math` that take two numbers.
_OF_TWO = ("pow", "atan2", "fmod", "hypot", "copysign")
