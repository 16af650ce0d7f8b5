"""Paths of many targets: legs of constant speed and turn rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = ["Paths"]

Whole = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Paths:
    """Paths of targets, each one leg after the other.

    Attributes
    ----------
    first : ndarray of int, shape (n_targets + 1,)
        First leg of each target, and the number of legs.
    begin : ndarray, shape (n_legs,)
        When a leg begins (s); increasing within a target.
    place : ndarray, shape (n_legs, 2)
        Where it begins (m).
    heading : ndarray, shape (n_legs,)
        Direction in which it begins (rad, from x toward y).
    speed, rate : ndarray, shape (n_legs,)
        Its speed (m/s) and turn rate (rad/s, from x toward y).
    """

    first: Whole
    begin: Array
    place: Array
    heading: Array
    speed: Array
    rate: Array

    def __repr__(self) -> str:
        return summary(self, targets=len(self), legs=len(self.begin))

    def __len__(self) -> int:
        """Number of targets."""
        return len(self.first) - 1

    def at(self, target: Whole, time: Array) -> tuple[Array, Array]:
        """Positions (m) and velocities (m/s) of targets at times, each of shape (n, 2).

        Before its first leg a target is where that leg would have come from.
        """
        if not len(target):
            return np.empty((0, 2)), np.empty((0, 2))
        origin = min(self.begin.min(), time.min())
        span = max(self.begin.max(), time.max()) - origin + 1.0
        owner = np.repeat(np.arange(len(self)), np.diff(self.first))
        leg = np.searchsorted(
            owner * span + (self.begin - origin), target * span + (time - origin), side="right"
        )
        leg = np.maximum(leg - 1, self.first[target])
        elapsed = time - self.begin[leg]
        half = self.rate[leg] * elapsed / 2
        # The chord of an arc; sinc is sin(pi x) / (pi x).
        chord = self.speed[leg] * elapsed * np.sinc(half / np.pi)
        along, end = self.heading[leg] + half, self.heading[leg] + 2 * half
        position = self.place[leg] + chord[:, None] * _unit(along)
        return position, self.speed[leg][:, None] * _unit(end)

    @classmethod
    def of_legs(
        cls, start: Array, heading: Array, begin: Array, durations: Array, speed: Array, rate: Array
    ) -> Paths:
        """Paths with equally many legs, all rows of shape (n_targets, n_legs).

        Parameters
        ----------
        start, heading, begin : ndarray, shapes (n_targets, 2), (n_targets,), (n_targets,)
            Where, in which direction and when the first leg begins.
        durations, speed, rate : ndarray
            Of each leg; the last one goes on for ever.
        """
        n, legs = durations.shape
        times = begin[:, None] + np.cumsum(durations, axis=1) - durations
        headings = heading[:, None] + np.cumsum(rate * durations, axis=1) - rate * durations
        half = rate * durations / 2
        steps = (speed * durations * np.sinc(half / np.pi))[..., None] * _unit(headings + half)
        places = start[:, None] + np.cumsum(steps, axis=1) - steps
        return cls(
            np.arange(n + 1, dtype=np.int64) * legs,
            times.ravel(),
            places.reshape(-1, 2),
            headings.ravel(),
            np.broadcast_to(speed, durations.shape).ravel(),
            rate.ravel(),
        )

    @classmethod
    def through(cls, points: Array) -> Paths:
        """Path of one target on straight lines through rows of (time, x, y); it ends at rest."""
        steps = np.diff(points, axis=0)
        length = np.hypot(steps[:, 1], steps[:, 2])
        heading = np.arctan2(steps[:, 2], steps[:, 1])
        last = heading[-1] if len(heading) else 0.0
        n = len(points)
        return cls(
            np.array([0, n]),
            points[:, 0].copy(),
            points[:, 1:].copy(),
            np.append(heading, last),
            np.append(length / steps[:, 0], 0.0),
            np.zeros(n),
        )

    @classmethod
    def joined(cls, parts: list[Paths]) -> Paths:
        """Several of them as one, in this order."""
        counts = np.concatenate([np.diff(part.first) for part in parts])
        columns = ("begin", "place", "heading", "speed", "rate")
        return cls(
            np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
            *(np.concatenate([getattr(part, name) for part in parts]) for name in columns),
        )


def _unit(heading: Array) -> Array:
    """Unit vectors, with a last axis of x and y."""
    return np.stack([np.cos(heading), np.sin(heading)], axis=-1)
