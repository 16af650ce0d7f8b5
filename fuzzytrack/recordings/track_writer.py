"""Tracks written to a file, with the plots that they were made of."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.formats import table_writer
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.recording import Recording
from fuzzytrack.io.table import Words
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.result import TrackResult

__all__ = ["OUTPUTS", "track_writer", "write_tracks"]

#: What must be known of a track to write it: outputs of `fuzzytrack.recordings.run_iter`.
OUTPUTS = ("predicted", "filtered", "velocity", "innovation", "gains")


@contextmanager
def track_writer(
    path: PathLike,
    columns: Columns,
    inputs: tuple[PathLike, ...] = (),
    *,
    with_gamma: bool = True,
    compact: bool = False,
    progress: Progress | None = None,
) -> Iterator[Callable[[Piece, Mapping[str, Array]], None]]:
    """Write tracks piece by piece; the file appears whole or not at all.

    Parameters
    ----------
    path : str or path
        CSV or Parquet by its suffix.
    columns : Columns
        Of the recording.
    inputs : tuple of str or path
        Files that must not be overwritten.
    with_gamma : bool
        Whether to write the columns of γ. When the first piece is written, it is not known whether
        γ is zero in all others.
    compact : bool
        Whether a small file is worth more time; see `fuzzytrack.io.table_writer`.
    progress : callable, optional
        Called with the share of a piece that has been written.

    Yields
    ------
    callable
        To be called with a piece, and with the outputs of its rows by name: those of ``OUTPUTS``,
        the gains as alpha, beta and gamma, each shaped as the plots.

    Raises
    ------
    DataError
        If the suffix is unknown, two columns would share a name, or the file is one of the inputs.
    OSError
        If the file cannot be written.

    Notes
    -----
    Columns: identity (if any), time, and for each axis NAME (measured), NAME_predicted,
    NAME_filtered, NAME_velocity, NAME_innovation, alpha_NAME, beta_NAME, gamma_NAME. A piece is one
    row group of a Parquet file.
    """
    table = _table(columns, with_gamma)
    names = [name for name, _, _ in table]
    doubled = [name for name in names if names.count(name) > 1]
    if doubled:
        raise DataError(f"{path}: two columns of the output would be {doubled[0]!r}")
    types = {name: "string" if what == "ids" else "float64" for name, what, _ in table}
    with table_writer(path, types, inputs, compact=compact, progress=progress) as write:

        def write_piece(piece: Piece, outputs: Mapping[str, Array]) -> None:
            write({name: _values(piece, outputs, what, axis) for name, what, axis in table})

        yield write_piece


def _table(columns: Columns, with_gamma: bool) -> list[tuple[str, str, int]]:
    """Columns of the table in their order: name, what of a piece or which output, and axis."""
    gains = ("alpha", "beta", "gamma") if with_gamma else ("alpha", "beta")
    found = [(columns.id, "ids", 0)] if columns.id else []
    found.append((columns.time, "time", 0))
    for k, axis in enumerate(columns.axes):
        found.append((axis, "plots", k))
        for name in ("predicted", "filtered", "velocity", "innovation"):
            found.append((f"{axis}_{name}", name, k))
        for name in gains:
            found.append((f"{name}_{axis}", name, k))
    return found


def _values(piece: Piece, outputs: Mapping[str, Array], what: str, axis: int) -> Words | Array:
    if what == "ids":
        return piece.ids
    if what == "time":
        return piece.time
    return (piece.plots if what == "plots" else outputs[what])[:, axis]


def write_tracks(
    path: PathLike,
    recording: Recording,
    results: Sequence[TrackResult],
    progress: Progress | None = None,
) -> None:
    """Write tracks with their plots, whole or not at all.

    Parameters
    ----------
    path : str or path
        CSV or Parquet by its suffix; not the file of the recording.
    recording : Recording
        The plots, track by track.
    results : sequence of TrackResult
        Result of each track.
    progress : callable, optional
        Called with the share that has been written.

    Raises
    ------
    DataError
        If the suffix is unknown, two columns would share a name, or the file is the recording's.
    OSError
        If the file cannot be written.

    Notes
    -----
    Columns as `track_writer` has them, gamma_NAME only if any γ is not zero. Tracks follow each
    other.
    """
    outputs = {name: _joined(results, name) for name in OUTPUTS if name != "gains"}
    gains = [result.gains for result in results]
    outputs |= {name: _joined(gains, name) for name in ("alpha", "beta", "gamma")}
    with_gamma = bool((np.nan_to_num(outputs["gamma"]) != 0.0).any())
    with track_writer(
        path,
        recording.columns,
        (recording.file,),
        with_gamma=with_gamma,
        compact=True,
        progress=progress,
    ) as write:
        write(_one_piece(recording, results), outputs)


def _one_piece(recording: Recording, results: Sequence[TrackResult]) -> Piece:
    """Plots of all tracks, one track after the other."""
    lengths = [len(result.time) for result in results]
    ids = tuple(track.id for track in recording.tracks)
    return Piece(
        Words(ids, np.repeat(np.arange(len(ids)), lengths)),
        _joined(results, "time"),
        _joined(results, "measured"),
        np.arange(1, sum(lengths) + 1),
        recording.file,
    )


def _joined(parts: Sequence[object], name: str) -> Array:
    """One attribute of all parts, one after the other."""
    return np.concatenate([getattr(part, name) for part in parts])
