"""A piece of C source and what it needs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from fuzzytrack.plurals import counted
from fuzzytrack.reprs import summary

__all__ = ["OPERATIONS", "CProgram", "operations_in_words"]

#: Kinds of operations, as they are printed.
OPERATIONS = ("additions", "multiplications", "divisions", "comparisons", "shifts")


@dataclass(frozen=True, eq=False)
class CProgram:
    """Definitions in C.

    Attributes
    ----------
    definitions : str
        Types and functions, without the lines that include headers.
    operations : dict of int
        Most operations of one call by kind; subtractions are additions.
    constants_bytes : int
        Bytes of constant data.
    state_bytes : int or None
        Bytes of the local variables of a call; None if they are not counted.
    includes, needs : frozenset of str
        Headers, and functions of the library of mathematics.
    """

    definitions: str
    operations: Mapping[str, int]
    constants_bytes: int
    state_bytes: int | None
    includes: frozenset[str] = field(default=frozenset())
    needs: frozenset[str] = field(default=frozenset())

    def __repr__(self) -> str:
        return summary(self, "constants_bytes", "state_bytes", "needs")


def operations_in_words(operations: Mapping[str, int]) -> str:
    """Counts of operations: ``1 division, 3 exp``; functions have their names."""
    return ", ".join(
        counted(number, kind.removesuffix("s")) if kind.endswith("s") else f"{number} {kind}"
        for kind, number in operations.items()
        if number
    )
