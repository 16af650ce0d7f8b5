"""Python expressions as C expressions: names, constants and tuples, and all operations on them."""

from __future__ import annotations

import ast
import math
from typing import Any

import numpy as np

from fuzzytrack.interop.c99.conversions import wording
from fuzzytrack.interop.c99.places import PlaceWriter
from fuzzytrack.interop.c99.python_source import plain_function
from fuzzytrack.interop.c99.values import Known, Row, Value, constant_tuple, scalar_kind

__all__ = ["ExpressionWriter"]


class ExpressionWriter(PlaceWriter):
    """Writes the expressions of one function."""

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


def _tuple_of_functions(value: Any) -> bool:
    return type(value) is tuple and all(
        plain_function(item) is not None or scalar_kind(item) or constant_tuple(item)
        for item in value
    )
