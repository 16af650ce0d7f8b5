"""Trajectories of published experiments, and random sets of tracks like them.

The functions need no arguments, or a seed, so that a result can be compared with a paper's for the
same target; `at` samples the same motion at other times. Their notes say what a paper leaves open,
and how it is read here.
"""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.sampling import REGULAR, Sampling
from fuzzytrack.simulation.trajectories import (
    constant_acceleration,
    constant_velocity,
    turn,
    turn_with_angular_acceleration,
)

__all__ = [
    "ALL_SETS",
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

#: Sets of random tracks by which trackers are tuned and ranked, and all sets.
TRACK_SETS = ("report", "mixed", "strong")
ALL_SETS = (*TRACK_SETS, "weaving")


# ---------------------------------------------------------------- single tracks


def llinas_maneuver(name: str, at: ArrayLike | None = None) -> tuple[Array, Array]:
    """One of the four submarine maneuvers of Llinas et al. (1998), section 5.2.

    Parameters
    ----------
    name : {"M1", "M2", "M3", "M4"}
        M1 constant velocity, M2 constant acceleration, M3 turn with constant speed, M4 turn with
        constant angular acceleration.
    at : array_like, optional
        Other times (s), of any shape.

    Returns
    -------
    t : ndarray, shape (20,)
        Times (s), 0 to 1140, 60 apart; or those of `at`.
    position : ndarray, shape (20, 2)
        Position (m) in the sensor field centered on (0, 0); of shape (..., 2) at times of shape
        (...).

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
    return _llinas(name, 6.0, 0.004, 4500.0, math.radians(heading), start, at)


def _llinas(
    name: str,
    speed: float,
    acceleration: float,
    radius: float,
    heading: float,
    start: tuple[float, float],
    at: ArrayLike | None,
) -> tuple[Array, Array]:
    if name == "M1":
        return constant_velocity(speed=speed, heading=heading, start=start, at=at)
    if name == "M2":
        return constant_acceleration(
            speed=speed, acceleration=acceleration, heading=heading, start=start, at=at
        )
    if name == "M3":
        return turn(speed=speed, radius=radius, heading=heading, start=start, at=at)
    return turn_with_angular_acceleration(
        speed=speed, acceleration=acceleration, radius=radius, heading=heading, start=start, at=at
    )


def kim_lee(at: ArrayLike | None = None) -> tuple[Array, Array]:
    """Target of Kim & Lee: 120 m/s, with +5 g and later -5 g for 10 s each.

    Parameters
    ----------
    at : array_like, optional
        Other times (s), of any shape, >= 0.

    Returns
    -------
    t : ndarray, shape (100,)
        Times (s), 1 to 100; or those of `at`.
    position : ndarray, shape (100, 1)
        Position (m); 0 at time 0. Of shape (..., 1) at times of shape (...).

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
    own, acceleration = _kim_lee_acceleration()
    t = own if at is None else finite("at", at)
    return t, _integrated(0.0, 120.0, acceleration, t)[..., None]


def kim_lee_velocity() -> Array:
    """Velocity of the target of Kim & Lee at its times (m/s), shape (100, 1); see `kim_lee`."""
    _, acceleration = _kim_lee_acceleration()
    return np.asarray(120.0 + np.cumsum(acceleration)[:, None])


def _kim_lee_acceleration() -> tuple[Array, Array]:
    """Times, and the acceleration in the second before each."""
    t: Array = np.arange(1.0, 101.0)
    gee = 5 * 9.81
    return t, np.where((t > 25) & (t <= 35), gee, np.where((t > 65) & (t <= 75), -gee, 0.0))


def s3(at: ArrayLike | None = None) -> tuple[Array, Array]:
    """Scenario S3, a target for the trackers of Al-Wagih & Abdulla.

    Parameters
    ----------
    at : array_like, optional
        Other times (s), of any shape, >= 0.

    Returns
    -------
    t : ndarray, shape (100,)
        Times (s), 0 to 99; or those of `at`.
    position : ndarray, shape (100, 2)
        Position (m); of shape (..., 2) at times of shape (...).

    Notes
    -----
    The paper does not give its trajectories; this one was made to give errors like its averages.
    x: 20 m/s, and from t = 70 on 0.62 m/s²; y: from rest, 1.45 m/s² in the first 23 seconds. Noise:
    15 m in x and 23 m in y, white; or 19 m and 23 m, AR(1) of correlation 0.7. The first two
    measurements are free of noise.
    """
    second: Array = np.arange(100.0)
    t = second if at is None else finite("at", at)
    x = _integrated(0.0, 20.0, np.where(second[:-1] >= 70, 0.62, 0.0), t)
    y = _integrated(0.0, 0.0, np.where(second[:-1] <= 22, 1.45, 0.0), t)
    return t, np.stack([x, y], axis=-1)


def _integrated(position: float, speed: float, acceleration: Array, at: Array) -> Array:
    """Positions at times from 0 under accelerations, each constant for one second."""
    speeds = speed + np.concatenate([[0.0], np.cumsum(acceleration)])
    moves = speeds[:-1] + acceleration / 2
    places = position + np.concatenate([[0.0], np.cumsum(moves)])
    second, since = _split(at, len(acceleration))
    after = np.append(acceleration, 0.0)[second]
    return np.asarray(places[second] + speeds[second] * since + after * since**2 / 2)


def _split(at: Array, last: int) -> tuple[NDArray[np.intp], Array]:
    """Whole units of time, `last` at most, and the time since then."""
    whole = np.clip(np.floor(at), 0, last).astype(np.intp)
    return whole, at - whole


def warship(rate: float = 0.0168, at: ArrayLike | None = None) -> tuple[Array, Array]:
    """Warship of Njonjo, Pan & Jeong (2017), Eqs. 15 and 16: a sum of sines.

    Parameters
    ----------
    rate : float
        Angular rate w of the sines (rad/s); sets the speed.
    at : array_like, optional
        Other times (s), of any shape.

    Returns
    -------
    t : ndarray, shape (1000,)
        Times (s), 0 to 2997, 3 apart; or those of `at`.
    position : ndarray, shape (1000, 2)
        Position (m), first (573, 1038.4); of shape (..., 2) at times of shape (...).

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
    t = np.asarray(3.0 * np.arange(1000.0)) if at is None else finite("at", at)
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
    return t, np.stack([x, y], axis=-1)


# ---------------------------------------------------------------- random sets


@dataclass(frozen=True, eq=False)
class TrackSet:
    """Tracks for ranking trackers, in units of the noise and of the period of the set.

    Attributes
    ----------
    name : str
        Name of the set.
    time : ndarray, shape (n_steps,) or (n_steps, n_tracks)
        Times, 0, 1, 2, … unless sampled otherwise; common, or each track's own.
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


def track_set(name: str, tracks: int, seed: int, sampling: Sampling = REGULAR) -> TrackSet:
    """Random tracks for ranking trackers.

    Parameters
    ----------
    name : {"report", "mixed", "strong", "weaving"}
        ``report``: the maneuvers M1 to M4 of Llinas et al. (1998) in turn, 20 scans, with speeds of
        3 to 9 m/s, accelerations of 0.002 to 0.006 m/s² and radii of 2500 to 7000 m, to the left,
        at T = 60 s and noise σ of 115 m. ``mixed``: 60 scans, straight legs alternating with
        maneuvers, each of 8 to 20 scans; each track has one acceleration a, with a T²/σ from 0.1 to
        1, uniform in its logarithm. ``strong``: the same with a T²/σ from 1 to 3, and three times
        as fast. ``weaving``: 60 scans of a target that never flies straight, but weaves about a
        straight course along a sine of a period of 12 to 40 T; its largest acceleration a has a
        T²/σ from 0.1 to 3, uniform in its logarithm. The trackers were not tuned for these.
    tracks : int
        Number of tracks, at least 1.
    seed : int
        Seed, not negative. Each track has a random stream of its own, so that the first tracks do
        not depend on the number of tracks.
    sampling : Sampling
        When the tracks are sampled; their motion does not depend on it.

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
    if name not in ALL_SETS:
        raise ValueError(f"name: unknown set {name!r}; one of {', '.join(ALL_SETS)}")
    number = operator.index(tracks)
    if number < 1:
        raise ValueError(f"tracks must be at least 1, got {number}")
    if seed < 0:
        raise ValueError(f"seed must not be negative, got {seed}")
    streams = np.random.SeedSequence(seed).spawn(number)
    scans, first = (20, 2) if name == "report" else (60, 8)
    own: Array = np.arange(float(scans))
    time = sampling.times(own, streams)
    # Common times are given to every track.
    each = [time] * number if time.ndim == 1 else list(time.T)
    draws = [np.random.default_rng(stream) for stream in streams]
    if name == "report":
        kinds = [MANEUVERS[k % len(MANEUVERS)] for k in range(number)]
        found = [_report(*track) for track in zip(kinds, draws, each, strict=True)]
    elif name == "weaving":
        kinds = [name] * number
        found = [_weave(*track) for track in zip(draws, each, strict=True)]
    else:
        kinds = [name] * number
        found = [_legs(*track, *_STRENGTHS[name], scans) for track in zip(draws, each, strict=True)]
    position = np.stack(found, axis=1)
    return TrackSet(name, time, position, np.array(kinds), sampling.scan(first, own))


def _report(kind: str, rng: np.random.Generator, at: Array) -> Array:
    speed, acceleration = rng.uniform(3, 9), rng.uniform(0.002, 0.006)
    radius, heading = rng.uniform(2500, 7000), rng.uniform(0, 2 * math.pi)
    start = (0.0, 0.0)
    return _llinas(kind, speed, acceleration, radius, heading, start, 60.0 * at)[1] / 115.0


def _weave(rng: np.random.Generator, at: Array) -> Array:
    size = math.exp(rng.uniform(math.log(0.1), math.log(3.0)))
    rate, phase = 2 * math.pi / rng.uniform(12, 40), rng.uniform(0, 2 * math.pi)
    speed, heading = rng.uniform(1.5, 15), rng.uniform(0, 2 * math.pi)
    along, across = speed * at, size / rate**2 * (np.sin(rate * at + phase) - math.sin(phase))
    cos, sin = math.cos(heading), math.sin(heading)
    return np.stack([along * cos - across * sin, along * sin + across * cos], axis=1)


# Range of a T²/σ, and of the first speed, in σ/T.
_STRENGTHS = {"mixed": ((0.1, 1.0), (1.5, 5.0)), "strong": ((1.0, 3.0), (4.5, 15.0))}


def _legs(
    rng: np.random.Generator,
    at: Array,
    accelerations: tuple[float, float],
    speeds: tuple[float, float],
    steps: int,
) -> Array:
    """Straight legs and maneuvers alternating, beginning with a straight leg."""
    low, high = accelerations
    size = math.exp(rng.uniform(math.log(low), math.log(high)))
    speed, heading = rng.uniform(*speeds), rng.uniform(0, 2 * math.pi)
    # Along and to the left of the heading, scan by scan
    along, left = np.zeros(steps - 1), np.zeros(steps - 1)
    scan, straight, now = 0, True, speed
    while scan < steps - 1:
        length = int(rng.integers(8, 21))
        if not straight:
            turns, side = bool(rng.integers(2)), float(rng.choice([-1.0, 1.0]))
            if turns and abs(now) > size:
                left[scan : scan + length] = side * size
            else:
                along[scan : scan + length] = side * size
                now += length * side * size
        scan, straight = scan + length, not straight
    return _moved(speed, heading, along, left, at)


def _moved(speed: float, heading: float, along: Array, left: Array, at: Array) -> Array:
    """Positions under accelerations along and across the path, each constant during a scan."""
    speeds = speed + np.concatenate([[0.0], np.cumsum(along)])
    # A maneuver is either along or across the path, so the speed is constant in a turn.
    turns = np.divide(left, speeds[:-1], out=np.zeros_like(left), where=left != 0)
    headings = heading + np.concatenate([[0.0], np.cumsum(turns)])
    moves = _chords(speeds[:-1], along, headings[:-1], turns, np.ones_like(along))
    places = np.concatenate([np.zeros((1, 2)), np.cumsum(moves, axis=0)])
    scan, since = _split(at, len(along))
    along, turns = np.append(along, 0.0), np.append(turns, 0.0)
    return np.asarray(
        places[scan] + _chords(speeds[scan], along[scan], headings[scan], turns[scan], since)
    )


def _chords(speed: Array, along: Array, heading: Array, turn: Array, time: Array) -> Array:
    """Way of targets that speed up by `along` or turn by `turn` in a unit of time."""
    middle = heading + turn * time / 2
    # Chord of the arc
    way = (speed + along * time / 2) * time * np.sinc(turn * time / (2 * math.pi))
    return np.asarray(way[:, None] * np.stack([np.cos(middle), np.sin(middle)], axis=1))
