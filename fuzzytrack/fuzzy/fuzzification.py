"""Fuzzification: from a crisp input to a fuzzy set on its universe."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.fuzzy.variable import Variable
from fuzzytrack.reprs import constructor_code

__all__ = ["FUZZIFICATIONS", "Fuzzification"]

FUZZIFICATIONS = ("singleton", "gaussian", "triangular")


@dataclass(frozen=True, repr=False)
class Fuzzification:
    """How a crisp input becomes a fuzzy one.

    Parameters
    ----------
    shape : {"singleton", "gaussian", "triangular"}
        ``singleton`` is Eq. 3.2 of Llinas et al. (1998).
    width : float or mapping of input name to float
        Standard deviation (gaussian) or half base (triangular), in the units of the input; at
        least the step of its grid, else the fuzzy input could fall between two grid points.

    Raises
    ------
    ValueError
        If the shape is unknown, or a width is missing, not positive or finer than the grid.
    """

    shape: str = "singleton"
    width: float | Mapping[str, float] | None = None

    def __post_init__(self) -> None:
        if self.shape not in FUZZIFICATIONS:
            raise ValueError(
                f"fuzzification: unknown shape {self.shape!r}; one of {', '.join(FUZZIFICATIONS)}"
            )
        if (self.width is None) != (self.shape == "singleton"):
            raise ValueError(
                "fuzzification: width goes with gaussian and triangular, and only there; "
                f"got shape={self.shape!r}, width={self.width}"
            )

    def __repr__(self) -> str:
        return constructor_code(self)

    @property
    def is_singleton(self) -> bool:
        """Whether inputs stay crisp."""
        return self.shape == "singleton"

    def check(self, variable: Variable) -> float:
        """Width for one input, checked against its grid."""
        width = self.width.get(variable.name) if isinstance(self.width, Mapping) else self.width
        step = variable.universe.step
        if width is None or not (math.isfinite(width) and width >= step * (1 - 1e-9)):
            raise ValueError(
                f"fuzzification: width of {variable.name} must be a number of at least "
                f"its grid step {step:g}, got {width}"
            )
        return float(width)

    def membership(self, variable: Variable, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Fuzzy input on the variable's grid, shape ``(*x.shape, n_points)``."""
        width = self.check(variable)
        distance = (variable.universe.values - x[..., None]) / width
        if self.shape == "gaussian":
            return np.asarray(np.exp(-0.5 * distance * distance))
        return np.maximum(0.0, 1.0 - np.abs(distance))
