"""GPX: tracks written as GPX 1.1."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from fuzzytrack.io.geo_track import GeoTrack, numbered
from fuzzytrack.io.track_text import decimals, iso_times, xml_text
from fuzzytrack.version import __version__

__all__ = ["write"]

# -------------------------------------------------------------------- writing

# Since GPX 1.1 a point has no speed and course of its own; programs agree on this extension.
_EXTENSION = "http://www.garmin.com/xmlschemas/TrackPointExtension/v2"


def write(draft: Path, tracks: Iterable[GeoTrack], name: str) -> None:
    """Write a track for each identity, and a segment for each part of it.

    Parameters
    ----------
    draft : Path
        The file; it must not exist.
    tracks : iterable of GeoTrack
        Written one by one; parts of a track follow each other.
    name : str
        Name of the file, for people.

    Notes
    -----
    A point has height, time, and an extension with speed (m/s) and course (deg), as far as they are
    known. Times without a date are not written.
    """
    with open(draft, "x", encoding="utf-8", newline="\n") as stream:
        stream.write('<?xml version="1.0" encoding="UTF-8"?>\n')
        stream.write(
            f'<gpx version="1.1" creator="fuzzytrack {__version__}"'
            f' xmlns="http://www.topografix.com/GPX/1/1" xmlns:gpxtpx="{_EXTENSION}">\n'
            f"<metadata><name>{xml_text(name)}</name></metadata>\n"
        )
        open_track = None
        for number, track in numbered(tracks):
            if number != open_track:
                if open_track is not None:
                    stream.write("</trk>\n")
                stream.write(f"<trk>\n<name>{xml_text(track.id or 'track')}</name>\n")
                open_track = number
            stream.writelines(_segment(track))
        if open_track is not None:
            stream.write("</trk>\n")
        stream.write("</gpx>\n")


def _segment(track: GeoTrack) -> Iterator[str]:
    gone = [""] * len(track)
    times = gone if track.time is None else iso_times(track.time)
    heights, speeds, courses = (
        gone if values is None else decimals(values)
        for values in (track.altitude, track.speed, track.course)
    )
    positions = zip(decimals(track.latitude), decimals(track.longitude), strict=True)
    rows = zip(positions, heights, times, speeds, courses, strict=True)
    yield "<trkseg>\n"
    for (latitude, longitude), height, time, speed, course in rows:
        motion = _element("gpxtpx:speed", speed) + _element("gpxtpx:course", course)
        extension = _element("gpxtpx:TrackPointExtension", motion)
        yield (
            f'<trkpt lat="{latitude}" lon="{longitude}">'
            f"{_element('ele', height)}{_element('time', time)}"
            f"{_element('extensions', extension)}</trkpt>\n"
        )
    yield "</trkseg>\n"


def _element(name: str, content: str) -> str:
    """Element of XML; nothing if it would be empty."""
    return f"<{name}>{content}</{name}>" if content else ""
