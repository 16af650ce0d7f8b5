"""The table of tracks: which columns it has, and their values for the rows of a piece."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError
from fuzzytrack.io import motion
from fuzzytrack.io.angles import wrapped
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.time_cells import numbers
from fuzzytrack.recordings.last_plots import LastPlots
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.trackers.result import velocity_over_ground

if TYPE_CHECKING:
    from fuzzytrack.io.geodetic import LocalFrame

__all__ = ["TrackRows", "TrackTable"]

_STATES = ("predicted", "filtered", "velocity", "innovation")
# Integers from here on are not exact as numbers with a fraction.
_EXACT = 2**53


@dataclass(frozen=True)
class TrackTable:
    """Which columns the table of tracks has; the same for all pieces of a recording.

    Attributes
    ----------
    time, id : str
        Names of the columns of time and of identity; the latter empty if there is none.
    axes : tuple of str
        Names of the coordinates.
    gamma : bool
        Whether there are the gains γ.
    deviation : bool
        Whether the standard deviation of the filtered position is known.
    segment : bool
        Whether to say which part of its track a row belongs to.
    period : float or None
        Full circle of a bare angle, in its unit.
    frame : LocalFrame or None
        Where on the earth the positions are, if that is known.
    epoch : int or None
        Time 0 of the recording (ns since 1970), if its times are dates.
    """

    time: str
    id: str
    axes: tuple[str, ...]
    gamma: bool = True
    deviation: bool = False
    segment: bool = False
    period: float | None = None
    frame: LocalFrame | None = None
    epoch: int | None = None

    @classmethod
    def of(cls, decoder: PlotDecoder, tracker: Tracker) -> TrackTable:
        """Table of the tracks of a tracker.

        Parameters
        ----------
        decoder : PlotDecoder
            How the recording is read: its columns, its clock, its place on the earth, its noise.
        tracker : Tracker
            Makes the tracks. There are columns of γ unless it uses none, and of standard deviations
            if it keeps a covariance and the noise of the plots is known.
        """
        columns, clock = decoder.columns, decoder.clock
        deviation = (
            isinstance(tracker, LaneTracker)
            and (decoder.noise_is_known or tracker.sigma_w is not None)
            and tracker.knows_variance(len(columns.axes))
        )
        return cls(
            columns.time,
            columns.id,
            columns.axes,
            gamma=_uses_gamma(tracker),
            deviation=deviation,
            segment=True,
            period=decoder.period,
            frame=decoder.frame,
            epoch=clock.origin if clock.dated else None,
        )

    @property
    def outputs(self) -> tuple[str, ...]:
        """What must be known of a track: outputs of `fuzzytrack.recordings.run_iter`."""
        return (*_STATES, "gains", *(("position_variance",) if self.deviation else ()))

    @property
    def moves_on_ground(self) -> bool:
        """Whether there are two axes on the ground, so that a course can be given."""
        return len(self.axes) >= 2 and self.period is None

    @property
    def on_earth(self) -> bool:
        """Whether it is known where on the earth a track is."""
        return self.frame is not None and self.moves_on_ground

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns in their order.

        Raises
        ------
        DataError
            If two would be the same.
        """
        found = [self.id] if self.id else []
        found.append(self.time)
        for axis in self.axes:
            found += [axis, *(f"{axis}_{name}" for name in _STATES)]
            found += [f"{gain}_{axis}" for gain in self._gains]
        if self.deviation:
            found += [f"{axis}_sd" for axis in self.axes]
        found += ["speed", "course"] if self.moves_on_ground else []
        if self.on_earth:
            found += ["latitude", "longitude", "altitude"][: max(len(self.axes), 2)]
        found += ["coasted", "since_last", *(["segment"] if self.segment else [])]
        doubled = [name for name in found if found.count(name) > 1]
        if doubled:
            raise DataError(f"two columns of the output would be {doubled[0]!r}")
        return tuple(found)

    @property
    def _gains(self) -> tuple[str, ...]:
        return ("alpha", "beta", "gamma") if self.gamma else ("alpha", "beta")

    def types(self, times: Sequence[str] | NDArray[Any]) -> dict[str, str]:
        """Types of the columns, for times of a type; see `fuzzytrack.io.table_writer`."""
        kinds = dict.fromkeys(self.names, "float64")
        if self.id:
            kinds[self.id] = "string"
        kinds[self.time] = times.dtype.name if isinstance(times, np.ndarray) else "string"
        kinds["coasted"] = "bool"
        if self.segment:
            kinds["segment"] = "int64"
        return kinds


class TrackRows:
    """Values of the table of tracks, for one piece after the other.

    Parameters
    ----------
    table : TrackTable
        Its columns.
    typed : bool
        Whether times that are numbers become numbers where they were read as text: for files and
        data frames whose columns have types.

    Attributes
    ----------
    last : LastPlots
        The last plots of the tracks so far.
    """

    def __init__(self, table: TrackTable, *, typed: bool = False) -> None:
        self.table, self._typed = table, typed
        self.last = LastPlots()
        self._time_type: type | None = None

    def values(self, piece: Piece, outputs: Mapping[str, Array]) -> dict[str, Any]:
        """Columns for the rows of a piece.

        Parameters
        ----------
        piece : Piece
        outputs : mapping of str to ndarray, shape (n_rows, n_axes)
            Those of `TrackTable.outputs`, the gains as alpha, beta and gamma.
        """
        table, period = self.table, self.table.period
        used = _used(piece.plots, outputs, period)
        since = self.last.advance(piece, used)
        values: dict[str, Any] = {table.id: piece.ids} if table.id else {}
        values[table.time] = self.times(piece)
        for k, axis in enumerate(table.axes):
            values[axis] = _turned(piece.plots[:, k], period)
            for name in _STATES:
                turns = period if name in ("predicted", "filtered") else None
                values[f"{axis}_{name}"] = _turned(outputs[name][:, k], turns)
            for name in table._gains:
                values[f"{name}_{axis}"] = outputs[name][:, k]
        if table.deviation:
            deviations = np.sqrt(outputs["position_variance"])
            values |= {f"{axis}_sd": deviations[:, k] for k, axis in enumerate(table.axes)}
        if table.moves_on_ground:
            ground = velocity_over_ground(
                *(outputs[name] for name in ("predicted", "filtered", "velocity"))
            )
            velocity = np.where(since.moving[:, None], ground, np.nan)
            values |= {"speed": motion.speed(velocity), "course": motion.course(velocity)}
        if table.frame is not None and table.on_earth:
            place = table.frame.to_geodetic(outputs["filtered"][:, :3])
            values |= {"latitude": place.lat, "longitude": place.lon}
            if len(table.axes) > 2:
                values["altitude"] = place.alt
        values |= {"coasted": ~used, "since_last": since.seconds}
        if table.segment:
            none = np.zeros(len(used), dtype=np.int64)
            values["segment"] = none if piece.segments is None else piece.segments
        return values

    def times(self, piece: Piece) -> Sequence[str] | NDArray[Any]:
        """Times of a piece as they were read."""
        cells = piece.time_cells
        if cells is None:
            return piece.time
        if isinstance(cells, np.ndarray) or not self._typed:
            return cells
        if self._time_type is None:
            self._time_type = _type_of(cells)
        return cells if self._time_type is str else np.array(cells, dtype=self._time_type)


def _uses_gamma(tracker: Tracker) -> bool:
    """Whether the gain γ of a tracker can be other than 0."""
    return not isinstance(tracker, LaneTracker) or tracker.uses_acceleration


def _used(plots: Array, outputs: Mapping[str, Array], period: float | None) -> Mask:
    """Whether the plot of a row was used, on any axis: to correct a prediction, or to start."""
    corrected = ~np.isnan(outputs["innovation"])
    apart = outputs["filtered"] - plots
    if period is not None:
        apart = apart - period * np.round(apart / period)
    # A track starts where its plot is.
    near = np.abs(apart) <= 1e-9 * (1.0 if period is None else period)
    started = np.isnan(outputs["predicted"]) & near
    return np.asarray((corrected | started).any(axis=1))


def _turned(values: Array, period: float | None) -> Array:
    return values if period is None else wrapped(values, period)


def _type_of(cells: Sequence[str]) -> type:
    """Type of times that are text: int, float, or text that is no number."""
    if numbers(list(cells)) is None:
        return str
    try:
        whole = [int(cell) for cell in cells]
    except ValueError:
        return float
    return int if any(abs(value) >= _EXACT for value in whole) else float
