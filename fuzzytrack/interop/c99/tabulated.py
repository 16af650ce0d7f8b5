"""A rule base written as a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.coverage import find_hole
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.interop.c99.c_program import CProgram
from fuzzytrack.interop.c99.float_lookup import FloatLookup, float_lookup
from fuzzytrack.interop.c99.float_writer import FloatWriter
from fuzzytrack.interop.c99.grid_table import (
    GridTable,
    default_nodes,
    even_table,
)
from fuzzytrack.interop.c99.number_types import NumberType
from fuzzytrack.interop.c99.q15_lookup import Q15Lookup, q15_lookup
from fuzzytrack.interop.c99.q15_writer import Q15Writer
from fuzzytrack.interop.c99.signature import Signature
from fuzzytrack.reprs import summary

__all__ = ["Tabulated", "tabulated"]


@dataclass(frozen=True, eq=False)
class Tabulated:
    """A table, and the same in numbers of C.

    Attributes
    ----------
    rules : RuleBase
    table : GridTable
    lookup : FloatLookup or Q15Lookup
    """

    #: Random inputs at which the error is measured, at the most.
    most_random: ClassVar[int] = 10_000_000

    rules: RuleBase
    table: GridTable
    lookup: FloatLookup | Q15Lookup

    def __repr__(self) -> str:
        return summary(self, "method", "nodes")

    @property
    def method(self) -> str:
        """What it is called among the figures."""
        return "break points" if self.table.exact else "table"

    @property
    def words(self) -> str:
        """What it is, in a sentence."""
        size = " x ".join(str(len(n)) for n in self.table.nodes)
        if self.table.exact:
            return f"a table at the break points of the sets ({size}), exact but for rounding"
        return f"a table of {size} nodes, an approximation between them"

    @property
    def nodes(self) -> tuple[Array, ...]:
        """Nodes of each input."""
        return self.table.nodes

    @property
    def silent(self) -> Mapping[str, str]:
        """What outputs are where no rule fires, for those where this can happen."""
        says = {}
        for name, total in self.table.totals.items():
            if not total.min() > 0.0:
                default = self.rules.output(name).default
                says[name] = "NaN" if default is None else f"{default:.15g}"
        return says

    def program(self, names: Signature) -> CProgram:
        """Source in C."""
        if isinstance(self.lookup, Q15Lookup):
            return Q15Writer(names, self.lookup).program()
        return FloatWriter(names, self.lookup).program()

    def evaluate(self, rows: NDArray[Any]) -> NDArray[Any]:
        """What the program gives at numbers of C, shape (n, n_outputs)."""
        return np.stack(list(self.lookup(rows).values()), axis=1)


def tabulated(
    system: FuzzySystem, number: NumberType, exact: GridTable | None, nodes: int | None
) -> Tabulated:
    """Tabulate a rule base.

    Parameters
    ----------
    system : FuzzySystem
    number : NumberType
    exact : GridTable or None
        Its table at the break points of its sets, if there is one.
    nodes : int, optional
        Nodes on each input of another table.

    Raises
    ------
    RuleBaseError
        If no rule fires at a node of a table that is not exact; or with integers anywhere, and an
        output has no default.
    ValueError
        If `nodes` are out of range.
    """
    rules = system.rules
    table = exact
    if table is None:
        table = even_table(system, default_nodes(len(rules.inputs)) if nodes is None else nodes)
        _refuse_gaps(rules, table)
    defaults = {v.name: np.nan if v.default is None else v.default for v in rules.outputs}
    if not number.whole:
        return Tabulated(rules, table, float_lookup(table, defaults, number.dtype))
    for name in table.totals:
        hole = find_hole(rules, name) if np.isnan(defaults[name]) else None
        if hole is not None and hole.stretches:
            raise RuleBaseError(
                f"{rules.name}: {hole}, and integers have no NaN: add a rule, or give the output a "
                "default"
            )
    universes = {v.name: v.universe for v in rules.outputs}
    inputs = tuple(v.universe for v in rules.inputs)
    return Tabulated(rules, table, q15_lookup(table, inputs, universes, defaults))


def _refuse_gaps(rules: RuleBase, table: GridTable) -> None:
    """Raise RuleBaseError if no rule fires at a node of a table."""
    for name, values in table.moments.items():
        if np.isnan(values).any():
            node = np.argwhere(np.isnan(values))[0]
            where = ", ".join(
                f"{word}={axis[k]:.6g}"
                for word, axis, k in zip(rules.input_names, table.nodes, node, strict=True)
            )
            raise RuleBaseError(
                f"{rules.name}: no rule about {name} fires at {where}, and a table has no gaps: "
                "add a rule, or give the output a default"
            )
