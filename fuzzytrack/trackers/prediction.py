"""Predicted state of a track at a later time, with its variance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary

__all__ = ["Prediction"]


@dataclass(frozen=True, eq=False)
class Prediction:
    """Predicted state of a track, or of a batch of tracks, at a later time.

    Attributes
    ----------
    time : float or ndarray
        Time predicted for (s), a NumPy number or of the batch's shape.
    position : ndarray
        Predicted position (m), shaped as a plot; NaN before the first plot. All that follows has
        this shape.
    velocity, acceleration : ndarray
        Predicted velocity (m/s) and acceleration (m/s²); 0 before they are known.
    position_variance : ndarray
        Variance of the predicted position (m²). NaN where the tracker keeps no covariance, and
        until the velocity of the track is known.
    innovation_variance : ndarray
        S, the variance of the difference between a plot at that time and `position` (m²):
        `position_variance` plus the variance of the plot. NaN where either is unknown.
    """

    time: Array | np.float64
    position: Array
    velocity: Array
    acceleration: Array
    position_variance: Array
    innovation_variance: Array

    def __repr__(self) -> str:
        return summary(self, "time", "position")
