"""What there is to compare: true objects and tracks at the same instants."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = ["ObjectRows", "ScoredScene"]

Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class ObjectRows:
    """Objects at the instants of a scene: a row for each object and instant, instant by instant.

    Attributes
    ----------
    instant : ndarray of int, shape (n,)
        Number of the instant, in order.
    id : ndarray of int, shape (n,)
        Number of the object in `names`.
    position : ndarray, shape (n, n_axes)
        Positions (m).
    velocity : ndarray, shape (n, n_axes)
        Velocities (m/s), NaN where unknown.
    names : ndarray, shape (n_objects,)
        Identities.
    kind : ndarray of int, shape (n,), optional
        Numbers of the words of `fuzzytrack.scoring.positions.KINDS`.
    """

    instant: Integers
    id: Integers
    position: Array
    velocity: Array
    names: NDArray[np.generic]
    kind: Integers | None = None

    def __repr__(self) -> str:
        return summary(self, rows=len(self), objects=len(self.names))

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.instant)

    def where(self, chosen: NDArray[np.bool_]) -> ObjectRows:
        """Only some rows; names stay."""
        return replace(
            self,
            instant=self.instant[chosen],
            id=self.id[chosen],
            position=self.position[chosen],
            velocity=self.velocity[chosen],
            kind=None if self.kind is None else self.kind[chosen],
        )

    def counts(self, instants: int) -> Integers:
        """Number of objects at each instant, shape (instants,)."""
        return np.bincount(self.instant, minlength=instants).astype(np.int64)


@dataclass(frozen=True, eq=False)
class ScoredScene:
    """True objects and tracks at common instants.

    Attributes
    ----------
    time : ndarray, shape (n_instants,)
        The instants (s), increasing, by the clock of the tracks.
    truth, tracks : ObjectRows
        What is there.
    """

    time: Array
    truth: ObjectRows
    tracks: ObjectRows

    def __repr__(self) -> str:
        return summary(
            self,
            instants=len(self.time),
            objects=len(self.truth.names),
            tracks=len(self.tracks.names),
        )

    @property
    def durations(self) -> Array:
        """Time until the next instant (s), shape (n_instants,).

        Of the last one it is the usual time; a single instant lasts 1 s.
        """
        steps = np.diff(self.time)
        return np.append(steps, np.median(steps)) if len(steps) else np.ones(len(self.time))

    @property
    def n_true(self) -> Integers:
        """Number of true objects at each instant."""
        return self.truth.counts(len(self.time))

    @property
    def n_tracks(self) -> Integers:
        """Number of tracks at each instant."""
        return self.tracks.counts(len(self.time))
