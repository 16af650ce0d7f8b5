"""Places on earth as positions in a plane or a space about an origin, and back.

`LocalFrame` has axes to the east, north and up of its origin (WGS 84). They are straight lines:
the plane of east and north touches the earth at the origin, and lies above it elsewhere, by 2 m at
5 km and by 20 km at 500 km. pymap3d does the conversions (extra ``geo``).
"""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError

__all__ = ["GeodeticPlaces", "LocalFrame", "LocalPlots", "axes_on_earth", "on_the_earth"]

#: Mean radius of the earth in m, where a rough figure is enough.
EARTH_RADIUS = 6371e3

#: Distance from the origin in m beyond which `LocalFrame.remark` has something to say.
FAR = 500e3

#: Cosine of the arc from the origin beyond which a place without altitude is dropped: 45°, 5000 km.
FARTHEST = np.sqrt(0.5)

#: Distance in m from the ground beyond which an altitude or a position is no place on earth.
HIGHEST = 1e9


@dataclass(frozen=True)
class LocalPlots:
    """Positions of plots that were given as places on earth.

    Attributes
    ----------
    position : ndarray, shape (n, 2) or (n, 3)
        East, north and perhaps up of the origin in m; NaN where the plot was missed or dropped.
    impossible : ndarray of bool, shape (n,)
        Dropped, since there is no such latitude or longitude.
    too_far : ndarray of bool, shape (n,)
        Dropped, since the plane about the origin does not reach so far (45° of arc, 5000 km);
        never where altitudes are given.
    """

    position: Array
    impossible: Mask
    too_far: Mask


@dataclass(frozen=True)
class GeodeticPlaces:
    """Places on earth (WGS 84).

    Attributes
    ----------
    lat, lon : ndarray, shape (n,)
        Degrees north, in [-90, 90], and east, in [-180, 180].
    alt : ndarray, shape (n,)
        Height above the ellipsoid in m.
    """

    lat: Array
    lon: Array
    alt: Array


@dataclass(frozen=True)
class LocalFrame:
    """Axes to the east, north and up of a place on earth.

    With altitudes, positions have three axes and are right in space at any distance; `up` is
    then the height above the plane, not above the ground. Without altitudes, all plots are
    taken at the height of the origin, and only their components to the east and north are
    kept. Seen along the ground, these become too short with the distance from the origin: at
    100 km by 0.004 % (speeds by 0.012 %), at 500 km by 0.1 % (0.3 %). `to_geodetic` undoes this.

    Parameters
    ----------
    lat, lon : float
        The origin in degrees north and east; longitudes in [-360, 360].
    alt : float
        Its height above the ellipsoid in m.

    Raises
    ------
    DataError
        If there is no such place, or pymap3d is not installed when it is needed.
    """

    lat: float
    lon: float
    alt: float = 0.0

    def __post_init__(self) -> None:
        for name, most in (("lat", 90.0), ("lon", 360.0), ("alt", HIGHEST)):
            value = getattr(self, name)
            if not abs(value) <= most:
                raise DataError(
                    f"origin of the local frame: {name} {value:g}; expected -{most:g} to {most:g}"
                )

    def to_local(self, lat: ArrayLike, lon: ArrayLike, alt: ArrayLike | None = None) -> LocalPlots:
        """East, north and perhaps up of places on earth.

        Parameters
        ----------
        lat, lon : array_like, shape (n,)
            Degrees. Longitudes may count from -180 to 180 or from 0 to 360. Impossible are a
            latitude beyond ±90, a longitude beyond ±360 and an altitude beyond ±1e9; so AIS's
            91/181 for "not available" is dropped. NaN is a missed plot.
        alt : array_like, shape (n,), optional
            Height above the ellipsoid in m. Where it is NaN, east and north are those of a
            place at the height of the origin, and up is NaN.

        Returns
        -------
        LocalPlots

        Raises
        ------
        ValueError
            If the shapes differ.
        DataError
            If pymap3d is not installed.
        """
        pymap3d = _pymap3d()
        columns = [np.asarray(values, dtype=np.float64) for values in (lat, lon)]
        height = np.full(columns[0].shape, np.nan)
        if alt is not None:
            height = np.asarray(alt, dtype=np.float64)
        _same_shapes(lat=columns[0], lon=columns[1], alt=height)
        impossible = _impossible(*columns) | (np.abs(height) > HIGHEST)
        far = np.zeros(impossible.shape, dtype=np.bool_)
        if alt is None:
            # NaN compares as false: neither missed nor impossible plots are far.
            far = ~impossible & (self._cosine_of_arc(*columns) < FARTHEST)
        north, east = (np.where(impossible | far, np.nan, column) for column in columns)
        known = np.where(np.isfinite(height), height, self.alt)
        position = np.stack(
            pymap3d.geodetic2enu(north, east, known, self.lat, self.lon, self.alt), axis=-1
        ).reshape(-1, 3)
        position += 0.0  # no -0.0 in files
        if alt is None:
            return LocalPlots(position[:, :2], impossible, far)
        position[np.isnan(height), 2] = np.nan
        return LocalPlots(position, impossible, far)

    def to_geodetic(self, position: ArrayLike) -> GeodeticPlaces:
        """Places on earth of positions in this frame.

        Parameters
        ----------
        position : array_like, shape (n, 2) or (n, 3)
            East, north and perhaps up in m. Without up, places are at the height of the origin.
            Where up alone is NaN, so are they, and their height is NaN.

        Returns
        -------
        GeodeticPlaces
            NaN for positions with NaN or beyond ±1e9 m, and for those without up that are not above
            the earth.

        Raises
        ------
        ValueError
            If the shape is another.
        DataError
            If pymap3d is not installed.
        """
        pymap3d = _pymap3d()
        places = np.asarray(position, dtype=np.float64)
        if places.ndim != 2 or places.shape[1] not in (2, 3):
            raise ValueError(f"`position`: shape {places.shape}; expected (n, 2) or (n, 3)")
        beyond = (np.abs(places) > HIGHEST).any(axis=1, keepdims=True)
        places = np.where(beyond, np.nan, places)
        east, north = places[:, 0], places[:, 1]
        level = on_the_earth(east, north, self.lat, self.lon, self.alt)
        if places.shape[1] == 2:
            return level
        up = places[:, 2]
        lat, lon, alt = pymap3d.enu2geodetic(east, north, up, self.lat, self.lon, self.alt)
        flat = np.isnan(up)
        return GeodeticPlaces(
            np.where(flat, level.lat, lat), np.where(flat, level.lon, lon), np.asarray(alt)
        )

    def remark(self, farthest: float, n_axes: int) -> str | None:
        """What to know of positions that are far from the origin; None if none is.

        Parameters
        ----------
        farthest : float
            Largest distance in the plane of east and north (m).
        n_axes : int
            Two, or three with heights.
        """
        if farthest <= FAR:
            return None
        found = f"plots lie up to {farthest / 1e3:.0f} km from the origin of the local frame"
        if n_axes == 3:
            drop = EARTH_RADIUS - np.sqrt(max(EARTH_RADIUS**2 - farthest**2, 0.0))
            return (
                f"{found}: there, up counts from a plane that is {drop / 1e3:.0f} km above the "
                "ground; name a nearer `site` if heights are compared"
            )
        arc = np.arcsin(min(farthest / EARTH_RADIUS, 1.0))
        short, slow = 1 - np.sin(arc) / arc, 1 - np.cos(arc)
        return (
            f"{found}: there, distances in the plane are {short:.1%} shorter than along the "
            f"ground, and speeds up to {slow:.1%} lower; name a nearer `site` if that matters"
        )

    def _cosine_of_arc(self, lat: Array, lon: Array) -> Array:
        """Cosine of the angle between the verticals of places and of the origin."""
        with np.errstate(invalid="ignore"):
            north, turn = np.radians(lat), np.radians(lon - self.lon)
            here = np.radians(self.lat)
            level = np.cos(north) * np.cos(here) * np.cos(turn)
            return np.asarray(np.sin(north) * np.sin(here) + level)


def on_the_earth(
    east: ArrayLike, north: ArrayLike, lat: ArrayLike, lon: ArrayLike, alt: ArrayLike
) -> GeodeticPlaces:
    """Places to the east and north of others, at the same height above the ellipsoid.

    Parameters
    ----------
    east, north : array_like, shape (n,)
        Components in the plane that touches the earth at the place, in m.
    lat, lon, alt : array_like, shape (n,) or numbers
        Origins in degrees and m.

    Returns
    -------
    GeodeticPlaces
        NaN where no such place lies below or above the point of the plane.

    Raises
    ------
    DataError
        If pymap3d is not installed.
    """
    pymap3d = _pymap3d()
    ellipsoid = pymap3d.Ellipsoid.from_name("wgs84")
    plane = np.stack([np.asarray(east, np.float64), np.asarray(north, np.float64)])
    to_east, to_north = np.where((np.abs(plane) > HIGHEST).any(axis=0), np.nan, plane)
    lat, lon, alt = (
        np.broadcast_to(np.asarray(v, np.float64), to_east.shape) for v in (lat, lon, alt)
    )
    vertical = axes_on_earth(lat, lon)[..., 2, :]
    # The vertical line meets an ellipsoid with longer axes, which is the surface of this height
    # to within a few centimeters; the nearer root of the quadratic, without cancellation.
    major, minor = ellipsoid.semimajor_axis + alt, ellipsoid.semiminor_axis + alt
    stretch = 1 / np.stack([major, major, minor], axis=-1)
    start = np.stack(pymap3d.enu2ecef(to_east, to_north, 0.0, lat, lon, alt), axis=-1) * stretch
    way = vertical * stretch
    square, cross = np.sum(way**2, axis=-1), np.sum(way * start, axis=-1)
    excess = np.sum(start**2, axis=-1) - 1
    with np.errstate(invalid="ignore"):
        up = -excess / (cross + np.sqrt(cross**2 - square * excess))
    for _ in range(2):
        found = pymap3d.enu2geodetic(to_east, to_north, up, lat, lon, alt)
        tilt = np.sum(axes_on_earth(found[0], found[1])[..., 2, :] * vertical, axis=-1)
        up = up - (found[2] - alt) / tilt
    found = pymap3d.enu2geodetic(to_east, to_north, up, lat, lon, alt)
    return GeodeticPlaces(*(np.asarray(value, dtype=np.float64) for value in found))


def axes_on_earth(lat: ArrayLike, lon: ArrayLike) -> Array:
    """Directions to the east, north and up of places, in coordinates that turn with the earth.

    Parameters
    ----------
    lat, lon : array_like, shape (...)
        Degrees.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        East, north and up as rows.
    """
    phi, lam = np.radians(np.asarray(lat, np.float64)), np.radians(np.asarray(lon, np.float64))
    sin, cos, sin_lon, cos_lon = np.sin(phi), np.cos(phi), np.sin(lam), np.cos(lam)
    rows = [
        [-sin_lon, cos_lon, np.zeros_like(phi)],
        [-sin * cos_lon, -sin * sin_lon, cos],
        [cos * cos_lon, cos * sin_lon, sin],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _impossible(lat: Array, lon: Array) -> Mask:
    """There is no such place; what is missing is not impossible."""
    return np.asarray((np.abs(lat) > 90) | (np.abs(lon) > 360))


def _same_shapes(**columns: Array) -> None:
    shape = columns["lat"].shape
    for name, column in columns.items():
        if column.ndim != 1 or column.shape != shape:
            raise ValueError(
                f"`{name}`: shape {column.shape}; expected one value for each plot"
                + ("" if name == "lat" else f", {shape}, as `lat` has")
            )


def _pymap3d() -> ModuleType:
    try:
        import pymap3d
    except ImportError:
        raise DataError(
            "places on earth need pymap3d, which is not installed; pip install 'fuzzytrack[geo]'"
        ) from None
    module: ModuleType = pymap3d
    return module
