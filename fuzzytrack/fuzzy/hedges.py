"""Hedges: words that change the grades of a fuzzy set, such as not and very."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.stretches import EVERYWHERE, Stretch, complement
from fuzzytrack.reprs import summary

__all__ = ["HEDGES", "MAX_HEDGES", "Hedge"]

#: Most hedges before one shape.
MAX_HEDGES = 3

Stretches = tuple[Stretch, ...]
# From the stretches on which grades are above zero, and those on which they are 1.
Follow = Callable[[Stretches, Stretches], Stretches]


@dataclass(frozen=True)
class Hedge:
    """A function of grades, from [0, 1] to [0, 1].

    Attributes
    ----------
    values : callable
        The function on arrays.
    expression : callable
        ``expression(grade) -> str``, the same of a scalar Python expression.
    keeps_order : bool
        Whether a larger grade stays larger, and 0 and 1 stay; so cores and centers stay.
    positive, ones : callable
        Stretches on which the new grade is above zero, and 1, from those of the old one.
    """

    values: Callable[[Array], Array]
    expression: Callable[[str], str]
    keeps_order: bool = True
    positive: Follow = lambda positive, ones: positive
    ones: Follow = lambda positive, ones: ones

    def __repr__(self) -> str:
        return summary(self, "keeps_order")


def _contrast(grades: Array) -> Array:
    return np.where(grades <= 0.5, 2.0 * grades**2, 1.0 - 2.0 * (1.0 - grades) ** 2)


def _contrast_expression(g: str) -> str:
    return f"(2.0 * ({g}) ** 2 if {g} <= 0.5 else 1.0 - 2.0 * (1.0 - ({g})) ** 2)"


def _seldom(grades: Array) -> Array:
    return np.where(grades <= 0.5, np.sqrt(grades / 2.0), 1.0 - np.sqrt((1.0 - grades) / 2.0))


def _seldom_expression(g: str) -> str:
    return f"((({g}) * 0.5) ** 0.5 if {g} <= 0.5 else 1.0 - ((1.0 - ({g})) * 0.5) ** 0.5)"


HEDGES: dict[str, Hedge] = {
    "not": Hedge(
        lambda g: 1.0 - g,
        lambda g: f"(1.0 - ({g}))",
        keeps_order=False,
        positive=lambda positive, ones: complement(ones),
        ones=lambda positive, ones: complement(positive),
    ),
    # Concentration, dilation and contrast intensification of Zadeh (1972).
    "very": Hedge(lambda g: g**2, lambda g: f"(({g}) ** 2)"),
    "somewhat": Hedge(np.sqrt, lambda g: f"(({g}) ** 0.5)"),
    "extremely": Hedge(lambda g: g**3, lambda g: f"(({g}) ** 3)"),
    "intensely": Hedge(_contrast, _contrast_expression),
    "seldom": Hedge(_seldom, _seldom_expression),
    "any": Hedge(
        np.ones_like,
        lambda g: "1.0",
        keeps_order=False,
        positive=lambda positive, ones: (EVERYWHERE,),
        ones=lambda positive, ones: (EVERYWHERE,),
    ),
}
