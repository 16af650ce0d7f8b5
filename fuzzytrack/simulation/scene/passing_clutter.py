"""Clutter that appears, moves and vanishes: glints, arcs and groups of echoes."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.simulation.scene.clutter import Clutter, ClutterPlots, View, refuse_too_many
from fuzzytrack.simulation.scene.region import Region
from fuzzytrack.simulation.scene.settings import setting
from fuzzytrack.simulation.scene.streams import Streams

__all__ = ["Arcs", "CreepingGlints", "EchoGroups", "PassingClutter"]

Whole = NDArray[np.int64]


@dataclass(frozen=True, repr=False)
class PassingClutter(Clutter):
    """Sources of echoes that appear at random times and live for an exponential time.

    Their number does not change on average, from the first scan on: it is births times life.
    """

    births: float = setting(..., "mean number that appear in a second", "1/s", least=0, most=1e4)
    life: float = setting(30.0, "mean life", "s", least=0, above=True, most=1e6)
    within: Region | None = setting(  # noqa: RUF009 (a setting is no shared value)
        None, "region in which they appear, instead of that of the scene", "", "part"
    )

    def plots(self, view: View, streams: Streams) -> ClutterPlots:
        """Draw its plots in all scans."""
        born, gone = self._lives(view, streams)
        there = (born[:, None] <= view.times) & (view.times < gone[:, None])
        source, scan = np.nonzero(there)
        return self._seen(view, streams, born, source, scan)

    def _lives(self, view: View, streams: Streams) -> tuple[Array, Array]:
        """When sources appear and vanish (s)."""
        rng = streams.stream("births")
        duration = view.times[-1] - view.start
        # Of each there is a place for each scan.
        refuse_too_many(self.births * (self.life + duration) * len(view.times))
        there, later = rng.poisson(self.births * np.array([self.life, duration]))
        # What is left of an exponential life has the same distribution.
        born = np.append(np.zeros(there), rng.random(later) * duration) + view.start
        return born, born + rng.exponential(self.life, there + later)

    def _places(self, view: View, streams: Streams, count: int) -> Array:
        return (self.within or view.region).draw(streams.stream("place"), count)

    @abstractmethod
    def _seen(
        self, view: View, streams: Streams, born: Array, source: Whole, scan: Whole
    ) -> ClutterPlots:
        """Plots of sources that are there at the times of scans."""


@dataclass(frozen=True, repr=False)
class CreepingGlints(PassingClutter):
    """Echoes that creep slowly in a straight line, as those of waves and wakes do."""

    summary = "echoes that creep in a straight line and vanish"

    speed: tuple[float, float] = setting((0.2, 1.5), "speed", "m/s", "interval", least=0)
    detection: float = setting(0.6, "probability of a plot in a scan", "", least=0, most=1)
    spread: float = setting(3.0, "standard deviation of x and of y", "m", least=0)

    def _seen(
        self, view: View, streams: Streams, born: Array, source: Whole, scan: Whole
    ) -> ClutterPlots:
        n = len(born)
        u = streams.stream("motion").random((n, 2))
        speed = self.speed[0] + (self.speed[1] - self.speed[0]) * u[:, 0]
        course = 2 * math.pi * u[:, 1]
        velocity = speed[:, None] * np.stack([np.cos(course), np.sin(course)], axis=1)
        kept = streams.stream("detection").random(len(scan)) < self.detection
        source, scan = source[kept], scan[kept]
        age = (view.times[scan] - born[source])[:, None]
        place = self._places(view, streams, n)[source] + age * velocity[source]
        return scan, place + self.spread * streams.stream("spread").standard_normal(place.shape)


@dataclass(frozen=True, repr=False)
class Arcs(PassingClutter):
    """Echoes that keep their range from the radar while their bearing wanders or sweeps.

    Side lobes, reflections and interference look so; `within` says where they begin.
    """

    summary = "echoes that keep their range from the radar while their bearing wanders"

    sweep: tuple[float, float] = setting(
        (0.0, 0.0), "steady change of the bearing, to either side", "rad/s", "interval", least=0
    )
    wander: float = setting(
        6.0, "standard deviation of the way along the arc in a second, times √s", "m", least=0
    )
    detection: float = setting(0.6, "probability of a plot in a scan", "", least=0, most=1)
    spread: float = setting(2.0, "standard deviation of range", "m", least=0)

    def _seen(
        self, view: View, streams: Streams, born: Array, source: Whole, scan: Whole
    ) -> ClutterPlots:
        n, scans = len(born), len(view.times)
        place = self._places(view, streams, n)
        first = np.searchsorted(view.times, born).clip(max=scans - 1)
        east, north = (place - view.own[first]).T
        radius = np.hypot(east, north)
        u = streams.stream("motion").random((n, 2))
        rate = self.sweep[0] + (self.sweep[1] - self.sweep[0]) * u[:, 0]
        rate = np.where(u[:, 1] < 0.5, -rate, rate)
        way = _walks(view, streams, n, 1)[..., 0] * self.wander
        kept = streams.stream("detection").random(len(scan)) < self.detection
        source, scan = source[kept], scan[kept]
        age = view.times[scan] - born[source]
        walked = way[source, scan] - way[source, first[source]]
        # The walk is in meters, so that it does not depend on the range.
        bearing = np.arctan2(east, north)[source] + rate[source] * age
        bearing = bearing + walked / np.maximum(radius[source], 1.0)
        at = radius[source] + self.spread * streams.stream("spread").standard_normal(len(scan))
        offset = np.stack([np.sin(bearing), np.cos(bearing)], axis=1) * at[:, None]
        return scan, view.own[scan] + offset


@dataclass(frozen=True, repr=False)
class EchoGroups(PassingClutter):
    """Groups of echoes whose middle wanders, as rain cells, flocks and wakes have them."""

    summary = "groups of echoes whose middle wanders"

    members: float = setting(
        3.0, "mean number of plots of a group in a scan", "", least=0, most=1e4
    )
    radius: float = setting(15.0, "standard deviation of x and of y in a group", "m", least=0)
    wander: float = setting(
        3.0, "standard deviation of the way of the middle in a second, times √s", "m", least=0
    )

    def _seen(
        self, view: View, streams: Streams, born: Array, source: Whole, scan: Whole
    ) -> ClutterPlots:
        n = len(born)
        refuse_too_many(self.members * len(scan))
        numbers = streams.stream("members").poisson(self.members, len(scan))
        source, scan = np.repeat(source, numbers), np.repeat(scan, numbers)
        first = np.searchsorted(view.times, born).clip(max=len(view.times) - 1)
        walks = _walks(view, streams, n, 2) * self.wander
        place = self._places(view, streams, n)[source]
        place = place + walks[source, scan] - walks[source, first[source]]
        return scan, place + self.radius * streams.stream("spread").standard_normal(place.shape)


def _walks(view: View, streams: Streams, count: int, axes: int) -> Array:
    """Random walks of variance 1 in a second, shape (count, n_scans, axes)."""
    steps = streams.stream("walk").standard_normal((count, len(view.times), axes))
    steps *= np.sqrt(np.diff(view.times, prepend=view.start))[:, None]
    return np.cumsum(steps, axis=1)
