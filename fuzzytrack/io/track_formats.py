"""Formats of maps, in which tracks on the earth are written: their list, and the writer."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from fuzzytrack.errors import DataError
from fuzzytrack.io.files import PathLike, check_output, whole_file

if TYPE_CHECKING:
    from fuzzytrack.io.geo_track import GeoTrack

__all__ = ["TRACK_SUFFIXES", "TrackFormat", "check_geo_tracks", "is_geo", "write_geo_tracks"]


class TrackFormat(Protocol):
    """What a module of this package offers for a format of maps."""

    def write(self, draft: Path, tracks: Iterable[GeoTrack], name: str, /) -> None:
        """Write a file that does not exist yet, track by track."""


# The modules of this package that write the formats, by suffix; each is imported when it is used.
_FORMATS = {".geojson": "geojson", ".kml": "kml", ".czml": "czml", ".gpx": "gpx"}

# Those in which every position has a date and time.
_DATED = {".kml": "KML", ".czml": "CZML"}

#: Suffixes of files of tracks on the earth.
TRACK_SUFFIXES = tuple(_FORMATS)


def is_geo(path: PathLike) -> bool:
    """Whether a file, by its suffix, is one of tracks on the earth.

    Parameters
    ----------
    path : str or path
    """
    return Path(path).suffix.lower() in _FORMATS


def check_geo_tracks(
    path: PathLike, inputs: tuple[PathLike, ...] = (), *, on_earth: bool = True, dated: bool = True
) -> None:
    """Check that tracks can be written, before the work is done.

    Parameters
    ----------
    path : str or path
        The file to be written, of a suffix in `TRACK_SUFFIXES`; it need not exist.
    inputs : tuple of str or path
        Files that must not be overwritten.
    on_earth : bool
        Whether it is known where on the earth the tracks are.
    dated : bool
        Whether their times have a date.

    Raises
    ------
    DataError
        If the tracks lack what the format needs, or the file is one of the inputs.
    OSError
        If the file cannot be written.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in _FORMATS:
        raise DataError(f"{path}: cannot write {suffix or 'without suffix'}; {_listed()}")
    if not on_earth:
        raise DataError(
            f"{path}: {suffix} needs positions on the earth; name the columns of latitude and "
            "longitude (`geodetic`), or the position of the sensor (`site`), or write .csv"
        )
    if suffix in _DATED and not dated:
        raise DataError(
            f"{path}: {_DATED[suffix]} needs the date of every plot, and these times have none; "
            "give times with a date, or write .geojson, .gpx or .csv"
        )
    check_output(path, inputs)


def write_geo_tracks(
    path: PathLike,
    tracks: Iterable[GeoTrack],
    inputs: tuple[PathLike, ...] = (),
    *,
    name: str | None = None,
) -> None:
    """Write tracks on the earth, whole or not at all.

    Parameters
    ----------
    path : str or path
        GeoJSON, KML, CZML or GPX by its suffix: ``.geojson``, ``.kml``, ``.czml`` or ``.gpx``.
    tracks : iterable of GeoTrack
        Written one by one, so that they need not fit into memory. Parts of a track follow each
        other. Rows without a position are left out.
    inputs : tuple of str or path
        Files that must not be overwritten.
    name : str, optional
        Name of the whole, for people; that of the file, without its suffix, unless given.

    Raises
    ------
    DataError
        If the suffix is unknown, the file is one of the inputs, or the format needs dates and the
        times have none.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import numpy as np
    >>> from fuzzytrack.io import GeoTrack, write_geo_tracks
    >>> track = GeoTrack(
    ...     id="ferry",
    ...     time=np.array(["2024-05-01T12:00:00", "2024-05-01T12:00:10"], "datetime64[ns]"),
    ...     latitude=np.array([63.43, 63.431]),
    ...     longitude=np.array([10.39, 10.391]),
    ... )
    >>> write_geo_tracks("ferry.kml", [track])
    """
    check_geo_tracks(path, inputs)
    suffix = Path(path).suffix.lower()
    with whole_file(path, inputs) as draft:
        format: TrackFormat = import_module(f"fuzzytrack.io.{_FORMATS[suffix]}")
        format.write(draft, tracks, Path(path).stem if name is None else name)


def _listed() -> str:
    return f"{', '.join(TRACK_SUFFIXES[:-1])} or {TRACK_SUFFIXES[-1]}"
