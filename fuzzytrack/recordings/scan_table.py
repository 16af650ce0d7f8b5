"""The table of the tracks of a scan tracker: its columns, and their values."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io import motion
from fuzzytrack.io.column_names import plain_name
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.table import Words
from fuzzytrack.io.times import Clock
from fuzzytrack.scan.track_reports import KINDS, STATUSES, TrackReports
from fuzzytrack.yamltree import suggestion

if TYPE_CHECKING:
    from fuzzytrack.io.geodetic import LocalFrame

__all__ = ["ScanTable"]

_NANOSECONDS = 1e9
# Words at the beginning and end of a name that say north and east.
_NORTH, _EAST = ("north", "n", "northing"), ("east", "e", "easting")


@dataclass(frozen=True)
class ScanTable:
    """Which columns the table of tracks has.

    Attributes
    ----------
    axes : tuple of str
        Names of the two coordinates.
    clock : Clock
        How times are written.
    group : str
        Column of the recordings; empty if there is one recording only.
    time : str
        Name of the column of time in the recording, which means ``t``, too.
    frame : LocalFrame or None
        Where on the earth the positions are, if that is known.
    chosen : tuple of (str, str)
        Columns that are written, each with its name in the file; empty for all.
    """

    axes: tuple[str, str]
    clock: Clock
    group: str = ""
    time: str = "t"
    frame: LocalFrame | None = None
    chosen: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(
        cls, decoder: PlotDecoder, group: str = "", output_columns: Sequence[str] | None = None
    ) -> ScanTable:
        """Table of the tracks of a recording.

        Parameters
        ----------
        decoder : PlotDecoder
            How it is read.
        group : str
            Column of the recordings in one file.
        output_columns : sequence of str, optional
            Columns that are written, in this order: their names, or ``NEW=NAME``. The name of the
            column of time in the recording is ``t`` under that name. All unless given.

        Raises
        ------
        DataError
            If there is no such column, or two have one name.
        """
        x, y = decoder.columns.axes[:2]
        table = cls((x, y), decoder.clock, group, decoder.columns.time, decoder.frame)
        names = table.all_names
        chosen = []
        for text in output_columns or names:
            new, _, old = text.rpartition("=")
            old = "t" if old == table.time and old not in names else old
            if old not in names:
                known = list(dict.fromkeys((*names, table.time)))
                raise DataError(f"output_columns: no column {old!r}{suggestion(old, known)}")
            chosen.append((old, new or (text if text == table.time else old)))
        written = [new for _, new in chosen]
        doubled = [name for name in written if written.count(name) > 1]
        if doubled:
            raise DataError(
                f"output_columns: two columns of the output would be {doubled[0]!r}; give one of "
                "them another name, as in NEW=NAME"
            )
        return cls(table.axes, table.clock, group, table.time, table.frame, tuple(chosen))

    @property
    def all_names(self) -> tuple[str, ...]:
        """Names of all columns that there can be."""
        x, y = self.axes
        return (
            *filter(None, [self.group]),
            *("t", "track_id", x, y, f"{x}_velocity", f"{y}_velocity", "speed", "course"),
            *(f"{x}_sd", f"{y}_sd", f"{x}_velocity_sd", f"{y}_velocity_sd"),
            *(("latitude", "longitude") if self.frame is not None else ()),
            *("status", "kind", "existence", "since_last", "plot"),
        )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns that are written."""
        return tuple(new for _, new in self._pairs)

    @property
    def _pairs(self) -> tuple[tuple[str, str], ...]:
        """Columns that are written, and their names in the file."""
        return self.chosen or tuple((name, name) for name in self.all_names)

    @property
    def epoch(self) -> int | None:
        """Time 0 of the recording (ns since 1970), if its times are dates."""
        return self.clock.origin if self.clock.dated else None

    @property
    def north_first(self) -> bool:
        """Whether the coordinates are north and east by their names, rather than east and north."""
        words = [plain_name(axis)[0].split("_") for axis in self.axes]
        return bool({words[0][0], words[0][-1]} & {*_NORTH}) and bool(
            {words[1][0], words[1][-1]} & {*_EAST}
        )

    def to_east_and_north(self, pairs: Array) -> Array:
        """Pairs of coordinates as those to the east and north."""
        return pairs[:, ::-1] if self.north_first else pairs

    def values(self, group: str, reports: TrackReports, *, typed: bool) -> dict[str, Any]:
        """Columns of some rows.

        Parameters
        ----------
        group : str
            Which recording they are of.
        reports : TrackReports
        typed : bool
            Whether dates are datetime64 rather than text.
        """
        (x, y), n = self.axes, len(reports)
        velocity = self.to_east_and_north(reports.velocity)
        values: dict[str, Any] = {self.group: Words.same(group, n)} if self.group else {}
        values |= {"t": self.times(reports.time, typed=typed), "track_id": reports.track_id}
        for k, axis in enumerate((x, y)):
            values[axis] = reports.position[:, k]
            values[f"{axis}_velocity"] = reports.velocity[:, k]
            values[f"{axis}_sd"] = reports.deviation[:, k]
            values[f"{axis}_velocity_sd"] = reports.deviation[:, 2 + k]
        values |= {"speed": motion.speed(velocity), "course": motion.course(velocity)}
        if self.frame is not None:
            place = self.places(reports)
            values |= {"latitude": place[:, 0], "longitude": place[:, 1]}
        values |= {
            "status": Words(STATUSES, reports.status.astype(np.int64)),
            "kind": Words(KINDS, reports.kind.astype(np.int64)),
            "existence": reports.existence,
            "since_last": reports.since_last,
            "plot": reports.plot,
        }
        return {new: values[old] for old, new in self._pairs}

    def places(self, reports: TrackReports) -> Array:
        """Latitude and longitude (deg) of positions, shape (n, 2)."""
        assert self.frame is not None
        found = self.frame.to_geodetic(self.to_east_and_north(reports.position))
        return np.column_stack([found.lat, found.lon])

    def types(self, *, typed: bool) -> dict[str, str]:
        """Types of the columns; see `fuzzytrack.io.table_writer`."""
        times = self.times(np.empty(0), typed=typed)
        of = dict.fromkeys(self.all_names, "float64")
        of |= dict.fromkeys(filter(None, [self.group, "status", "kind"]), "string")
        of |= dict.fromkeys(("track_id", "plot"), "int64")
        of["t"] = times.dtype.name if isinstance(times, np.ndarray) else "string"
        return {new: of[old] for old, new in self._pairs}

    def times(self, seconds: Array, *, typed: bool) -> Sequence[str] | NDArray[Any]:
        """Times as the recording has them: numbers in its unit, dates, times of day."""
        clock = self.clock
        if clock.form == "iso" and typed:
            return self.dates(seconds)
        if clock.form != "number":
            return [clock.as_cell(each) for each in seconds.tolist()]
        unit = clock.scale / _NANOSECONDS
        if not clock.counted:
            return seconds if unit == 1.0 else seconds / unit
        counts = np.round(seconds * _NANOSECONDS).astype(np.int64) + clock.origin
        return counts if clock.scale == 1 else counts / clock.scale

    def dates(self, seconds: Array) -> NDArray[np.datetime64]:
        """Times as dates."""
        since = np.round(seconds * _NANOSECONDS).astype(np.int64)
        return (since + self.clock.origin).astype("datetime64[ns]")

    def time_of_day(self, seconds: Array) -> Array:
        """Seconds after midnight; of times without a date, the times themselves."""
        start = 0.0
        if self.clock.dated:
            start = (self.clock.origin % round(86_400 * _NANOSECONDS)) / _NANOSECONDS
        return np.mod(seconds + start, 86_400.0) if math.isfinite(start) else seconds
