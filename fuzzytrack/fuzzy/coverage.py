"""Inputs at which no rule about an output fires, found exactly: single points of them, too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.inference import antecedents
from fuzzytrack.fuzzy.rulebase import Rule, RuleBase
from fuzzytrack.fuzzy.variable import Variable

__all__ = ["Hole", "find_hole"]

#: Combinations of pieces of the inputs that are tried before the search is given up.
_MOST_TRIED = 200_000
#: Strengths below this are lost in the sums of a defuzzification.
_FAINT = 1e-290
#: Points between two cores that are tried.
_BETWEEN = 65

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Hole:
    """Inputs at which no rule about an output fires.

    Attributes
    ----------
    output : str
        Name of the output.
    stretches : tuple of (str, float, float)
        Name of an input, and the ends of a stretch of it, equal for a single point; for each input.
        Empty if there are so many rules that the search was given up: there may be a hole.
    underflow : bool
        Whether rules would fire there, but with strengths too small for a floating-point number.
    """

    output: str
    stretches: tuple[tuple[str, float, float], ...]
    underflow: bool = False

    @property
    def point(self) -> tuple[float, ...]:
        """One of the inputs, in the order of the rule base."""
        return tuple((low + high) / 2 for _, low, high in self.stretches)

    @property
    def where(self) -> str:
        """The inputs, in words: ``at a=5, b=5``, or ``for a between 2 and 3, b at 5``."""
        if all(low == high for _, low, high in self.stretches):
            return "at " + ", ".join(f"{name}={low:.6g}" for name, low, _ in self.stretches)
        return "for " + ", ".join(
            f"{name} at {low:.6g}" if low == high else f"{name} between {low:.6g} and {high:.6g}"
            for name, low, high in self.stretches
        )

    def __str__(self) -> str:
        if self.underflow:
            return (
                f"the strengths of all rules about {self.output} underflow to 0 {self.where}: "
                "their sets are too narrow for the distances between them"
            )
        return f"no rule about {self.output} fires {self.where}"


@dataclass(frozen=True)
class _Piece:
    """A point of an input, or a stretch without its ends, on which the same sets are above 0."""

    low: float
    high: float
    positive: Flags

    @property
    def width(self) -> float:
        return self.high - self.low


def find_hole(rules: RuleBase, output: str) -> Hole | None:
    """Inputs at which no rule about an output fires; None if one always does.

    Parameters
    ----------
    rules : RuleBase
    output : str
        Name of the output.

    Returns
    -------
    Hole or None

    Notes
    -----
    Where grades are above 0 follows from the sets: each input falls into points and stretches on
    which this is the same for all sets. A product of grades may be too small for a floating-point
    number; this is looked for where the largest grades are smallest.
    """
    about = np.array([k for k, rule in enumerate(rules.rules) if _concludes(rule, output)])
    conditions = antecedents(rules).of(about).term
    pieces = [
        _pieces(variable, np.unique(conditions[:, axis]))
        for axis, variable in enumerate(rules.inputs)
    ]
    try:
        found = _search(conditions, [_fewest(of_input) for of_input in pieces])
    except _GivenUpError:
        return Hole(output, ())
    if found is None:
        return _underflow(rules, about, output)
    widest = _widened(conditions, pieces, found)
    names = rules.input_names
    return Hole(output, tuple((n, p.low, p.high) for n, p in zip(names, widest, strict=True)))


def _concludes(rule: Rule, output: str) -> bool:
    return any(c.output == output and c.confidence > 0 for c in rule.consequents)


# ---------------------------------------------------------------- pieces of an input


def _pieces(variable: Variable, used: NDArray[np.intp]) -> list[_Piece]:
    """Points and stretches of an input, in ascending order, with those `used` sets above 0."""
    universe = variable.universe
    supports = [s.positive() for s in variable.sets]
    counts = np.isin(np.arange(len(supports)), used)
    ends = {universe.low, universe.high}
    ends |= {
        e
        for k in np.flatnonzero(counts)
        for stretch in supports[k]
        for e in stretch[:2]
        if universe.low < e < universe.high
    }
    knots = sorted(ends)
    found = []
    for low, high in zip(knots, [*knots[1:], None], strict=True):
        at = [any(low in stretch for stretch in stretches) for stretches in supports]
        found.append(_Piece(low, low, counts & at))
        if high is not None:
            inside = [
                any(s.low <= low and high <= s.high and s.low < s.high for s in stretches)
                for stretches in supports
            ]
            found.append(_Piece(low, high, counts & inside))
    return found


def _fewest(pieces: list[_Piece]) -> list[_Piece]:
    """Pieces of which no other has fewer sets above 0: where there is a hole, one has it."""
    distinct = {piece.positive.tobytes(): piece for piece in pieces}
    rest = list(distinct.values())
    return [
        piece
        for piece in rest
        if not any(
            other is not piece and not (other.positive & ~piece.positive).any() for other in rest
        )
    ]


# ---------------------------------------------------------------- the search


class _GivenUpError(Exception):
    """There are too many combinations of pieces."""


def _search(conditions: NDArray[np.intp], pieces: list[list[_Piece]]) -> list[_Piece] | None:
    """One piece of each input such that no rule fires on all of them together."""
    tried = 0
    hopeless: set[tuple[int, bytes]] = set()

    def fill(axis: int, alive: NDArray[np.intp]) -> list[_Piece] | None:
        """Pieces of the inputs from `axis` on that stop the rules which are still alive."""
        nonlocal tried
        if not len(alive):
            return [of_input[0] for of_input in pieces[axis:]]
        key = (axis, alive.tobytes())
        if axis == len(pieces) or key in hopeless or (conditions[alive, axis:] < 0).all(1).any():
            return None
        tried += 1
        if tried > _MOST_TRIED:
            raise _GivenUpError
        for piece in pieces[axis]:
            rest = fill(axis + 1, alive[_fires(conditions[alive, axis], piece)])
            if rest is not None:
                return [piece, *rest]
        hopeless.add(key)
        return None

    return fill(0, np.arange(len(conditions)))


def _fires(needed: NDArray[np.intp], piece: _Piece) -> Flags:
    """Whether a piece fulfills each condition of an input."""
    return np.asarray((needed < 0) | piece.positive[needed])


def _widened(
    conditions: NDArray[np.intp], pieces: list[list[_Piece]], found: list[_Piece]
) -> list[_Piece]:
    """The widest hole that differs from a hole in one input after the other."""
    widest = list(found)
    for axis, of_input in enumerate(pieces):
        others = np.ones(len(conditions), dtype=bool)
        for other, piece in enumerate(widest):
            if other != axis:
                others &= _fires(conditions[:, other], piece)
        free = [p for p in of_input if not (others & _fires(conditions[:, axis], p)).any()]
        widest[axis] = max(free, key=lambda piece: piece.width)
    return widest


# ---------------------------------------------------------------- underflow


def _underflow(rules: RuleBase, about: NDArray[np.intp], output: str) -> Hole | None:
    """A point at which the strength of every rule about an output is lost, though none is 0."""
    used = {condition for k in about for group in rules.rules[k].groups for condition in group}
    tailed = any(
        fuzzy_set.is_tailed
        for variable in rules.inputs
        for fuzzy_set in variable.sets
        if (variable.name, fuzzy_set.name) in used
    )
    if not tailed or rules.operators.conjunction == "min":
        return None
    conditions = antecedents(rules).of(about)
    axes = [_faintest(variable, used) for variable in rules.inputs]
    for points in _in_blocks(axes):
        grades = [v.memberships(points[:, k]) for k, v in enumerate(rules.inputs)]
        strongest = conditions.strengths(grades).max(axis=1)
        faint = np.flatnonzero(strongest < _FAINT)
        if len(faint):
            place = points[faint[np.argmin(strongest[faint])]].tolist()
            stretches = zip(rules.input_names, place, place, strict=True)
            return Hole(output, tuple(stretches), underflow=True)
    return None


def _faintest(variable: Variable, used: set[tuple[str, str]]) -> Array:
    """Points of an input: its ends, and between two cores where the largest grade is smallest."""
    low, high = variable.universe.low, variable.universe.high
    sets = [s for s in variable.sets if (variable.name, s.name) in used]
    if not sets:
        return np.array([low])
    cores = sorted({end for s in sets for end in s.core(low, high)})
    points = {low, high}
    for a, b in pairwise(cores):
        between = np.linspace(a, b, _BETWEEN)
        largest = np.max([s.membership(between) for s in sets], axis=0)
        points.add(float(between[np.argmin(largest)]))
    return np.array(sorted(points))


def _in_blocks(axes: list[Array]) -> Iterator[Array]:
    """All combinations of some points, up to `_MOST_TRIED`, shape (n, n_inputs) at a time."""
    block: list[tuple[float, ...]] = []
    for count, point in enumerate(product(*(axis.tolist() for axis in axes)), start=1):
        block.append(point)
        if len(block) == 4096:
            yield np.array(block)
            block = []
        if count == _MOST_TRIED:
            break
    if block:
        yield np.array(block)
