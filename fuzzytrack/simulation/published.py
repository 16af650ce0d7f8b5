"""Trajectories of published experiments, and random sets of tracks like them.

The functions take no arguments, or a seed, so that a result can be compared with a paper's for the
same target. Their notes say what a paper leaves open, and how it is read here.
"""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.trajectories import (
    constant_acceleration,
    constant_velocity,
    turn,
    turn_with_angular_acceleration,
)

__all__ = [
    "MANEUVERS",
    "TRACK_SETS",
    "TrackSet",
    "kim_lee",
    "kim_lee_velocity",
    "llinas_maneuver",
    "s3",
    "track_set",
    "warship",
]


#: Llinas' maneuvers: name to first position (m) and heading (degrees).
_STARTS = {
    "M1": ((-3600.0, -800.0), 330.0),
    "M2": ((1900.0, 900.0), 240.0),
    "M3": ((-4800.0, -4400.0), 65.0),
    "M4": ((-2600.0, -4300.0), 85.0),
}
MANEUVERS = tuple(_STARTS)

TRACK_SETS = ("report", "mixed", "strong")


# ---------------------------------------------------------------- single tracks


def llinas_maneuver(name: str) -> tuple[Array, Array]:
    """One of the four submarine maneuvers of Llinas et al. (1998), section 5.2.

    Parameters
    ----------
    name : {"M1", "M2", "M3", "M4"}
        M1 constant velocity, M2 constant acceleration, M3 turn with constant speed, M4 turn with
        constant angular acceleration.

    Returns
    -------
    t : ndarray, shape (20,)
        Times (s), 0 to 1140, 60 apart.
    position : ndarray, shape (20, 2)
        Position (m) in the sensor field centered on (0, 0).

    Raises
    ------
    ValueError
        If there is no such maneuver.

    Notes
    -----
    The report gives the kinds of maneuver, 20 scans and 60 s. Start, heading, speed 6 m/s,
    acceleration 0.004 m/s² and radius 4500 m (to the left) are a fit to its Table 5.3.

    Examples
    --------
    >>> from fuzzytrack.simulation.published import llinas_maneuver
    >>> t, position = llinas_maneuver("M1")
    >>> position[0]
    array([-3600.,  -800.])
    """
    if name not in _STARTS:
        raise ValueError(f"name: unknown maneuver {name!r}; one of {', '.join(MANEUVERS)}")
    start, heading = _STARTS[name]
    return _llinas(name, 6.0, 0.004, 4500.0, math.radians(heading), start)


def _llinas(
    name: str,
    speed: float,
    acceleration: float,
    radius: float,
    heading: float,
    start: tuple[float, float] = (0.0, 0.0),
) -> tuple[Array, Array]:
    if name == "M1":
        return constant_velocity(speed=speed, heading=heading, start=start)
    if name == "M2":
        return constant_acceleration(
            speed=speed, acceleration=acceleration, heading=heading, start=start
        )
    if name == "M3":
        return turn(speed=speed, radius=radius, heading=heading, start=start)
    return turn_with_angular_acceleration(
        speed=speed, acceleration=acceleration, radius=radius, heading=heading, start=start
    )


def kim_lee() -> tuple[Array, Array]:
    """Target of Kim & Lee: 120 m/s, with +5 g and later -5 g for 10 s each.

    Returns
    -------
    t : ndarray, shape (100,)
        Times (s), 1 to 100.
    position : ndarray, shape (100, 1)
        Position (m); 0 at time 0.

    Notes
    -----
    The acceleration of 5 · 9.81 m/s² acts in the seconds that end at t = 26 to 35, its opposite in
    those that end at 66 to 75: the speed reaches 610.5 m/s, and is 120 m/s again at the end. The
    paper tracks it with noise of 150 m.

    Examples
    --------
    >>> from fuzzytrack.simulation.published import kim_lee
    >>> t, position = kim_lee()
    >>> round(float(position[40, 0] - position[39, 0]), 6)
    610.5
    """
    t, acceleration = _kim_lee_acceleration()
    return t, _integrated(0.0, 120.0, acceleration)[1:, None]


def kim_lee_velocity() -> Array:
    """Velocity of the target of Kim & Lee at its times (m/s), shape (100, 1); see `kim_lee`."""
    _, acceleration = _kim_lee_acceleration()
    return np.asarray(120.0 + np.cumsum(acceleration)[:, None])


def _kim_lee_acceleration() -> tuple[Array, Array]:
    """Times, and the acceleration in the second before each."""
    t: Array = np.arange(1.0, 101.0)
    gee = 5 * 9.81
    return t, np.where((t > 25) & (t <= 35), gee, np.where((t > 65) & (t <= 75), -gee, 0.0))


def s3() -> tuple[Array, Array]:
    """Scenario S3, a target for the trackers of Al-Wagih & Abdulla.

    Returns
    -------
    t : ndarray, shape (100,)
        Times (s), 0 to 99.
    position : ndarray, shape (100, 2)
        Position (m).

    Notes
    -----
    The paper does not give its trajectories; this one was made to give errors like its averages.
    x: 20 m/s, and from t = 70 on 0.62 m/s²; y: from rest, 1.45 m/s² in the first 23 seconds. Noise:
    15 m in x and 23 m in y, white; or 19 m and 23 m, AR(1) of correlation 0.7. The first two
    measurements are free of noise.
    """
    t: Array = np.arange(100.0)
    x = _integrated(0.0, 20.0, np.where(t[:-1] >= 70, 0.62, 0.0))
    y = _integrated(0.0, 0.0, np.where(t[:-1] <= 22, 1.45, 0.0))
    return t, np.stack([x, y], axis=1)


def _integrated(position: float, speed: float, acceleration: Array) -> Array:
    """Positions under accelerations, each constant for one second."""
    speeds = speed + np.concatenate([[0.0], np.cumsum(acceleration)])
    moves = speeds[:-1] + acceleration / 2
    return np.asarray(position + np.concatenate([[0.0], np.cumsum(moves)]))


def warship(rate: float = 0.0168) -> tuple[Array, Array]:
    """Warship of Njonjo, Pan & Jeong (2017), Eqs. 15 and 16: a sum of sines.

    Parameters
    ----------
    rate : float
        Angular rate w of the sines (rad/s); sets the speed.

    Returns
    -------
    t : ndarray, shape (1000,)
        Times (s), 0 to 2997, 3 apart.
    position : ndarray, shape (1000, 2)
        Position (m), first (573, 1038.4).

    Raises
    ------
    ValueError
        If `rate` is not positive.

    Notes
    -----
    The paper leaves the rate open; at the default the way to the second sample, over 3 s, gives the
    published 50.4 m/s. The factors a and b follow from the first position. Noise: 10 m.
    """
    if not (math.isfinite(rate) and rate > 0):
        raise ValueError(f"rate must be finite and > 0, got {rate}")
    t: Array = 3.0 * np.arange(1000.0)
    u = rate * t
    x = (573 / 18) * (
        10 * np.sin(1.2 * u)
        + 7 * np.cos(0.99 * u)
        + 8 * np.sin(0.7 * u)
        + 6 * np.cos(2 * u)
        + 9 * np.sin(3 * u)
        + 5 * np.cos(3 * u)
    ) + 10 * t
    y = (1038.4 / 20) * (20 * np.cos(0.3 * u) + 22 * np.sin(2 * u))
    return t, np.stack([x, y], axis=1)


# ---------------------------------------------------------------- random sets


@dataclass(frozen=True, eq=False)
class TrackSet:
    """Tracks for ranking trackers, in units of the noise and of the time between scans.

    Attributes
    ----------
    name : str
        Name of the set.
    time : ndarray, shape (n_steps,)
        Times, 0, 1, 2, …
    position : ndarray, shape (n_steps, n_tracks, 2)
        True positions, in standard deviations of the noise on each axis.
    kind : ndarray of str, shape (n_tracks,)
        Kind of each track: its maneuver in ``report``, else the name of the set.
    first_scored : int
        First scan (from 0) whose prediction counts.
    """

    name: str
    time: Array
    position: Array
    kind: NDArray[np.str_]
    first_scored: int

    def __repr__(self) -> str:
        return summary(self, "name", "position")


def track_set(name: str, tracks: int, seed: int) -> TrackSet:
    """Random tracks for ranking trackers.

    Parameters
    ----------
    name : {"report", "mixed", "strong"}
        ``report``: the maneuvers M1 to M4 of Llinas et al. (1998) in turn, 20 scans, with speeds of
        3 to 9 m/s, accelerations of 0.002 to 0.006 m/s² and radii of 2500 to 7000 m, to the left,
        at T = 60 s and noise σ of 115 m. ``mixed``: 60 scans, straight legs alternating with
        maneuvers, each of 8 to 20 scans; each track has one acceleration a, with a T²/σ from 0.1 to
        1, uniform in its logarithm. ``strong``: the same with a T²/σ from 1 to 3, and three times
        as fast.
    tracks : int
        Number of tracks, at least 1.
    seed : int
        Seed, not negative. Each track has a random stream of its own, so that the first tracks do
        not depend on the number of tracks.

    Returns
    -------
    TrackSet

    Raises
    ------
    ValueError
        If there is no such set, or a number is out of range.

    Notes
    -----
    A maneuver of ``mixed`` and ``strong`` is, with equal probability, an acceleration or braking
    along the track, or a turn of constant speed to either side. A target that is too slow to turn
    by less than 1 rad a scan accelerates instead. Headings are random.

    Examples
    --------
    >>> from fuzzytrack.simulation.published import track_set
    >>> track_set("mixed", 8, seed=1).position.shape
    (60, 8, 2)
    """
    if name not in TRACK_SETS:
        raise ValueError(f"name: unknown set {name!r}; one of {', '.join(TRACK_SETS)}")
    number = operator.index(tracks)
    if number < 1:
        raise ValueError(f"tracks must be at least 1, got {number}")
    if seed < 0:
        raise ValueError(f"seed must not be negative, got {seed}")
    draws = [np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(number)]
    if name == "report":
        kinds = [MANEUVERS[k % len(MANEUVERS)] for k in range(number)]
        found = [_report(kind, rng) for kind, rng in zip(kinds, draws, strict=True)]
    else:
        kinds = [name] * number
        found = [_legs(rng, *_STRENGTHS[name]) for rng in draws]
    position = np.stack(found, axis=1)
    first = 2 if name == "report" else 8
    return TrackSet(name, np.arange(float(len(position))), position, np.array(kinds), first)


def _report(kind: str, rng: np.random.Generator) -> Array:
    speed, acceleration = rng.uniform(3, 9), rng.uniform(0.002, 0.006)
    radius, heading = rng.uniform(2500, 7000), rng.uniform(0, 2 * math.pi)
    return _llinas(kind, speed, acceleration, radius, heading)[1] / 115.0


# Range of a T²/σ, and of the first speed, in σ/T.
_STRENGTHS = {"mixed": ((0.1, 1.0), (1.5, 5.0)), "strong": ((1.0, 3.0), (4.5, 15.0))}


def _legs(
    rng: np.random.Generator,
    accelerations: tuple[float, float],
    speeds: tuple[float, float],
    steps: int = 60,
) -> Array:
    """Straight legs and maneuvers alternating, beginning with a straight leg."""
    low, high = accelerations
    size = math.exp(rng.uniform(math.log(low), math.log(high)))
    speed, heading = rng.uniform(*speeds), rng.uniform(0, 2 * math.pi)
    # Along and to the left of the heading, scan by scan
    along, left = np.zeros(steps - 1), np.zeros(steps - 1)
    at, straight, now = 0, True, speed
    while at < steps - 1:
        length = int(rng.integers(8, 21))
        if not straight:
            turns, side = bool(rng.integers(2)), float(rng.choice([-1.0, 1.0]))
            if turns and abs(now) > size:
                left[at : at + length] = side * size
            else:
                along[at : at + length] = side * size
                now += length * side * size
        at, straight = at + length, not straight
    return _moved(speed, heading, along, left)


def _moved(speed: float, heading: float, along: Array, left: Array) -> Array:
    """Positions under accelerations along and across the path, each constant during a scan."""
    speeds = speed + np.concatenate([[0.0], np.cumsum(along)])
    # A maneuver is either along or across the path, so the speed is constant in a turn.
    turns = np.divide(left, speeds[:-1], out=np.zeros_like(left), where=left != 0)
    headings = heading + np.concatenate([[0.0], np.cumsum(turns)])
    middle = headings[:-1] + turns / 2
    # Chord of the arc
    way = (speeds[:-1] + along / 2) * np.sinc(turns / (2 * math.pi))
    moves = way[:, None] * np.stack([np.cos(middle), np.sin(middle)], axis=1)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(moves, axis=0)])
