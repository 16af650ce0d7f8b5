"""The function of a table in C, as far as it does not depend on its numbers."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from fuzzytrack.interop.c99.c_program import OPERATIONS, CProgram
from fuzzytrack.interop.c99.c_text import WIDTH, array_lines
from fuzzytrack.interop.c99.identifiers import Identifiers
from fuzzytrack.interop.c99.signature import INLINE, Signature

__all__ = ["LookupWriter"]

_BYTES = {"double": 8, "float": 4, "int16_t": 2, "uint16_t": 2, "uint32_t": 4, "uint64_t": 8}


class LookupWriter(ABC):
    """Collects the lines of the function, its data and what one call does.

    Parameters
    ----------
    names : Signature
    lookup : FloatLookup or Q15Lookup
        The table in numbers of C.
    """

    #: Type of the values of a table.
    cell: str

    def __init__(self, names: Signature, lookup: Any) -> None:
        self.names, self.lookup = names, lookup
        self.scope = Identifiers(*names.inputs)
        self.data: list[str] = []
        self.arrays: dict[tuple[str, tuple[Any, ...]], str] = {}
        self.variables: list[str] = []
        self.body: list[str] = []
        self.operations: Counter[str] = Counter(dict.fromkeys(OPERATIONS, 0))
        self.constants_bytes = 0
        self.locals_bytes = 0
        self.includes: set[str] = {"stdint.h"}
        self.between = f"{names.prefix}_between"
        #: The variable that counts nodes, once there is one.
        self.k = ""

    def program(self) -> CProgram:
        """The structure, the functions and their counts."""
        y = self.scope.unique("y")
        shares = [self.axis(k, axis) for k, axis in enumerate(self.lookup.axes)]
        place = self._place([index for index, *_ in shares])
        for name, member in zip(self.lookup.moments, self.names.outputs, strict=True):
            self.output(name, f"{y}.{member}", place, [rest for _, *rest in shares])
        lines = [
            *INLINE,
            "",
            *self.names.structure_lines(),
            "",
            *self.helpers(),
            "",
            f"/* {', '.join(self.names.outputs)} of {', '.join(self.names.inputs)}. */",
            self.names.declaration(),
            "{",
            *_indented([*self.data, f"{self.names.structure} {y};", *self.variables, ""]),
            *_indented([*self.body, "", f"return {y};"]),
            "}",
        ]
        return CProgram(
            "\n".join(lines) + "\n",
            dict(self.operations),
            self.constants_bytes,
            self.locals_bytes,
            frozenset(self.includes),
        )

    def array(
        self, c_type: str, name: str, values: Sequence[Any], comment: str = "", row: int = 0
    ) -> str:
        """Define a constant array, once for all of its type that are equal; its name."""
        key = (c_type, tuple(values))
        if key not in self.arrays:
            self.arrays[key] = self.scope.unique(name)
            self.data += [f"/* {comment} */"] if comment else []
            self.data += array_lines(c_type, self.arrays[key], values, row)
            self.constants_bytes += len(values) * _BYTES[c_type]
        return self.arrays[key]

    def variable(self, c_type: str, name: str, value: str | None = None) -> str:
        """Declare a local variable; its name."""
        found = self.scope.unique(name)
        self.variables.append(f"{c_type} {found}{'' if value is None else f' = {value}'};")
        self.locals_bytes += _BYTES[c_type]
        return found

    def interval(self, name: str, x: str, nodes: str, last: int) -> str:
        """Lines that find the interval of x among the nodes; the variable that holds it."""
        index = self.variable("uint32_t", f"{name}_index", "0U")
        if last > 1:
            self.k = self.k or self.variable("uint32_t", "k")
            self.body += [
                f"for ({self.k} = 1U; {self.k} < {last}U; {self.k}++) {{",
                f"    if ({x} >= {nodes}[{self.k}]) {{",
                f"        {index} = {self.k};",
                "    }",
                "}",
            ]
            # Each turn compares the number, and its own count.
            self.operations["comparisons"] += 2 * (last - 1) + 1
            self.operations["additions"] += last - 1
        return index

    def clipped(self, x: str, given: str, first: str, last: str) -> None:
        """Lines that move a number to the nearest end where it lies beyond; no end if empty."""
        for sign, end in (("<", first), (">", last)):
            if end:
                self.body.append(f"{x} = ({given} {sign} {end}) ? {end} : {given};")
                given = x
                self.operations["comparisons"] += 1

    def alike(self, axis: Any) -> str:
        """The inputs that have the nodes of an axis."""
        return " and ".join(
            name
            for name, other in zip(self.names.inputs, self.lookup.axes, strict=True)
            if np.array_equal(other.nodes, axis.nodes) and np.array_equal(other.rates, axis.rates)
        )

    def _place(self, indices: list[str]) -> str:
        """Lines for the first corner of the cell; the variable that holds its place."""
        lengths = [len(axis.nodes) for axis in self.lookup.axes]
        expression = indices[0]
        for k, (index, length) in enumerate(zip(indices[1:], lengths[1:], strict=True)):
            before = f"({expression})" if k else expression
            expression = f"({before} * {length}U) + {index}"
            self.operations["multiplications"] += 1
            self.operations["additions"] += 1
        if len(indices) == 1:
            return indices[0]
        place = self.variable("uint32_t", "corner")
        self.body += ["", f"{place} = {expression};"]
        return place

    def table(self, name: str, values: Any) -> str:
        """Define the table of an output; its name."""
        *down, across = self.names.inputs
        order = f"A row for each node of {' and '.join(down)}; across, those of {across}."
        order = order if down else ""
        return self.array(self.cell, name, list(values.ravel()), order, values.shape[-1])

    def interpolation(
        self, table: str, place: str, shares: list[list[str]], helper: str = ""
    ) -> list[str]:
        """An expression between the corners of a cell, over several lines.

        Parameters
        ----------
        table, place : str
            The table, and the place of the first corner.
        shares : list of list of str
            For each input what a call of the helper gets after two values.
        helper : str
            Function between two values; `between` unless given.
        """
        lengths = [len(axis.nodes) for axis in self.lookup.axes]
        strides = [math.prod(lengths[k + 1 :]) for k in range(len(lengths))]
        corners = []
        for steps in product((0, 1), repeat=len(lengths)):
            offset = sum(a * b for a, b in zip(steps, strides, strict=True))
            corners.append([f"{table}[{place}{f' + {offset}U' if offset else ''}]"])
            self.operations["additions"] += bool(offset)
        for own in reversed(shares):
            corners = [
                self._call(helper or self.between, [low, high, [", ".join(own)]])
                for low, high in zip(corners[::2], corners[1::2], strict=True)
            ]
        return corners[0]

    def _call(self, helper: str, arguments: list[list[str]]) -> list[str]:
        """A call of a helper, in one line if it fits."""
        self.count_call(helper)
        flat = f"{helper}({', '.join(a[0] for a in arguments)})"
        if all(len(a) == 1 for a in arguments) and len(flat) < WIDTH - 12:
            return [flat]
        flat = f"    {', '.join(a[0] for a in arguments)})"
        if all(len(a) == 1 for a in arguments) and len(flat) < WIDTH - 16:
            return [f"{helper}(", flat]
        lines = [f"{helper}("]
        for k, argument in enumerate(arguments):
            comma = "," if k < len(arguments) - 1 else ")"
            lines += [f"    {line}" for line in argument[:-1]]
            lines.append(f"    {argument[-1]}{comma}")
        return lines

    def assign(self, target: str, expression: list[str]) -> None:
        """Lines that assign an expression."""
        self.body += [f"{target} = {expression[0]}", *expression[1:]]
        self.body[-1] += ";"

    @abstractmethod
    def helpers(self) -> list[str]:
        """The functions between two nodes that were called."""

    @abstractmethod
    def count_call(self, helper: str) -> None:
        """Count the operations of a call of one of them."""

    @abstractmethod
    def axis(self, k: int, axis: Any) -> tuple[str, ...]:
        """Lines for the interval of an input; its index and its shares."""

    @abstractmethod
    def output(self, name: str, target: str, place: str, shares: list[list[str]]) -> None:
        """Lines for an output."""


def _indented(lines: list[str]) -> list[str]:
    return [f"    {line}" if line else "" for line in lines]
