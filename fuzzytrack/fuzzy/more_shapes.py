"""Formulas of membership shapes that scikit-fuzzy lacks, or has without a scalar expression.

Each is a function on arrays and a scalar Python expression; `fuzzytrack.fuzzy.membership` has them
in its table of shapes.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.stretches import Stretch

__all__ = [
    "concave", "concave_values", "cosine", "cosine_values", "discrete", "discrete_core",
    "discrete_ones", "discrete_positive", "discrete_values", "ellipse",
    "ellipse_values",
    "quarter_circle", "quarter_circle_values", "sigmoid_difference", "sigmoid_difference_values",
    "sigmoid_peak", "sigmoid_product", "sigmoid_product_values", "spike", "spike_values",
]  # fmt: skip

Parameters = tuple[float, ...]

# math.exp overflows beyond 709.
_EXPONENT = 700.0
# So many times the inverse of its slope from its inflection, a sigmoid is flat.
_FLAT = 40.0
# Search of a peak: each round leaves a twentieth of the interval.
_ROUNDS, _POINTS = 12, 41

# -------------------------------------------------------------------- two sigmoids


def _sigmoid(b: float, c: float, x: str) -> str:
    return f"1.0 / (1.0 + exp(min({_EXPONENT!r}, {-c!r} * ({x} - {b!r}))))"


def sigmoid_difference(parameters: Parameters, x: str) -> str:
    """Write the absolute difference of two sigmoids."""
    b1, c1, b2, c2 = parameters
    return f"abs({_sigmoid(b1, c1, x)} - {_sigmoid(b2, c2, x)})"


def sigmoid_product(parameters: Parameters, x: str) -> str:
    """Write the product of two sigmoids."""
    b1, c1, b2, c2 = parameters
    return f"{_sigmoid(b1, c1, x)} * ({_sigmoid(b2, c2, x)})"


def sigmoid_difference_values(parameters: Parameters, x: Array) -> Array:
    """Evaluate the absolute difference of two sigmoids."""
    first, second = _two_sigmoids(parameters, x)
    return np.abs(first - second)


def sigmoid_product_values(parameters: Parameters, x: Array) -> Array:
    """Evaluate the product of two sigmoids."""
    first, second = _two_sigmoids(parameters, x)
    return first * second


def _two_sigmoids(parameters: Parameters, x: Array) -> tuple[Array, Array]:
    b1, c1, b2, c2 = parameters
    first = 1.0 / (1.0 + np.exp(np.minimum(_EXPONENT, -c1 * (x - b1))))
    second = 1.0 / (1.0 + np.exp(np.minimum(_EXPONENT, -c2 * (x - b2))))
    return np.asarray(first), np.asarray(second)


def sigmoid_peak(parameters: Parameters, *, product: bool) -> tuple[float, float]:
    """Where the difference or the product of two sigmoids is largest.

    Two sigmoids that rise or fall together have the largest product at an end of the line; one that
    rises and one that falls have the largest difference at both ends. For the other cases the peak
    is at the middle of the points of inflection if the slopes are alike, and is searched if not.
    """
    b1, c1, b2, c2 = parameters
    together = (c1 > 0) == (c2 > 0)
    if product and together:
        end = math.inf if c1 > 0 else -math.inf
        return end, end
    if not product and not together:
        return -math.inf, math.inf
    if abs(c1) == abs(c2):
        middle = (b1 + b2) / 2
        return middle, middle
    reach = min(_FLAT / min(abs(c1), abs(c2)), 1e100)
    low, high = min(b1, b2) - reach, max(b1, b2) + reach
    values = sigmoid_product_values if product else sigmoid_difference_values
    for _ in range(_ROUNDS):
        points = np.linspace(low, high, _POINTS)
        best = int(np.argmax(values(parameters, points)))
        low, high = float(points[max(best - 1, 0)]), float(points[min(best + 1, _POINTS - 1)])
    middle = (low + high) / 2
    return middle, middle


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


# -------------------------------------------------------------------- curves of fuzzylite


def cosine_values(parameters: Parameters, x: Array) -> Array:
    """Evaluate a single wave of a cosine, lifted to grades."""
    center, width = parameters
    wave = 0.5 * (1.0 + np.cos(2.0 * math.pi / width * (x - center)))
    return np.where(np.abs(x - center) <= width / 2, wave, 0.0)


def cosine(parameters: Parameters, x: str) -> str:
    """Write the wave."""
    center, width = parameters
    wave = f"0.5 * (1.0 + cos({2.0 * math.pi / width!r} * ({x} - {center!r})))"
    return f"({wave} if abs({x} - {center!r}) <= {width / 2!r} else 0.0)"


def spike_values(parameters: Parameters, x: Array) -> Array:
    """Evaluate two exponentials that meet in a cusp."""
    center, width = parameters
    return np.asarray(np.exp(-np.abs(10.0 / width * (x - center))))


def spike(parameters: Parameters, x: str) -> str:
    """Write the exponentials."""
    center, width = parameters
    return f"exp(-abs({10.0 / width!r} * ({x} - {center!r})))"


def concave_values(parameters: Parameters, x: Array) -> Array:
    """Evaluate a hyperbola that reaches 1 at its end."""
    inflection, end = parameters
    # The falling curve is the rising one seen in a mirror.
    sign = 1.0 if inflection < end else -1.0
    rise, left = sign * (end - inflection), np.maximum(sign * (end - x), 0.0)
    return np.asarray(rise / (rise + left))


def concave(parameters: Parameters, x: str) -> str:
    """Write the hyperbola."""
    inflection, end = parameters
    sign = 1.0 if inflection < end else -1.0
    rise = sign * (end - inflection)
    return f"{rise!r} / ({rise!r} + max({sign!r} * ({end!r} - {x}), 0.0))"


def quarter_circle_values(parameters: Parameters, x: Array) -> Array:
    """Evaluate a quarter of an ellipse from 0 at its start to 1 at its end, and 1 beyond."""
    start, end = parameters
    part = np.clip((x - end) / (start - end), 0.0, 1.0)
    return np.asarray(np.sqrt(1.0 - part**2))


def quarter_circle(parameters: Parameters, x: str) -> str:
    """Write the quarter of an ellipse."""
    start, end = parameters
    return f"(1.0 - max(0.0, min(1.0, ({x} - {end!r}) / {start - end!r})) ** 2) ** 0.5"


def ellipse_values(parameters: Parameters, x: Array) -> Array:
    """Evaluate the upper half of an ellipse between its ends."""
    start, end = parameters
    part = np.clip(np.abs(2.0 * x - (start + end)) / (end - start), 0.0, 1.0)
    return np.asarray(np.sqrt(1.0 - part**2))


def ellipse(parameters: Parameters, x: str) -> str:
    """Write the half of an ellipse."""
    start, end = parameters
    part = f"abs(2.0 * {x} - {start + end!r}) / {end - start!r}"
    return f"(1.0 - min(1.0, {part}) ** 2) ** 0.5"
