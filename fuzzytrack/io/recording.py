"""Recordings: the plots of tracks in files, read as whole tracks."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.formats import CSV, PARQUET
from fuzzytrack.io.piece import Piece, joined
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.table import Cells, no_rows
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress

__all__ = ["Recording", "Track", "read_recording", "read_tracks", "recording_files"]


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
    sigma : ndarray, shape (n_steps, n_axes), optional
        Standard deviations of the plots, where each has its own.
    time_cells : sequence of str or ndarray, optional
        Times as the file has them.
    segment : int
        Which part of the track this is, if it was not seen for long and began again.
    """

    id: str
    time: Array
    plots: Array
    sigma: Array | None = None
    time_cells: Cells | None = None
    segment: int = 0

    def __repr__(self) -> str:
        return summary(self, "id", "plots")

    def part(self, rows: slice) -> Track:
        """Some rows that follow each other."""
        return replace(
            self,
            time=self.time[rows],
            plots=self.plots[rows],
            sigma=None if self.sigma is None else self.sigma[rows],
            time_cells=None if self.time_cells is None else self.time_cells[rows],
        )


@dataclass(frozen=True, eq=False)
class Recording:
    """The tracks of a file, in order of first appearance.

    Attributes
    ----------
    file : str
        Name of the file.
    columns : Columns
        Which of its columns are what.
    tracks : tuple of Track
        At least one, with at least one plot each.
    decoder : PlotDecoder, optional
        How its rows became plots.
    findings : Findings
        Faults and notes.
    """

    file: str
    columns: Columns
    tracks: tuple[Track, ...]
    decoder: PlotDecoder | None = None
    findings: Findings = field(default_factory=Findings)

    def __repr__(self) -> str:
        return summary(self, "file", tracks=len(self.tracks))


def recording_files(path: PathLike) -> tuple[str, ...]:
    """Files of a recording: the file itself, or those of a folder, Parquet or CSV, by name.

    Raises
    ------
    DataError
        If the folder holds none, or some of both.
    OSError
        If it cannot be read.
    """
    if not os.path.isdir(path):
        return (os.fspath(path),)
    # Drafts of files that are being written begin with a dot.
    files = sorted(file for file in Path(path).iterdir() if file.is_file() and file.name[0] != ".")
    found = {
        name: tuple(str(file) for file in files if file.name.lower().endswith(suffixes))
        for name, suffixes in (("Parquet", PARQUET), ("CSV", CSV))
    }
    if all(found.values()):
        raise DataError(
            f"{path}: holds {Path(found['Parquet'][0]).name} and {Path(found['CSV'][0]).name}; the "
            "files of a folder must all be Parquet, or all CSV"
        )
    if not any(found.values()):
        raise DataError(f"{path}: holds no Parquet and no CSV files")
    return found["Parquet"] or found["CSV"]


def read_tracks(path: PathLike, *, progress: Progress | None = None, **options: Any) -> Recording:
    """Read the plots of tracks.

    Parameters
    ----------
    path : str or path
        A file, see `fuzzytrack.io.formats.open_table`, or a folder of them. Columns that are not
        named are ignored.
    progress : callable, optional
        Called with the share of the file that has been read.
    **options
        How it is read: attributes of `PlotDescription` (time, id, axes, polar…), `Cleaning`
        (duplicates, max_gap…) and `TextForm` (delimiter, na…), ``format``, and ``sort``, which puts
        the plots of each track in order of time.

    Returns
    -------
    Recording

    Raises
    ------
    DataError
        If the file does not hold such tracks: names row, column, value and what was expected.
    TypeError
        If there is no such option.
    OSError
        If it cannot be read.
    """
    return read_recording(PlotFiles.of(recording_files(path), Reading.of(**options)), progress)


def read_recording(files: PlotFiles, progress: Progress | None = None) -> Recording:
    """Read files as whole tracks.

    Parameters
    ----------
    files : PlotFiles
        The files.
    progress : callable, optional
        Called with the share of the files that has been read.

    Raises
    ------
    DataError, OSError
        As `read_tracks`.
    """
    findings = Findings()
    pieces = list(files.pieces(rows=None, findings=findings, progress=progress))
    if not pieces:
        raise no_rows(files.names[0])
    tracks = tracks_of(joined(list(files.cleaned([joined(pieces)], findings))))
    return Recording(files.names[0], files.columns, tracks, files.decoder, findings)


def tracks_of(piece: Piece) -> tuple[Track, ...]:
    """Tracks of a piece that has been cleaned, in order of first appearance."""
    keys = piece.tracks
    # Stable: the order of the piece within a track.
    order = np.argsort(keys.codes, kind="stable")
    ends = np.searchsorted(keys.codes[order], np.arange(len(keys.names) + 1))
    return tuple(_track(piece, order[start:end]) for start, end in pairwise(ends) if end > start)


def _track(piece: Piece, places: NDArray[np.int64]) -> Track:
    rows = piece.take(places)
    return Track(
        rows.ids[0],
        rows.time,
        rows.plots,
        rows.sigma,
        rows.time_cells,
        0 if rows.segments is None else int(rows.segments[0]),
    )
