"""State of a track: a value that can be kept, pickled, sent away and resumed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Gains", "TrackState"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Gains:
    """Gains of a tracker, arrays of one shape.

    Attributes
    ----------
    alpha, beta, gamma : ndarray
        Shaped as the plots they corrected; NaN where no correction was made (missed plot, start).
        Gamma is the one whose acceleration gain is γ/(2T²).
    """

    alpha: Array
    beta: Array
    gamma: Array


@dataclass(frozen=True, eq=False)
class TrackState:
    """What a tracker knows after a step.

    Attributes
    ----------
    time : ndarray
        Time of the last step (s), shape () or that of the batch.
    position, velocity, acceleration : ndarray
        Estimates after the step (m, m/s, m/s²), shaped as a plot. Position is NaN before the first
        plot, velocity 0 before it is known.
    predicted, innovation : ndarray
        Of the last step (m); NaN where there was none.
    gains : Gains
        Of the last step.
    lanes : ndarray, shape (rows, lanes)
        The tracker's own representation; see `fuzzytrack.trackers.runner.Rows`.
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    predicted: Array
    innovation: Array
    gains: Gains
    lanes: Array

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a plot: (n_axes,), (n_tracks, n_axes), or () for one axis alone."""
        return self.position.shape
