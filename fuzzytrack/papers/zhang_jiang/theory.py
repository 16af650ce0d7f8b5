"""Gains and gates from the quality factor of a track, as formulas."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import within
from fuzzytrack.gains.design import quality
from fuzzytrack.papers.reproduction import Row, row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["gate_factor", "gates_picture", "theory_rows"]


QUALITIES = (1, 2, 3, 5, 8, 10, 12, 15, 20, 30, 46, 100)


def gate_factor(n: ArrayLike) -> Array:
    """Gate factor F of the paper: standard deviation of a predicted position, in that of a plot.

    Parameters
    ----------
    n : array_like
        Quality factor N, > 1; 1 gives infinity.

    Returns
    -------
    ndarray

    Raises
    ------
    ValueError
        If N is less than 1.

    Notes
    -----
    Zhang & Jiang, "track gate factor calculation". It is that of a line through N plots, one scan
    ahead. A track of quality N has N + 1 plots when its gate is set, so F(N + 1) would be right,
    which also is finite for N = 1.
    """
    number = np.asarray(n, dtype=np.float64)
    number = within("n", number, number >= 1, ">= 1")
    with np.errstate(divide="ignore"):
        return np.asarray(np.sqrt(2 * (2 * number + 1) / (number * (number - 1))))


def theory_rows() -> list[Row]:
    """Gains, gate factors, and lags in a turn."""
    return [*_gain_rows(), *_gate_rows(), *_lag_rows()]


def _gain_rows() -> list[Row]:
    rows = []
    published = {("α", 1): 0.83333333333333334, ("β", 1): 0.7003401714778814}
    for n in QUALITIES:
        for name, gain in zip("αβ", quality(n), strict=True):
            rows.append(
                row("Smoothing filter", f"{name} at N = {n}", float(gain),
                    published=published.get((name, n)), within=1e-12)
            )  # fmt: skip
    return rows


def _gate_rows() -> list[Row]:
    clamp = "the formula divides by zero; 3 can only be a clamp"
    count = "of 30 constants, N = 1 to 30, the last is 0.374; 0.3 is first reached at N = 46"
    numbers = np.arange(2, 200)
    first = float(numbers[gate_factor(numbers) <= 0.3][0])
    rows = [
        row("Gate", "F at N = 1, largest of the table", float(gate_factor(1)), published=3.0,
            why=clamp),
        row("Gate", "F at N = 30, smallest of the table", float(gate_factor(30)), published=0.3,
            within=0.05, why=count),
        row("Gate", "first N with F <= 0.3", first, published=30.0, why=count),
    ]  # fmt: skip
    return [*rows, *(row("Gate", f"F at N = {n}", float(gate_factor(n))) for n in QUALITIES[1:])]


def _lag_rows() -> list[Row]:
    quantity = "lag in a turn, over a T², at N = {}"
    return [
        row("Smoothing filter", quantity.format(n), float(1 / quality(n)[1])) for n in QUALITIES
    ]


def gates_picture() -> Figure:
    """Gains and gate factor over the quality."""
    from fuzzytrack.plotting.curves import plot_curves

    n = np.arange(2, 61)
    alpha, beta = quality(n)
    curves: dict[str, Array] = {
        "α": np.asarray(alpha), "β": np.asarray(beta), "gate factor F": gate_factor(n)
    }  # fmt: skip
    draw: Callable[..., tuple[Figure, object]] = plot_curves
    return draw(
        n, curves, xlabel="quality factor N", ylabel="gain, gate factor", ylog=True,
        marks={"smallest F as printed": (30, 0.3)},
    )[0]  # fmt: skip
