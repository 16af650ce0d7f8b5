"""KML of tracks: KML 2.2 with the tracks of Google's extension, which Google Earth plays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from fuzzytrack.arrays import Array
from fuzzytrack.io.geo_track import COLORS, GeoTrack, check_dates, numbered
from fuzzytrack.io.track_text import decimals, iso_times, xml_text

__all__ = ["write"]

# Columns of numbers beside the positions: name, unit.
_COLUMNS = (("speed", "m/s"), ("course", "deg"))


def write(draft: Path, tracks: Iterable[GeoTrack], name: str) -> None:
    """Write a document with a placemark for each track.

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
    A ``gx:Track`` with speed and course as arrays, empty where unknown. Heights are absolute;
    without them a track lies on the ground.
    """
    with open(draft, "x", encoding="utf-8", newline="\n") as stream:
        stream.write('<?xml version="1.0" encoding="UTF-8"?>\n')
        stream.write(
            '<kml xmlns="http://www.opengis.net/kml/2.2"'
            ' xmlns:gx="http://www.google.com/kml/ext/2.2">\n'
            f"<Document>\n<name>{xml_text(name)}</name>\n"
        )
        stream.writelines(_styles())
        stream.write('<Schema id="motion">\n')
        for column, unit in _COLUMNS:
            stream.write(
                f'<gx:SimpleArrayField name="{column}" type="float">'
                f"<displayName>{column} ({unit})</displayName></gx:SimpleArrayField>\n"
            )
        stream.write("</Schema>\n")
        for number, track in numbered(tracks):
            stream.writelines(_placemark(track, number))
        stream.write("</Document>\n</kml>\n")


def _styles() -> Iterator[str]:
    for number, (red, green, blue) in enumerate(COLORS):
        color = f"<color>ff{blue:02x}{green:02x}{red:02x}</color>"
        yield (
            f'<Style id="color{number}"><IconStyle>{color}<scale>0.6</scale></IconStyle>'
            f"<LabelStyle>{color}</LabelStyle>"
            f"<LineStyle>{color}<width>2</width></LineStyle></Style>\n"
        )


def _placemark(track: GeoTrack, number: int) -> Iterator[str]:
    times = check_dates(track, "KML")
    yield f"<Placemark>\n<name>{xml_text(track.title)}</name>\n"
    yield f"<styleUrl>#color{number % len(COLORS)}</styleUrl>\n<gx:Track>\n"
    grounded = track.altitude is None
    yield f"<altitudeMode>{'clampToGround' if grounded else 'absolute'}</altitudeMode>\n"
    for time in iso_times(times):
        yield f"<when>{time}</when>\n"
    heights = ["0"] * len(track) if track.altitude is None else decimals(track.altitude)
    positions = zip(decimals(track.longitude), decimals(track.latitude), heights, strict=True)
    for longitude, latitude, height in positions:
        yield f"<gx:coord>{longitude} {latitude} {height}</gx:coord>\n"
    yield from _extended_data(track)
    yield "</gx:Track>\n</Placemark>\n"


def _extended_data(track: GeoTrack) -> Iterator[str]:
    columns: list[tuple[str, Array]] = [
        (column, values) for column, _ in _COLUMNS if (values := getattr(track, column)) is not None
    ]
    if not columns:
        return
    yield '<ExtendedData>\n<SchemaData schemaUrl="#motion">\n'
    for column, values in columns:
        yield f'<gx:SimpleArrayData name="{column}">\n'
        for number in decimals(values):
            yield f"<gx:value>{number}</gx:value>\n"
        yield "</gx:SimpleArrayData>\n"
    yield "</SchemaData>\n</ExtendedData>\n"
