"""True positions of recorded plots: from a file, or from columns beside the plots."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.io.angles import unwrapped
from fuzzytrack.io.columns import looks_like_angle
from fuzzytrack.io.description import PlotDescription
from fuzzytrack.io.plot_files import Input, PlotFiles, opened
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import Recording, Track, read_recording, recording_files
from fuzzytrack.yamltree import suggestion

__all__ = ["read_truth", "true_positions"]


def read_truth(truth: str | os.PathLike[str], plots: PlotFiles) -> Recording:
    """Read the true positions of recorded plots, in the coordinates and the time of these.

    Parameters
    ----------
    truth : str or path
        A file with columns of the same names as those of the plots; of polar plots it may have x
        and y (m, to the east and north of the origin) instead. If there is no such file, columns of
        the file of plots, with commas between them.
    plots : PlotFiles
        The plots.

    Raises
    ------
    DataError
        If there is neither such a file nor such columns, the file does not hold tracks, or its
        times are of another kind than those of the plots.
    OSError
        If the file cannot be read.
    """
    reading, inputs = plots.reading, plots.inputs
    # Noise and limits are those of plots, and a target exists between its plots too.
    cleaning = replace(reading.cleaning, stale=None, least_step=None, max_gap=None, max_coast=None)
    reading = replace(reading, cleaning=cleaning)
    if os.path.exists(truth):
        inputs = recording_files(truth)
        reading = replace(reading, format=None)
        said = _of_file(reading.description, inputs[0], reading)
    else:
        said = _of_columns(truth, plots)
    said = replace(said, **_NO_NOISE, valid=())
    return read_recording(_like(PlotFiles.of(inputs, replace(reading, description=said)), plots))


def true_positions(track: Track, true: Recording, lag: float = 0.0) -> Array:
    """True positions at the times of a track, interpolated linearly.

    Parameters
    ----------
    track : Track
        The plots of one identity.
    true : Recording
        From `read_truth`.
    lag : float
        Time by which the clock of the track is late against that of the truth (s).

    Returns
    -------
    ndarray, shape (n_steps, n_axes)
        NaN outside of the times of the true positions, and beside one that is missing. Bare angles
        are in the turn that is nearest to the plot.

    Raises
    ------
    DataError
        If the truth has no such identity, or other axes.
    """
    for other in true.tracks:
        if other.id == track.id:
            break
    else:
        raise DataError(f"{true.file}: has no track {track.id!r}, for which there are plots")
    if other.plots.shape[1] != track.plots.shape[1]:
        raise DataError(
            f"{true.file}: has {other.plots.shape[1]} axes, the plots have {track.plots.shape[1]}"
        )
    time = track.time - lag
    period = None if true.decoder is None else true.decoder.period
    if period is None:
        return _interpolated(time, other.time, other.plots)
    series = unwrapped(other.plots[:, 0], period=period)[:, None]
    found = _interpolated(time, other.time, series)
    turns = np.round((track.plots - found) / period)
    return np.asarray(found + period * np.where(np.isnan(turns), 0.0, turns))


def _interpolated(time: Array, known: Array, positions: Array) -> Array:
    return np.stack([np.interp(time, known, x, np.nan, np.nan) for x in positions.T], axis=1)


_NO_NOISE: dict[str, Any] = dict.fromkeys(
    ("sigma", "sigma_range", "sigma_azimuth", "sigma_elevation")
)
_NO_POSITION: dict[str, Any] = dict.fromkeys(("axes", "polar", "geodetic", "angle"))
# Positions about the fixed origin, whatever the sensor does.
_FIXED: dict[str, Any] = {
    **_NO_POSITION,
    "own_ship": None,
    "own_heading": None,
    "azimuth_from": "north",
}


def _of_file(said: PlotDescription, file: Input, reading: Reading) -> PlotDescription:
    """Description of a file of true positions: of polar plots these may be x and y."""
    if said.polar is None:
        return said
    with opened(file, reading) as source:
        there = {name.lower() for name in source.types}
    return said if said.polar[0].lower() in there else replace(said, **_FIXED)


def _of_columns(truth: str | os.PathLike[str], plots: PlotFiles) -> PlotDescription:
    """Description of true positions in columns of the file of plots."""
    said, kind = plots.decoder.description, plots.columns.position
    names = tuple(name.strip() for name in os.fspath(truth).split(","))
    with opened(plots.inputs[0], plots.reading) as source:
        there = tuple(source.types)
    for name in names:
        if name not in there:
            raise DataError(
                f"truth: there is no file {os.fspath(truth)}, and {plots.names[0]} has no column "
                f"{name!r}{suggestion(name, there)}"
            )
    if kind == "angle":
        return replace(said, angle=names[0])
    if kind == "polar" and not any(map(looks_like_angle, names)):
        return replace(said, **{**_FIXED, "axes": names})
    return replace(said, **{**_NO_POSITION, {"cartesian": "axes"}.get(kind, kind): names})


def _like(files: PlotFiles, plots: PlotFiles) -> PlotFiles:
    """True positions in the frame of the plots, and their times from the same beginning."""
    clock, first = files.decoder.clock, plots.decoder.clock
    if clock.form != first.form:
        raise DataError(
            f"truth: times of {files.names[0]} are {_TIMES[clock.form]}, "
            f"those of {plots.names[0]} are {_TIMES[first.form]}"
        )
    clock = replace(clock, origin=first.origin, counted=first.counted)
    return replace(files, decoder=replace(files.decoder, clock=clock, frame=plots.decoder.frame))


_TIMES = {"number": "numbers", "iso": "dates", "time of day": "times of day"}
