"""Tracks written to a file, beside the plots that they were made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.files import PathLike
from fuzzytrack.io.table import Progress, write_table
from fuzzytrack.io.tracks import Recording
from fuzzytrack.trackers.result import TrackResult

__all__ = ["write_tracks"]


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
        What a tracker made of each track.
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
    Columns: identity (if any), time, and for each axis NAME (measured), NAME_predicted,
    NAME_filtered, NAME_velocity, NAME_innovation, alpha_NAME, beta_NAME, and gamma_NAME if any is
    not zero. Tracks follow each other.
    """
    write_table(path, _columns(recording, results), (recording.file,), progress)


def _columns(
    recording: Recording, results: Sequence[TrackResult]
) -> Mapping[str, Sequence[str] | Array]:
    columns: list[tuple[str, Sequence[str] | Array]] = []
    if recording.id:
        ids = [track.id for track in recording.tracks for _ in range(len(track.time))]
        columns.append((recording.id, ids))
    columns.append((recording.time, np.concatenate([r.time for r in results])))
    gammas = np.concatenate([r.gains.gamma for r in results])
    with_gamma = bool((np.nan_to_num(gammas) != 0.0).any())
    for k, axis in enumerate(recording.axes):
        for name, values in (
            (axis, [r.measured for r in results]),
            (f"{axis}_predicted", [r.predicted for r in results]),
            (f"{axis}_filtered", [r.filtered for r in results]),
            (f"{axis}_velocity", [r.velocity for r in results]),
            (f"{axis}_innovation", [r.innovation for r in results]),
            (f"alpha_{axis}", [r.gains.alpha for r in results]),
            (f"beta_{axis}", [r.gains.beta for r in results]),
        ):
            columns.append((name, np.concatenate(values)[:, k]))
        if with_gamma:
            columns.append((f"gamma_{axis}", gammas[:, k]))
    names = [name for name, _ in columns]
    doubled = [name for name in names if names.count(name) > 1]
    if doubled:
        raise DataError(f"{recording.file}: two columns of the output would be {doubled[0]!r}")
    return dict(columns)
