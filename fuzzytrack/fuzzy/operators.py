"""The algebra of a rule base: AND, OR, implication, weights and defuzzification."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.norms import S_NORMS, T_NORMS

__all__ = ["CONJUNCTIONS", "DEFUZZIFICATIONS", "DISJUNCTIONS", "Operators"]

CONJUNCTIONS = tuple(T_NORMS)
DISJUNCTIONS = tuple(S_NORMS)
DEFUZZIFICATIONS = ("centroid", "bisector", "mom", "som", "lom", "weighted-centers")


@dataclass(frozen=True)
class Operators:
    """The algebra of a rule base (Llinas et al. 1998, Table 3.1).

    Parameters
    ----------
    conjunction : str
        The AND of Eqs. 3.3 and 3.4, also the composition's: ``product``, ``min``,
        ``einstein-product`` or ``hamacher-product``.
    disjunction : str
        The OR of Eq. 3.5, by which the conclusions of all rules are joined, also the
        composition's: ``sum`` (the plain sum, not a bounded one), ``max``, ``algebraic-sum``,
        ``bounded-sum``, ``einstein-sum`` or ``hamacher-sum``.
    defuzzification : {"centroid", "bisector", "mom", "som", "lom", "weighted-centers"}
        ``centroid`` is the plain sum over the output grid (Eq. 3.10), ``weighted-centers`` the
        centroid over the sets' centers alone (Eqs. 3.12 and 3.13).
    implication : str
        How the strength of a rule changes the set that it concludes, of the words of
        `conjunction`; empty where it is the same as `conjunction`.
    weighting : str
        How the confidence of a conclusion changes the strength of its rule, likewise.
    alternatives : str
        The OR between alternative conditions inside of one rule, of the words of `disjunction`.
        ``sum`` goes with products, and sum or max, only, since a strength may then exceed 1.

    Raises
    ------
    RuleBaseError
        If a name is unknown.
    """

    conjunction: str = "product"
    disjunction: str = "sum"
    defuzzification: str = "centroid"
    implication: str = ""
    weighting: str = ""
    alternatives: str = "max"

    def __post_init__(self) -> None:
        for name in ("implication", "weighting"):
            if getattr(self, name) == self.conjunction:
                object.__setattr__(self, name, "")
        for role, word, allowed in (
            ("and", self.conjunction, CONJUNCTIONS),
            ("or", self.disjunction, DISJUNCTIONS),
            ("defuzzification", self.defuzzification, DEFUZZIFICATIONS),
            ("implication", self.implying, CONJUNCTIONS),
            ("weighting", self.weighing, CONJUNCTIONS),
            ("alternatives", self.alternatives, DISJUNCTIONS),
        ):
            if word not in allowed:
                raise RuleBaseError(
                    f"operators: unknown {role} {word!r}; one of {', '.join(allowed)}"
                )

    def words(self) -> dict[str, str]:
        """Words of a file, by key; those that follow from others are left out."""
        found = {
            "and": self.conjunction,
            "or": self.disjunction,
            "defuzzification": self.defuzzification,
        }
        if self.implication:
            found["implication"] = self.implication
        if self.weighting:
            found["weighting"] = self.weighting
        if self.alternatives != "max":
            found["alternatives"] = self.alternatives
        return found

    @property
    def implying(self) -> str:
        """The implication, in words of `conjunction`."""
        return self.implication or self.conjunction

    @property
    def weighing(self) -> str:
        """The weighting, in words of `conjunction`."""
        return self.weighting or self.conjunction

    @property
    def takes_sums(self) -> bool:
        """Whether a strength above 1, as the plain sum of alternatives has, is as good as any.

        Other norms are for grades: beyond 1 some divide by 0, become negative, or cut it to 1.
        """
        products = self.implying == self.weighing == "product"
        return products and self.disjunction in ("sum", "max")

    @property
    def is_classical(self) -> bool:
        """Whether it is one of the four algebras of Table 3.1, with one AND for everything."""
        return (
            not self.implication
            and not self.weighting
            and self.conjunction in ("product", "min")
            and (self.disjunction in ("sum", "max"))
        )
