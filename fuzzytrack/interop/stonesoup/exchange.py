"""Tracks, truth and detections of Stone Soup in the types of this package, and back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
from stonesoup.types.array import CovarianceMatrix, StateVector
from stonesoup.types.detection import Detection
from stonesoup.types.groundtruth import GroundTruthPath, GroundTruthState
from stonesoup.types.prediction import Prediction
from stonesoup.types.state import GaussianState, State, StateMutableSequence
from stonesoup.types.track import Track

from fuzzytrack.arrays import Array
from fuzzytrack.interop.stonesoup.plots import position_of
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scoring.positions import Positions
from fuzzytrack.trackers.result import TrackResult

__all__ = ["EPOCH", "as_positions", "from_stonesoup", "to_stonesoup"]

#: Time 0 of this package, unless another is given.
EPOCH = datetime(1970, 1, 1)


def from_stonesoup(
    items: Any,
    *,
    position_mapping: Sequence[int] = (0, 2),
    velocity_mapping: Sequence[int] | None = None,
    measurement_model: Any = None,
    epoch: datetime = EPOCH,
) -> Positions | list[Scan]:
    """Tracks or true paths as positions, detections as scans.

    Parameters
    ----------
    items : Track, GroundTruthPath, or iterable
        A track or path, or several; or detections: several, of which those of one time are a scan,
        or what a detector gives, pairs of a time and a set of detections.
    position_mapping : sequence of int
        Places of the position in the state vectors, and in the state of measurement models.
    velocity_mapping : sequence of int, optional
        Places of the velocity in the state vectors of tracks.
    measurement_model : stonesoup.models.measurement.MeasurementModel, optional
        For detections that have none.
    epoch : datetime
        Time 0.

    Returns
    -------
    Positions
        Of tracks and paths: what `fuzzytrack.score` takes, with their ``id``. A state that is a
        prediction is coasting.
    list of Scan
        Of detections: what a scan tracker takes, with the covariance of each.

    Raises
    ------
    TypeError
        If there is anything else among the items.
    ValueError
        If a mapping does not fit the states, a timestamp is missing or lacks the time zone of
        `epoch`, or a detection is no position, or has another number of axes than two.

    Examples
    --------
    >>> from datetime import datetime
    >>> from stonesoup.types.state import State
    >>> from stonesoup.types.track import Track
    >>> from fuzzytrack.interop.stonesoup import from_stonesoup
    >>> track = Track([State([[1.0], [0.0], [2.0], [0.0]], datetime(2030, 1, 1, 0, 0, 5))], id="a")
    >>> found = from_stonesoup(track, epoch=datetime(2030, 1, 1))
    >>> found.time, found.position
    (array([5.]), array([[1., 2.]]))
    """
    listed = [items] if isinstance(items, StateMutableSequence | Detection) else items
    if not isinstance(listed, Iterable):
        raise TypeError(f"items: {type(items).__name__}; expected tracks, true paths or detections")
    listed = list(listed)
    if all(isinstance(each, Detection | tuple) for each in listed) and listed:
        return list(_scans(listed, position_mapping, measurement_model, epoch))
    for each in listed:
        if not isinstance(each, StateMutableSequence):
            raise TypeError(
                f"items: {type(each).__name__}; expected tracks and true paths only, or detections "
                "only"
            )
    return _positions(listed, position_mapping, velocity_mapping, epoch)


def _positions(
    tracks: Sequence[Any],
    position: Sequence[int],
    velocity: Sequence[int] | None,
    epoch: datetime,
) -> Positions:
    rows = [
        (track.id, state)
        for track in tracks
        if len(track)
        for state in track.last_timestamp_generator()
    ]
    vectors = [np.asarray(state.state_vector, dtype=np.float64).ravel() for _, state in rows]

    def chosen(name: str, places: Sequence[int]) -> Array:
        if len(set(places)) < len(places):
            raise ValueError(f"{name}: {tuple(places)} has a place twice; give one for each axis")
        for (id_, _), vector in zip(rows, vectors, strict=True):
            if not all(-1 < place < len(vector) for place in places):
                raise ValueError(
                    f"{name}: {tuple(places)} does not fit the state vectors of {id_}, which have "
                    f"{len(vector)} places"
                )
        found = np.array([vector[list(places)] for vector in vectors])
        return found.reshape(len(rows), len(places))

    return Positions.make(
        "items",
        np.array([_seconds(state.timestamp, epoch) for _, state in rows]),
        np.array([str(name) for name, _ in rows]),
        chosen("position_mapping", position),
        None if velocity is None else chosen("velocity_mapping", velocity),
        coasting=np.array([isinstance(state, Prediction) for _, state in rows], np.bool_),
    )


def _scans(items: Sequence[Any], position: Sequence[int], model: Any, epoch: datetime) -> Any:
    if len(position) != 2:
        raise ValueError(
            f"position_mapping: {tuple(position)} has {len(position)} places; scans have two axes"
        )
    first = 0
    for when, detections in _by_time(items, epoch):
        plots = [position_of(each, model, position) for each in detections]
        times = [_seconds(each.timestamp or when, epoch) for each in detections]
        noise = np.array([covar[np.triu_indices(2)] for _, covar in plots]).reshape(-1, 3)
        yield Scan(
            _seconds(when, epoch),
            np.array([place for place, _ in plots]).reshape(-1, 2),
            noise,
            np.array(times),
            rows=np.arange(first, first + len(plots)),
        )
        first += len(plots)


def _by_time(items: Sequence[Any], epoch: datetime) -> Iterator[tuple[datetime, list[Any]]]:
    """Detections of each scan, in an order that does not depend on that of sets."""
    pairs: Iterable[tuple[datetime, Any]]
    if all(isinstance(each, Detection) for each in items):
        times = sorted({each.timestamp for each in items}, key=lambda when: _seconds(when, epoch))
        pairs = [(when, [each for each in items if each.timestamp == when]) for when in times]
    elif all(isinstance(each, tuple) and len(each) == 2 for each in items):
        pairs = items
    else:
        raise TypeError("items: a mixture of detections and pairs; expected one of the two")
    for when, detections in pairs:
        yield when, sorted(detections, key=_order)


def _order(detection: Any) -> tuple[Any, ...]:
    vector = np.asarray(detection.state_vector, dtype=np.float64).ravel()
    return (detection.timestamp or EPOCH, *vector.tolist())


def to_stonesoup(
    tracks: Any, *, epoch: datetime = EPOCH, truth: bool = False
) -> set[Track] | set[GroundTruthPath]:
    """Tracks of this package as those of Stone Soup.

    Parameters
    ----------
    tracks : TrackResult, ScanResult, TrackReports, Positions, mapping or tuple
        A result of a tracker or scan tracker, or what else `fuzzytrack.score` takes.
    epoch : datetime
        Time 0.
    truth : bool
        Whether they are true paths.

    Returns
    -------
    set of Track, or set of GroundTruthPath
        State vectors are position and velocity of one axis after the other, as (x, vx, y, vy), or
        positions alone where there are no velocities. States of a scan tracker have the variances
        of its reports. The ``id`` of a track is its identity, or its number in a batch.

    Raises
    ------
    TypeError, ValueError
        If `tracks` is nothing of the kind, or a time is not within the years 1 to 9999.

    Examples
    --------
    >>> from fuzzytrack import AlphaBetaTracker, FixedGains
    >>> from fuzzytrack.interop.stonesoup import to_stonesoup
    >>> result = AlphaBetaTracker(FixedGains(0.5, 0.2)).run([0, 1, 2], [0, 10, 19])
    >>> (track,) = to_stonesoup(result)
    >>> track.state_vector
    StateVector([[19.5],
                 [ 9.8]])
    """
    found = as_positions(tracks, "tracks")
    deviations = _deviations(tracks, found)
    made: dict[Any, list[State]] = {}
    for row in np.argsort(found.time, kind="stable").tolist():
        vector, when = _vector(found, row), _timestamp(float(found.time[row]), epoch)
        if truth:
            state = GroundTruthState(vector, timestamp=when)
        elif deviations is not None:
            covar = CovarianceMatrix(np.diag(deviations[row] ** 2))
            state = GaussianState(vector, covar, timestamp=when)
        else:
            state = State(vector, timestamp=when)
        made.setdefault(found.id[row].item(), []).append(state)
    kind = GroundTruthPath if truth else Track
    return {kind(states, id=str(name)) for name, states in made.items()}


def as_positions(tracks: Any, name: str) -> Positions:
    """Positions of what a user has, a result of a tracker included.

    Parameters
    ----------
    tracks : TrackResult, or as for `fuzzytrack.scoring.Positions.of`
    name : str
        The argument, for messages.

    Raises
    ------
    TypeError, ValueError
        As for `fuzzytrack.scoring.Positions.of`, or if there are groups.
    """
    if isinstance(tracks, TrackResult):
        return _of_result(tracks)
    try:
        found = Positions.of(tracks, name)
    except TypeError:
        raise TypeError(
            f"{name}: {type(tracks).__name__}; expected a result of a tracker or scan tracker, "
            "a mapping of time, id and position, or a tuple (time, id, position)"
        ) from None
    if found.group is not None:
        raise ValueError(f"{name}: have groups; give those of one recording")
    return found


def _of_result(result: TrackResult) -> Positions:
    """Rows of the tracks of a run that have begun."""
    filtered, velocity = (
        np.asarray(values, np.float64).reshape(*_batch(result), -1)
        for values in (result.filtered, result.velocity)
    )
    steps, tracks = filtered.shape[:2]
    times = np.broadcast_to(result.time.reshape(steps, -1), (steps, tracks)).ravel()
    flat = filtered.reshape(steps * tracks, -1)
    known = ~np.isnan(flat).any(axis=1)
    return Positions.make(
        "tracks",
        times[known],
        np.tile(np.arange(tracks), steps)[known],
        flat[known],
        velocity.reshape(steps * tracks, -1)[known],
    )


def _batch(result: TrackResult) -> tuple[int, int]:
    """Number of steps, and of tracks."""
    shape = result.measured.shape
    return shape[0], int(np.prod(shape[1:-1], dtype=int))


def _deviations(tracks: Any, found: Positions) -> Array | None:
    """Standard deviations of reported tracks in the order of their state vectors, if they have any.

    Of a track that coasts beside a plot, the row with the plot is the one among the positions.
    """
    reports = getattr(tracks, "reports", tracks)
    if not hasattr(reports, "deviation"):
        return None
    seen_last = np.argsort(np.asarray(reports.plot) >= 0, kind="stable").tolist()
    names, times = reports.track_id.tolist(), reports.time.tolist()
    rows = {(names[row], times[row]): row for row in seen_last}
    chosen = [rows[key] for key in zip(found.id.tolist(), found.time.tolist(), strict=True)]
    every: Array = reports.deviation[chosen][:, [0, 2, 1, 3]]
    return every


def _vector(found: Positions, row: int) -> Any:
    if found.velocity is None:
        return StateVector(found.position[row])
    return StateVector(np.stack([found.position[row], found.velocity[row]], axis=-1).ravel())


def _seconds(when: datetime | None, epoch: datetime) -> float:
    if when is None:
        raise ValueError("items: a state or detection has no timestamp; give each of them one")
    if when.tzinfo is None and epoch.tzinfo is not None:
        raise ValueError(
            f"epoch: {epoch} has a time zone, but {when} among the items has none; give an epoch "
            "without one"
        )
    if when.tzinfo is not None and epoch.tzinfo is None:
        epoch = epoch.replace(tzinfo=UTC)
    return (when - epoch).total_seconds()


def _timestamp(seconds: float, epoch: datetime) -> datetime:
    try:
        return epoch + timedelta(seconds=seconds)
    except OverflowError:
        raise ValueError(
            f"tracks: the time {seconds:g} s after {epoch} is not within the years 1 to 9999; give "
            "times in seconds"
        ) from None
