"""Regions of a plane, in which targets appear and clutter lies."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.simulation.scene.settings import Settings, setting

__all__ = ["SHAPES", "Region"]

#: Settings of which a region has exactly one.
SHAPES = ("disc", "square", "polygon", "area_each")


@dataclass(frozen=True, repr=False)
class Region(Settings):
    """A disc or ring, a square or a polygon; exactly one of the first four settings is given.

    Raises
    ------
    ValueError
        If a value is not allowed, or there is not exactly one shape.
    """

    disc: tuple[float, float] | None = setting(
        None,
        "disc with this radius, or ring between two radii",
        "m",
        "interval",
        least=0,
    )
    square: float | None = setting(None, "side of a square", "m", least=0, above=True)
    polygon: tuple[tuple[float, float], ...] | None = setting(
        None, "corners of a polygon, in order", "m", "points"
    )
    area_each: float | None = setting(
        None,
        "square with this area for each target that there is from the start on",
        "m²",
        least=0,
        above=True,
    )
    at: tuple[float, float] = setting((0.0, 0.0), "center of a disc or square", "m", "point")
    sector: tuple[float, float] | None = setting(
        None, "part of a disc between two bearings, clockwise from y", "rad", "interval"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        given = [name for name in SHAPES if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(
                f"region must have exactly one of {', '.join(SHAPES)}, got "
                f"{' and '.join(given) or 'none'}"
            )
        if self.disc is not None and self.disc[0] == self.disc[1]:
            object.__setattr__(self, "disc", (0.0, self.disc[1]))
        if self.disc is not None and self.disc[1] == 0:
            raise ValueError("disc must have a radius > 0, got 0")
        if self.polygon is not None and (len(self.polygon) < 3 or not self.area > 0):
            raise ValueError("polygon must be three corners or more that enclose an area")
        if self.sector is not None and (
            self.disc is None or not 0 < self.sector[1] - self.sector[0] <= 2 * math.pi + 1e-9
        ):
            raise ValueError("sector must be a part of a disc, more than 0 and at most 360 degrees")

    def for_targets(self, count: int) -> Region:
        """The region for this number of targets, which matters where it has an area for each."""
        if self.area_each is None:
            return self
        return replace(self, square=math.sqrt(self.area_each * max(count, 1)), area_each=None)

    @property
    def area(self) -> float:
        """Its area (m²)."""
        if self.disc is not None:
            low, high = self._sector
            return (high - low) / 2 * (self.disc[1] ** 2 - self.disc[0] ** 2)
        if self.square is not None:
            return self.square**2
        x, y = self._corners.T
        return abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2

    @property
    def middle(self) -> Array:
        """Its middle (m); of a polygon the mean of its corners."""
        return np.array(self.at) if self.polygon is None else self._corners.mean(axis=0)

    def without_hole(self) -> Region:
        """The region; a disc in place of a ring."""
        return self if self.disc is None else replace(self, disc=(0.0, self.disc[1]))

    @property
    def _sector(self) -> tuple[float, float]:
        return (0.0, 2 * math.pi) if self.sector is None else self.sector

    @property
    def _corners(self) -> Array:
        if self.polygon is None:
            raise ValueError("area_each must be resolved by `for_targets` first")
        return np.array(self.polygon)

    def draw(self, rng: np.random.Generator, count: int) -> Array:
        """Places drawn uniformly, shape (count, 2); more of them begin with the same ones."""
        if self.disc is not None:
            u = rng.random((count, 2))
            inner, outer = self.disc
            radius = np.sqrt(inner**2 + u[:, 0] * (outer**2 - inner**2))
            low, high = self._sector
            bearing = low + u[:, 1] * (high - low)
            return np.stack([np.sin(bearing), np.cos(bearing)], -1) * radius[:, None] + self.at
        if self.square is not None:
            return (rng.random((count, 2)) - 0.5) * self.square + self.at
        corners = self._corners
        low_corner, size = corners.min(axis=0), np.ptp(corners, axis=0)
        share = self.area / float(size.prod())
        found = np.empty((0, 2))
        while len(found) < count:
            tries = max(int((count - len(found)) / share), 16)
            places = low_corner + rng.random((tries, 2)) * size
            found = np.concatenate([found, places[self.holds(places)]])
        return found[:count]

    def holds(self, places: Array) -> NDArray[np.bool_]:
        """Whether places, shape (n, 2), are inside."""
        x, y = (places - self.at).T if self.polygon is None else places.T
        if self.disc is not None:
            radius = np.hypot(x, y)
            inside = (self.disc[0] <= radius) & (radius <= self.disc[1])
            if self.sector is not None:
                low, high = self.sector
                inside &= np.mod(np.arctan2(x, y) - low, 2 * math.pi) <= high - low
            return np.asarray(inside)
        if self.square is not None:
            return np.asarray((abs(x) <= self.square / 2) & (abs(y) <= self.square / 2))
        inside = np.zeros(len(places), bool)
        corners = self._corners
        for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            if y0 != y1:
                crossed = (y0 > y) != (y1 > y)
                inside ^= crossed & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
        return inside
