"""Tracks written to a file, with the plots that they were made of."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.formats import PARQUET, check_table, table_writer
from fuzzytrack.io.piece import Piece, joined_cells
from fuzzytrack.io.recording import Recording
from fuzzytrack.io.table import Words
from fuzzytrack.io.track_formats import (
    TRACK_SUFFIXES,
    check_geo_tracks,
    is_geo,
    write_geo_tracks,
)
from fuzzytrack.recordings.track_table import TrackRows, TrackTable
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.result import TrackResult

__all__ = ["check_tracks", "table_of_tracks", "track_writer", "write_tracks"]

#: Takes a piece, and the outputs of its rows by name.
WritePiece = Callable[[Piece, Mapping[str, Array]], None]


def check_tracks(path: PathLike, table: TrackTable, inputs: tuple[PathLike, ...] = ()) -> None:
    """Check that tracks can be written, before the work is done.

    Parameters
    ----------
    path : str or path
        The file to be written; it need not exist.
    table : TrackTable
        Which columns there are, and what is known of places and times.
    inputs : tuple of str or path
        Files that must not be overwritten.

    Raises
    ------
    DataError
        If the suffix is unknown, two columns would share a name, the format needs places on the
        earth or dates and there are none, or the file is one of the inputs.
    OSError
        If the file cannot be written.
    """
    if is_geo(path):
        check_geo_tracks(path, inputs, on_earth=table.on_earth, dated=table.epoch is not None)
        return
    _checked_names(path, table)
    check_table(path, inputs, others=TRACK_SUFFIXES)


@contextmanager
def track_writer(
    path: PathLike,
    table: TrackTable,
    inputs: tuple[PathLike, ...] = (),
    *,
    compact: bool = False,
    quote_formulas: bool = False,
    progress: Progress | None = None,
) -> Iterator[WritePiece]:
    """Write tracks piece by piece; the file appears whole or not at all.

    Parameters
    ----------
    path : str or path
        CSV or Parquet by its suffix, or a format of maps, see `fuzzytrack.io.write_geo_tracks`.
    table : TrackTable
        Its columns.
    inputs : tuple of str or path
        Files that must not be overwritten.
    compact, quote_formulas
        As for `fuzzytrack.io.table_writer`.
    progress : callable, optional
        Called with the share of a piece that has been written.

    Yields
    ------
    callable
        To be called with a piece, and with the outputs of its rows by name: those of
        `TrackTable.outputs`, the gains as alpha, beta and gamma, each shaped as the plots.

    Raises
    ------
    DataError, OSError
        As `check_tracks`.

    Notes
    -----
    Columns: identity (if any) and time as they were read; for each axis NAME (measured),
    NAME_predicted, NAME_filtered, NAME_velocity, NAME_innovation, alpha_NAME, beta_NAME and, if the
    tracker uses it, gamma_NAME; then, as far as they are known, NAME_sd of each axis (standard
    deviation of the filtered position), speed and course (over ground; degrees clockwise from
    north), latitude, longitude and altitude; coasted (whether the row has no plot that was used),
    since_last (time since the last one, s), and segment. A piece is one row group of a Parquet
    file. The rows of formats of maps are held in memory until the end.
    """
    check_tracks(path, table, inputs)
    if is_geo(path):
        from fuzzytrack.recordings.geo_rows import GeoRows

        rows = GeoRows(table)
        yield rows.add
        write_geo_tracks(path, rows.tracks(), inputs)
        return
    values = TrackRows(table, typed=Path(path).suffix.lower() in PARQUET)
    with ExitStack() as stack:
        opened: list[Callable[[Mapping[str, Any]], None]] = []

        def begin(times: Sequence[str] | np.ndarray[Any, Any]) -> None:
            """Open the file, when the type of times is known."""
            writer = table_writer(
                path,
                table.types(times),
                inputs,
                compact=compact,
                quote_formulas=quote_formulas,
                progress=progress,
            )
            opened.append(stack.enter_context(writer))

        def write_piece(piece: Piece, outputs: Mapping[str, Array]) -> None:
            columns = values.values(piece, outputs)
            if not opened:
                begin(columns[table.time])
            opened[0](columns)

        yield write_piece
        if not opened:
            begin(np.empty(0))


def _checked_names(path: PathLike, table: TrackTable) -> tuple[str, ...]:
    try:
        return table.names
    except DataError as error:
        raise DataError(f"{path}: {error}") from None


def write_tracks(
    path: PathLike,
    recording: Recording,
    results: Sequence[TrackResult],
    progress: Progress | None = None,
    *,
    table: TrackTable | None = None,
    quote_formulas: bool = False,
) -> None:
    """Write tracks with their plots, whole or not at all.

    Parameters
    ----------
    path : str or path
        CSV or Parquet by its suffix, or a format of maps, see `fuzzytrack.io.write_geo_tracks`; not
        the file of the recording.
    recording : Recording
        The plots, track by track.
    results : sequence of TrackResult
        Result of each track.
    progress : callable, optional
        Called with the share that has been written.
    table : TrackTable, optional
        Columns of the file; unless given, those of γ are written if any γ is not zero, and standard
        deviations if the results have them.
    quote_formulas : bool
        As for `fuzzytrack.io.table_writer`.

    Raises
    ------
    DataError, OSError
        As `track_writer`.

    Notes
    -----
    Columns as `track_writer` has them. Tracks follow each other.
    """
    piece, outputs = _joined_tracks(recording, results)
    with track_writer(
        path,
        table or _table_of(recording, outputs),
        (recording.file,),
        compact=True,
        quote_formulas=quote_formulas,
        progress=progress,
    ) as write:
        write(piece, outputs)


def table_of_tracks(
    recording: Recording, results: Sequence[TrackResult], table: TrackTable | None = None
) -> dict[str, Any]:
    """Columns that `write_tracks` writes, by name.

    Parameters
    ----------
    recording, results, table
        As for `write_tracks`.

    Raises
    ------
    DataError
        If two columns would share a name.
    """
    piece, outputs = _joined_tracks(recording, results)
    table = table or _table_of(recording, outputs)
    values = TrackRows(table, typed=True).values(piece, outputs)
    return {name: values[name] for name in table.names}


def _table_of(recording: Recording, outputs: Mapping[str, Array]) -> TrackTable:
    columns, tracks = recording.columns, recording.tracks
    return TrackTable(
        columns.time,
        columns.id,
        columns.axes,
        gamma=bool((np.nan_to_num(outputs["gamma"]) != 0.0).any()),
        deviation="position_variance" in outputs,
        segment=any(track.segment for track in tracks),
    )


def _joined_tracks(
    recording: Recording, results: Sequence[TrackResult]
) -> tuple[Piece, dict[str, Array]]:
    """All tracks one after the other: plots and outputs."""
    names = ["predicted", "filtered", "velocity", "innovation"]
    if all("position_variance" in result.kept for result in results):
        names.append("position_variance")
    outputs = {name: _joined(results, name) for name in names}
    gains = [result.gains for result in results]
    outputs |= {name: _joined(gains, name) for name in ("alpha", "beta", "gamma")}
    return _one_piece(recording, results), outputs


def _one_piece(recording: Recording, results: Sequence[TrackResult]) -> Piece:
    """Plots of all tracks, one track after the other."""
    lengths = [len(result.time) for result in results]
    tracks = recording.tracks
    # A track in several segments is there several times.
    numbers: dict[str, int] = {}
    codes = [numbers.setdefault(track.id, len(numbers)) for track in tracks]
    return Piece(
        Words(tuple(numbers), np.repeat(codes, lengths)),
        _joined(results, "time"),
        _joined(results, "measured"),
        np.arange(1, sum(lengths) + 1),
        recording.file,
        time_cells=joined_cells([track.time_cells for track in tracks]),
        segments=np.repeat([track.segment for track in tracks], lengths),
    )


def _joined(parts: Sequence[object], name: str) -> Array:
    """One attribute of all parts, one after the other."""
    return np.concatenate([getattr(part, name) for part in parts])
