"""What a radar sees: its reach, noise, probability of detection, resolution and shadows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.simulation.scene.paths import Paths
from fuzzytrack.simulation.scene.settings import Settings, setting

__all__ = ["OwnShip", "Radar", "ScanTimes"]


@dataclass(frozen=True, repr=False)
class Radar(Settings):
    """A radar that measures range and bearing."""

    reach: tuple[float, float] = setting(
        (0.0, math.inf),
        "range, or the least and the largest one, that it sees",
        "m",
        "interval",
        least=0,
    )
    sigma_range: float = setting(0.0, "standard deviation of range", "m", least=0)
    sigma_bearing: float = setting(0.0, "standard deviation of bearing", "rad", least=0)
    sigma_position: float = setting(
        0.0, "standard deviation of x and of y, added to the others", "m", least=0
    )
    detection: tuple[tuple[float, float], ...] = setting(
        ((0.0, 1.0),),
        "probability of detection, or pairs of a range (m) and the probability there, with "
        "straight lines between them",
        "",
        "curve",
        least=0,
        most=1,
    )
    range_cell: float = setting(
        0.0,
        "echoes that differ by less than this in range, and by less than `beam` in bearing, become "
        "one plot",
        "m",
        least=0,
    )
    beam: float = setting(0.0, "width of the beam", "rad", least=0, most=math.pi)
    shadowing: float = setting(
        0.0, "probability that a target behind another one is hidden", "", least=0, most=1
    )
    shadow_margin: float = setting(
        0.0,
        "by what a shadow is wider than its target, to either side",
        "rad",
        least=0,
        most=math.pi,
    )

    def __post_init__(self) -> None:
        # A single number is the largest range.
        if isinstance(self.reach, int | float):
            object.__setattr__(self, "reach", (0.0, self.reach))
        super().__post_init__()

    def probability(self, distance: Array) -> Array:
        """Probability of detection at ranges (m); 0 out of reach."""
        ranges, values = np.array(self.detection).T
        found = np.interp(distance, ranges, values)
        inside = (self.reach[0] <= distance) & (distance <= self.reach[1])
        return np.where(inside, found, 0.0)

    @property
    def resolves_all(self) -> bool:
        """Whether no plots are merged."""
        return self.range_cell == 0 or self.beam == 0


@dataclass(frozen=True, repr=False)
class ScanTimes(Settings):
    """When a radar scans.

    The time of a scan is its end. A turning antenna points to y at the beginning of a scan and
    turns clockwise; a plot has the time at which the beam passed its echo.
    """

    count: int = setting(..., "number of scans", "", "whole", least=1, most=100_000)
    period: float = setting(..., "from one scan to the next", "s", least=0, above=True)
    start: float = setting(0.0, "when the first scan begins", "s")
    jitter: float = setting(
        0.0, "largest shift of the time of a scan, in periods", "", least=0, most=0.5, below=True
    )
    lost: float = setting(0.0, "probability that a scan has no plots at all", "", least=0, most=1)
    antenna: str = setting(
        "turning",
        "`turning`: each plot has its own time; `at-once`: all have that of the scan",
        "",
        "word",
        ("turning", "at-once"),
    )

    @property
    def turning(self) -> bool:
        """Whether plots have times of their own."""
        return self.antenna == "turning"

    def times(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """Ends of the scans (s), and their durations (s)."""
        shift = (2 * rng.random(self.count) - 1) * self.jitter
        ends = self.start + (np.arange(1, self.count + 1) + shift) * self.period
        return ends, np.diff(ends, prepend=self.start)


@dataclass(frozen=True, repr=False)
class OwnShip(Settings):
    """The place of the radar: it rests, moves with a course and a turn rate, or along a path."""

    at: tuple[float, float] = setting((0.0, 0.0), "where it is at the start", "m", "point")
    speed: float = setting(0.0, "speed", "m/s", least=0)
    course: float = setting(0.0, "course at the start, clockwise from y", "rad")
    turn_rate: float = setting(0.0, "turn rate, positive to the right", "rad/s")
    path: tuple[tuple[float, ...], ...] | None = setting(
        None,
        "instead: times (s) and places (m), [t, x, y], joined by straight lines",
        "",
        "points",
        columns=(3,),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.path is None:
            return
        if self.speed or self.course or self.turn_rate or self.at != (0.0, 0.0):
            raise ValueError("path must be alone: it says where the radar is at all times")
        if any(not a[0] < b[0] for a, b in zip(self.path, self.path[1:], strict=False)):
            raise ValueError("path must have increasing times")

    def places(self, start: float, times: Array) -> Array:
        """Where it is at times, shape (n, 2) (m); `start` is when the scene begins (s)."""
        if self.path is not None:
            paths = Paths.through(np.array(self.path))
        else:
            one = np.ones((1, 1))
            paths = Paths.of_legs(
                np.array([self.at]),
                np.array([math.pi / 2 - self.course]),
                np.array([start]),
                0 * one,
                self.speed * one,
                -self.turn_rate * one,
            )
        if self.path is not None:
            times = np.maximum(times, self.path[0][0])
        return paths.at(np.zeros(len(times), np.int64), times)[0]
