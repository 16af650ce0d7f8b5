"""Surfaces of the outputs of a rule base and of the gains behind them, as the page draws them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.fuzzy.rulebase import RuleBase
from fuzzytrack.fuzzy.system import FuzzySystem
from fuzzytrack.reprs import summary
from fuzzytrack.schedulers.gain_outputs import choices, find_gain_outputs, gains_of
from fuzzytrack.yamltree import quoted, suggestion

__all__ = ["MAX_POINTS", "Surfaces", "surface_names", "surfaces"]

#: Points on each axis.
MAX_POINTS = 201
_LARGEST = 1e300
_GAINS = ("alpha", "beta", "gamma")

Floats = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Values over a regular grid of one or two inputs.

    Attributes
    ----------
    inputs : tuple of str
        The inputs drawn over: x, and y unless the rule base has one input.
    x, y : ndarray of float32, shape (nx,) and (ny,)
        Points of the inputs, in their units; `y` is a single 0 where there is one input.
    values : dict of str to ndarray of float32, shape (nx, ny)
        For each name ``values[i, j]`` at ``x[i]``, ``y[j]``, little-endian; NaN where no rule
        fires.
    """

    inputs: tuple[str, ...]
    x: Floats
    y: Floats
    values: dict[str, Floats]

    def __repr__(self) -> str:
        return summary(self, "inputs", "values")


def surface_names(system: FuzzySystem) -> tuple[str, ...]:
    """Names that `surfaces` takes: the outputs, and the gains that follow from them."""
    names = system.rules.output_names
    found = find_gain_outputs(names)
    return (*names, *(gain for gain in (found.gain_names if found else ()) if gain not in names))


def surfaces(
    system: FuzzySystem,
    names: Sequence[str],
    points: int = 41,
    *,
    inputs: Sequence[str] | None = None,
    at: Mapping[str, float] | None = None,
    less: FuzzySystem | None = None,
) -> Surfaces:
    """Surfaces of some outputs and gains.

    Parameters
    ----------
    system : FuzzySystem
    names : sequence of str
        Outputs, and ``alpha``, ``beta`` or ``gamma`` where the outputs determine them.
    points : int
        Points on each axis, from 2 to 201, evenly spaced over the universe.
    inputs : sequence of two str, optional
        The inputs to draw over; the first two unless given.
    at : mapping, optional
        Values of the other inputs.
    less : FuzzySystem, optional
        Another system with the same inputs, whose values at the same points are subtracted.

    Raises
    ------
    ValueError
        If an argument is not one of the allowed ones, or the systems have not the same inputs.
    """
    rules = system.rules
    if not isinstance(points, int) or not 2 <= points <= MAX_POINTS:
        raise ValueError(f"points: must be a whole number from 2 to {MAX_POINTS}, got {points!r}")
    drawn, fixed = _drawn(rules, inputs), dict(at or {})
    _check_fixed(rules, drawn, fixed)
    axes = [rules.input(name).nodes(points, corners=False) for name in drawn]
    mesh = np.meshgrid(*axes, indexing="ij")
    places = dict(zip(drawn, mesh, strict=True))
    places |= {name: np.full(mesh[0].shape, value) for name, value in fixed.items()}
    values = _values(system, names, places)
    if less is not None:
        if set(less.rules.input_names) != set(rules.input_names):
            raise ValueError(
                f"less: {less.rules.name} has inputs {', '.join(less.rules.input_names)}; a "
                f"difference to {rules.name} needs {', '.join(rules.input_names)}"
            )
        others = _values(less, names, places)
        values = {name: found - others[name] for name, found in values.items()}
    x, *rest = (axis.astype("<f4") for axis in axes)
    y = rest[0] if rest else np.zeros(1, "<f4")
    grids = {name: found.reshape(len(x), len(y)).astype("<f4") for name, found in values.items()}
    return Surfaces(drawn, x, y, grids)


def _drawn(rules: RuleBase, inputs: Sequence[str] | None) -> tuple[str, ...]:
    drawn = tuple(inputs or rules.input_names[:2])
    wanted = min(2, len(rules.inputs))
    if len(drawn) != wanted or len(set(drawn)) != wanted or not {*drawn} <= {*rules.input_names}:
        raise ValueError(
            f"inputs: must be {wanted} of {', '.join(rules.input_names)}, got {', '.join(drawn)}"
        )
    return drawn


def _check_fixed(rules: RuleBase, drawn: tuple[str, ...], fixed: Mapping[str, float]) -> None:
    others = [name for name in rules.input_names if name not in drawn]
    numbers = all(isinstance(v, int | float) and abs(v) <= _LARGEST for v in fixed.values())
    if set(fixed) != set(others) or not numbers:
        got = ", ".join(f"{name}={value}" for name, value in fixed.items())
        raise ValueError(
            f"at: must give a number for {', '.join(others) or 'no input'}; got {got or 'nothing'}"
        )


def _values(
    system: FuzzySystem, names: Sequence[str], places: Mapping[str, Array]
) -> dict[str, Array]:
    """Outputs and gains at places, given by input as arrays of one shape."""
    _check_names(system, names)
    found = system.evaluate(
        np.stack([places[name].ravel() for name in system.rules.input_names], axis=1)
    )
    if not set(names) <= set(found):
        found |= gains_of(found)
    return {name: found[name] for name in names}


def _check_names(system: FuzzySystem, names: Sequence[str]) -> None:
    allowed = surface_names(system)
    if not names:
        raise ValueError(f"names: give at least one of {', '.join(allowed)}")
    for name in names:
        if name in _GAINS and name not in allowed:
            raise ValueError(
                f"names: {name} does not follow from the outputs of {system.rules.name} alone; "
                f"that needs {choices()}"
            )
        if name not in allowed:
            raise ValueError(f"names: unknown output {quoted(name)}{suggestion(name, allowed)}")
