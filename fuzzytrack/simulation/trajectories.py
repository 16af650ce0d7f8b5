"""Trajectories of simulated targets: straight, accelerating, turning, or through way-points.

The first four are those of the tracker testbed of Llinas et al. (1998), section 4.1, the way-points
its fifth.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite, positive, within

__all__ = [
    "constant_acceleration",
    "constant_velocity",
    "turn",
    "turn_with_angular_acceleration",
    "turning_target",
    "waypoints",
]


def constant_velocity(
    *,
    speed: float,
    heading: float = 0.0,
    start: Sequence[float] = (0.0, 0.0),
    steps: int = 20,
    period: float = 60.0,
    at: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """Target on a straight line with constant speed.

    Parameters
    ----------
    speed : float
        Speed (m/s).
    heading : float
        Heading (rad), counted from the x axis to the y axis.
    start : (float, float)
        First position (m).
    steps : int
        Number of samples, at least 1.
    period : float
        Time between samples (s).
    at : array_like, optional
        Times of the samples (s), of any shape; `steps` and `period` are not used then.

    Returns
    -------
    t : ndarray, shape (steps,)
        Times (s) from 0, `period` apart; or those of `at`.
    position : ndarray, shape (steps, 2)
        Position (m); of shape (..., 2) at times of shape (...).

    Raises
    ------
    ValueError
        If a number is not finite, `period` is not positive, or `steps` is less than 1.

    Notes
    -----
    Llinas et al. (1998), section 4.1, trajectory 1.

    Examples
    --------
    >>> from fuzzytrack.simulation.trajectories import constant_velocity
    >>> t, position = constant_velocity(speed=6.0)
    >>> position[-1]
    array([6840.,    0.])
    """
    return constant_acceleration(
        speed=speed,
        acceleration=0.0,
        heading=heading,
        start=start,
        steps=steps,
        period=period,
        at=at,
    )


def constant_acceleration(
    *,
    speed: float,
    acceleration: float,
    heading: float = 0.0,
    start: Sequence[float] = (0.0, 0.0),
    steps: int = 20,
    period: float = 60.0,
    at: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """Target on a straight line with constant acceleration along it.

    Parameters
    ----------
    speed : float
        First speed (m/s).
    acceleration : float
        Acceleration along the heading (m/s²); a target that brakes past a standstill goes back.
    heading, start, steps, period, at
        As for `constant_velocity`.

    Returns
    -------
    t, position : ndarray
        As for `constant_velocity`.

    Raises
    ------
    ValueError
        As for `constant_velocity`.

    Notes
    -----
    Llinas et al. (1998), section 4.1, trajectory 2.
    """
    t, way = _way(speed, acceleration, steps, period, at)
    return t, _placed(way, np.zeros_like(way), heading, start)


def turn(
    *,
    speed: float,
    radius: float,
    heading: float = 0.0,
    start: Sequence[float] = (0.0, 0.0),
    steps: int = 20,
    period: float = 60.0,
    at: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """Target on a circle with constant speed.

    Parameters
    ----------
    speed : float
        Speed (m/s).
    radius : float
        Radius of the circle (m), not 0; negative for a turn to the right.
    heading, start, steps, period, at
        As for `constant_velocity`; the first heading.

    Returns
    -------
    t, position : ndarray
        As for `constant_velocity`.

    Raises
    ------
    ValueError
        As for `constant_velocity`, or if `radius` is 0.

    Notes
    -----
    Llinas et al. (1998), section 4.1, trajectory 3: the angular velocity is speed/radius.
    """
    return turn_with_angular_acceleration(
        speed=speed,
        acceleration=0.0,
        radius=radius,
        heading=heading,
        start=start,
        steps=steps,
        period=period,
        at=at,
    )


def turn_with_angular_acceleration(
    *,
    speed: float,
    acceleration: float,
    radius: float,
    heading: float = 0.0,
    start: Sequence[float] = (0.0, 0.0),
    steps: int = 20,
    period: float = 60.0,
    at: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """Target on a circle with constant angular acceleration.

    Parameters
    ----------
    speed : float
        First speed (m/s).
    acceleration : float
        Acceleration along the circle (m/s²).
    radius : float
        Radius of the circle (m), not 0; negative for a turn to the right.
    heading, start, steps, period, at
        As for `constant_velocity`; the first heading.

    Returns
    -------
    t, position : ndarray
        As for `constant_velocity`.

    Raises
    ------
    ValueError
        As for `constant_velocity`, or if `radius` is 0.

    Notes
    -----
    Llinas et al. (1998), section 4.1, trajectory 4: the angular acceleration is
    acceleration/radius.
    """
    t, way = _way(speed, acceleration, steps, period, at)
    side = float(finite("radius", radius))
    if side == 0:
        raise ValueError("radius must be finite and not 0, got 0")
    angle = way / side
    # 1 - cos, without cancellation at small angles
    across = side * 2 * np.sin(angle / 2) ** 2
    return t, _placed(side * np.sin(angle), across, heading, start)


def waypoints(
    points: ArrayLike,
    *,
    times: ArrayLike | None = None,
    leg: float = 60.0,
    period: float = 60.0,
    at: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """Target on a cubic spline through way-points.

    Parameters
    ----------
    points : array_like, shape (n_points, n_axes)
        Way-points (m), at least two, not all on one spot.
    times : array_like, shape (n_points,), optional
        Times at which the target passes them (s), increasing; `leg` apart from 0 unless given.
    leg : float
        Time from one way-point to the next (s); not used with `times`.
    period : float
        Time between samples (s).
    at : array_like, optional
        Times of the samples (s), of any shape, from the first way-point to the last; `period` is
        not used then.

    Returns
    -------
    t : ndarray, shape (n_steps,)
        Times (s), `period` apart, from the first way-point until the last at most; or those of
        `at`.
    position : ndarray, shape (n_steps, n_axes)
        Position (m); of shape (..., n_axes) at times of shape (...).

    Raises
    ------
    ValueError
        If there are fewer than two way-points, they are all on one spot, a number is not finite,
        times do not increase, `leg` or `period` is not positive, or `at` is before the first
        way-point or after the last.

    Notes
    -----
    Llinas et al. (1998), section 4.1, trajectory 5: way-points one unit of time apart, so their
    spacing sets the acceleration. The spline has not-a-knot ends, as MATLAB's: two points give a
    straight line, three a parabola.

    Examples
    --------
    >>> from fuzzytrack.simulation.trajectories import waypoints
    >>> t, position = waypoints([[0, 0], [100, 0], [200, 100]], period=30.0)
    >>> position[:, 1]
    array([  0. , -12.5,   0. ,  37.5, 100. ])
    """
    from scipy.interpolate import CubicSpline

    places = finite("points", points)
    if places.ndim != 2 or len(places) < 2 or not places.shape[1]:
        raise ValueError(
            "points must have shape (n_points, n_axes), two way-points at least; "
            f"got shape {places.shape}"
        )
    if (places == places[0]).all():
        raise ValueError(
            f"points must not all lie on one spot; all {len(places)} lie on {places[0].tolist()}"
        )
    if times is None:
        passed = np.asarray(positive("leg", leg) * np.arange(len(places)), np.float64)
    else:
        passed = finite("times", times)
        if passed.shape != (len(places),) or not (np.diff(passed) > 0).all():
            raise ValueError(
                f"times must be {len(places)} increasing numbers, one for each way-point; "
                f"got {passed.tolist()}"
            )
    if at is not None:
        t = finite("at", at)
        within("at", t, (t >= passed[0]) & (t <= passed[-1]), "within the times of the way-points")
    else:
        dt = float(positive("period", period))
        last = math.floor((passed[-1] - passed[0]) / dt * (1 + 1e-12))
        t = np.asarray(np.minimum(passed[0] + dt * np.arange(last + 1), passed[-1]), np.float64)
    return t, np.asarray(CubicSpline(passed, places)(t))


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
    >>> from fuzzytrack.simulation import turning_target
    >>> t, position = turning_target()
    >>> len(t), position[60].round(), position[120].round()
    (181, array([9000.,    0.]), array([9000., 5730.]))
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


def sample_times(steps: int, period: float) -> Array:
    """Times of `steps` samples from 0 (s), `period` apart.

    Raises
    ------
    ValueError
        If `steps` is less than 1, or `period` is not positive.
    """
    number = operator.index(steps)
    if number < 1:
        raise ValueError(f"steps must be at least 1, got {number}")
    return np.asarray(np.arange(number) * positive("period", period))


def _way(
    speed: float, acceleration: float, steps: int, period: float, at: ArrayLike | None
) -> tuple[Array, Array]:
    """Times, and the distance covered by then."""
    t = sample_times(steps, period) if at is None else finite("at", at)
    return t, finite("speed", speed) * t + finite("acceleration", acceleration) * t**2 / 2


def _placed(along: Array, across: Array, heading: float, start: Sequence[float]) -> Array:
    """Positions and velocities turned from a frame with the x axis along the heading."""
    first = finite("start", start)
    if first.shape != (2,):
        raise ValueError(f"start must be two coordinates (m), got shape {first.shape}")
    angle = float(finite("heading", heading))
    cos, sin = math.cos(angle), math.sin(angle)
    return np.asarray(
        first + np.stack([along * cos - across * sin, along * sin + across * cos], -1)
    )
