"""Free parameters of a tracker, and the coordinates in which they are searched."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array

__all__ = ["SCALES", "Numbers", "Parameter", "Space"]

#: Parameters of a tracker.
Numbers = tuple[float, ...]

#: How a parameter is searched: evenly, by factors, or as a probability, by factors of the odds.
SCALES = ("linear", "log", "probability")

# One step of the search, in the coordinate of its scale: a third for a factor, and for the odds of
# a probability; a part of the range between the limits.
_STEPS = {"log": 0.3, "probability": 0.6}
_LINEAR_PART = 0.12
# A probability stays so far from 0 and 1.
_EDGE = 1e-4
#: Digits of a number that a search tries: what is printed is what was measured.
_DIGITS = 5


@dataclass(frozen=True)
class Parameter:
    """A number of a tracker that is free.

    Parameters
    ----------
    name : str
        As a user names it.
    start : float
        Where the search begins; moved into the limits.
    low, high : float
        Limits, ``low < high``; for "log" positive, for "probability" within [0, 1].
    scale : {"linear", "log", "probability"}
        How it is searched.
    """

    name: str
    start: float
    low: float
    high: float
    scale: str = "log"

    def __post_init__(self) -> None:
        if self.scale not in SCALES:
            raise ValueError(f"scale: unknown {self.scale!r}; one of {', '.join(SCALES)}")
        if self.scale == "probability":
            object.__setattr__(self, "low", max(self.low, _EDGE))
            object.__setattr__(self, "high", min(self.high, 1.0 - _EDGE))
        if not self.low < self.high or (self.scale == "log" and self.low <= 0):
            raise ValueError(f"{self.name}: limits must rise, got {self.low:g} to {self.high:g}")
        object.__setattr__(self, "start", min(max(self.start, self.low), self.high))

    def coordinate(self, value: float) -> float:
        """Coordinate of a value, in steps from the start."""
        return (self._scaled(value) - self._scaled(self.start)) / self._step

    def value(self, coordinate: float) -> float:
        """Value at a coordinate, rounded to what is written."""
        scaled = self._scaled(self.start) + coordinate * self._step
        if self.scale == "log":
            scaled = math.exp(scaled)
        elif self.scale == "probability":
            scaled = 1.0 / (1.0 + math.exp(-scaled))
        # The start itself is as it was given.
        value = self.start if coordinate == 0.0 else float(f"{scaled:.{_DIGITS}g}")
        return min(max(value, self.low), self.high)

    def _scaled(self, value: float) -> float:
        if self.scale == "log":
            return math.log(value)
        return math.log(value / (1.0 - value)) if self.scale == "probability" else value

    @property
    def _step(self) -> float:
        return _STEPS.get(self.scale, _LINEAR_PART * (self.high - self.low))


@dataclass(frozen=True)
class Space:
    """Parameters that are searched together.

    Parameters
    ----------
    parameters : tuple of Parameter
    rising : tuple of tuple of int
        Groups of parameters, by number, whose values must rise.
    """

    parameters: tuple[Parameter, ...]
    rising: tuple[tuple[int, ...], ...] = ()

    @property
    def start(self) -> Numbers:
        """Numbers at which the search begins."""
        return tuple(p.start for p in self.parameters)

    @property
    def bounds(self) -> Array:
        """Limits as coordinates, shape (n_parameters, 2)."""
        return np.array(
            [(p.coordinate(p.low), p.coordinate(p.high)) for p in self.parameters]
        ).reshape(-1, 2)

    def numbers(self, place: Sequence[float] | Array) -> Numbers:
        """Numbers at a place, in coordinates; those of a rising group in order."""
        found = [p.value(float(x)) for p, x in zip(self.parameters, place, strict=True)]
        for group in self.rising:
            for k, value in zip(group, sorted(found[k] for k in group), strict=True):
                found[k] = value
        return tuple(found)

    def restricted(self, kept: Sequence[int]) -> Space:
        """Space of some of the parameters, by number; the others stay where they start."""
        order = {k: n for n, k in enumerate(kept)}
        groups = [tuple(order[k] for k in group if k in order) for group in self.rising]
        return Space(
            tuple(self.parameters[k] for k in kept),
            tuple(group for group in groups if len(group) > 1),
        )
