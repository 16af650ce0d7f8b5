"""Tracks on the earth, as the formats of maps take them: GeoJSON, KML, CZML and GPX."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.reprs import summary

__all__ = ["COLORS", "GeoTrack", "check_dates", "numbered"]

#: Colors of tracks in a map (red, green, blue), which people of all kinds of sight can tell apart:
#: those of Okabe and Ito (2008) but black and yellow, which maps have too.
COLORS = (
    (0, 114, 178),
    (213, 94, 0),
    (0, 158, 115),
    (204, 121, 167),
    (230, 159, 0),
    (86, 180, 233),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class GeoTrack:
    """A track on the earth, or the part of one between two long gaps.

    Parameters
    ----------
    id : str
        Identity of the track; empty if it has none.
    latitude, longitude : ndarray, shape (n_steps,)
        Position (deg), WGS 84; NaN where it is not known.
    time : ndarray of datetime64, shape (n_steps,), optional
        Times (UTC), increasing; without them the recording has times without a date.
    altitude : ndarray, shape (n_steps,), optional
        Height (m), NaN where it is not known.
    speed : ndarray, shape (n_steps,), optional
        Speed over ground (m/s), NaN where it is not known.
    course : ndarray, shape (n_steps,), optional
        Direction of motion (deg), clockwise from north, NaN where it is not known.
    segment : int
        Which part of the track it is, counted from 0.

    Raises
    ------
    ValueError
        If shapes differ, a number is infinite, a latitude is beyond ±90, or times do not increase.
    """

    id: str
    latitude: Array
    longitude: Array
    time: NDArray[np.datetime64] | None = None
    altitude: Array | None = None
    speed: Array | None = None
    course: Array | None = None
    segment: int = 0

    def __post_init__(self) -> None:
        shape = np.shape(self.latitude)
        for name in ("latitude", "longitude", "altitude", "speed", "course"):
            value = getattr(self, name)
            if value is None:
                continue
            values = np.asarray(value, dtype=np.float64)
            if values.ndim != 1 or values.shape != shape:
                raise ValueError(f"{name}: shape {values.shape}; expected {shape}, of one axis")
            if np.isinf(values).any():
                raise ValueError(f"{name}: holds infinite values; NaN stands for an unknown one")
            object.__setattr__(self, name, values)
        beyond = np.abs(self.latitude) > 90
        if beyond.any():
            value = self.latitude[np.argmax(beyond)]
            raise ValueError(f"latitude: {value:g}; expected degrees from -90 to 90")
        if self.time is not None:
            times = np.asarray(self.time).astype("datetime64[ns]")
            if times.shape != shape:
                raise ValueError(f"time: shape {times.shape}; expected {shape}")
            known = times[~np.isnat(times)]
            if (known[1:] <= known[:-1]).any():
                raise ValueError("time: does not increase; give each track in order of time")
            object.__setattr__(self, "time", times)

    def __repr__(self) -> str:
        return summary(self, "id", "segment", "latitude")

    def __len__(self) -> int:
        """Number of times, with and without a position."""
        return len(self.latitude)

    @property
    def title(self) -> str:
        """Name for people: the identity, and which part of the track it is if not the first."""
        name = self.id or "track"
        return f"{name} ({self.segment + 1})" if self.segment else name

    def known(self) -> GeoTrack:
        """The same without the rows that lack a coordinate or time, and longitudes below 180."""
        good = ~(np.isnan(self.latitude) | np.isnan(self.longitude))
        if self.altitude is not None:
            good &= ~np.isnan(self.altitude)
        if self.time is not None:
            good &= ~np.isnat(self.time)
        longitude = self.longitude[good]
        # Only those beyond: the others keep their last bit.
        beyond = (longitude < -180) | (longitude >= 180)
        longitude[beyond] = (longitude[beyond] + 180) % 360 - 180

        def kept(values: NDArray[Any] | None) -> Any:
            return None if values is None else values[good]

        return GeoTrack(
            id=self.id,
            latitude=self.latitude[good],
            longitude=longitude,
            time=kept(self.time),
            altitude=kept(self.altitude),
            speed=kept(self.speed),
            course=kept(self.course),
            segment=self.segment,
        )


def numbered(tracks: Iterable[GeoTrack]) -> Iterator[tuple[int, GeoTrack]]:
    """Tracks with numbers from 0 on; parts of a track that follow each other have the same."""
    number, last = -1, None
    for track in tracks:
        number += track.id != last
        last = track.id
        yield number, track.known()


def check_dates(track: GeoTrack, format: str) -> NDArray[np.datetime64]:
    """Times of a track for a format that needs them.

    Parameters
    ----------
    track : GeoTrack
    format : str
        Name of the format, for the message.

    Raises
    ------
    DataError
        If the times have no date.
    """
    if track.time is None:
        raise DataError(
            f"{format} needs the date of every plot, and these times have none; "
            "give times with a date, or write .geojson or .gpx"
        )
    return track.time
