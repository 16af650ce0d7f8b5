"""Angles on the circle: within one turn, differences, and series without jumps.

Readers of polar plots and of bearings use this. The circle may have any length: ``2 * pi`` for
radians, 360 for degrees, or the period of a counter.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import positive

__all__ = ["TURN", "signed_difference", "unwrapped", "wrapped"]

#: A full turn in radians.
TURN = 2 * np.pi


def wrapped(angle: ArrayLike, period: float = TURN) -> Array:
    """Angles within one turn, from 0 to `period`.

    Parameters
    ----------
    angle : array_like
        Angles in any turn; NaN stays NaN.
    period : float
        Length of the circle, in the unit of the angles: ``2 * pi`` (default), 360, ...

    Returns
    -------
    ndarray
        The same directions in [0, `period`).

    Raises
    ------
    ValueError
        If the period is not finite and positive.
    """
    length = float(positive("period", period))
    with np.errstate(invalid="ignore"):
        inside = np.mod(np.asarray(angle, dtype=np.float64), length)
    # A tiny negative angle is rounded to the period itself.
    return np.asarray(np.where(inside == length, 0.0, inside))


def signed_difference(angle: ArrayLike, reference: ArrayLike, period: float = TURN) -> Array:
    """The shorter way on the circle from a reference to an angle.

    Parameters
    ----------
    angle, reference : array_like
        Angles in any turn, which broadcast against each other; NaN gives NaN.
    period : float
        Length of the circle, in the unit of the angles.

    Returns
    -------
    ndarray
        Differences in [-`period`/2, `period`/2): what `reference` turns by to become `angle`.

    Raises
    ------
    ValueError
        If the period is not finite and positive.
    """
    length = float(positive("period", period))
    with np.errstate(invalid="ignore"):
        difference = np.asarray(angle, dtype=np.float64) - np.asarray(reference, dtype=np.float64)
        # The remainder is exact; the usual mod(d + half) - half loses the digits of a small d.
        shorter = np.fmod(difference, length)
    shorter = np.where(shorter >= length / 2, shorter - length, shorter)
    return np.asarray(np.where(shorter < -length / 2, shorter + length, shorter))


def unwrapped(angle: ArrayLike, tracks: ArrayLike | None = None, period: float = TURN) -> Array:
    """A series of angles without jumps: whole turns are added to each.

    Each angle is taken in the turn that brings it nearest to the one before it in its track,
    missed ones left out. So a target must turn by less than half a circle between two plots.

    Parameters
    ----------
    angle : array_like, shape (n,)
        Angles in the order of time; NaN is a missed plot, and stays NaN.
    tracks : array_like, shape (n,), optional
        To which track each angle belongs, as numbers or words; tracks may alternate. Without
        it all belong to one.
    period : float
        Length of the circle, in the unit of the angles.

    Returns
    -------
    ndarray, shape (n,)
        Angles plus whole periods. The first angle of each track is as it was given.

    Raises
    ------
    ValueError
        If the period is not finite and positive, or the shapes are others.
    """
    length = float(positive("period", period))
    series = np.array(angle, dtype=np.float64)
    if series.ndim != 1:
        raise ValueError(f"`angle`: shape {series.shape}; expected one angle for each plot, (n,)")
    group = _numbered(tracks, series.size)
    # Tracks one after the other, each in the order of its rows.
    present = np.flatnonzero(np.isfinite(series))
    order = present[np.argsort(group[present], kind="stable")]
    ordered = series[order]
    step = np.diff(ordered)
    turns = np.round((step - signed_difference(step, 0.0, length)) / length)
    same = np.diff(group[order]) == 0
    total = np.concatenate([[0.0], np.cumsum(np.where(same, turns, 0.0))])[: order.size]
    starts = np.flatnonzero(np.concatenate([[True], ~same]))[: order.size]
    total -= np.repeat(total[starts], np.diff(np.append(starts, order.size)))
    series[order] = ordered - total * length
    return series


def _numbered(tracks: ArrayLike | None, size: int) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Which track each row is of, as numbers from 0."""
    if tracks is None:
        return np.zeros(size, dtype=np.int64)
    words = np.asarray(tracks)
    if words.shape != (size,):
        raise ValueError(f"`tracks`: shape {words.shape}; expected {(size,)}, that of `angle`")
    _, numbers = np.unique(words, return_inverse=True)
    return np.asarray(numbers, dtype=np.int64).reshape(size)
