"""A rule base written as the formulas of its sets and rules.

They are those of `fuzzytrack.fuzzy.kernel`, translated. A program with numbers of 32 bits computes
them with 64, and rounds once: sums over an output's grid would otherwise lose two digits.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.coverage import find_hole
from fuzzytrack.fuzzy.kernel import Infer, infer_function
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.interop.c99.c_program import CProgram
from fuzzytrack.interop.c99.identifiers import Identifiers
from fuzzytrack.interop.c99.number_types import NumberType
from fuzzytrack.interop.c99.signature import Signature
from fuzzytrack.interop.c99.translation import translated
from fuzzytrack.interop.c99.values import NUMBER
from fuzzytrack.reprs import summary

__all__ = ["Formulas", "formulas"]


@dataclass(frozen=True, eq=False)
class Formulas:
    """Formulas of a rule base.

    Attributes
    ----------
    rules : RuleBase
    number : NumberType
    infer : callable
        See `fuzzytrack.fuzzy.kernel.infer_function`.
    """

    #: Random inputs at which the error is measured, at the most: one by one, in plain Python.
    most_random: ClassVar[int] = 20_000
    #: Name among the figures.
    method: ClassVar[str] = "formulas"
    #: Nodes of a table; it has none.
    nodes: ClassVar[tuple[Array, ...]] = ()

    rules: RuleBase
    number: NumberType
    infer: Infer

    def __repr__(self) -> str:
        return summary(self, "rules", "number")

    @property
    def words(self) -> str:
        """What it is, in a sentence."""
        inside = " in double, rounded to float" if self.number.name == "float" else ""
        return f"the formulas of sets and rules{inside}"

    @property
    def silent(self) -> Mapping[str, str]:
        """What outputs are where no rule fires, for those where this can happen."""
        says = {}
        for output in self.rules.outputs:
            if find_hole(self.rules, output.name) is not None:
                says[output.name] = "NaN" if output.default is None else f"{output.default:.15g}"
        return says

    def program(self, names: Signature) -> CProgram:
        """Source in C."""
        inner = f"{names.prefix}_formulas"
        made = translated(
            self.infer, name=inner, number="double", arguments=((NUMBER,) * len(names.inputs),)
        )
        scope = Identifiers(*names.inputs)
        given, found, y = (scope.unique(word) for word in ("given", "found", "y"))
        wide = names.inputs if names.c_type == "double" else [f"(double){n}" for n in names.inputs]
        cast = ", ".join(wide)
        unknown = " || ".join(f"({name} != {name})" for name in names.inputs)
        unknown = f"({unknown})" if len(names.inputs) > 1 else unknown
        rounded = "(float)" if names.c_type == "float" else ""
        results = [
            f"{y}.{member} = {unknown} ? ({names.c_type})NAN : {rounded}{found}[{k}];"
            for k, member in enumerate(names.outputs)
        ]
        lines = [
            *names.structure_lines(),
            "",
            f"/* {', '.join(names.outputs)} of {', '.join(names.inputs)}. */",
            names.declaration(),
            "{",
            f"    const double {given}[{len(names.inputs)}] = {{ {cast} }};",
            f"    double {found}[{len(names.outputs)}];",
            f"    {names.structure} {y};",
            "",
            f"    {inner}({given}, {found});",
            *(f"    {line}" for line in results),
            "",
            f"    return {y};",
            "}",
        ]
        operations = dict(made.operations)
        operations["comparisons"] = operations.get("comparisons", 0) + len(names.inputs)
        return CProgram(
            f"{made.definitions.rstrip()}\n\n" + "\n".join(lines) + "\n",
            operations,
            made.constants_bytes,
            None,
            frozenset(made.includes),
            made.needs,
        )

    def evaluate(self, rows: NDArray[Any]) -> NDArray[Any]:
        """What the program gives at numbers of C, shape (n, n_outputs), but for the last bits."""
        found = np.array([self.infer(tuple(row)) for row in rows.astype(np.float64).tolist()])
        found[np.isnan(rows).any(axis=1)] = np.nan
        return found.astype(self.number.dtype)


def formulas(system: FuzzySystem, number: NumberType) -> Formulas:
    """Write the formulas of a rule base.

    Raises
    ------
    ValueError
        If it cannot be written as formulas.
    """
    for operators in map(system.rules.operators_of, system.rules.outputs):
        if operators.defuzzification not in ("centroid", "weighted-centers"):
            raise ValueError(
                f"table: {system.rules.name} has defuzzification {operators.defuzzification}, for "
                "which there are no formulas; write a table"
            )
    return Formulas(system.rules, number, infer_function(system))
