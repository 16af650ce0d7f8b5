"""Picture of a tracked recording: its tracks where and in the units in which they were recorded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.io.column_names import plain_name
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.recording import Recording
from fuzzytrack.trackers.result import TrackResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fuzzytrack.io.geodetic import LocalFrame

__all__ = ["picture_of"]

# Tracks whose gains are drawn too, unless the user says so.
_WITH_GAINS = 3
# Rows that are converted at once.
_PIECE = 20_000
_GROUND = ("east", "north", "up")


def picture_of(
    recording: Recording, results: Sequence[TrackResult], gains: bool | None = None
) -> Figure:
    """Draw the tracks of a recording; see `fuzzytrack.plotting.plot_tracks`.

    Parameters
    ----------
    recording : Recording
        Says what its positions are: polar plots are drawn around their sensor, geodetic ones by
        longitude and latitude, angles over time.
    results : sequence of TrackResult
        One for each of its tracks.
    gains : bool, optional
        Whether the gains are drawn below. Unless given, for up to three tracks that have some.

    Raises
    ------
    DataError
        If positions are geodetic, and pymap3d is not installed.
    """
    from fuzzytrack.plotting import plot_tracks

    names = [track.id for track in recording.tracks]
    # By name, with A2 before A10; parts of a track stay in their order.
    order = sorted(range(len(names)), key=lambda k: (len(names[k]), names[k]))
    ids, results = [names[k] for k in order], [results[k] for k in order]
    if gains is None:
        some = any(np.isfinite(result.gains.alpha).any() for result in results)
        gains = len(set(ids)) <= _WITH_GAINS and some
    return plot_tracks(results, ids, gains=gains, **_place(recording))[0]


def _place(recording: Recording) -> dict[str, Any]:
    """Where and how positions are drawn."""
    columns, decoder = recording.columns, recording.decoder
    count = len(columns.axes)
    if columns.position == "polar":
        # Plots of a moving sensor are about a fixed origin, where it is no longer.
        sensor = None if columns.own_ship else (0.0, 0.0)
        return {"axes_names": _GROUND[:count], "unit": None, "sensor": sensor}
    if columns.position == "geodetic" and decoder is not None and decoder.frame is not None:
        frame = decoder.frame
        return {
            "axes_names": ("longitude", "latitude", "altitude")[:count],
            "unit": ("deg", "deg", "m")[:count],
            "aspect": 1.0 / np.cos(np.radians(np.clip(frame.lat, -89.0, 89.0))),
            "project": _on_earth(frame),
        }
    if columns.position == "angle":
        period = None if decoder is None else decoder.period
        unit = "deg" if period in (None, 360.0) else "rad"
        return {"axes_names": columns.axes, "unit": unit, "period": period}
    return _cartesian(columns.axes, decoder)


def _cartesian(axes: tuple[str, ...], decoder: PlotDecoder | None) -> dict[str, Any]:
    """Cartesian positions are in the unit of the file, if the names of its columns say it."""
    names, units = zip(*(plain_name(axis) for axis in axes), strict=True)
    if set(units) == {"m"}:
        return {"axes_names": names, "unit": None}
    return {"axes_names": names if all(units) else axes, "unit": units}


def _on_earth(frame: LocalFrame) -> Callable[[Array], Array]:
    """Longitude, latitude and maybe altitude of positions in a local frame."""

    def project(positions: Array) -> Array:
        # In pieces that fit into the cache of the processor, which takes less than half the time.
        starts = range(0, max(len(positions), 1), _PIECE)
        return np.concatenate([placed(positions[start : start + _PIECE]) for start in starts])

    def placed(positions: Array) -> Array:
        place = frame.to_geodetic(positions)
        # Continuous where longitudes pass from 180 to -180 degrees.
        turned = (place.lon - frame.lon + 180.0) % 360.0 - 180.0
        columns = [frame.lon + turned, place.lat]
        if positions.shape[1] > 2:
            columns.append(place.alt)
        return np.stack(columns, axis=1)

    return project
