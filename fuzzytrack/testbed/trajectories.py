"""Trajectories of simulated targets, in closed form."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["turning_target"]

Array = NDArray[np.float64]


def turning_target(
    *,
    speed: float = 150.0,
    straight: float = 60.0,
    turn: float = math.radians(180.0),
    rate: float = math.radians(3.0),
    period: float = 1.0,
    heading: float = 0.0,
) -> tuple[Array, Array]:
    """Target that flies straight, makes a coordinated turn, and flies straight again.

    Parameters
    ----------
    speed : float
        Constant speed (m/s).
    straight : float
        Duration of each of the two straight legs (s).
    turn : float
        Angle turned through (rad), positive to the left.
    rate : float
        Turn rate (rad/s), positive. The default of 3°/s is the rate-one turn of instrument
        flight, 7.9 m/s² at 150 m/s.
    period : float
        Time between samples (s).
    heading : float
        First heading (rad), counted from the x axis to the y axis.

    Returns
    -------
    t : ndarray, shape (n_steps,)
        Times (s) from 0, `period` apart, to the end of the last leg.
    position : ndarray, shape (n_steps, 2)
        Position (m), first (0, 0).

    Raises
    ------
    ValueError
        If speed, rate or period is not positive, or a leg is negative.

    Examples
    --------
    >>> from fuzzytrack.testbed import turning_target
    >>> t, position = turning_target()
    >>> len(t), position[60].round(), position[-1].round()
    (181, array([9000.,    0.]), array([   0., 5730.]))
    """
    for name, value in (("speed", speed), ("rate", rate), ("period", period)):
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be positive, got {value}")
    if not (math.isfinite(straight) and straight >= 0 and math.isfinite(turn)):
        raise ValueError(f"straight must not be negative, and turn finite; got {straight}, {turn}")
    turning = abs(turn) / rate
    steps = math.floor((2 * straight + turning) / period + 1e-9)
    t: Array = np.arange(steps + 1, dtype=np.float64) * period
    before = np.minimum(t, straight)
    within = np.clip(t - straight, 0.0, turning)
    after = np.maximum(t - straight - turning, 0.0)
    side = math.copysign(1.0, turn)
    radius = speed / rate
    # In a frame with the x axis along the first heading.
    along = speed * before + radius * np.sin(rate * within) + speed * after * math.cos(turn)
    across = side * radius * (1 - np.cos(rate * within)) + speed * after * math.sin(turn)
    cos, sin = math.cos(heading), math.sin(heading)
    position: Array = np.stack([along * cos - across * sin, along * sin + across * cos], axis=1)
    return t, position
