"""Names of a rule base in C: of its function, its parameters and what it returns."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.interop.c99.identifiers import Identifiers

__all__ = ["INLINE", "Signature", "signature"]

#: A user may define another word than ``static inline`` before a header is included.
INLINE = ("#ifndef FUZZYTRACK_INLINE", "#define FUZZYTRACK_INLINE static inline", "#endif")


@dataclass(frozen=True)
class Signature:
    """Names of a rule base in C.

    Attributes
    ----------
    prefix : str
        With which all names begin.
    inputs, outputs : tuple of str
        Parameters of the function, and members of the structure that it returns.
    c_type : str
        Type of both.
    """

    prefix: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    c_type: str

    @property
    def function(self) -> str:
        """The function."""
        return f"{self.prefix}_infer"

    @property
    def structure(self) -> str:
        """The structure that it returns."""
        return f"{self.prefix}_outputs"

    def structure_lines(self) -> list[str]:
        """Definition of the structure."""
        members = [f"    {self.c_type} {name};" for name in self.outputs]
        return [
            f"/* What {self.function} returns. */",
            "typedef struct {",
            *members,
            f"}} {self.structure};",
        ]

    def declaration(self) -> str:
        """Head of the function."""
        parameters = ", ".join(f"{self.c_type} {name}" for name in self.inputs)
        return f"FUZZYTRACK_INLINE {self.structure} {self.function}({parameters})"


def signature(rules: RuleBase, prefix: str, c_type: str) -> Signature:
    """Names of a rule base in C, each once in its scope."""
    scope, members = Identifiers(), Identifiers()
    return Signature(
        prefix,
        tuple(scope.unique(name, "input") for name in rules.input_names),
        tuple(members.unique(name, "output") for name in rules.output_names),
        c_type,
    )
