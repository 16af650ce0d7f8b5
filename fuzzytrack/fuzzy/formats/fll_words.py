"""Words of FLL files and what they stand for: terms with their parameters, norms, hedges."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

__all__ = [
    "DEFUZZIFIERS", "HEDGES", "KEYWORDS", "S_NORMS", "TERMS", "T_NORMS", "Term", "term_of",
]  # fmt: skip

Numbers = tuple[float, ...]
Set = tuple[str, Numbers]


@dataclass(frozen=True)
class Term:
    """A term of the language.

    Attributes
    ----------
    names : tuple of str
        Its parameters.
    read : callable
        From the parameters to the shape here and its parameters.
    """

    names: tuple[str, ...]
    read: Callable[[Numbers], Set]


def _as(shape: str, *names: str) -> Term:
    return Term(names, lambda numbers: (shape, numbers))


def _sides(shape: str) -> Term:
    # The slope of the right side stands before its inflection.
    names = ("left", "rising", "falling", "right")
    return Term(names, lambda p: (shape, (p[0], p[1], p[3], p[2])))


def _ramp(p: Numbers) -> Set:
    return ("linsmf", p) if p[0] <= p[1] else ("linzmf", (p[1], p[0]))


def _binary(p: Numbers) -> Set:
    return ("smf" if p[1] > 0 else "zmf"), (p[0], p[0])


def _rectangle(p: Numbers) -> Set:
    low, high = sorted(p)
    return "trapmf", (low, low, high, high)


def _ellipse(p: Numbers) -> Set:
    low, high = sorted(p)
    return "ellipse", (low, high)


#: Terms that are fuzzy sets. Discrete takes any number of pairs.
TERMS: dict[str, Term] = {
    "Arc": _as("arc", "start", "end"),
    "Bell": Term(("center", "width", "slope"), lambda p: ("gbellmf", (p[1], p[2], p[0]))),
    "Binary": Term(("start", "direction"), _binary),
    "Concave": _as("concave", "inflection", "end"),
    "Cosine": _as("cosine", "center", "width"),
    "Gaussian": _as("gaussmf", "mean", "deviation"),
    "GaussianProduct": _as("gauss2mf", "mean", "deviation", "mean", "deviation"),
    "PiShape": _as("pimf", "bottom-left", "top-left", "top-right", "bottom-right"),
    "Ramp": Term(("start", "end"), _ramp),
    "Rectangle": Term(("start", "end"), _rectangle),
    "SemiEllipse": Term(("start", "end"), _ellipse),
    "Sigmoid": _as("sigmf", "inflection", "slope"),
    "SigmoidDifference": _sides("dsigmf"),
    "SigmoidProduct": _sides("psigmf"),
    "Spike": _as("spike", "center", "width"),
    "SShape": _as("smf", "start", "end"),
    "Trapezoid": _as("trapmf", "bottom-left", "top-left", "top-right", "bottom-right"),
    "Triangle": _as("trimf", "left", "top", "right"),
    "ZShape": _as("zmf", "start", "end"),
}

_NAMES = {
    "trimf": "Triangle", "trapmf": "Trapezoid", "gaussmf": "Gaussian",
    "gauss2mf": "GaussianProduct", "sigmf": "Sigmoid", "pimf": "PiShape", "cosine": "Cosine",
    "spike": "Spike", "concave": "Concave", "arc": "Arc", "ellipse": "SemiEllipse",
    "discrete": "Discrete",
}  # fmt: skip


def term_of(shape: str, p: Numbers) -> tuple[str, Numbers] | None:
    """Term and parameters for a shape; None if there is no such term."""
    if shape in _NAMES:
        return _NAMES[shape], p
    if shape == "gbellmf":
        return "Bell", (p[2], p[0], p[1])
    if shape in ("dsigmf", "psigmf"):
        name = "SigmoidDifference" if shape == "dsigmf" else "SigmoidProduct"
        return name, (p[0], p[1], p[3], p[2])
    if shape in ("smf", "linsmf", "zmf", "linzmf"):
        rises = shape in ("smf", "linsmf")
        if p[0] == p[1]:
            return "Binary", (p[0], math.inf if rises else -math.inf)
        if shape in ("linsmf", "linzmf"):
            return "Ramp", p if rises else (p[1], p[0])
        return ("SShape" if rises else "ZShape"), p
    return None


T_NORMS = {
    "AlgebraicProduct": "product",
    "Minimum": "min",
    "EinsteinProduct": "einstein-product",
    "HamacherProduct": "hamacher-product",
}
S_NORMS = {
    "UnboundedSum": "sum",
    "Maximum": "max",
    "AlgebraicSum": "algebraic-sum",
    "BoundedSum": "bounded-sum",
    "EinsteinSum": "einstein-sum",
    "HamacherSum": "hamacher-sum",
}
DEFUZZIFIERS = {
    "Centroid": "centroid",
    "Bisector": "bisector",
    "MeanOfMaximum": "mom",
    "SmallestOfMaximum": "som",
    "LargestOfMaximum": "lom",
}
#: Hedges by their word in a rule.
HEDGES = {
    "not": "not",
    "very": "very",
    "somewhat": "somewhat",
    "extremely": "intensely",
    "seldom": "seldom",
    "any": "any",
}
#: Words of rules, which are no names.
KEYWORDS = frozenset({"if", "is", "then", "and", "or", "with", *HEDGES})
