"""Membership functions: scikit-fuzzy's shapes by its names and parameter order, and a few more.

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
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy import more_shapes
from fuzzytrack.fuzzy.hedges import HEDGES, MAX_HEDGES
from fuzzytrack.fuzzy.stretches import EVERYWHERE, Stretch
from fuzzytrack.reprs import summary

__all__ = ["LINEAR", "MAX_PARAMETERS", "SHAPES", "TAILED", "FuzzySet", "Shape"]

#: A linear function of the inputs, as the conclusion of a Takagi-Sugeno rule; it has no grades.
LINEAR = "linear"
#: Most parameters of a shape that takes any number of them.
MAX_PARAMETERS = 4000

#: Shapes that are above zero everywhere, and far from their core too small for a float.
TAILED = ("gaussmf", "gauss2mf", "gbellmf", "sigmf", "dsigmf", "psigmf", "spike")

Parameters = tuple[float, ...]

# Smallest width whose square is not zero, and smallest whose inverse is a number.
_TINY = 1e-100
_STEEP = 1e-300
# exp(-x) is above zero up to here, and so is a Gaussian up to so many sigma.
_EXPONENT = 700.0
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


def _trapezoid(parameters: Parameters, x: str) -> str:
    a, b, c, d = parameters
    rise, fall = f"(1.0 if {x} >= {b!r} else 0.0)", f"(1.0 if {x} <= {c!r} else 0.0)"
    if b > a:
        rise = f"({x} - {a!r}) {_times_inverse(b - a)}"
    if d > c:
        fall = f"({d!r} - {x}) {_times_inverse(d - c)}"
    return f"max(0.0, min(1.0, min({rise}, {fall})))"


def _times_inverse(width: float) -> str:
    """Division by a width; by multiplication, which is faster, where the inverse is finite."""
    return f"* {1 / width!r}" if width > _STEEP else f"/ {width!r}"


def _triangle(parameters: Parameters, x: str) -> str:
    a, b, c = parameters
    return _trapezoid((a, b, b, c), x)


def _gaussian(mean: float, sigma: float, x: str) -> str:
    return f"exp(-(({x} - {mean!r}) * ({x} - {mean!r})) / {2 * sigma * sigma!r})"


def _two_gaussians(parameters: Parameters, x: str) -> str:
    mean1, sigma1, mean2, sigma2 = parameters
    left, right = _gaussian(mean1, sigma1, x), _gaussian(mean2, sigma2, x)
    return f"({left} if {x} <= {mean1!r} else 1.0) * ({right} if {x} > {mean2!r} else 1.0)"


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


def _two_gaussians_values(parameters: Parameters, x: Array) -> Array:
    mean1, sigma1, mean2, sigma2 = parameters
    left = np.exp(-((x - mean1) ** 2) / (2 * sigma1**2))
    right = np.exp(-((x - mean2) ** 2) / (2 * sigma2**2))
    return np.where(x <= mean1, left, 1.0) * np.where(x > mean2, right, 1.0)


def _bell(parameters: Parameters, x: str) -> str:
    a, b, c = parameters
    # Where the power passes 1e300 the grade is zero and Python's ** would overflow.
    far = 10 ** min(300.0, 150 / b)
    return f"1.0 / (1.0 + min(abs(({x} - {c!r}) / {a!r}), {far!r}) ** {2 * b!r})"


# The ends come first: between neighboring floats the middle is rounded to one of them. At the
# middle itself, the half that scikit-fuzzy uses there is used; it differs between shapes.
def _s_curve(a: float, b: float, x: str, lower: str) -> str:
    middle, width = (a + b) / 2, b - a
    if width == 0:
        return f"(1.0 if {x} >= {b!r} else 0.0)"
    low, high = f"(({x} - {a!r}) / {width!r})", f"(({x} - {b!r}) / {width!r})"
    return (
        f"(0.0 if {x} <= {a!r} else 1.0 if {x} >= {b!r} else 2.0 * {low} * {low} "
        f"if {x} {lower} {middle!r} else 1.0 - 2.0 * {high} * {high})"
    )


def _z_curve(a: float, b: float, x: str) -> str:
    middle, width = (a + b) / 2, b - a
    if width == 0:
        return f"(1.0 if {x} <= {a!r} else 0.0)"
    low, high = f"(({x} - {a!r}) / {width!r})", f"(({x} - {b!r}) / {width!r})"
    return (
        f"(1.0 if {x} <= {a!r} else 0.0 if {x} >= {b!r} else 1.0 - 2.0 * {low} * {low} "
        f"if {x} < {middle!r} else 2.0 * {high} * {high})"
    )


def _whole(parameters: Parameters) -> tuple[float, float]:
    return parameters[0], parameters[-1]


def _bell_support(parameters: Parameters) -> tuple[float, float]:
    a, b, c = parameters
    digits = 300 / (2 * b)
    reach = a * 10.0**digits if digits < 200 else math.inf
    return c - reach, c + reach


def _pairs_ascend(parameters: Parameters) -> bool:
    places, grades = parameters[::2], parameters[1::2]
    ascend = all(a < b and b - a > _STEEP for a, b in pairwise(places))
    return ascend and all(0.0 <= g <= 1.0 for g in grades)


def _whole_places(parameters: Parameters) -> tuple[float, float]:
    return parameters[0], parameters[-2]


def _ramp_up(parameters: Parameters, x: str) -> str:
    a, b = parameters
    if a == b:
        return f"(1.0 if {x} >= {b!r} else 0.0)"
    return f"max(0.0, min(1.0, ({x} - {a!r}) {_times_inverse(b - a)}))"


def _ramp_down(parameters: Parameters, x: str) -> str:
    a, b = parameters
    if a == b:
        return f"(1.0 if {x} <= {a!r} else 0.0)"
    return f"max(0.0, min(1.0, ({b!r} - {x}) {_times_inverse(b - a)}))"


def _ramp_values(parameters: Parameters, x: Array, sign: float) -> Array:
    """Rise over [a, b]; with a sign of -1 the fall."""
    a, b = parameters
    if a == b:
        return np.where(sign * x >= sign * a, 1.0, 0.0)
    part = (x - a) / (b - a) if sign > 0 else (b - x) / (b - a)
    return np.clip(part, 0.0, 1.0)


def _sigmoid_support(parameters: Parameters) -> tuple[float, float]:
    b, c = parameters
    foot = b - _EXPONENT / c
    return (foot, math.inf) if c > 0 else (-math.inf, foot)


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
            _triangle,
        ),
        "trapmf": Shape(
            ("a", "b", "c", "d"),
            "a <= b <= c <= d",
            _ascending,
            lambda p: (p[1], p[2]),
            _whole,
            _everywhere_ends,
            _trapezoid,
        ),
        "gaussmf": Shape(
            ("mean", "sigma"),
            "sigma > 0 (from 1e-100)",
            lambda p: p[1] >= _TINY,
            lambda p: (p[0], p[0]),
            lambda p: (p[0] - _SIGMAS * p[1], p[0] + _SIGMAS * p[1]),
            lambda p: (),
            lambda p, x: _gaussian(p[0], p[1], x),
        ),
        "gauss2mf": Shape(
            ("mean1", "sigma1", "mean2", "sigma2"),
            "mean1 <= mean2 + 20 (sigma1 + sigma2), sigma1 > 0, sigma2 > 0 (from 1e-100)",
            _two_gaussians_meet,
            _two_gaussians_core,
            lambda p: (p[0] - _SIGMAS * p[1], p[2] + _SIGMAS * p[3]),
            lambda p: (p[0], p[2]),
            _two_gaussians,
            _two_gaussians_values,
            ones=lambda p: (Stretch(p[0], p[2], True, True),) if p[0] <= p[2] else (),
        ),
        "gbellmf": Shape(
            ("a", "b", "c"),
            "a > 0, b > 0 (from 1e-100; b up to 1e6)",
            lambda p: p[0] >= _TINY and _TINY <= p[1] <= 1e6,
            lambda p: (p[2], p[2]),
            _bell_support,
            lambda p: (),
            _bell,
        ),
        "sigmf": Shape(
            ("b", "c"),
            "c != 0",
            lambda p: p[1] != 0,
            lambda p: (math.inf, math.inf) if p[1] > 0 else (-math.inf, -math.inf),
            _sigmoid_support,
            lambda p: (),
            # math.exp overflows beyond 709.
            lambda p, x: f"1.0 / (1.0 + exp(min(700.0, {-p[1]!r} * ({x} - {p[0]!r}))))",
        ),
        "smf": Shape(
            ("a", "b"),
            "a <= b",
            _ascending,
            lambda p: (p[1], math.inf),
            lambda p: (p[0], math.inf),
            _everywhere_ends,
            lambda p, x: _s_curve(p[0], p[1], x, "<"),
        ),
        "zmf": Shape(
            ("a", "b"),
            "a <= b",
            _ascending,
            lambda p: (-math.inf, p[0]),
            lambda p: (-math.inf, p[1]),
            _everywhere_ends,
            lambda p, x: _z_curve(p[0], p[1], x),
        ),
        "pimf": Shape(
            ("a", "b", "c", "d"),
            "a <= b <= c <= d",
            _ascending,
            lambda p: (p[1], p[2]),
            _whole,
            _everywhere_ends,
            lambda p, x: f"{_s_curve(p[0], p[1], x, '<=')} * {_z_curve(p[2], p[3], x)}",
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
            _ramp_up,
            lambda p, x: _ramp_values(p, x, 1.0),
        ),
        "linzmf": Shape(
            ("a", "b"),
            "a <= b",
            _ascending,
            lambda p: (-math.inf, p[0]),
            lambda p: (-math.inf, p[1]),
            _everywhere_ends,
            _ramp_down,
            lambda p, x: _ramp_values(p, x, -1.0),
        ),
        "dsigmf": Shape(
            ("b1", "c1", "b2", "c2"),
            "c1 != 0, c2 != 0",
            lambda p: p[1] != 0 and p[3] != 0,
            lambda p: more_shapes.sigmoid_peak(p, product=False),
            lambda p: (-math.inf, math.inf),
            lambda p: (),
            more_shapes.sigmoid_difference,
            more_shapes.sigmoid_difference_values,
            ones=lambda p: (),
        ),
        "psigmf": Shape(
            ("b1", "c1", "b2", "c2"),
            "c1 != 0, c2 != 0",
            lambda p: p[1] != 0 and p[3] != 0,
            lambda p: more_shapes.sigmoid_peak(p, product=True),
            lambda p: (-math.inf, math.inf),
            lambda p: (),
            more_shapes.sigmoid_product,
            more_shapes.sigmoid_product_values,
            ones=lambda p: (),
        ),
        "discrete": Shape(
            ("x1", "y1", "x2", "y2"),
            "pairs x y with x ascending and y from 0 to 1",
            _pairs_ascend,
            more_shapes.discrete_core,
            _whole_places,
            lambda p: p[::2],
            more_shapes.discrete,
            more_shapes.discrete_values,
            repeats=2,
            ones=more_shapes.discrete_ones,
            positive=more_shapes.discrete_positive,
        ),
        "cosine": Shape(
            ("center", "width"),
            "width > 0 (from 1e-100)",
            lambda p: p[1] >= _TINY,
            lambda p: (p[0], p[0]),
            lambda p: (p[0] - p[1] / 2, p[0] + p[1] / 2),
            lambda p: (p[0] - p[1] / 2, p[0] + p[1] / 2),
            more_shapes.cosine,
            more_shapes.cosine_values,
        ),
        "spike": Shape(
            ("center", "width"),
            "width > 0 (from 1e-100)",
            lambda p: p[1] >= _TINY,
            lambda p: (p[0], p[0]),
            lambda p: (p[0] - _EXPONENT * p[1] / 10, p[0] + _EXPONENT * p[1] / 10),
            lambda p: (p[0],),
            more_shapes.spike,
            more_shapes.spike_values,
        ),
        "concave": Shape(
            ("inflection", "end"),
            "inflection != end",
            lambda p: p[0] != p[1],
            lambda p: (p[1], math.inf) if p[0] < p[1] else (-math.inf, p[1]),
            lambda p: (-math.inf, math.inf),
            lambda p: (p[1],),
            more_shapes.concave,
            more_shapes.concave_values,
        ),
        "arc": Shape(
            ("start", "end"),
            "start != end",
            lambda p: p[0] != p[1],
            lambda p: (p[1], math.inf) if p[0] < p[1] else (-math.inf, p[1]),
            lambda p: (p[0], math.inf) if p[0] < p[1] else (-math.inf, p[0]),
            _everywhere_ends,
            more_shapes.quarter_circle,
            more_shapes.quarter_circle_values,
        ),
        "ellipse": Shape(
            ("start", "end"),
            "start < end",
            lambda p: p[0] < p[1],
            lambda p: ((p[0] + p[1]) / 2, (p[0] + p[1]) / 2),
            _whole,
            _everywhere_ends,
            more_shapes.ellipse,
            more_shapes.ellipse_values,
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


@dataclass(frozen=True)
class FuzzySet:
    """A named fuzzy set: a membership shape with its parameters.

    Parameters
    ----------
    name : str
        Linguistic term, e.g. ``"nl"`` (negative large).
    shape : str
        A key of `SHAPES`: scikit-fuzzy's function name, another, or either with hedges before it
        (``"not trimf"``).
    parameters : tuple of float
        In scikit-fuzzy's order, in the units of the variable.

    Raises
    ------
    RuleBaseError
        If the shape is unknown or the parameters do not fit it.
    """

    name: str
    shape: str
    parameters: tuple[float, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", tuple(float(p) for p in self.parameters))
        if self.shape not in SHAPES:
            allowed = ", ".join(SHAPES)
            raise RuleBaseError(
                f"set {self.name!r}: unknown shape {self.shape!r}; one of {allowed}"
            )
        shape = SHAPES[self.shape]
        if not shape.takes(len(self.parameters)):
            least = "at least " if shape.repeats else ""
            raise RuleBaseError(
                f"set {self.name!r}: {self.shape} takes {least}{len(shape.parameters)} parameters "
                f"({', '.join(shape.parameters)}), not {len(self.parameters)}"
            )
        if not all(math.isfinite(p) and abs(p) <= 1e100 for p in self.parameters):
            raise RuleBaseError(
                f"set {self.name!r}: parameters must be finite numbers up to 1e100, "
                f"got {list(self.parameters)}"
            )
        if not shape.valid(self.parameters):
            raise RuleBaseError(
                f"set {self.name!r}: {self.shape} requires {shape.requirement}, "
                f"got {list(self.parameters)}"
            )

    def membership(self, x: ArrayLike) -> NDArray[np.float64]:
        """Membership grade at `x`.

        Parameters
        ----------
        x : array_like
            Values of the variable, any shape; NaN gives NaN.

        Returns
        -------
        ndarray
            Grades in [0, 1], shape of `x`.
        """
        points = np.asarray(x, dtype=np.float64)
        shape = SHAPES[self.base]
        if shape.values is not None:
            with np.errstate(over="ignore", under="ignore"):
                grades = shape.values(self.parameters, points)
        else:
            grades = self._from_scikit_fuzzy(points, *shape.core(self.parameters))
        for word in reversed(self.hedges):
            grades = HEDGES[word].values(grades)
        return np.where(np.isnan(points), np.nan, grades)

    def _from_scikit_fuzzy(self, points: Array, start: float, end: float) -> Array:
        # Slow to import, and a rule base can be loaded and checked for form without it.
        from skfuzzy import membership

        function = getattr(membership, self.base)
        listed = self.base in ("trimf", "trapmf")
        given = (list(self.parameters),) if listed else self.parameters
        with np.errstate(over="ignore", under="ignore", invalid="ignore", divide="ignore"):
            curve = np.asarray(function(points.ravel(), *given)).reshape(points.shape)
        if self.base in ("smf", "zmf", "pimf"):
            # Between neighboring floats the halves of scikit-fuzzy's curves overlap.
            curve = np.clip(curve, 0.0, 1.0)
        # scikit-fuzzy divides 0 by 0 at a vertical flank; the core is closed, there as elsewhere.
        return np.where((points >= start) & (points <= end), 1.0, curve)

    @property
    def base(self) -> str:
        """The shape without its hedges."""
        return self.shape.rpartition(" ")[2]

    @property
    def hedges(self) -> tuple[str, ...]:
        """Hedges before the shape; the last is applied first."""
        return tuple(self.shape.split(" ")[:-1])

    @property
    def has_core(self) -> bool:
        """Whether the set is one hill, so that it has a core, a center and a place in an order."""
        return self.base != LINEAR and all(HEDGES[word].keeps_order for word in self.hedges)

    @property
    def is_tailed(self) -> bool:
        """Whether the set is above zero everywhere, and in places too small for a float."""
        return self.base in TAILED and self.has_core

    def core(self, low: float, high: float) -> tuple[float, float]:
        """Interval of largest membership inside [low, high]."""
        start, end = SHAPES[self.shape].core(self.parameters)
        return min(max(start, low), high), min(max(end, low), high)

    def support(self) -> tuple[float, float, bool, bool]:
        """Smallest interval that has all points where the membership is above zero.

        Returns
        -------
        low, high : float
            Ends; may be infinite.
        with_low, with_high : bool
            Whether the membership is above zero at the end itself (a vertical flank).
        """
        found = self.positive()
        if not found:
            return math.inf, math.inf, False, False
        return found[0].low, found[-1].high, found[0].with_low, found[-1].with_high

    def positive(self) -> tuple[Stretch, ...]:
        """Stretches on which the membership is above zero, in ascending order.

        What a tailed shape has beyond the reach of floats is not among them.
        """
        return SHAPES[self.shape].is_positive(self.parameters)

    def center(self, low: float, high: float) -> float:
        """Middle of the core inside [low, high]: the yᶜ of Llinas et al. (1998), Eq. 3.12."""
        start, end = self.core(low, high)
        return (start + end) / 2

    def breakpoints(self) -> tuple[float, ...]:
        """Points where the membership function is not smooth."""
        return SHAPES[self.shape].breakpoints(self.parameters)

    def expression(self, x: str) -> str:
        """Scalar Python expression for the grade of the variable named `x`."""
        return SHAPES[self.shape].expression(self.parameters, x)
