"""Recordings: the plots of one or more tracks in a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.columns import Columns, choose_columns
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.table import Kind, Progress, Table, Words, read_table

__all__ = ["Recording", "Track", "read_tracks"]


@dataclass(frozen=True, eq=False)
class Track:
    """The plots of one track.

    Attributes
    ----------
    id : str
        Identity, as the file spells it; empty if the file names none.
    time : ndarray, shape (n_steps,)
        Times (s), increasing.
    plots : ndarray, shape (n_steps, n_axes)
        Positions, NaN where missed.
    """

    id: str
    time: Array
    plots: Array


@dataclass(frozen=True, eq=False)
class Recording:
    """The tracks of a file, in order of first appearance.

    Attributes
    ----------
    file : str
        Name of the file.
    time, id : str
        Names of the columns of time and of identity; the latter empty if there is none.
    axes : tuple of str
        Names of the columns of position.
    tracks : tuple of Track
        At least one, with at least one plot each.
    """

    file: str
    time: str
    id: str
    axes: tuple[str, ...]
    tracks: tuple[Track, ...]


def read_tracks(
    path: PathLike,
    *,
    time: str | None = None,
    id: str | None = None,
    axes: Sequence[str] | None = None,
    sort: bool = False,
    progress: Progress | None = None,
) -> Recording:
    """Read the plots of tracks.

    Parameters
    ----------
    path : str or path
        CSV or Parquet; see `fuzzytrack.io.table.read_table`. Columns that are not named are
        ignored.
    time : str, optional
        Column of time (s); t, t_s, time or time_s unless given.
    id : str, optional
        Column of the identity of tracks, kept as text; one track unless given.
    axes : sequence of str, optional
        Columns of position; x, y, z or x_m, y_m, z_m, those that there are, unless given. An empty
        cell, ``nan`` or ``NA`` is a missed plot.
    sort : bool
        Whether to put plots in order of time.
    progress : callable, optional
        Called with the share of the file that has been read.

    Returns
    -------
    Recording

    Raises
    ------
    DataError
        If the file does not hold such tracks: names row, column, value and what was expected.
    OSError
        If it cannot be read.
    """
    chosen: list[Columns] = []

    def wanted(names: tuple[str, ...]) -> dict[str, Kind]:
        chosen.append(choose_columns(names, str(path), time, id, axes))
        return chosen[0].kinds

    table = read_table(path, wanted, progress)
    (columns,) = chosen
    tracks = _tracks(table, columns.time, columns.id, columns.axes, sort)
    return Recording(table.file, columns.time, columns.id, columns.axes, tracks)


# -------------------------------------------------------------------- which rows


def _tracks(
    table: Table, time_name: str, id_name: str, axes: tuple[str, ...], sort: bool
) -> tuple[Track, ...]:
    times = table.numbers[time_name]
    nobody = Words(("",), np.zeros(len(times), dtype=np.int64))
    ids = table.words[id_name] if id_name else nobody
    # Stable: the order of the file within a track.
    order = np.lexsort((times, ids.codes)) if sort else np.argsort(ids.codes, kind="stable")
    codes, times = ids.codes[order], times[order]
    wrong = np.flatnonzero((np.diff(times) <= 0) & (np.diff(codes) == 0)) + 1
    if len(wrong):
        first = wrong[np.argmin(table.rows[order[wrong]])]
        before, here = order[first - 1], order[first]
        raise _time_error(table, time_name, id_name and ids.names[codes[first]], before, here)
    plots = np.stack([table.numbers[name][order] for name in axes], axis=1)
    ends = np.searchsorted(codes, np.arange(len(ids.names) + 1))
    return tuple(
        Track(name, times[start:end], plots[start:end])
        for name, start, end in zip(ids.names, ends[:-1], ends[1:], strict=True)
    )


def _time_error(table: Table, time_name: str, track: str, before: int, here: int) -> DataError:
    times, rows = table.numbers[time_name], table.rows
    first, second = rows[before], rows[here]
    whose = f" (id {track!r})" if track else ""
    if times[here] == times[before]:
        # Several tracks in one file look like this when they are not told apart.
        mend = "" if track else "; if these are several tracks, name the column of their id (--id)"
        what = f"repeats that of row {first}"
        wanted = f"expected times that differ{mend}"
    else:
        what = f"is earlier than {times[before]:.15g} in row {first}"
        wanted = "expected increasing times; --sort puts them in order"
        if not track:
            wanted += ", and --id tells several tracks apart"
    return DataError(
        f"{table.file}: row {second}, column {time_name}: time {times[here]:.15g}{whose} "
        f"{what}; {wanted}"
    )
