"""Membership functions: scikit-fuzzy's shapes, by scikit-fuzzy's names and parameter order.

Array values come from scikit-fuzzy. Each shape also carries its formula as one scalar Python
expression, from which :mod:`fuzzytrack.fuzzy.kernel` writes the inner loop of a tracker.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.reprs import summary

__all__ = ["SHAPES", "TAILED", "FuzzySet", "Shape"]

#: Shapes that are above zero everywhere, and far from their core too small for a float.
TAILED = ("gaussmf", "gauss2mf", "gbellmf", "sigmf")

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
    """

    parameters: tuple[str, ...]
    requirement: str
    valid: Callable[[Parameters], bool]
    core: Callable[[Parameters], tuple[float, float]]
    support: Callable[[Parameters], tuple[float, float]]
    breakpoints: Callable[[Parameters], Parameters]
    expression: Callable[[Parameters, str], str]

    def __repr__(self) -> str:
        return summary(self, "parameters", "requirement")


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


def _sigmoid_support(parameters: Parameters) -> tuple[float, float]:
    b, c = parameters
    foot = b - _EXPONENT / c
    return (foot, math.inf) if c > 0 else (-math.inf, foot)


def _everywhere_ends(p: Parameters) -> Parameters:
    return p


SHAPES: dict[str, Shape] = {
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
        "mean1 <= mean2, sigma1 > 0, sigma2 > 0 (from 1e-100)",
        lambda p: p[0] <= p[2] and p[1] >= _TINY and p[3] >= _TINY,
        lambda p: (p[0], p[2]),
        lambda p: (p[0] - _SIGMAS * p[1], p[2] + _SIGMAS * p[3]),
        lambda p: (p[0], p[2]),
        _two_gaussians,
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
    ),
}


@dataclass(frozen=True)
class FuzzySet:
    """A named fuzzy set: a membership shape with its parameters.

    Parameters
    ----------
    name : str
        Linguistic term, e.g. ``"nl"`` (negative large).
    shape : str
        A key of `SHAPES`: scikit-fuzzy's function name, or ``"singleton"``.
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
        if len(self.parameters) != len(shape.parameters):
            raise RuleBaseError(
                f"set {self.name!r}: {self.shape} takes {len(shape.parameters)} parameters "
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
        start, end = SHAPES[self.shape].core(self.parameters)
        # scikit-fuzzy divides 0 by 0 at a vertical flank; the core is closed, there as elsewhere.
        grades = np.where((points >= start) & (points <= end), 1.0, 0.0)
        if self.shape != "singleton":
            curve = self._from_scikit_fuzzy(points.ravel()).reshape(points.shape)
            if self.shape in ("smf", "zmf", "pimf"):
                # Between neighboring floats the halves of scikit-fuzzy's curves overlap.
                curve = np.clip(curve, 0.0, 1.0)
            grades = np.where(grades == 1.0, 1.0, curve)
        return np.where(np.isnan(points), np.nan, grades)

    def _from_scikit_fuzzy(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        # Slow to import, and a rule base can be loaded and checked for form without it.
        from skfuzzy import membership

        function = getattr(membership, self.shape)
        with np.errstate(over="ignore", under="ignore", invalid="ignore", divide="ignore"):
            if self.shape in ("trimf", "trapmf"):
                grades = function(x, list(self.parameters))
            else:
                grades = function(x, *self.parameters)
        return np.asarray(grades, dtype=np.float64)

    def core(self, low: float, high: float) -> tuple[float, float]:
        """Interval of largest membership inside [low, high]."""
        start, end = SHAPES[self.shape].core(self.parameters)
        return min(max(start, low), high), min(max(end, low), high)

    def support(self) -> tuple[float, float, bool, bool]:
        """Interval where the membership is above zero.

        Returns
        -------
        low, high : float
            Ends; may be infinite.
        with_low, with_high : bool
            Whether the membership is above zero at the end itself (a vertical flank).
        """
        shape = SHAPES[self.shape]
        (low, high), (start, end) = shape.support(self.parameters), shape.core(self.parameters)
        return low, high, low == start, high == end

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
