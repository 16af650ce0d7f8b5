"""Point symmetry of a rule base: what is at −x is the same as at x."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.yamltree import quoted

__all__ = ["DRAWN", "mirrored_conditions", "mirrored_name", "mirrored_shape", "symmetric_shape"]

Numbers = tuple[float, ...]


def _reversed(p: Numbers, twice: float) -> Numbers:
    return tuple(twice - each + 0.0 for each in reversed(p))


#: Shape to the shape of its mirror image, and its parameters; `twice` is twice the middle.
_MIRRORS: dict[str, tuple[str, Callable[[Numbers, float], Numbers]]] = {
    "trimf": ("trimf", _reversed),
    "trapmf": ("trapmf", _reversed),
    "pimf": ("pimf", _reversed),
    "singleton": ("singleton", _reversed),
    "smf": ("zmf", _reversed),
    "zmf": ("smf", _reversed),
    "gaussmf": ("gaussmf", lambda p, twice: (twice - p[0] + 0.0, p[1])),
    "gauss2mf": (
        "gauss2mf",
        lambda p, twice: (twice - p[2] + 0.0, p[3], twice - p[0] + 0.0, p[1]),
    ),
    "gbellmf": ("gbellmf", lambda p, twice: (p[0], p[1], twice - p[2] + 0.0)),
    "sigmf": ("sigmf", lambda p, twice: (twice - p[0] + 0.0, -p[1])),
}


#: Shapes that a page draws, and whose mirror images are known.
DRAWN = tuple(_MIRRORS)


def mirrored_name(variable: Variable, set_name: str) -> str:
    """Set in the place that is as far from the last as that of a set is from the first."""
    return variable.set_names[-1 - variable.index(set_name)]


def mirrored_conditions(rules: RuleBase, where: Mapping[str, str]) -> dict[str, str]:
    """Conditions of the rule that mirrors the one with some conditions; they may be the same."""
    return {name: mirrored_name(rules.input(name), term) for name, term in where.items()}


def mirrored_shape(variable: Variable, shape: FuzzySet) -> FuzzySet:
    """Mirror image of a set about the middle of the universe, with the name of its mirror."""
    kind, mirror = _MIRRORS[shape.shape]
    twice = variable.universe.low + variable.universe.high
    name = mirrored_name(variable, shape.name)
    return FuzzySet(name, kind, mirror(shape.parameters, twice))


def symmetric_shape(variable: Variable, shape: FuzzySet) -> FuzzySet:
    """New shape of the set that is its own mirror, with what was changed on both sides.

    Raises
    ------
    RuleBaseError
        If the shape cannot be symmetric.
    """
    old = variable.sets[variable.index(shape.name)]
    other = mirrored_shape(variable, shape)
    both = shape
    if other != shape and (other.shape, old.shape) == (shape.shape, shape.shape):
        both = FuzzySet(
            shape.name,
            shape.shape,
            tuple(
                new if new != was else mirrored
                for new, was, mirrored in zip(
                    shape.parameters, old.parameters, other.parameters, strict=True
                )
            ),
        )
    if mirrored_shape(variable, both) != both:
        raise RuleBaseError(
            f"the set {quoted(shape.name)} of {variable.name} is its own mirror: a symmetric edit "
            "needs a shape that is symmetric about the middle of the universe"
        )
    return both
