"""One track out of a batch: its place, its values, its true positions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.trackers.result import TrackResult

__all__ = ["Track", "batch_of", "one_track", "place_of", "true_positions"]

#: Index of a track in its batch.
Track = int | tuple[int, ...]


def batch_of(result: TrackResult) -> tuple[int, ...]:
    """Shape of the batch of a result; () if it is one track."""
    return result.measured.shape[1:-1]


def place_of(result: object, track: Track | None) -> tuple[int, ...]:
    """Index of a track in its batch; () where there is no batch.

    Raises
    ------
    ValueError
        If there is no such track.
    """
    if not isinstance(result, TrackResult):
        raise ValueError(f"result: must be a TrackResult, got {type(result).__name__}")
    batch = batch_of(result)
    place = () if track is None else tuple(np.atleast_1d(track).tolist())
    if len(place) != len(batch) or any(not -n <= k < n for k, n in zip(place, batch, strict=True)):
        allowed = f"an index into a batch of shape {batch}" if batch else "None, there is one track"
        raise ValueError(f"track: must be {allowed}; got {track!r}")
    return place


def one_track(values: NDArray[Any], place: tuple[int, ...]) -> NDArray[Any]:
    """Values of one track, shape (n_steps, n_axes)."""
    # The batch in front, to be indexed away.
    moved = np.asarray(np.moveaxis(values, 0, len(place))[place] if place else values)
    return moved if moved.ndim > 1 else moved[:, None]


def true_positions(truth: ArrayLike, result: TrackResult, place: tuple[int, ...]) -> Array:
    """True positions of one track, given for it alone or for its batch.

    Raises
    ------
    ValueError
        If the shape does not fit.
    """
    actual = np.asarray(truth, dtype=np.float64)
    whole = result.measured.shape
    if actual.shape == whole:
        return one_track(actual, place)
    if actual.shape != (len(result.measured), *whole[len(place) + 1 :]):
        allowed = f"{whole} or {(whole[0], whole[-1])}" if len(whole) > 2 else f"{whole}"
        raise ValueError(f"truth: shape {actual.shape} does not fit the plots; needed is {allowed}")
    return actual if actual.ndim > 1 else actual[:, None]
