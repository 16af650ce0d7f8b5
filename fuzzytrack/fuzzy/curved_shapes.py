"""Formulas of membership shapes with curved sides, for `fuzzytrack.fuzzy.shapes`.

Those that end in ``values`` are functions on arrays; the others write a scalar Python expression.
"""

from __future__ import annotations

import math

import numpy as np

from fuzzytrack.arrays import Array

__all__ = [
    "EXPONENT", "bell", "concave", "concave_values", "cosine", "cosine_values", "ellipse",
    "ellipse_values", "gaussian", "pi_curve", "quarter_circle", "quarter_circle_values", "s_curve",
    "sigmoid", "sigmoid_difference", "sigmoid_difference_values", "sigmoid_peak",
    "sigmoid_product", "sigmoid_product_values", "spike", "spike_values",
    "two_gaussians", "two_gaussians_values", "z_curve",
]  # fmt: skip

Parameters = tuple[float, ...]

#: exp(-x) is above zero up to here; math.exp overflows beyond 709.
EXPONENT = 700.0
# So many times the inverse of its slope from its inflection, a sigmoid is flat.
_FLAT = 40.0
# Search of a peak: each round leaves a twentieth of the interval.
_ROUNDS, _POINTS = 12, 41

# -------------------------------------------------------------------- curves of scikit-fuzzy


def gaussian(mean: float, sigma: float, x: str) -> str:
    """Write a Gaussian."""
    return f"exp(-(({x} - {mean!r}) * ({x} - {mean!r})) / {2 * sigma * sigma!r})"


def two_gaussians(parameters: Parameters, x: str) -> str:
    """Write two halves of Gaussians with 1 between them."""
    mean1, sigma1, mean2, sigma2 = parameters
    left, right = gaussian(mean1, sigma1, x), gaussian(mean2, sigma2, x)
    return f"({left} if {x} <= {mean1!r} else 1.0) * ({right} if {x} > {mean2!r} else 1.0)"


def two_gaussians_values(parameters: Parameters, x: Array) -> Array:
    """Evaluate the halves of Gaussians."""
    mean1, sigma1, mean2, sigma2 = parameters
    left = np.exp(-((x - mean1) ** 2) / (2 * sigma1**2))
    right = np.exp(-((x - mean2) ** 2) / (2 * sigma2**2))
    return np.where(x <= mean1, left, 1.0) * np.where(x > mean2, right, 1.0)


def bell(parameters: Parameters, x: str) -> str:
    """Write a generalized bell."""
    a, b, c = parameters
    # Where the power passes 1e300 the grade is zero and Python's ** would overflow.
    far = 10 ** min(300.0, 150 / b)
    return f"1.0 / (1.0 + min(abs(({x} - {c!r}) / {a!r}), {far!r}) ** {2 * b!r})"


# The ends come first: between neighboring floats the middle is rounded to one of them. At the
# middle itself, the half that scikit-fuzzy uses there is used; it differs between shapes.
def s_curve(a: float, b: float, x: str, lower: str) -> str:
    """Write two parabolas that rise from 0 at `a` to 1 at `b`."""
    middle, width = (a + b) / 2, b - a
    if width == 0:
        return f"(1.0 if {x} >= {b!r} else 0.0)"
    low, high = f"(({x} - {a!r}) / {width!r})", f"(({x} - {b!r}) / {width!r})"
    return (
        f"(0.0 if {x} <= {a!r} else 1.0 if {x} >= {b!r} else 2.0 * {low} * {low} "
        f"if {x} {lower} {middle!r} else 1.0 - 2.0 * {high} * {high})"
    )


def z_curve(a: float, b: float, x: str) -> str:
    """Write two parabolas that fall from 1 at `a` to 0 at `b`."""
    middle, width = (a + b) / 2, b - a
    if width == 0:
        return f"(1.0 if {x} <= {a!r} else 0.0)"
    low, high = f"(({x} - {a!r}) / {width!r})", f"(({x} - {b!r}) / {width!r})"
    return (
        f"(1.0 if {x} <= {a!r} else 0.0 if {x} >= {b!r} else 1.0 - 2.0 * {low} * {low} "
        f"if {x} < {middle!r} else 2.0 * {high} * {high})"
    )


def pi_curve(parameters: Parameters, x: str) -> str:
    """Write the rise of an s-curve times the fall of a z-curve."""
    a, b, c, d = parameters
    return f"{s_curve(a, b, x, '<=')} * {z_curve(c, d, x)}"


# -------------------------------------------------------------------- two sigmoids


def sigmoid(b: float, c: float, x: str) -> str:
    """Write a sigmoid with its inflection at `b`."""
    return f"1.0 / (1.0 + exp(min({EXPONENT!r}, {-c!r} * ({x} - {b!r}))))"


def sigmoid_difference(parameters: Parameters, x: str) -> str:
    """Write the absolute difference of two sigmoids."""
    b1, c1, b2, c2 = parameters
    return f"abs({sigmoid(b1, c1, x)} - {sigmoid(b2, c2, x)})"


def sigmoid_product(parameters: Parameters, x: str) -> str:
    """Write the product of two sigmoids."""
    b1, c1, b2, c2 = parameters
    return f"{sigmoid(b1, c1, x)} * ({sigmoid(b2, c2, x)})"


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
    first = 1.0 / (1.0 + np.exp(np.minimum(EXPONENT, -c1 * (x - b1))))
    second = 1.0 / (1.0 + np.exp(np.minimum(EXPONENT, -c2 * (x - b2))))
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
    # From the nearer end, so that it is 0 there: a root makes much of a rounding.
    part = np.clip(1.0 - 2.0 * np.minimum(x - start, end - x) / (end - start), 0.0, 1.0)
    return np.asarray(np.sqrt(1.0 - part**2))


def ellipse(parameters: Parameters, x: str) -> str:
    """Write the half of an ellipse."""
    start, end = parameters
    part = f"1.0 - 2.0 * min({x} - {start!r}, {end!r} - {x}) / {end - start!r}"
    return f"(1.0 - max(0.0, min(1.0, {part})) ** 2) ** 0.5"
