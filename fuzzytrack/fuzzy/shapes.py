"""Membership shapes: scikit-fuzzy's by its names and parameter order, and a few more.

Array values come from scikit-fuzzy where it has the shape. Each shape also carries its formula as
one scalar Python expression, from which :mod:`fuzzytrack.fuzzy.kernel` writes the inner loop of a
tracker. Words before a shape, as in ``not trimf``, are hedges: see `fuzzytrack.fuzzy.hedges`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy import curved_shapes, straight_shapes
from fuzzytrack.fuzzy.hedges import HEDGES, MAX_HEDGES
from fuzzytrack.fuzzy.stretches import EVERYWHERE, Stretch
from fuzzytrack.reprs import summary

__all__ = ["LINEAR", "MAX_PARAMETERS", "SHAPES", "TAILED", "Shape"]

#: A linear function of the inputs, as the conclusion of a Takagi-Sugeno rule; it has no grades.
LINEAR = "linear"
#: Most parameters of a shape that takes any number of them.
MAX_PARAMETERS = 4000

#: Shapes that are above zero everywhere, and far from their core too small for a float.
TAILED = ("gaussmf", "gauss2mf", "gbellmf", "sigmf", "dsigmf", "psigmf", "spike")

Parameters = tuple[float, ...]

# Smallest width whose square is not zero.
_TINY = 1e-100
# A Gaussian is above zero up to so many sigma.
_SIGMAS = 37.0


@dataclass(frozen=True)
class Shape:
    """A membership shape: its parameters, their conditions and its formulas.

    Attributes
    ----------
    parameters : tuple of str
        Names of the parameters, in scikit-fuzzy's order.
    requirement : str
        What the parameters must satisfy, in words for the error message.
    valid : callable
        ``valid(parameters) -> bool``.
    core : callable
        ``core(parameters) -> (low, high)``, where the membership is largest; ends may be infinite.
    support : callable
        ``support(parameters) -> (low, high)``, outside of which the membership is zero, or too
        small for a float; ends may be infinite.
    breakpoints : callable
        Points where the function or its slope is not smooth.
    expression : callable
        ``expression(parameters, x) -> str``, the membership of the variable named ``x``.
    values : callable or None
        ``values(parameters, points) -> array``; None where scikit-fuzzy has the shape.
    repeats : int
        How many of the parameters, from the first, may be repeated; 0 for none.
    ones : callable or None
        ``ones(parameters)``, stretches on which the membership is exactly 1; None for the core.
    positive : callable or None
        ``positive(parameters)``, stretches on which it is above zero; None for the support.
    """

    parameters: tuple[str, ...]
    requirement: str
    valid: Callable[[Parameters], bool]
    core: Callable[[Parameters], tuple[float, float]]
    support: Callable[[Parameters], tuple[float, float]]
    breakpoints: Callable[[Parameters], Parameters]
    expression: Callable[[Parameters, str], str]
    values: Callable[[Parameters, Array], Array] | None = None
    repeats: int = 0
    ones: Callable[[Parameters], tuple[Stretch, ...]] | None = None
    positive: Callable[[Parameters], tuple[Stretch, ...]] | None = None

    def __repr__(self) -> str:
        return summary(self, "parameters", "requirement")

    def takes(self, count: int) -> bool:
        """Whether the shape takes so many parameters."""
        fixed = len(self.parameters)
        if not self.repeats:
            return count == fixed
        return fixed <= count <= MAX_PARAMETERS and (count - fixed) % self.repeats == 0

    def is_positive(self, parameters: Parameters) -> tuple[Stretch, ...]:
        """Stretches on which the membership is above zero, in ascending order."""
        if self.positive is not None:
            return self.positive(parameters)
        (low, high), (start, end) = self.support(parameters), self.core(parameters)
        return (Stretch(low, high, low == start, high == end),)

    def is_one(self, parameters: Parameters) -> tuple[Stretch, ...]:
        """Stretches on which the membership is exactly 1, in ascending order."""
        if self.ones is not None:
            return self.ones(parameters)
        start, end = self.core(parameters)
        return () if math.isinf(start) and start == end else (Stretch(start, end, True, True),)


def _ascending(parameters: Parameters) -> bool:
    return all(a <= b for a, b in pairwise(parameters))


def _whole(parameters: Parameters) -> tuple[float, float]:
    return parameters[0], parameters[-1]


def _two_gaussians_meet(parameters: Parameters) -> bool:
    mean1, sigma1, mean2, sigma2 = parameters
    proper = sigma1 >= _TINY and sigma2 >= _TINY
    # Sides that lie farther apart have a product of 0 in floats.
    return proper and mean1 <= mean2 + 20.0 * (sigma1 + sigma2)


def _two_gaussians_core(parameters: Parameters) -> tuple[float, float]:
    """From mean to mean; if they are in the other order, where the product is largest."""
    mean1, sigma1, mean2, sigma2 = parameters
    if mean1 <= mean2:
        return mean1, mean2
    share = 1.0 / (1.0 + (sigma1 / sigma2) ** 2)
    peak = mean2 + share * (mean1 - mean2)
    return peak, peak


def _bell_support(parameters: Parameters) -> tuple[float, float]:
    a, b, c = parameters
    digits = 300 / (2 * b)
    reach = a * 10.0**digits if digits < 200 else math.inf
    return c - reach, c + reach


def _pairs_ascend(parameters: Parameters) -> bool:
    places, grades = parameters[::2], parameters[1::2]
    ascend = all(a < b and b - a > straight_shapes.STEEP for a, b in pairwise(places))
    return ascend and all(0.0 <= g <= 1.0 for g in grades)


def _whole_places(parameters: Parameters) -> tuple[float, float]:
    return parameters[0], parameters[-2]


def _sigmoid_support(parameters: Parameters) -> tuple[float, float]:
    b, c = parameters
    foot = b - curved_shapes.EXPONENT / c
    return (foot, math.inf) if c > 0 else (-math.inf, foot)


def _spike_support(parameters: Parameters) -> tuple[float, float]:
    center, width = parameters
    reach = curved_shapes.EXPONENT * width / 10
    return center - reach, center + reach


def _everywhere_ends(p: Parameters) -> Parameters:
    return p


def _hedged(words: list[str], base: Shape) -> Shape:
    """The shape with hedges before it, the last of which is applied first."""
    for word in reversed(words):
        base = _with_hedge(word, base)
    return base


def _with_hedge(word: str, base: Shape) -> Shape:
    hedge = HEDGES[word]
    return replace(
        base,
        core=base.core if hedge.keeps_order else lambda p: (-math.inf, math.inf),
        support=base.support if hedge.keeps_order else lambda p: (-math.inf, math.inf),
        expression=lambda p, x: hedge.expression(base.expression(p, x)),
        ones=lambda p: hedge.ones(base.is_positive(p), base.is_one(p)),
        positive=lambda p: hedge.positive(base.is_positive(p), base.is_one(p)),
    )


class _Shapes(dict[str, Shape]):
    """Shapes by name; with hedges before a name, the shape that they make of it.

    Iteration is over the names without hedges.
    """

    def __contains__(self, name: object) -> bool:
        *words, base = name.split(" ") if isinstance(name, str) else ("",)
        known = super().__contains__(base) and not (words and base == LINEAR)
        return known and len(words) <= MAX_HEDGES and all(word in HEDGES for word in words)

    def __missing__(self, name: str) -> Shape:
        if name not in self:
            raise KeyError(name)
        *words, base = name.split(" ")
        return _hedged(words, self[base])


SHAPES: dict[str, Shape] = _Shapes(
    {
        "trimf": Shape(
            ("a", "b", "c"),
            "a <= b <= c",
            _ascending,
            lambda p: (p[1], p[1]),
            _whole,
            _everywhere_ends,
            straight_shapes.triangle,
        ),
        "trapmf": Shape(
            ("a", "b", "c", "d"),
            "a <= b <= c <= d",
            _ascending,
            lambda p: (p[1], p[2]),
            _whole,
            _everywhere_ends,
            straight_shapes.trapezoid,
        ),
        "gaussmf": Shape(
            ("mean", "sigma"),
            "sigma > 0 (from 1e-100)",
            lambda p: p[1] >= _TINY,
            lambda p: (p[0], p[0]),
            lambda p: (p[0] - _SIGMAS * p[1], p[0] + _SIGMAS * p[1]),
            lambda p: (),
            lambda p, x: curved_shapes.gaussian(p[0], p[1], x),
        ),
        "gauss2mf": Shape(
            ("mean1", "sigma1", "mean2", "sigma2"),
            "mean1 <= mean2 + 20 (sigma1 + sigma2), sigma1 > 0, sigma2 > 0 (from 1e-100)",
            _two_gaussians_meet,
            _two_gaussians_core,
            lambda p: (p[0] - _SIGMAS * p[1], p[2] + _SIGMAS * p[3]),
            lambda p: (p[0], p[2]),
            curved_shapes.two_gaussians,
            curved_shapes.two_gaussians_values,
            ones=lambda p: (Stretch(p[0], p[2], True, True),) if p[0] <= p[2] else (),
        ),
        "gbellmf": Shape(
            ("a", "b", "c"),
            "a > 0, b > 0 (from 1e-100; b up to 1e6)",
            lambda p: p[0] >= _TINY and _TINY <= p[1] <= 1e6,
            lambda p: (p[2], p[2]),
            _bell_support,
            lambda p: (),
            curved_shapes.bell,
        ),
        "sigmf": Shape(
            ("b", "c"),
            "c != 0",
            lambda p: p[1] != 0,
            lambda p: (math.inf, math.inf) if p[1] > 0 else (-math.inf, -math.inf),
            _sigmoid_support,
            lambda p: (),
            lambda p, x: curved_shapes.sigmoid(p[0], p[1], x),
        ),
        "smf": Shape(
            ("a", "b"),
            "a <= b",
            _ascending,
            lambda p: (p[1], math.inf),
            lambda p: (p[0], math.inf),
            _everywhere_ends,
            lambda p, x: curved_shapes.s_curve(p[0], p[1], x, "<"),
        ),
        "zmf": Shape(
            ("a", "b"),
            "a <= b",
            _ascending,
            lambda p: (-math.inf, p[0]),
            lambda p: (-math.inf, p[1]),
            _everywhere_ends,
            lambda p, x: curved_shapes.z_curve(p[0], p[1], x),
        ),
        "pimf": Shape(
            ("a", "b", "c", "d"),
            "a <= b <= c <= d",
            _ascending,
            lambda p: (p[1], p[2]),
            _whole,
            _everywhere_ends,
            curved_shapes.pi_curve,
        ),
        "singleton": Shape(
            ("value",),
            "any number",
            lambda p: True,
            lambda p: (p[0], p[0]),
            _whole,
            _everywhere_ends,
            lambda p, x: f"(1.0 if {x} == {p[0]!r} else 0.0)",
            lambda p, x: np.where(x == p[0], 1.0, 0.0),
        ),
        "linsmf": Shape(
            ("a", "b"),
            "a <= b",
            _ascending,
            lambda p: (p[1], math.inf),
            lambda p: (p[0], math.inf),
            _everywhere_ends,
            straight_shapes.ramp_up,
            lambda p, x: straight_shapes.ramp_values(p, x, 1.0),
        ),
        "linzmf": Shape(
            ("a", "b"),
            "a <= b",
            _ascending,
            lambda p: (-math.inf, p[0]),
            lambda p: (-math.inf, p[1]),
            _everywhere_ends,
            straight_shapes.ramp_down,
            lambda p, x: straight_shapes.ramp_values(p, x, -1.0),
        ),
        "dsigmf": Shape(
            ("b1", "c1", "b2", "c2"),
            "c1 != 0, c2 != 0",
            lambda p: p[1] != 0 and p[3] != 0,
            lambda p: curved_shapes.sigmoid_peak(p, product=False),
            lambda p: (-math.inf, math.inf),
            lambda p: (),
            curved_shapes.sigmoid_difference,
            curved_shapes.sigmoid_difference_values,
            ones=lambda p: (),
        ),
        "psigmf": Shape(
            ("b1", "c1", "b2", "c2"),
            "c1 != 0, c2 != 0",
            lambda p: p[1] != 0 and p[3] != 0,
            lambda p: curved_shapes.sigmoid_peak(p, product=True),
            lambda p: (-math.inf, math.inf),
            lambda p: (),
            curved_shapes.sigmoid_product,
            curved_shapes.sigmoid_product_values,
            ones=lambda p: (),
        ),
        "discrete": Shape(
            ("x1", "y1", "x2", "y2"),
            "pairs x y with x ascending and y from 0 to 1",
            _pairs_ascend,
            straight_shapes.discrete_core,
            _whole_places,
            lambda p: p[::2],
            straight_shapes.discrete,
            straight_shapes.discrete_values,
            repeats=2,
            ones=straight_shapes.discrete_ones,
            positive=straight_shapes.discrete_positive,
        ),
        "cosine": Shape(
            ("center", "width"),
            "width > 0 (from 1e-100)",
            lambda p: p[1] >= _TINY,
            lambda p: (p[0], p[0]),
            lambda p: (p[0] - p[1] / 2, p[0] + p[1] / 2),
            lambda p: (p[0] - p[1] / 2, p[0] + p[1] / 2),
            curved_shapes.cosine,
            curved_shapes.cosine_values,
        ),
        "spike": Shape(
            ("center", "width"),
            "width > 0 (from 1e-100)",
            lambda p: p[1] >= _TINY,
            lambda p: (p[0], p[0]),
            _spike_support,
            lambda p: (p[0],),
            curved_shapes.spike,
            curved_shapes.spike_values,
        ),
        "concave": Shape(
            ("inflection", "end"),
            "inflection != end",
            lambda p: p[0] != p[1],
            lambda p: (p[1], math.inf) if p[0] < p[1] else (-math.inf, p[1]),
            lambda p: (-math.inf, math.inf),
            lambda p: (p[1],),
            curved_shapes.concave,
            curved_shapes.concave_values,
        ),
        "arc": Shape(
            ("start", "end"),
            "start != end",
            lambda p: p[0] != p[1],
            lambda p: (p[1], math.inf) if p[0] < p[1] else (-math.inf, p[1]),
            lambda p: (p[0], math.inf) if p[0] < p[1] else (-math.inf, p[0]),
            _everywhere_ends,
            curved_shapes.quarter_circle,
            curved_shapes.quarter_circle_values,
        ),
        "ellipse": Shape(
            ("start", "end"),
            "start < end",
            lambda p: p[0] < p[1],
            lambda p: ((p[0] + p[1]) / 2, (p[0] + p[1]) / 2),
            _whole,
            _everywhere_ends,
            curved_shapes.ellipse,
            curved_shapes.ellipse_values,
        ),
        LINEAR: Shape(
            ("coefficient", "constant"),
            "a coefficient for each input, and a constant",
            lambda p: True,
            lambda p: (-math.inf, math.inf),
            lambda p: (-math.inf, math.inf),
            lambda p: (),
            lambda p, x: "0.0",
            lambda p, x: np.zeros_like(x),
            repeats=1,
            ones=lambda p: (),
            positive=lambda p: (EVERYWHERE,),
        ),
    }
)
