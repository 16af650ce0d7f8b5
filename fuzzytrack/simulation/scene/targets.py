"""Groups of targets: where they appear, how they move, and how a radar sees them."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.scene.legs import Legs, between
from fuzzytrack.simulation.scene.paths import Paths
from fuzzytrack.simulation.scene.region import Region
from fuzzytrack.simulation.scene.settings import Settings, setting
from fuzzytrack.simulation.scene.streams import Streams

__all__ = ["TargetGroup", "Targets"]

_TURN = (0.0, 2 * math.pi)


@dataclass(frozen=True, eq=False)
class Targets:
    """Targets of a simulation.

    Attributes
    ----------
    paths : Paths
        How they move.
    born, gone : ndarray, shape (n,)
        They are there at times in [born, gone) (s).
    """

    paths: Paths
    born: Array
    gone: Array

    def __repr__(self) -> str:
        return summary(self, targets=len(self.born))

    def __len__(self) -> int:
        """Number of targets."""
        return len(self.born)


@dataclass(frozen=True, repr=False)
class TargetGroup(Settings):
    """Targets that appear and move by the same rules.

    Straight legs and turns take turns: a leg lasts an exponential time, a turn goes on until the
    course has changed by what was drawn for it. The speed of a target does not change.

    Raises
    ------
    ValueError
        If a value is not allowed, or values do not fit each other.
    """

    count: int = setting(
        0, "targets that are there from the start on", "", "whole", least=0, most=1_000_000
    )
    births: float = setting(
        0.0, "mean number of further targets in a second, at random times", "1/s", least=0
    )
    life: float = setting(
        math.inf, "mean life, exponential; without it to the end", "s", least=0, above=True
    )
    begin: tuple[float, float] = setting(
        (0.0, 0.0), "when those of `count` appear, after the start", "s", "interval", least=0
    )
    at: tuple[float, float] | None = setting(None, "where they appear", "m", "point")
    within: Region | None = setting(  # noqa: RUF009 (a setting is no shared value)
        None, "region in which they appear, instead of that of the scene", "", "part"
    )
    path: tuple[tuple[float, ...], ...] | None = setting(
        None,
        "times (s) and places (m) of one target, [t, x, y], joined by straight lines",
        "",
        "points",
        columns=(3,),
    )
    leaves: str = setting(
        "no", "whether they end when they leave the region of the scene", "", "word", ("no", "yes")
    )
    returns: str = setting(
        "no",
        "whether, outside their region, their next turn is toward its middle",
        "",
        "word",
        ("no", "yes"),
    )
    speed: tuple[float, float] = setting((0.0, 0.0), "speed", "m/s", "interval", least=0)
    course: tuple[float, float] = setting(_TURN, "course, clockwise from y", "rad", "interval")
    rest: tuple[float, float] = setting(
        (0.0, 0.0), "time at rest before they move", "s", "interval", least=0
    )
    turn_rate: float = setting(0.0, "level of the turn rate; 0 is straight", "rad/s", least=0)
    turn_share: tuple[float, float] = setting(
        (0.3, 1.0), "turn rates in units of the level", "", "interval", least=0, above=True
    )
    turn: tuple[float, float] = setting(
        (math.radians(30), math.radians(90)),
        "change of course in a turn, to either side",
        "rad",
        "interval",
        least=0,
        above=True,
    )
    leg: float = setting(120.0, "mean time between turns", "s", least=0, above=True)
    detection: float = setting(
        1.0, "factor of the radar's probability of detection", "", least=0, most=1
    )
    fade_in: float = setting(
        0.0,
        "time after their appearance during which this probability grows from 0 to its value",
        "s",
        least=0,
    )
    size: float = setting(0.0, "diameter: what is behind them may be hidden", "m", least=0)
    wander: float = setting(
        0.0,
        "standard deviation of the place along a large ship where the echo comes from",
        "m",
        least=0,
    )
    wander_time: float = setting(10.0, "correlation time of this place", "s", least=0, above=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.at is not None and self.within is not None:
            raise ValueError("at and within both say where they appear; give one")
        if self.path is None:
            return
        for name in ("count", "births", "begin", "at", "within", "speed", "course", "rest"):
            default = next(each.default for each in fields(self) if each.name == name)
            if getattr(self, name) != default:
                raise ValueError(f"{name} has no meaning beside path, which is that of one target")
        if any(not a[0] < b[0] for a, b in zip(self.path, self.path[1:], strict=False)):
            raise ValueError("path must have increasing times")

    @property
    def at_start(self) -> int:
        """How many there are from the start on."""
        return self.count if self.path is None else 1

    def targets(self, streams: Streams, start: float, end: float, region: Region) -> Targets:
        """Draw the targets of the group.

        Parameters
        ----------
        streams : Streams
            Random streams of the group.
        start, end : float
            Times (s) between which the scene is simulated.
        region : Region
            Region of the scene.
        """
        if self.path is not None:
            born = np.array([self.path[0][0]])
            return Targets(Paths.through(np.array(self.path)), born, self._gone(streams, born))
        later = int(streams.stream("births").poisson(self.births * (end - start)))
        first = start + _within(streams, "begin", self.begin, self.count)
        born = np.append(first, start + streams.stream("born").random(later) * (end - start))
        gone = self._gone(streams, born)
        n = len(born)
        if self.at is not None:
            places = np.tile(np.array(self.at), (n, 1))
        else:
            places = (self.within or region).draw(streams.stream("place"), n)
        heading = math.pi / 2 - _within(streams, "course", self.course, n)
        speed = _within(streams, "speed", self.speed, n)
        rest = _within(streams, "rest", self.rest, n)
        home = (self.within or region).without_hole() if self.returns == "yes" else None
        moving = np.maximum(end - born - rest, 0.0) if self.turn_rate > 0 else np.zeros(n)
        legs = Legs(self.leg, self.turn_rate, self.turn_share, self.turn, home)
        durations, rates = legs.draw(streams, places, heading, speed, moving)
        speeds = np.repeat(speed[:, None], durations.shape[1], axis=1)
        if self.rest[1] > 0:
            none = np.zeros((n, 1))
            durations = np.concatenate([rest[:, None], durations], axis=1)
            rates, speeds = (np.concatenate([none, each], axis=1) for each in (rates, speeds))
        return Targets(Paths.of_legs(places, heading, born, durations, speeds, rates), born, gone)

    def _gone(self, streams: Streams, born: Array) -> Array:
        if math.isinf(self.life):
            return np.full(len(born), math.inf)
        return np.asarray(born + streams.stream("life").exponential(self.life, len(born)))


def _within(streams: Streams, purpose: str, limits: tuple[float, float], count: int) -> Array:
    return between(limits, streams.stream(purpose).random(count))
