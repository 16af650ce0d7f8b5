"""Linguistic variables: a discrete universe of discourse and the fuzzy sets on it."""

from __future__ import annotations

import math
import numbers
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.errors import RuleBaseError
from fuzzytrack.fuzzy.membership import FuzzySet
from fuzzytrack.fuzzy.operators import Operators
from fuzzytrack.fuzzy.shapes import LINEAR
from fuzzytrack.html_reprs import block, curves
from fuzzytrack.reprs import summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["GRIDS", "Universe", "Variable"]

GRIDS = ("ends", "midpoints")
MAX_POINTS = 100_001


@dataclass(frozen=True)
class Universe:
    """Discrete universe of discourse: `points` equally spaced values from `low` to `high`.

    Parameters
    ----------
    low, high : float
        Ends, ``low < high``, in the units of the variable.
    points : int
        Number of grid points, from 2 to 100,001.
    grid : {"ends", "midpoints"}
        Whether the grid includes both ends (as in MATLAB and simpful), or holds the midpoints of
        `points` equal cells (as in fuzzylite). Published results depend on it.

    Raises
    ------
    RuleBaseError
        If a value is out of range.
    """

    low: float
    high: float
    points: int
    grid: str = "ends"

    def __post_init__(self) -> None:
        object.__setattr__(self, "low", float(self.low))
        object.__setattr__(self, "high", float(self.high))
        finite = math.isfinite(self.low) and math.isfinite(self.high)
        if not (finite and self.low < self.high and max(abs(self.low), abs(self.high)) <= 1e100):
            raise RuleBaseError(
                f"universe: needs finite low < high, got low={self.low}, high={self.high}"
            )
        whole = isinstance(self.points, numbers.Real) and float(self.points).is_integer()
        if not whole or not 2 <= self.points <= MAX_POINTS:
            raise RuleBaseError(
                f"universe: points must be a whole number from 2 to {MAX_POINTS}, got {self.points}"
            )
        object.__setattr__(self, "points", int(self.points))
        if self.grid not in GRIDS:
            raise RuleBaseError(f"universe: unknown grid {self.grid!r}; one of {', '.join(GRIDS)}")
        if not (self.low + self.step > self.low and self.high - self.step < self.high):
            raise RuleBaseError(
                f"universe: {self.points} points from low={self.low} to high={self.high} "
                "are finer than floating point"
            )

    @property
    def step(self) -> float:
        """Distance between neighboring grid points."""
        intervals = self.points - 1 if self.grid == "ends" else self.points
        return (self.high - self.low) / intervals

    @property
    def first(self) -> float:
        """First grid point."""
        return self.low if self.grid == "ends" else self.low + self.step / 2

    @cached_property
    def values(self) -> NDArray[np.float64]:
        """The grid points, shape (points,), read-only."""
        last = self.high if self.grid == "ends" else self.high - self.step / 2
        grid = np.linspace(self.first, last, self.points)
        grid.flags.writeable = False
        return grid

    def nearest(self, x: NDArray[np.float64]) -> NDArray[np.intp]:
        """Index of the grid point nearest to each `x`; a tie goes to the upper one."""
        index = np.floor((x - self.first) / self.step + 0.5)
        return np.clip(index, 0, self.points - 1).astype(np.intp)

    def clip(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """`x` moved to the nearest end of the universe where it lies outside."""
        return np.clip(x, self.low, self.high)


# Change of a membership from one float to the next from which it is a jump.
_JUMP = 1e-3


@dataclass(frozen=True)
class Variable:
    """Linguistic variable: an input or output of a fuzzy system.

    Parameters
    ----------
    name : str
        Name used in rules and calls.
    universe : Universe
        Discrete universe of discourse.
    sets : tuple of FuzzySet
        At least one, with distinct names.
    default : float or None
        For an output, the value where no rule fires, within the universe; None gives NaN and a
        warning.
    label, unit : str
        For axes and tables.
    operators : Operators or None
        For an output, operators of its own by which its conclusions are joined, where they differ
        from those of the rule base; its AND of conditions is the rule base's.

    Raises
    ------
    RuleBaseError
        If there is no set, two sets share a name, or the default lies outside of the universe.
    """

    name: str
    universe: Universe
    sets: tuple[FuzzySet, ...]
    default: float | None = None
    label: str = ""
    unit: str = ""
    operators: Operators | None = None
    _index: dict[str, int] = field(init=False, repr=False, compare=False)

    def __repr__(self) -> str:
        return summary(self, "name", "universe", "set_names")

    def __post_init__(self) -> None:
        object.__setattr__(self, "sets", tuple(self.sets))
        names = [s.name for s in self.sets]
        if not names:
            raise RuleBaseError(f"variable {self.name!r} needs at least one set")
        if len(set(names)) < len(names):
            doubled = min(n for n, k in Counter(names).items() if k > 1)
            raise RuleBaseError(f"variable {self.name!r}: two sets of one name: {doubled!r}")
        object.__setattr__(self, "_index", {n: i for i, n in enumerate(names)})
        if self.default is not None:
            object.__setattr__(self, "default", float(self.default))
            if not self.universe.low <= self.default <= self.universe.high:
                raise RuleBaseError(
                    f"default of {self.name} must be within its universe, "
                    f"[{self.universe.low:g}, {self.universe.high:g}], got {self.default:g}"
                )

    @property
    def set_names(self) -> tuple[str, ...]:
        """Names of the sets, in order."""
        return tuple(self._index)

    @property
    def axis_label(self) -> str:
        """Label with unit, for an axis."""
        text = self.label or self.name
        return f"{text} ({self.unit})" if self.unit and self.unit != "1" else text

    def index(self, set_name: str) -> int:
        """Position of a set by name.

        Raises
        ------
        RuleBaseError
            If there is no such set; names the allowed ones.
        """
        if set_name not in self._index:
            raise RuleBaseError(
                f"{self.name} has no set {set_name!r}; one of {', '.join(self._index)}"
            )
        return self._index[set_name]

    def uncovered(self, set_names: Collection[str] | None = None) -> Iterator[tuple[float, float]]:
        """Intervals of the universe, as (low, high), where every membership is zero.

        Parameters
        ----------
        set_names : collection of str, optional
            The sets that count; all unless given.

        Yields
        ------
        low, high : float
            In ascending order; equal where only one point has no membership.
        """
        end, end_covered = self.universe.low, False
        supports = [
            stretch
            for s in self.sets
            if set_names is None or s.name in set_names
            for stretch in s.positive()
        ]
        for low, high, with_low, with_high in sorted(supports, key=lambda s: (s[0], not s[2])):
            if low > self.universe.high:
                break
            if low > end or (low == end and not end_covered and not with_low):
                yield end, low
            if high > end or (high == end and with_high):
                end, end_covered = high, with_high
        if end < self.universe.high or (end == self.universe.high and not end_covered):
            yield end, self.universe.high

    def is_within(self, set_name: str, x: float) -> bool:
        """Whether a set is above zero at `x`, or would be if floats were smaller."""
        fuzzy_set = self.sets[self.index(set_name)]
        if fuzzy_set.is_tailed:
            return True
        x = min(max(x, self.universe.low), self.universe.high)
        return any(x in stretch for stretch in fuzzy_set.positive())

    def memberships(self, x: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        """Grades of every set, shape ``(n_sets, *x.shape)``; on the universe's grid without `x`."""
        points = self.universe.values if x is None else x
        least, most = np.min(points, initial=np.inf), np.max(points, initial=-np.inf)
        grades = np.zeros((len(self.sets), *np.shape(points)))
        for row, fuzzy_set in enumerate(self.sets):
            low, high, _, _ = fuzzy_set.support()
            # Not so where a point is NaN.
            if not (most < low or high < least):
                grades[row] = fuzzy_set.membership(points)
        if x is None:
            for row, fuzzy_set in enumerate(self.sets):
                if fuzzy_set.shape == "singleton":
                    # A spike between two grid points belongs to the nearer one (Eq. 3.2).
                    grades[row] = 0.0
                    grades[row, self.universe.nearest(np.asarray(fuzzy_set.parameters[0]))] = 1.0
        return grades

    def nodes(self, points: int, *, corners: bool = True) -> NDArray[np.float64]:
        """Points of the universe: evenly spaced ones, and every corner of its sets.

        Between them all sets are smooth, so that what is drawn on them has its corners where they
        are. Where a set jumps, the points next to the jump are among them.

        Parameters
        ----------
        points : int
            How many are evenly spaced.
        corners : bool
            False leaves out the corners.

        Returns
        -------
        ndarray, shape (n_nodes,)
            Ascending, from one end of the universe to the other.
        """
        low, high = self.universe.low, self.universe.high
        even = np.linspace(low, high, points)
        if not corners:
            return even
        exact = {low, high}
        for each in self.sets:
            inside = np.array([p for p in each.breakpoints() if low <= p <= high])
            exact.update(inside.tolist())
            for end in (low, high):
                beside = np.nextafter(inside, end)
                jumps = np.abs(each.membership(beside) - each.membership(inside)) > _JUMP
                exact.update(beside[jumps].tolist())
        ends = np.array(sorted(exact))
        # An even point that rounding has put beside a corner is left out.
        apart = np.abs(even[:, None] - ends).min(axis=1) > 1e-9 * (high - low)
        return np.union1d(ends, even[apart])

    @property
    def is_linear(self) -> bool:
        """Whether some sets are linear functions of the inputs."""
        return any(s.base == LINEAR for s in self.sets)

    def values_of_sets(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Centers of the sets at points of the inputs, those of linear sets being their values.

        Parameters
        ----------
        points : ndarray, shape (n, n_inputs)

        Returns
        -------
        ndarray, shape (n, n_sets)
        """
        values = np.tile(self.centers(), (len(points), 1))
        for column, fuzzy_set in enumerate(self.sets):
            if fuzzy_set.base == LINEAR:
                *slopes, constant = fuzzy_set.parameters
                values[:, column] = points @ np.array(slopes) + constant
        return values

    def centers(self) -> NDArray[np.float64]:
        """Centers of the sets, shape (n_sets,)."""
        low, high = self.universe.low, self.universe.high
        return np.array([s.center(low, high) for s in self.sets])

    def shares(self) -> dict[str, float]:
        """Place of each set among all of them, by their centers: 0 is the lowest, 1 the highest."""
        places = np.argsort(np.argsort(self.centers(), kind="stable"))
        last = max(len(self.sets) - 1, 1)
        alone = len(self.sets) == 1
        return {
            name: 0.5 if alone else place / last
            for name, place in zip(self.set_names, places.tolist(), strict=True)
        }

    def plot(self) -> Figure:
        """Picture of the memberships of the sets."""
        from fuzzytrack.plotting import plot_memberships

        return plot_memberships(self)[0]

    def _repr_html_(self) -> str:
        """Picture of the sets, for notebooks."""
        return block(self.axis_label, self.drawing())

    def drawing(self) -> str:
        """The sets as a small drawing in HTML."""
        x = self.nodes(61)
        grades = dict(zip(self.set_names, self.memberships(x), strict=True))
        return curves(x, grades, list(self.shares().values()))
