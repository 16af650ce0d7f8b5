"""Formulas of membership shapes with straight sides, for `fuzzytrack.fuzzy.shapes`.

Those that end in ``values`` are functions on arrays; the others write a scalar Python expression.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.stretches import Stretch

__all__ = [
    "STEEP", "discrete", "discrete_core", "discrete_ones", "discrete_positive",
    "discrete_values", "ramp_down", "ramp_up", "ramp_values", "trapezoid", "triangle",
]  # fmt: skip

Parameters = tuple[float, ...]

#: Smallest width whose inverse is a number.
STEEP = 1e-300

# -------------------------------------------------------------------- trapezoids and ramps


def trapezoid(parameters: Parameters, x: str) -> str:
    """Write a trapezoid, of which flanks may be vertical."""
    a, b, c, d = parameters
    rise, fall = f"(1.0 if {x} >= {b!r} else 0.0)", f"(1.0 if {x} <= {c!r} else 0.0)"
    if b > a:
        rise = f"({x} - {a!r}) {_times_inverse(b - a)}"
    if d > c:
        fall = f"({d!r} - {x}) {_times_inverse(d - c)}"
    return f"max(0.0, min(1.0, min({rise}, {fall})))"


def _times_inverse(width: float) -> str:
    """Division by a width; by multiplication, which is faster, where the inverse is finite."""
    if width <= STEEP:
        return f"/ {width!r}"
    inverse = 1 / width
    # At the corner the grade is 1 and not a rounding below: after `not` a rule fires, or does not.
    return f"* {inverse if width * inverse >= 1.0 else math.nextafter(inverse, math.inf)!r}"


def triangle(parameters: Parameters, x: str) -> str:
    """Write a triangle."""
    a, b, c = parameters
    return trapezoid((a, b, b, c), x)


def ramp_up(parameters: Parameters, x: str) -> str:
    """Write a rise over [a, b], and 1 beyond."""
    a, b = parameters
    if a == b:
        return f"(1.0 if {x} >= {b!r} else 0.0)"
    return f"max(0.0, min(1.0, ({x} - {a!r}) {_times_inverse(b - a)}))"


def ramp_down(parameters: Parameters, x: str) -> str:
    """Write a fall over [a, b], and 0 beyond."""
    a, b = parameters
    if a == b:
        return f"(1.0 if {x} <= {a!r} else 0.0)"
    return f"max(0.0, min(1.0, ({b!r} - {x}) {_times_inverse(b - a)}))"


def ramp_values(parameters: Parameters, x: Array, sign: float) -> Array:
    """Rise over [a, b]; with a sign of -1 the fall."""
    a, b = parameters
    if a == b:
        return np.where(sign * x >= sign * a, 1.0, 0.0)
    part = (x - a) / (b - a) if sign > 0 else (b - x) / (b - a)
    return np.clip(part, 0.0, 1.0)


# -------------------------------------------------------------------- points on straight lines


def discrete_values(parameters: Parameters, x: Array) -> Array:
    """Interpolate the grades between the points; beyond them they are those of the ends."""
    return np.clip(np.interp(x, parameters[::2], parameters[1::2]), 0.0, 1.0)


def discrete(parameters: Parameters, x: str) -> str:
    """Write the grade between points as choices, half of the points left by each."""
    return _between(parameters[::2], parameters[1::2], x, 0, len(parameters) // 2)


def _between(xs: Parameters, ys: Parameters, x: str, first: int, last: int) -> str:
    """For x below the point number `last` and not below the one before `first`."""
    if first == last:
        if first == 0:
            return repr(ys[0])
        if first == len(xs):
            return repr(ys[-1])
        slope = (ys[first] - ys[first - 1]) / (xs[first] - xs[first - 1])
        line = f"{slope!r} * ({x} - {xs[first - 1]!r}) + {ys[first - 1]!r}"
        return f"max(0.0, min(1.0, {line}))"
    middle = (first + last) // 2
    below, above = _between(xs, ys, x, first, middle), _between(xs, ys, x, middle + 1, last)
    return f"({below} if {x} < {xs[middle]!r} else {above})"


def discrete_core(parameters: Parameters) -> tuple[float, float]:
    """From the first point of the largest grade to the last one."""
    places, grades = parameters[::2], parameters[1::2]
    largest = max(grades)
    at = [k for k, grade in enumerate(grades) if grade == largest]
    low = -math.inf if at[0] == 0 else places[at[0]]
    high = math.inf if at[-1] == len(places) - 1 else places[at[-1]]
    if (low, high) == (-math.inf, math.inf):
        return places[0], places[-1]
    return low, high


def discrete_positive(parameters: Parameters) -> tuple[Stretch, ...]:
    """Stretches on which the grade is above zero."""
    return _where(parameters, [grade > 0.0 for grade in parameters[1::2]], either=True)


def discrete_ones(parameters: Parameters) -> tuple[Stretch, ...]:
    """Stretches on which the grade is 1."""
    return _where(parameters, [grade == 1.0 for grade in parameters[1::2]], either=False)


def _where(parameters: Parameters, true: list[bool], *, either: bool) -> tuple[Stretch, ...]:
    """Stretches from which points are true; a line between two, if either is, or both are."""
    places = (-math.inf, *parameters[::2], math.inf)
    true = [true[0], *true, true[-1]]
    found: list[Stretch] = []
    for (low, high), (at_low, at_high) in zip(pairwise(places), pairwise(true), strict=True):
        line = (at_low or at_high) if either else (at_low and at_high)
        pieces = [Stretch(low, high, at_low, at_high)] if line else []
        if not line and at_low:
            pieces.append(Stretch(low, low, True, True))
        for piece in pieces:
            joined = (
                found and found[-1].high == piece.low and (found[-1].with_high or piece.with_low)
            )
            if joined:
                last = found.pop()
                piece = Stretch(last.low, piece.high, last.with_low, piece.with_high)
            found.append(piece)
    return tuple(found)
