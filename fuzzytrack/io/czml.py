"""CZML of tracks: JSON that Cesium plays, with a packet for each track."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.io.geo_track import COLORS, GeoTrack, check_dates, numbered
from fuzzytrack.io.track_text import iso_times, seconds_since, unicode_text

__all__ = ["write"]


def write(draft: Path, tracks: Iterable[GeoTrack], name: str) -> None:
    """Write a document with a packet for each track.

    Parameters
    ----------
    draft : Path
        The file; it must not exist.
    tracks : iterable of GeoTrack
        Written one by one.
    name : str
        Name of the document.

    Raises
    ------
    DataError
        If the times have no date.

    Notes
    -----
    A packet has the position as seconds since its epoch with longitude, latitude and height, and
    the properties ``speed`` (m/s) and ``course`` (deg) at the times at which they are known. Since
    Cesium interpolates linearly, courses continue beyond 360 and below 0 where a track passes
    north. Without heights a track is at height 0.
    """
    with open(draft, "x", encoding="utf-8", newline="\n") as stream:
        stream.write(f"[\n{_json({'id': 'document', 'name': name, 'version': '1.0'})}")
        for number, track in numbered(tracks):
            stream.write(",\n" + _json(_packet(track, number)))
        stream.write("\n]\n")


def _json(value: Any) -> str:
    return unicode_text(json.dumps(value, ensure_ascii=False, allow_nan=False))


def _packet(track: GeoTrack, number: int) -> dict[str, Any]:
    times = check_dates(track, "CZML")
    # No two packets may share an id, and "document" has another meaning.
    packet: dict[str, Any] = {"id": f"track/{track.id}/{track.segment}", "name": track.title}
    if not len(track):
        return packet
    first, *_, last = iso_times(times[[0, -1]])
    seconds = seconds_since(times)
    height = np.zeros(len(track)) if track.altitude is None else track.altitude
    color = {"rgba": [*COLORS[number % len(COLORS)], 255]}
    packet["availability"] = f"{first}/{last}"
    packet["position"] = {
        "epoch": first,
        "cartographicDegrees": _flat(seconds, track.longitude, track.latitude, height),
    }
    packet["point"] = {"pixelSize": 8, "color": color}
    packet["path"] = {"width": 2, "material": {"solidColor": {"color": color}}}
    if track.altitude is None:
        packet["point"]["heightReference"] = {"heightReference": "CLAMP_TO_GROUND"}
    properties = {}
    for name, values in (("speed", track.speed), ("course", track.course)):
        if values is not None and not np.isnan(values).all():
            known = ~np.isnan(values)
            numbers = values[known]
            if name == "course":
                numbers = np.unwrap(numbers, period=360)
            properties[name] = {"epoch": first, "number": _flat(seconds[known], numbers)}
    if properties:
        packet["properties"] = properties
    return packet


def _flat(*columns: Array) -> list[float]:
    """Numbers row by row."""
    numbers: list[float] = np.stack(columns, axis=1).ravel().tolist()
    return numbers
