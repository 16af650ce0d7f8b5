"""Rows of a recording of plots without identities, as flat arrays, piece by piece."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.column_names import meters_of
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.decoder import PlotDecoder, is_latitude
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.io.table import Kind, Table
from fuzzytrack.recordings.scan_findings import ScanFindings
from fuzzytrack.reprs import summary
from fuzzytrack.scan.scan import UNKNOWN_PLACE
from fuzzytrack.scan.stages.plots import LARGEST
from fuzzytrack.tasks import Progress

__all__ = ["RowColumns", "ScanRows", "places_of", "read_rows"]

#: Plots of a scan have two coordinates.
PLANE = 2


@dataclass(frozen=True)
class RowColumns:
    """Columns beside those of the plots.

    Attributes
    ----------
    scan, group : str
        Which scan and which recording a row belongs to; empty if no column says so.
    own : tuple of str
        Position of a moving radar, in the frame of the plots.
    radar : tuple of float
        Position of one that does not move (m); NaN if it is not known.
    """

    scan: str = ""
    group: str = ""
    own: tuple[str, ...] = ()
    radar: tuple[float, float] = UNKNOWN_PLACE

    @property
    def kinds(self) -> dict[str, Kind]:
        """What the columns must hold."""
        words = dict.fromkeys(filter(None, [self.group, self.scan]), "word")
        return {**words, **dict.fromkeys(self.own, "gaps")}  # type: ignore[dict-item]


@dataclass(frozen=True, eq=False)
class ScanRows:
    """Some rows of a recording, in the order in which they were read.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Times (s).
    positions : ndarray, shape (n, 2)
        Plots (m), NaN where there is none.
    own : ndarray, shape (n, 2)
        Position of the radar (m), NaN where it is not known.
    rows : ndarray of int, shape (n,)
        Where they stand in the file.
    scans, groups : ndarray of str, shape (n,)
        Words that say to which scan and to which recording they belong; empty if none do.
    covariances : ndarray, shape (n, 3), or None
        Variance of x, covariance, and variance of y (m²).
    file : str
        Name of the file.
    """

    time: Array
    positions: Array
    own: Array
    rows: NDArray[np.int64]
    scans: NDArray[np.str_]
    groups: NDArray[np.str_]
    covariances: Array | None = None
    file: str = ""

    def __repr__(self) -> str:
        return summary(self, "file", rows=len(self))

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.time)

    def take(self, places: NDArray[Any] | slice) -> ScanRows:
        """Some of the rows."""
        chosen = {
            each.name: getattr(self, each.name)[places]
            for each in fields(self)
            if each.name != "file" and getattr(self, each.name) is not None
        }
        return replace(self, **chosen)

    @classmethod
    def joined(cls, parts: Sequence[ScanRows]) -> ScanRows:
        """Several of them as one, in this order; the file of the first stands for all."""
        if len(parts) == 1:
            return parts[0]
        columns: dict[str, Any] = {}
        for each in fields(cls):
            values = [getattr(part, each.name) for part in parts]
            known = each.name != "file" and values[0] is not None
            columns[each.name] = np.concatenate(values) if known else values[0]
        return cls(**columns)


def read_rows(
    files: PlotFiles,
    columns: RowColumns,
    findings: ScanFindings,
    *,
    rows: int | None,
    progress: Progress | None = None,
) -> Iterator[ScanRows]:
    """Read the rows of files piece by piece.

    Parameters
    ----------
    files : PlotFiles
        Opened without identities.
    columns : RowColumns
        Columns beside those of the plots.
    findings : ScanFindings
        Gets what was left out.
    rows : int or None
        Rows of a piece at most; None makes each file one.
    progress : callable, optional
        Called with the share that has been read.

    Raises
    ------
    DataError
        If a cell does not hold what it must; names row, column and value.
    OSError
        If a file cannot be read.
    """
    limit = files.reading.cleaning.fill_limit
    for table in files.tables(columns.kinds, rows=rows, findings=findings, progress=progress):
        yield rows_of(table, files.decoder, columns, findings, limit)


def rows_of(
    table: Table,
    decoder: PlotDecoder,
    columns: RowColumns,
    findings: ScanFindings,
    limit: float,
) -> ScanRows:
    """Rows of one table."""
    piece, covariance = decoder.decode_with_covariance(table, findings.impossible)
    positions = piece.plots[:, :PLANE].copy()
    with np.errstate(invalid="ignore"):
        filled = (np.abs(positions) > limit).any(axis=1)
    findings.fills += int(filled.sum())
    positions[filled] = np.nan
    own = np.tile(columns.radar, (len(piece), 1))
    named = columns.own or decoder.columns.own_ship
    if named:
        own = places_of(table.numbers, named, decoder)
    _check_size(positions, table, decoder)
    packed = None
    if covariance is not None:
        packed = covariance[:, [0, 0, 1], [0, 1, 1]]
    return ScanRows(
        piece.time,
        positions,
        own,
        table.rows,
        _words(table, columns.scan),
        _words(table, columns.group),
        packed,
        table.file,
    )


def _check_size(positions: Array, table: Table, decoder: PlotDecoder) -> None:
    """Check that a scan tracker can use the numbers."""
    with np.errstate(invalid="ignore"):
        beyond = np.argwhere(np.abs(positions) > LARGEST)
    if len(beyond):
        row, axis = beyond[0].tolist()
        names = ", ".join(decoder.columns.axes[:PLANE])
        raise DataError(
            f"{table.file}: row {table.rows[row]}, columns {names}:"
            f" a position of {positions[row, axis]:g} m; expected numbers below {LARGEST:g}"
        )


def _words(table: Table, name: str) -> NDArray[np.str_]:
    """Words of a column, the empty word in all rows if there is none; no cell may be empty."""
    if not name:
        return np.full(len(table.rows), "")
    words = table.words[name]
    if "" in words.names:
        empty = np.flatnonzero(words.codes == words.names.index(""))
        if len(empty):
            raise DataError(
                f"{table.file}: row {table.rows[empty[0]]}, column {name}: an empty cell; expected "
                "a number or a name"
            )
    return np.array(words.names)[words.codes]


def places_of(numbers: Mapping[str, Array], names: Sequence[str], decoder: PlotDecoder) -> Array:
    """Positions of the radar from columns of a table, in the frame of the plots.

    Parameters
    ----------
    numbers : mapping of str to ndarray
        Columns.
    names : sequence of str
        Those of the position: along the axes of the plots, or latitude and longitude by their
        names.
    decoder : PlotDecoder
        How the plots are read.

    Returns
    -------
    ndarray, shape (n, 2)
        NaN where the position is not known.
    """
    values = np.stack([numbers[name] for name in names[:PLANE]], axis=1)
    if is_latitude(names[0]):
        assert decoder.frame is not None
        return decoder.frame.to_local(values[:, 0], values[:, 1]).position
    return values * [_meters(name, decoder.columns) for name in names[:PLANE]]


def _meters(name: str, columns: Columns) -> float:
    """Meters of the unit of a column; Cartesian positions are taken as they are."""
    return 1.0 if columns.position == "cartesian" else meters_of(columns.unit(name))
