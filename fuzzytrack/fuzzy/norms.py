"""Norms: the AND and OR of grades, on arrays and as scalar expressions.

Only norms that are above zero where all of their grades are serve as AND, so that a rule fires
wherever each of its conditions is fulfilled to some degree.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = ["S_NORMS", "T_NORMS", "Norm"]


@dataclass(frozen=True)
class Norm:
    """A norm of two grades; of several, it is taken from the first to the last.

    Attributes
    ----------
    values : callable
        The norm of two arrays.
    expression : callable
        ``expression(a, b) -> str``, the norm of two scalar Python expressions.
    repeats : bool
        Whether the expression repeats its arguments, so that long ones need a name first.
    """

    values: Callable[[Array, Array], Array]
    expression: Callable[[str, str], str]
    repeats: bool = True

    def __repr__(self) -> str:
        return summary(self, "repeats")


# Sums of parts that are not negative keep grades within [0, 1]; differences would not near 1.


def _hamacher_product(a: Array, b: Array) -> Array:
    total = a + b * (1.0 - a)
    return np.asarray(np.where(total > 0.0, a * b / np.where(total > 0.0, total, 1.0), 0.0))


def _hamacher_sum(a: Array, b: Array) -> Array:
    either = a * (1.0 - b) + b * (1.0 - a)
    total = either + (1.0 - a) * (1.0 - b)
    return np.asarray(np.where(total > 0.0, either / np.where(total > 0.0, total, 1.0), 1.0))


def _hamacher_sum_expression(a: str, b: str) -> str:
    either, neither = f"{a} * (1.0 - {b}) + {b} * (1.0 - {a})", f"(1.0 - {a}) * (1.0 - {b})"
    return f"(({either}) / ({either} + {neither}) if {either} + {neither} > 0.0 else 1.0)"


#: What may stand for AND.
T_NORMS: dict[str, Norm] = {
    "product": Norm(lambda a, b: a * b, lambda a, b: f"{a} * {b}", repeats=False),
    "min": Norm(np.minimum, lambda a, b: f"min({a}, {b})", repeats=False),
    "einstein-product": Norm(
        lambda a, b: a * b / (1.0 + (1.0 - a) * (1.0 - b)),
        lambda a, b: f"{a} * {b} / (1.0 + (1.0 - {a}) * (1.0 - {b}))",
    ),
    "hamacher-product": Norm(
        _hamacher_product,
        lambda a, b: (
            f"({a} * {b} / ({a} + {b} * (1.0 - {a})) if {a} + {b} * (1.0 - {a}) > 0.0 else 0.0)"
        ),
    ),
}

#: What may stand for OR. The plain sum is no norm in the strict sense, as it exceeds 1.
S_NORMS: dict[str, Norm] = {
    "sum": Norm(lambda a, b: a + b, lambda a, b: f"{a} + {b}", repeats=False),
    "max": Norm(np.maximum, lambda a, b: f"max({a}, {b})", repeats=False),
    "algebraic-sum": Norm(
        lambda a, b: a + b * (1.0 - a), lambda a, b: f"({a} + {b} * (1.0 - {a}))"
    ),
    "bounded-sum": Norm(
        lambda a, b: np.minimum(1.0, a + b), lambda a, b: f"min(1.0, {a} + {b})", repeats=False
    ),
    "einstein-sum": Norm(
        lambda a, b: (a + b) / (1.0 + a * b), lambda a, b: f"({a} + {b}) / (1.0 + {a} * {b})"
    ),
    "hamacher-sum": Norm(_hamacher_sum, _hamacher_sum_expression),
}
