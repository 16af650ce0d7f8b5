"""The list of all scans of a recording, those without a plot included."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.column_names import plain_name
from fuzzytrack.io.columns import known
from fuzzytrack.io.decoder import PlotDecoder, is_latitude, joined_cells
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.formats import read_table
from fuzzytrack.io.table import Kind, Table
from fuzzytrack.recordings.scan_rows import RowColumns, places_of

__all__ = ["ScanList", "own_columns"]


@dataclass(frozen=True, eq=False)
class ScanList:
    """Scans of one or more recordings, in order.

    Attributes
    ----------
    file : str
        Where they are from.
    scans : mapping of str to tuple of str
        Words of the scans of each group, the empty word being the group of a single recording.
    times : mapping of str to ndarray
        Times of the scans (s).
    own : mapping of str to ndarray, shape (n, 2)
        Position of the radar (m), NaN where it is not known.
    has_own : bool
        Whether the file has the position of the radar.
    """

    file: str
    scans: Mapping[str, tuple[str, ...]]
    times: Mapping[str, Array]
    own: Mapping[str, Array]
    has_own: bool = False

    @classmethod
    def read(
        cls,
        path: PathLike,
        decoder: PlotDecoder,
        columns: RowColumns,
        own: tuple[str, ...] | None = None,
    ) -> ScanList:
        """Read a table with a row for each scan.

        Parameters
        ----------
        path : str or path
            CSV or Parquet. It has the columns of scan, group and time that the plots have, and
            maybe the position of the radar.
        decoder : PlotDecoder
            How the plots are read.
        columns : RowColumns
            Columns of scan and group in the file of plots.
        own : tuple of str, optional
            Columns of the position of the radar; unless given, ``own_`` before the names of the
            axes, if there are such.

        Raises
        ------
        DataError
            If a column is missing, a scan is there twice, or times do not increase.
        OSError
            If the file cannot be read.
        """
        place: tuple[str, ...] = ()
        file, time = str(path), decoder.columns.time

        def wanted(names: tuple[str, ...]) -> Mapping[str, Kind]:
            nonlocal place
            place = _own_columns(names, file, decoder, own)
            kinds: dict[str, Kind] = {}
            for argument, name, kind in (
                ("group", columns.group, "word"),
                ("scan", columns.scan, "word"),
                ("time", decoder.columns.date, "time"),
                ("time", time, "time"),
            ):
                if name and name not in names:
                    known(names, name, argument, file)
                    raise DataError(f"{file}: `{argument}`: {name!r} is written in other letters")
                if name:
                    kinds[name] = kind  # type: ignore[assignment]
            return kinds | dict.fromkeys(place, "gaps")

        table = read_table(path, wanted)
        seconds = decoder.clock.seconds(
            joined_cells(table, decoder.columns), table.rows, table.file, time
        )
        places = np.full((len(seconds), 2), math.nan)
        if place:
            places = places_of(table.numbers, place, decoder)
        words = np.array(table.words[columns.scan][:])
        groups = table.words[columns.group][:] if columns.group else [""] * len(words)
        listed: dict[str, list[int]] = {}
        for row, word in enumerate(groups):
            listed.setdefault(word, []).append(row)
        for rows in listed.values():
            _check_order(table, columns.scan, words[rows], rows)
            _check_times(table, decoder, seconds[rows], rows)
        return cls(
            table.file,
            {key: tuple(map(str, words[rows])) for key, rows in listed.items()},
            {key: seconds[rows] for key, rows in listed.items()},
            {key: places[rows] for key, rows in listed.items()},
            bool(place),
        )


def _check_order(table: Table, column: str, words: NDArray[np.str_], rows: Sequence[int]) -> None:
    """Check that each scan is there once."""
    seen: dict[str, int] = {}
    for word, row in zip(words.tolist(), rows, strict=True):
        if word in seen:
            raise DataError(
                f"{table.file}: row {table.rows[row]}, column {column}: {word!r} is also in row "
                f"{table.rows[seen[word]]}; expected each scan once"
            )
        seen[word] = row


def _check_times(table: Table, decoder: PlotDecoder, time: Array, rows: Sequence[int]) -> None:
    """Check that the times of scans increase."""
    wrong = np.flatnonzero(np.diff(time) <= 0)
    if len(wrong):
        place = int(wrong[0])
        before, now = (decoder.clock.as_cell(float(each)) for each in time[place : place + 2])
        raise DataError(
            f"{table.file}: row {table.rows[rows[place + 1]]}, column {decoder.columns.time}: "
            f"{now} is not later than {before} of the scan before"
        )


def own_columns(names: tuple[str, ...], axes: tuple[str, ...]) -> tuple[str, ...]:
    """Columns that by their names are the position of the radar; empty if there are none.

    Parameters
    ----------
    names : tuple of str
        Columns of a file.
    axes : tuple of str
        Coordinates of the plots: ``own_x`` belongs to ``x``, ``own_north_m`` to ``north_m``.
    """
    plain = {plain_name(name)[0]: name for name in names}
    found = tuple(
        plain.get(f"own_{word}") or plain.get(f"own_ship_{word}") or ""
        for word in (plain_name(axis)[0] for axis in axes[:2])
    )
    return found if all(found) and len(found) == 2 else ()


def _own_columns(
    names: tuple[str, ...], file: str, decoder: PlotDecoder, own: tuple[str, ...] | None
) -> tuple[str, ...]:
    if own is None:
        return own_columns(names, decoder.columns.axes)
    if not any(name in names for name in own):
        return ()  # they are columns of the plots
    found = tuple(known(names, name, "own", file) for name in own)
    if is_latitude(found[0]) and decoder.frame is None:
        raise DataError(
            f"{file}: `own`: {found[0]!r} is a latitude by its name, but the plots have no place "
            "on earth; give `site`"
        )
    return found
