"""Fuzzy sets: a membership shape with its parameters and a name."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.hedges import HEDGES
from fuzzytrack.fuzzy.shapes import LINEAR, SHAPES, TAILED
from fuzzytrack.fuzzy.stretches import Stretch

__all__ = ["FuzzySet"]


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
