"""Clutter of what does not move: steady points, and shorelines."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.simulation.scene.clutter import Clutter, ClutterPlots, View, refuse_too_many
from fuzzytrack.simulation.scene.region import Region
from fuzzytrack.simulation.scene.settings import setting
from fuzzytrack.simulation.scene.streams import Streams

__all__ = ["Shoreline", "SteadyPoints"]

_TURN = 2 * math.pi


@dataclass(frozen=True, repr=False)
class SteadyPoints(Clutter):
    """Points that give an echo again and again: buoys, piers, moored boats."""

    summary = "points that give an echo again and again, as buoys and piers do"

    count: int = setting(0, "points at random places", "", "whole", least=0, most=100_000)
    at: tuple[tuple[float, float], ...] | None = setting(
        None, "instead: their places", "m", "points"
    )
    within: Region | None = setting(  # noqa: RUF009 (a setting is no shared value)
        None, "region of the random places, instead of that of the scene", "", "part"
    )
    detection: float = setting(0.8, "probability of a plot in a scan", "", least=0, most=1)
    spread: float = setting(2.0, "standard deviation of x and of y", "m", least=0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.at is None) == (self.count == 0) or (self.at and self.within):
            raise ValueError("count must be given, or at without within")

    def plots(self, view: View, streams: Streams) -> ClutterPlots:
        """Draw its plots in all scans."""
        if self.at is not None:
            points = np.array(self.at)
        else:
            points = (self.within or view.region).draw(streams.stream("place"), self.count)
        shape = (len(points), len(view.times))
        refuse_too_many(math.prod(shape))
        seen = streams.stream("detection").random(shape) < self.detection
        point, scan = np.nonzero(seen)
        shift = streams.stream("spread").standard_normal((*shape, 2))[point, scan]
        return scan, points[point] + self.spread * shift


@dataclass(frozen=True, repr=False)
class Shoreline(Clutter):
    """Plots along a line, in each scan at other places of it.

    A bearing window that turns shows another stretch of the shore from scan to scan; then echoes
    appear, creep along the shore and vanish, as targets would.
    """

    summary = "plots along a line, maybe seen through a bearing window that turns"

    line: tuple[tuple[float, float], ...] = setting(
        ..., "points of the line, in order", "m", "points"
    )
    spacing: float = setting(
        50.0, "mean distance between plots along the line in a scan", "m", least=0, above=True
    )
    spread: float = setting(5.0, "standard deviation of x and of y", "m", least=0)
    window: float = setting(
        _TURN,
        "width of the bearing window through which it is seen",
        "rad",
        least=0,
        most=_TURN,
        above=True,
    )
    window_at: float = setting(
        0.0, "bearing of the middle of the window at the start, clockwise from y", "rad"
    )
    window_rate: float = setting(0.0, "how fast the window turns, clockwise", "rad/s")

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self._lengths().sum() > 0:
            raise ValueError("line must have two different points at least")

    def _lengths(self) -> Array:
        return np.asarray(np.hypot(*np.diff(np.array(self.line), axis=0).T))

    def plots(self, view: View, streams: Streams) -> ClutterPlots:
        """Draw its plots in all scans."""
        ends = np.concatenate([[0.0], np.cumsum(self._lengths())])
        mean = ends[-1] / self.spacing
        refuse_too_many(mean * len(view.times))
        numbers = streams.stream("count").poisson(mean, len(view.times))
        scan = np.repeat(np.arange(len(view.times)), numbers)
        along = streams.stream("place").random(len(scan)) * ends[-1]
        points = np.array(self.line)
        place = np.stack([np.interp(along, ends, points[:, axis]) for axis in (0, 1)], axis=1)
        place += self.spread * streams.stream("spread").standard_normal(place.shape)
        east, north = (place - view.own[scan]).T
        middle = self.window_at + self.window_rate * (view.times[scan] - view.start)
        off = np.mod(np.arctan2(east, north) - middle + math.pi, _TURN) - math.pi
        shown = abs(off) <= self.window / 2 + 1e-12
        return scan[shown], place[shown]
