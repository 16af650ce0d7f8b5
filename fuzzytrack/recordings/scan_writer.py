"""Tracks of a scan tracker written to a file: tables, formats of maps, ASTERIX."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.errors import DataError
from fuzzytrack.io import motion
from fuzzytrack.io.cat062 import SUFFIXES, SystemTracks, is_cat062, write_blocks
from fuzzytrack.io.files import PathLike, check_output, whole_file
from fuzzytrack.io.formats import PARQUET, check_table, table_writer
from fuzzytrack.io.geo_track import GeoTrack
from fuzzytrack.io.track_formats import TRACK_SUFFIXES, check_geo_tracks, is_geo, write_geo_tracks
from fuzzytrack.recordings.scan_table import ScanTable
from fuzzytrack.scan.track_reports import STATUSES, TrackReports

__all__ = ["check_scan_tracks", "scan_writer"]

#: Takes the group and the reports of some scans of it.
WriteReports = Callable[[str, TrackReports], None]

# Numbers of tracks in ASTERIX: 16 bits, 0 left free.
_NUMBERS = 2**16 - 1


def check_scan_tracks(path: PathLike, table: ScanTable, inputs: tuple[PathLike, ...] = ()) -> None:
    """Check that tracks can be written, before the work is done.

    Parameters
    ----------
    path : str or path
        The file; it need not exist.
    table : ScanTable
        Its columns, and what is known of places and times.
    inputs : tuple of str or path
        Files that must not be overwritten.

    Raises
    ------
    DataError
        If the suffix is unknown, the format needs places on the earth or dates and there are none,
        it has no columns to be chosen, or the file is one of the inputs.
    OSError
        If the file cannot be written.
    """
    if is_geo(path):
        check_geo_tracks(
            path, inputs, on_earth=table.frame is not None, dated=table.epoch is not None
        )
    elif is_cat062(path):
        check_output(path, inputs)
    else:
        check_table(path, inputs, others=(*TRACK_SUFFIXES, *SUFFIXES))
        return
    if table.names != table.all_names:
        raise DataError(f"{path}: output_columns: only tables have columns; write .csv or .parquet")


@contextmanager
def scan_writer(
    path: PathLike,
    table: ScanTable,
    inputs: tuple[PathLike, ...] = (),
    *,
    quote_formulas: bool = False,
) -> Iterator[WriteReports]:
    """Write tracks scan by scan; the file appears whole or not at all.

    Parameters
    ----------
    path : str or path
        CSV or Parquet by its suffix; ``.geojson``, ``.kml``, ``.czml`` or ``.gpx`` for tracks on
        the earth; ``.ast`` or ``.cat062`` for ASTERIX of category 062.
    table : ScanTable
    inputs : tuple of str or path
        Files that must not be overwritten.
    quote_formulas : bool
        As for `fuzzytrack.io.table_writer`.

    Yields
    ------
    callable
        To be called with a group and with reports of it.

    Raises
    ------
    DataError, OSError
        As `check_scan_tracks`.

    Notes
    -----
    The rows of formats of maps are held in memory until the end; the others are written as they
    come.
    """
    check_scan_tracks(path, table, inputs)
    if is_geo(path):
        tracks = _GeoReports(table)
        yield tracks.add
        write_geo_tracks(path, tracks.tracks(), inputs)
    elif is_cat062(path):
        with whole_file(path, inputs) as draft, open(draft, "wb") as stream:
            yield _SystemReports(stream, table).add
    else:
        typed = Path(path).suffix.lower() in PARQUET
        types = table.types(typed=typed)
        with table_writer(path, types, inputs, quote_formulas=quote_formulas) as write:
            yield lambda group, reports: write(table.values(group, reports, typed=typed))


class _GeoReports:
    """Reports put together as tracks on the earth."""

    def __init__(self, table: ScanTable) -> None:
        self._table = table
        self._parts: list[tuple[str, TrackReports]] = []

    def add(self, group: str, reports: TrackReports) -> None:
        self._parts.append((group, reports))

    def tracks(self) -> Iterator[GeoTrack]:
        """All tracks, those of each group in the order of their identities."""
        for group in dict.fromkeys(group for group, _ in self._parts):
            mine = TrackReports.joined([part for name, part in self._parts if name == group])
            order = np.lexsort((mine.time, mine.track_id))
            mine = mine.where(order)
            # A track has one position at a time.
            same = (np.diff(mine.track_id) == 0) & (np.diff(mine.time) <= 0)
            mine = mine.where(np.append(True, ~same)[: len(mine)])
            for start, end in _runs(mine.track_id):
                yield self._track(group, mine.where(np.arange(start, end)))

    def _track(self, group: str, reports: TrackReports) -> GeoTrack:
        table = self._table
        place, velocity = table.places(reports), table.to_east_and_north(reports.velocity)
        id = str(reports.track_id[0])
        return GeoTrack(
            id=f"{group}/{id}" if group else id,
            latitude=place[:, 0],
            longitude=place[:, 1],
            time=table.dates(reports.time) if table.epoch is not None else None,
            speed=motion.speed(velocity),
            course=motion.course(velocity),
        )


def _runs(codes: NDArray[np.int64]) -> Iterator[tuple[int, int]]:
    """Starts and ends of runs of equal numbers."""
    cuts = (np.flatnonzero(np.diff(codes)) + 1).tolist()
    if len(codes):
        yield from zip([0, *cuts], [*cuts, len(codes)], strict=True)


class _SystemReports:
    """Reports written as ASTERIX.

    Holds a number for each track so far: when it was first written.
    """

    def __init__(self, stream: BinaryIO, table: ScanTable) -> None:
        self._stream, self._table = stream, table
        self._begun: dict[int, float] = {}

    def add(self, _group: str, reports: TrackReports) -> None:
        table = self._table
        ids, times = reports.track_id.tolist(), reports.time.tolist()
        first = np.array([id not in self._begun for id in ids], dtype=bool)
        begun = [self._begun.setdefault(id, time) for id, time in zip(ids, times, strict=True)]
        place = table.places(reports) if table.frame is not None else None
        deviation = np.column_stack(
            [
                table.to_east_and_north(reports.deviation[:, :2]),
                table.to_east_and_north(reports.deviation[:, 2:]),
            ]
        )
        tracks = SystemTracks(
            table.time_of_day(reports.time),
            (reports.track_id - 1) % _NUMBERS + 1,
            table.to_east_and_north(reports.position),
            table.to_east_and_north(reports.velocity),
            deviation,
            reports.status == STATUSES.index("tentative"),
            reports.status == STATUSES.index("coasting"),
            first,
            reports.time - np.array(begun, dtype=np.float64),
            reports.since_last,
            place,
        )
        write_blocks(self._stream, tracks)
