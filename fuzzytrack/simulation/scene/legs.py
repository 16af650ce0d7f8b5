"""Legs of targets that move on straight lines and turn from time to time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.scene.region import Region
from fuzzytrack.simulation.scene.streams import Streams

__all__ = ["Legs", "between"]

# A turn with the leg before it takes a second at least in any scene that makes sense.
_MOST_TURNS = 20_000


def between(limits: tuple[float, float], u: Array) -> Array:
    """Numbers between limits, of numbers from 0 to 1."""
    return limits[0] + (limits[1] - limits[0]) * u


@dataclass(frozen=True, eq=False)
class Legs:
    """By which rules targets turn; see `fuzzytrack.simulation.scene.TargetGroup`.

    Attributes
    ----------
    leg : float
        Mean time between turns (s).
    level : float
        Level of the turn rate (rad/s).
    share : (float, float)
        Limits of turn rates in units of the level.
    turn : (float, float)
        Limits of the change of course in a turn (rad).
    home : Region or None
        Where outside of it they turn toward its middle.
    """

    leg: float
    level: float
    share: tuple[float, float]
    turn: tuple[float, float]
    home: Region | None = None

    def __repr__(self) -> str:
        return summary(self, "leg", "level")

    def draw(
        self, streams: Streams, place: Array, heading: Array, speed: Array, time: Array
    ) -> tuple[Array, Array]:
        """Durations (s) and turn rates (rad/s) of legs, each of shape (n, n_legs).

        Parameters
        ----------
        streams : Streams
            Random streams of the group.
        place, heading, speed : ndarray, shapes (n, 2), (n,), (n,)
            Where targets begin to move (m), in which direction (rad) and how fast (m/s).
        time : ndarray, shape (n,)
            How long they will move (s); further legs are not needed.
        """
        n = len(place)
        durations, rates = [], []
        left = time.copy()
        for number in range(_MOST_TURNS):
            if not (left > 0).any():
                break
            u = streams.stream("turns", number).random((n, 4))
            straight = -self.leg * np.log1p(-u[:, 0])
            rate = self.level * between(self.share, u[:, 1])
            change = between(self.turn, u[:, 2]) * np.where(u[:, 3] < 0.5, -1, 1)
            ahead = np.stack([np.cos(heading), np.sin(heading)], axis=1)
            place = place + (speed * straight)[:, None] * ahead
            if self.home is not None:
                east, north = (self.home.middle - place).T
                back = np.angle(np.exp(1j * (np.arctan2(north, east) - heading)))
                change = np.where(self.home.holds(place), change, back)
            turning = abs(change) / rate
            rate = np.copysign(rate, change)
            chord = speed * turning * np.sinc(change / 2 / np.pi)
            along = heading + change / 2
            place = place + chord[:, None] * np.stack([np.cos(along), np.sin(along)], axis=1)
            heading = heading + change
            durations += [straight, turning]
            rates += [np.zeros(n), rate]
            left = left - straight - turning
        # The last leg goes on for ever.
        durations.append(np.zeros(n))
        rates.append(np.zeros(n))
        return np.stack(durations, axis=1), np.stack(rates, axis=1)
