"""Small recordings to try things with: simulated plots of radars, AIS, ADS-B and a sonar.

Each has what real recordings have: irregular times, missed plots, noise, turns, and in the sonar's
plots that are far off. Nothing in them was recorded.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.io.polar import cartesian_to_polar
from fuzzytrack.reprs import summary
from fuzzytrack.simulation.noise import check_runs
from fuzzytrack.simulation.sampling import Sampling
from fuzzytrack.simulation.scene.files import load_scene
from fuzzytrack.simulation.scene.simulate import simulate_scans
from fuzzytrack.simulation.scene.tables import plot_table, truth_table
from fuzzytrack.simulation.trajectories import constant_velocity, turn
from fuzzytrack.yamltree import suggestion

__all__ = ["SAMPLES", "Sample", "SampleKind", "make_sample"]

Columns = dict[str, Sequence[str] | Array]

_KNOT = 1852 / 3600
# 2024-05-01T12:00:00Z in Unix seconds.
_START = 1714564800


@dataclass(frozen=True, eq=False)
class Sample:
    """A simulated recording.

    Attributes
    ----------
    plots : dict of str to sequence
        Columns, a row for each plot, in order of time; NaN where a plot was missed.
    truth : dict of str to sequence
        The same columns and rows without noise, missed plots and outliers; of scans, whose plots
        have no identity, a row for each true target and scan.
    """

    plots: Columns
    truth: Columns

    def __repr__(self) -> str:
        return summary(self, "plots", "truth")


@dataclass(frozen=True)
class SampleKind:
    """What a sample holds and how it is read.

    Attributes
    ----------
    summary : str
        One line.
    reading : mapping of str to Any
        Arguments of `fuzzytrack.track`, or options of its command, that fit it.
    extra : str
        Extra of this package that is needed to read it, or "".
    make : callable
        Makes it from random numbers.
    command : {"track", "scan"}
        Command that tracks it: whether its plots have identities, or not.
    """

    summary: str
    reading: Mapping[str, Any]
    extra: str
    make: Callable[[np.random.Generator], Sample]
    command: str = "track"


def make_sample(name: str, seed: int = 0) -> Sample:
    """Simulate a small recording.

    Parameters
    ----------
    name : {"radar", "ais", "adsb", "sonar", "scans"}
        Kind of recording; `SAMPLES` says what each holds.
    seed : int
        Seed of times, noise and missed plots, not negative. The targets are always the same.

    Returns
    -------
    Sample

    Raises
    ------
    ValueError
        If there is no such sample, or `seed` is negative.

    Examples
    --------
    >>> from fuzzytrack.simulation import make_sample
    >>> sample = make_sample("radar")
    >>> list(sample.plots), len(sample.plots["time"]) == len(sample.truth["time"])
    (['time', 'track', 'range', 'azimuth'], True)
    """
    if name not in SAMPLES:
        raise ValueError(f"no such sample {name!r}{suggestion(name, SAMPLES)}")
    check_runs(1, seed)
    return SAMPLES[name].make(np.random.default_rng(seed))


# -------------------------------------------------------------------- targets


@dataclass(frozen=True)
class _Target:
    """A target that flies straight legs and turns at constant speed.

    Attributes
    ----------
    name : str
    start : (float, float)
        First position (m): east, north.
    course : float
        First course (degrees clockwise from north).
    speed : float
        Speed (m/s).
    legs : sequence of (float, float)
        Durations (s) and turn rates (degrees/s, positive to the right); then straight on.
    altitude, climb : float
        First altitude (m) and vertical speed (m/s).
    begin, end : float
        Times (s) between which it is seen.
    """

    name: str
    start: tuple[float, float]
    course: float
    speed: float
    legs: tuple[tuple[float, float], ...] = ()
    altitude: float = 0.0
    climb: float = 0.0
    begin: float = 0.0
    end: float = 600.0

    def position(self, t: Array) -> Array:
        """East and north (m) at times, of shape (n, 2)."""
        place = np.tile(np.array(self.start, np.float64), (len(t), 1))
        heading, begin = math.radians(90 - self.course), self.begin
        for duration, rate in (*self.legs, (math.inf, 0.0)):
            within, angle = np.clip(t - begin, 0.0, duration), math.radians(-rate)
            if angle == 0:
                place += constant_velocity(speed=self.speed, heading=heading, at=within)[1]
            else:
                radius = self.speed / angle
                place += turn(speed=self.speed, radius=radius, heading=heading, at=within)[1]
                heading += angle * duration
            begin += duration
        return place

    def courses(self, t: Array) -> Array:
        """Courses at times (degrees clockwise from north, in [0, 360))."""
        turned, begin = np.full(len(t), self.course, np.float64), self.begin
        for duration, rate in self.legs:
            turned += rate * np.clip(t - begin, 0.0, duration)
            begin += duration
        return turned % 360

    def times(self, rng: np.random.Generator, sampling: Sampling) -> Array:
        """Times (s) at which it is measured."""
        own = np.array([self.begin, self.end])
        stream = np.random.SeedSequence(int(rng.integers(2**63)))
        return sampling.times(own, [stream])[:, 0]


def _joined(
    targets: Sequence[_Target], id: str, parts: Sequence[tuple[Columns, Columns]]
) -> Sample:
    """Plots and truth of several targets, with their names, in order of time."""
    joined = []
    for side in zip(*parts, strict=True):
        columns = {name: np.concatenate([part[name] for part in side]) for name in side[0]}
        order = np.argsort(columns["time"], kind="stable")
        lengths = [len(part["time"]) for part in side]
        names = np.repeat([target.name for target in targets], lengths)[order].tolist()
        time, *others = ((name, values[order]) for name, values in columns.items())
        joined.append(dict([time, (id, names), *others]))
    return Sample(*joined)


# -------------------------------------------------------------------- radar

_SCAN = 4.0
_AIRCRAFT = (
    _Target("A1", (-30e3, -18e3), 70, 210, ((120, 0), (40, 1.5), (90, 0), (30, -3))),
    _Target("A2", (18e3, 25e3), 200, 140, ((60, 0), (30, 3), (60, 0), (60, -3))),
    _Target("A3", (-8e3, 33e3), 175, 230, ((200, 0), (60, -1)), begin=40),
    _Target("A4", (38e3, -14e3), 262, 180, ((150, 0), (30, 3), (40, 0), (30, -3)), end=420),
    _Target("A5", (5e3, 9e3), 320, 95, ((30, 0), (120, 3), (60, 0), (60, 3)), begin=100),
    _Target("A6", (-25e3, 26e3), 115, 245, end=330),
)


def _radar(rng: np.random.Generator) -> Sample:
    """Plots of 30 m and 0.1 degrees, each when the beam passes; of 20, one or two are missed."""
    parts = []
    for target in _AIRCRAFT:
        scans = target.times(rng, Sampling("jitter", 0.02, _SCAN))
        time = np.round(_beam_passes(target, scans), 3)
        true = cartesian_to_polar(target.position(time))
        missed = rng.random(len(time)) < 0.08
        distance = true.range + rng.normal(0, 30, len(time))
        bearing = np.degrees(true.azimuth) + rng.normal(0, 0.1, len(time))
        plots: Columns = {
            "time": time,
            "range": np.where(missed, np.nan, np.round(distance, 1)),
            "azimuth": np.where(missed, np.nan, np.mod(np.round(bearing, 2), 360)),
        }
        truth: Columns = {
            "time": time,
            "range": np.round(true.range, 3),
            "azimuth": np.mod(np.round(np.degrees(true.azimuth), 6), 360),
        }
        parts.append((plots, truth))
    return _joined(_AIRCRAFT, "track", parts)


def _beam_passes(target: _Target, scans: Array) -> Array:
    """Times at which the beam points to a target, when it points north at the times `scans`."""
    time = scans
    for _ in range(4):
        # Counted on over north, since the beam needs a full turn and more for a target that has
        # moved clockwise past north.
        azimuth = np.unwrap(cartesian_to_polar(target.position(time)).azimuth)
        time = scans + azimuth / (2 * np.pi) * _SCAN
    return time


# -------------------------------------------------------------------- places on earth


def _places(position: Array, lat: float, lon: float, digits: int) -> Columns:
    """Latitude and longitude (degrees, rounded) of positions within some 50 km of a place.

    They are counted along the meridian and the parallel of the place (WGS 84), which needs no
    other package; distances are right to a fraction of a percent.
    """
    major, squared = 6378137.0, 6.69437999014e-3
    width = 1 - squared * math.sin(math.radians(lat)) ** 2
    along = major * (1 - squared) / width**1.5
    across = major / math.sqrt(width) * math.cos(math.radians(lat))
    return {
        "lat": np.round(lat + np.degrees(position[:, 1] / along), digits),
        "lon": np.round(lon + np.degrees(position[:, 0] / across), digits),
    }


# -------------------------------------------------------------------- AIS

_HARBOR = (54.2, 12.05)
# No country has the first three digits.
_SHIPS = (
    _Target("200000001", (-5e3, 1e3), 95, 7.0, ((300, 0), (90, 0.5), (200, 0)), end=900),
    _Target("200000002", (2e3, 9e3), 190, 9.5, ((240, 0), (60, -1), (120, 0), (60, 1)), end=900),
    _Target("200000003", (4e3, -3e3), 300, 16.0, ((100, 0), (60, 2), (100, 0), (60, -2)), end=600),
    _Target("200000004", (-1e3, -2e3), 20, 3.5, ((200, 0), (180, 0.5)), begin=120, end=900),
    _Target("200000005", (8e3, 4e3), 255, 11.0, ((500, 0), (60, 0.7)), begin=60, end=900),
)


def _ais(rng: np.random.Generator) -> Sample:
    """Positions of 10 m at 2 to 10 s; one of ten is lost, and each ship is lost once for 40 s."""
    parts = []
    for ship in _SHIPS:
        time = np.unique(np.round(ship.times(rng, Sampling("log-uniform", (2, 10), 5.0))))
        lost = rng.uniform(time[0] + 60, time[-1] - 100)
        received = (rng.random(len(time)) >= 0.1) & ~((time > lost) & (time < lost + 40))
        time = time[received]
        position, course = ship.position(time), ship.courses(time)
        measured = position + rng.normal(0, 10, position.shape)
        speed = np.full(len(time), ship.speed / _KNOT)
        plots: Columns = {
            "time": time,
            **_places(measured, *_HARBOR, 6),
            "sog": np.round(speed + rng.normal(0, 0.1, len(time)), 1),
            "cog": np.mod(np.round(course + rng.normal(0, 1, len(time)), 1), 360),
        }
        truth: Columns = {
            "time": time,
            **_places(position, *_HARBOR, 9),
            "sog": np.round(speed, 3),
            "cog": np.mod(np.round(course, 3), 360),
        }
        parts.append((plots, truth))
    sample = _joined(_SHIPS, "mmsi", parts)
    for columns in (sample.plots, sample.truth):
        seconds = np.asarray(columns["time"], np.int64) + _START
        columns["time"] = [f"{text}Z" for text in seconds.astype("datetime64[s]").astype(str)]
    return sample


# -------------------------------------------------------------------- ADS-B

_RECEIVER = (48.35, 11.8)
# Altitudes are sent in steps of 25 feet.
_ALTITUDE_STEP = 7.62
# Addresses that are given to no country.
_FLIGHTS = (
    _Target("f00001", (-30e3, 5e3), 80, 220, ((100, 0), (60, 1)), 9000, -6, end=300),
    _Target("f00002", (12e3, -20e3), 330, 130, ((60, 0), (40, 3), (60, 0)), 1200, 9, end=300),
    _Target("f00003", (25e3, 22e3), 240, 240, ((180, 0), (30, -1.5)), 11000, 0, end=280),
)


def _adsb(rng: np.random.Generator) -> Sample:
    """Positions of 25 m about every second; one of ten is lost, and each aircraft once for 12 s."""
    parts = []
    for flight in _FLIGHTS:
        time = np.round(flight.times(rng, Sampling("jitter", 0.4, 1.0)), 2)
        lost = rng.uniform(time[0] + 30, time[-1] - 40)
        received = (rng.random(len(time)) >= 0.1) & ~((time > lost) & (time < lost + 12))
        time = time[received]
        position, altitude = flight.position(time), flight.altitude + flight.climb * time
        measured = position + rng.normal(0, 25, position.shape)
        level = altitude + rng.normal(0, 8, len(time))
        plots: Columns = {
            "time": time + _START,
            **_places(measured, *_RECEIVER, 6),
            "alt": np.round(np.round(level / _ALTITUDE_STEP) * _ALTITUDE_STEP, 2),
        }
        truth: Columns = {
            "time": time + _START,
            **_places(position, *_RECEIVER, 9),
            "alt": np.round(altitude, 3),
        }
        parts.append((plots, truth))
    return _joined(_FLIGHTS, "icao24", parts)


# -------------------------------------------------------------------- sonar

_DIVER = _Target("", (-250, 90), 100, 1.8, ((90, 0), (60, 2), (120, 0), (45, -4)), end=500)


def _sonar(rng: np.random.Generator) -> Sample:
    """Positions of 2 m every second; one of 25 is an echo of something else, and two gaps."""
    time = np.round(_DIVER.times(rng, Sampling("jitter", 0.1, 1.0)), 3)
    gaps = [(start, start + 15) for start in rng.uniform((150, 350), (250, 450))]
    silent = np.logical_or.reduce([(time > start) & (time < end) for start, end in gaps])
    time = time[~silent]
    position = _DIVER.position(time)
    measured = position + rng.normal(0, 2, position.shape)
    # The first ones are good, so that a track can begin.
    echo = (rng.random(len(time)) < 0.04) & (np.arange(len(time)) >= 10)
    measured[echo] += rng.choice((-1, 1), (echo.sum(), 2)) * rng.uniform(40, 150, (echo.sum(), 2))
    plots, truth = (
        {"time": time, "x": np.round(places[:, 0], digits), "y": np.round(places[:, 1], digits)}
        for places, digits in ((measured, 2), (position, 4))
    )
    return Sample(plots, truth)


# -------------------------------------------------------------------- scans


def _scans(rng: np.random.Generator) -> Sample:
    """Scans of a harbor from a ship that moves: boats, a ferry, a shore, piers, other clutter."""
    found = simulate_scans(load_scene("harbor:scans.count=120"), int(rng.integers(2**31)))
    plots = {name: _rounded(values, 3) for name, values in plot_table(found, own=True).items()}
    truth = {name: _rounded(values, 4) for name, values in truth_table(found).items()}
    for columns in (plots, truth):
        columns["time"] = columns.pop("t")
    return Sample(
        {name: plots[name] for name in ("scan", "time", "x", "y", "own_x", "own_y")},
        {name: truth[name] for name in ("time", "id", "x", "y", "vx", "vy")},
    )


def _rounded(values: Sequence[str] | Array, digits: int) -> Sequence[str] | Array:
    return np.round(values, digits) if isinstance(values, np.ndarray) else values


#: Kinds of samples by name.
SAMPLES = MappingProxyType(
    {
        "radar": SampleKind(
            "polar plots of six aircraft, a scan in 4 s, some missed",
            {
                "polar": ("range", "azimuth"),
                "id": "track",
                "sigma_range": 30,
                "sigma_azimuth": 0.1,
            },
            "",
            _radar,
        ),
        "ais": SampleKind(
            "reports of five ships at irregular times, 2 to 10 s and more apart",
            {"geodetic": ("lat", "lon"), "id": "mmsi"},
            "geo",
            _ais,
        ),
        "adsb": SampleKind(
            "positions and altitudes of three aircraft, about one a second",
            {"geodetic": ("lat", "lon", "alt"), "id": "icao24"},
            "geo",
            _adsb,
        ),
        "sonar": SampleKind("positions of a diver with spikes and gaps", {"sigma": 2}, "", _sonar),
        "scans": SampleKind(
            "scans of a harbor from a moving ship: plots without identities, and clutter",
            {"scan": "scan", "axes": ("x", "y"), "own": ("own_x", "own_y")},
            "",
            _scans,
            "scan",
        ),
    }
)
