"""GPX: the points of its tracks, read part by part; tracks written as GPX 1.1."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.parsers import expat

from fuzzytrack.errors import DataError
from fuzzytrack.io.byte_stream import ByteStream, open_bytes
from fuzzytrack.io.description import PlotDescription
from fuzzytrack.io.geo_track import GeoTrack, numbered
from fuzzytrack.io.readers import Reader
from fuzzytrack.io.record_source import Losses, RecordSource, Row
from fuzzytrack.io.track_text import decimals, iso_times, xml_text
from fuzzytrack.numerals import as_number
from fuzzytrack.version import __version__

__all__ = ["Gpx", "write"]

# -------------------------------------------------------------------- reading

_TYPES = {
    "time": "text",
    "id": "text",
    "segment": "number",
    "lat": "number",
    "lon": "number",
    "ele": "number",
}
_BYTES = 1 << 16
# Longest text of an element that is kept.
_TEXT = 1_000


class Gpx(Reader):
    """Reads the points of GPX tracks, with the standard library: nothing is installed for it.

    Notes
    -----
    The file is never held as a whole. A file with a document type, which may define entities that
    grow without limit, is refused.
    """

    suffixes = (".gpx",)

    @contextmanager
    def open_source(self, file: str) -> Iterator[RecordSource]:
        """Open a file.

        Raises
        ------
        DataError
            If it has a document type, or no point of a track with a time, also later, while it is
            read.
        OSError
            If it cannot be read.
        """
        with open_bytes(file) as stream:
            losses = Losses()
            description = PlotDescription(time="time", id="id", geodetic=("lat", "lon"), wrap=None)
            rows = _rows(stream, losses)
            yield RecordSource(stream, _TYPES, description, rows, losses)


def _rows(stream: ByteStream, losses: Losses) -> Iterator[Row]:
    points = _Points(stream.file, losses)
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartDoctypeDeclHandler = points.refuse
    parser.StartElementHandler = points.start
    parser.EndElementHandler = points.end
    parser.CharacterDataHandler = points.text
    points.line = lambda: parser.CurrentLineNumber
    count = 0
    last = False
    while not last:
        part = stream.take(_BYTES)
        last = not part
        try:
            parser.Parse(part, last)
        except DataError:
            raise
        except (expat.ExpatError, ValueError, LookupError) as error:
            # What stands before it is right: a recorder may have been switched off.
            losses.say(f"left out: what is no XML, and all that follows: {error}")
            last = True
        for row in points.found:
            count += 1
            yield count, row
        points.found.clear()


class _Points:
    """What the parser tells, made into points.

    Attributes
    ----------
    found : list of tuple
        Points that are complete.
    """

    def __init__(self, file: str, losses: Losses) -> None:
        self.found: list[tuple[object, ...]] = []
        self.line: Callable[[], int] = lambda: 0
        self._file, self._losses = file, losses
        self._path: list[str] = []
        self._text: list[str] = []
        self._length = 0
        self._ids: set[str] = set()
        self._number = 0
        self._id = ""
        self._segment = 0
        self._point: dict[str, str] = {}

    def refuse(self, *_: object) -> None:
        """Refuse a document type."""
        raise DataError(
            f"{self._file}: line {self.line()}: has a document type (DOCTYPE), which no GPX needs "
            "and which can define endless entities; remove it"
        )

    def start(self, name: str, attributes: dict[str, str]) -> None:
        """Begin of an element."""
        name = name.rpartition(":")[2]
        self._path.append(name)
        self._text, self._length = [], 0
        if name == "trk":
            self._number += 1
            self._id, self._segment = "", 0
        elif name == "trkseg":
            self._segment += 1
        elif name == "trkpt":
            self._point = {key: attributes.get(key, "") for key in ("lat", "lon")}

    def text(self, data: str) -> None:
        """Text of an element."""
        if self._length < _TEXT:
            self._text.append(data[:_TEXT])
            self._length += len(data)

    def end(self, _: str) -> None:
        """End of an element."""
        name = self._path.pop()
        parent = self._path[-1] if self._path else ""
        text = "".join(self._text).strip()
        self._text, self._length = [], 0
        if name == "trkpt":
            self._take()
        elif parent == "trkpt" and name in ("time", "ele"):
            self._point[name] = text
        elif parent == "trk" and name == "name" and not self._id:
            self._id = self._unique(text)
        elif name in ("rtept", "wpt"):
            what = "points of routes" if name == "rtept" else "waypoints"
            self._losses.add(what, f"line {self.line()}")

    def _unique(self, name: str) -> str:
        """Identity of the track: its name or number, with another number if it is taken."""
        name = name or str(self._number)
        found, count = name, 1
        while found in self._ids:
            count += 1
            found = f"{name} ({count})"
        self._ids.add(found)
        return found

    def _take(self) -> None:
        place = f"line {self.line()}"
        lat, lon, ele = (_number(self._point.get(key, "")) for key in ("lat", "lon", "ele"))
        time = self._point.get("time", "")
        # Comparisons with NaN are false.
        if not (abs(lat) <= 90.0 and abs(lon) <= 360.0):
            self._losses.add("points of tracks whose latitude or longitude is none", place)
        elif not time:
            self._losses.add("points of tracks without a time", place)
        else:
            self._id = self._id or self._unique("")
            self.found.append((time, self._id, self._segment, lat, lon, ele))


def _number(text: str) -> float:
    """Number of a text; NaN if it is none."""
    value = as_number(text)
    return math.nan if value is None else value


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
