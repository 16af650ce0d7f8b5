"""Places in tuples, arrays and memory, as places in C."""

from __future__ import annotations

import ast
import operator

import numpy as np

from fuzzytrack.interop.c99.conversions import whole_constant
from fuzzytrack.interop.c99.operations import OperationWriter
from fuzzytrack.interop.c99.values import (
    LARGEST_INT32,
    NUMBER,
    POSTFIX,
    WHOLE,
    Known,
    Row,
    Scalar,
    Space,
    Value,
    form_of,
    scalar_kind,
)

__all__ = ["PlaceWriter"]


class PlaceWriter(OperationWriter):
    """Writes the indices and slices of one function."""

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
        if (
            isinstance(owner, Known)
            and kinds == {WHOLE}
            and max(map(abs, numbers)) <= LARGEST_INT32
        ):
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


def _is_tuple(value: Value) -> bool:
    return isinstance(value, Row) or (isinstance(value, Known) and isinstance(value.value, tuple))
