"""GeoJSON of tracks (RFC 7946): a feature for each, cut where it crosses the date line."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.io.date_line import cut_at_date_line
from fuzzytrack.io.geo_track import COLORS, GeoTrack, numbered
from fuzzytrack.io.track_text import iso_times, unicode_text

__all__ = ["write"]


def write(draft: Path, tracks: Iterable[GeoTrack], name: str) -> None:
    """Write a FeatureCollection with a feature for each track.

    Parameters
    ----------
    draft : Path
        The file; it must not exist.
    tracks : iterable of GeoTrack
        Written one by one.
    name : str
        Name of the collection.

    Notes
    -----
    A track is a LineString; a MultiLineString where it crosses the date line, cut there; a Point if
    it has a single position; a feature without geometry if it has none. Its properties ``times``
    (ISO 8601), ``speeds`` (m/s) and ``courses`` (deg) are nested as its coordinates, null where
    unknown. A cut has a time, interpolated, but neither speed nor course. ``stroke`` is a color.
    """
    with open(draft, "x", encoding="utf-8", newline="\n") as stream:
        stream.write(f'{{"type": "FeatureCollection", "name": {_json(name)}, "features": [')
        mark = "\n"
        for number, track in numbered(tracks):
            stream.write(mark + _json(_feature(track, number)))
            mark = ",\n"
        stream.write("\n]}\n")


def _json(value: Any) -> str:
    return unicode_text(json.dumps(value, ensure_ascii=False, allow_nan=False))


def _feature(track: GeoTrack, number: int) -> dict[str, Any]:
    color = "#{:02x}{:02x}{:02x}".format(*COLORS[number % len(COLORS)])
    parts = _parts(track)
    kind = "MultiLineString" if len(parts) > 1 else "LineString"
    if len(track) == 1:
        kind = "Point"

    def nested(values: list[list[Any]]) -> Any:
        """A list for each part, one list, or a single value: as the geometry has coordinates."""
        if kind == "MultiLineString":
            return values
        whole = values[0] if values else []
        return whole[0] if kind == "Point" else whole

    geometry = None
    if parts:
        geometry = {"type": kind, "coordinates": nested([part.coordinates for part in parts])}
    properties: dict[str, Any] = {"id": track.id, "segment": track.segment, "stroke": color}
    for key, given, values in (
        ("times", track.time, [part.times for part in parts]),
        ("speeds", track.speed, [part.speeds for part in parts]),
        ("courses", track.course, [part.courses for part in parts]),
    ):
        if given is not None:
            properties[key] = nested(values)
    return {"type": "Feature", "properties": properties, "geometry": geometry}


@dataclass(frozen=True)
class _Part:
    """The part of a track between two crossings of the date line, as lists for JSON."""

    coordinates: list[list[float]]
    times: list[str]
    speeds: list[float | None]
    courses: list[float | None]


def _parts(track: GeoTrack) -> list[_Part]:
    """Parts of a track, none if it has no positions."""
    return [_part(track, rows, longitude) for rows, longitude in cut_at_date_line(track.longitude)]


def _part(track: GeoTrack, rows: Array, longitude: Array) -> _Part:
    columns = [longitude, _between(track.latitude, rows)]
    if track.altitude is not None:
        columns.append(_between(track.altitude, rows))
    return _Part(
        np.stack(columns, axis=1).tolist(),
        _times(track.time, rows),
        _at_rows(track.speed, rows),
        _at_rows(track.course, rows),
    )


# -------------------------------------------------------------------- rows and crossings


def _between(values: Array, rows: Array) -> Array:
    """Values at rows, linear between two."""
    found = np.interp(rows, np.arange(len(values)), values)
    whole = rows == np.floor(rows)
    # The last bit of interpolated values may differ.
    found[whole] = values[rows[whole].astype(np.int64)]
    return found


def _times(times: NDArray[np.datetime64] | None, rows: Array) -> list[str]:
    if times is None:
        return []
    before = np.floor(rows).astype(np.int64)
    after = np.minimum(before + 1, len(times) - 1)
    span = (times[after] - times[before]).astype(np.int64)
    shift = np.round((rows - before) * span).astype(np.int64).astype("timedelta64[ns]")
    return iso_times(times[before] + shift)


def _at_rows(values: Array | None, rows: Array) -> list[float | None]:
    """Values at rows, None between two and where unknown."""
    if values is None:
        return []
    found = values[np.floor(rows).astype(np.int64)]
    known = (rows == np.floor(rows)) & ~np.isnan(found)
    return [
        value if good else None for value, good in zip(found.tolist(), known.tolist(), strict=True)
    ]
