"""Result of a run over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.trackers.state import Gains, TrackState

__all__ = ["TrackResult"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TrackResult:
    """Tracks over time, as arrays: time first, axis of space last, batch between.

    Attributes
    ----------
    time : ndarray, shape (n_steps,) or (n_steps, ...batch)
        Times (s).
    measured : ndarray, shape (n_steps, ...batch, n_axes)
        The plots (m); NaN where missed. All that follows has this shape.
    predicted : ndarray
        Position before the plot is used (m); NaN until the tracker has started.
    filtered : ndarray
        Position after the plot is used (m); the prediction where it was missed.
    velocity, acceleration : ndarray
        After the plot is used (m/s, m/s²); 0 before they are known.
    innovation : ndarray
        Plot minus prediction (m); NaN where there is no prediction or no plot.
    gains : Gains
        The gains used; NaN where none were.
    state : TrackState
        State after the last step, from which to go on; None if there was no step.
    """

    time: Array
    measured: Array
    predicted: Array
    filtered: Array
    velocity: Array
    acceleration: Array
    innovation: Array
    gains: Gains
    state: TrackState | None

    @property
    def coasted(self) -> NDArray[np.bool_]:
        """Where the track was carried on without a plot."""
        return np.isnan(self.innovation) & ~np.isnan(self.predicted)
