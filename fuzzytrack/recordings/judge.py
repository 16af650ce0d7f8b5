"""Plots judged by the prediction of their track, before they are used: a gate, and a circle.

`fuzzytrack.recordings.judged` runs trackers with it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.gains.checks import number, positive
from fuzzytrack.io.angles import wrapped
from fuzzytrack.reprs import constructor_code, summary

__all__ = ["Circle", "Gate", "Judge", "JudgeMemory", "Verdict"]


@dataclass(frozen=True)
class Gate:
    """Plots too far from the prediction are not used.

    A plot is rejected, all of its axes, if its innovation on one of them exceeds::

        width · σ · max(1, dt / 2T)² + |e|

    where dt is the time since the last plot used, T the mean interval between plots used so far,
    and e the innovation of the last plot used. The square is what a target may do in a gap; e lets
    a tracker lag behind a maneuver, or catch up after one. The first two plots of a track, from
    which it knows no velocity, are always used, and there is no e before the third.

    Parameters
    ----------
    width : float
        In standard deviations of a plot, > 0.
    again : int
        After this many rejected plots in a row, the next that would be rejected starts the track
        again, >= 0. A track that follows a wrong plot, or that has lost its target, thus recovers.

    Raises
    ------
    ValueError
        If a number is out of its range.
    """

    width: float = 20.0
    again: int = 3

    def __post_init__(self) -> None:
        object.__setattr__(self, "width", number("width", positive("width", self.width)))
        if self.again < 0:
            raise ValueError(f"again must not be negative, got {self.again}")

    def __repr__(self) -> str:
        return constructor_code(self)


@dataclass(frozen=True)
class Circle:
    """Angles on a circle: each plot is taken in the turn that is nearest to its prediction.

    The second plot of a track, for which there is none, is taken in the turn nearest to the first.

    Parameters
    ----------
    period : float
        A full turn in the unit of the plots, > 0.

    Raises
    ------
    ValueError
        If `period` is not positive.
    """

    period: float = 360.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "period", number("period", positive("period", self.period)))

    def __repr__(self) -> str:
        return constructor_code(self)

    def wrapped(self, angle: ArrayLike) -> Array:
        """Angles of a track within one turn, in [0, `period`)."""
        return wrapped(angle, self.period)


@dataclass(frozen=True)
class Judge:
    """What happens to plots before they are used.

    Parameters
    ----------
    gate : Gate, optional
    circle : Circle, optional
        The axes of the plots are angles; the gate judges them on the circle.
    """

    gate: Gate | None = None
    circle: Circle | None = None

    def __repr__(self) -> str:
        return constructor_code(self)


# Mean intervals from which on there is a gap.
_GAP = 2.0
# What the memory of a gate has of each axis.
_FIRST, _LAST, _COUNT, _INNOVATION, _REJECTED = range(5)
_NUMBERS = 5


@dataclass(frozen=True, eq=False)
class JudgeMemory:
    """What a gate needs to know of tracks, to continue beside their states.

    Attributes
    ----------
    numbers : ndarray, shape (n_tracks, n_axes, 5)
        Of each axis: times of the first and of the last plot used (s), number of plots used, size
        of the innovation of the last; and plots of the track rejected in a row.
    """

    numbers: Array

    def __repr__(self) -> str:
        return summary(self, "numbers")

    @classmethod
    def fresh(cls, n_tracks: int, n_axes: int) -> JudgeMemory:
        """Memory of tracks before their first plot."""
        return cls(np.zeros((n_tracks, n_axes, _NUMBERS)))

    @property
    def rejected(self) -> NDArray[np.int64]:
        """Plots rejected in a row, shape (n_tracks,)."""
        return self.numbers[:, 0, _REJECTED].astype(np.int64)


@dataclass(frozen=True, eq=False)
class Verdict:
    """What is to happen to the plots of some tracks, if all plots before were treated rightly.

    Attributes
    ----------
    rejected, begins : ndarray of bool, shape (n_steps, n_tracks)
        Plots that are not used; those that start their track again.
    turns : ndarray, shape (n_steps, n_tracks, n_axes)
        Turns of the circle to add to each plot, a whole number.
    numbers : ndarray, shape (n_steps + 1, n_tracks, n_axes, 5)
        Memory before each plot, and after the last.
    """

    rejected: Mask
    begins: Mask
    turns: Array
    numbers: Array

    def __repr__(self) -> str:
        return summary(self, "rejected")


# -------------------------------------------------------------------- plots as they would be used


def used(judge: Judge, plots: Array, rejected: Mask, turns: Array) -> Array:
    """Plots as a tracker gets them: NaN where rejected, and in their turn of the circle."""
    values = plots if judge.circle is None else plots + judge.circle.period * turns
    return np.where(rejected[..., None], np.nan, values)


def judged(
    judge: Judge,
    times: Array,
    plots: Array,
    sigma: Array,
    given: Array,
    rejected: Mask,
    predicted: Array,
    position: Array,
    memory: Array,
) -> Verdict:
    """Judge plots by the predictions of a run over some of them.

    Parameters
    ----------
    judge : Judge
    times : ndarray, shape (n_steps, n_tracks)
        Times (s).
    plots : ndarray, shape (n_steps, n_tracks, n_axes)
        Plots, before they are judged.
    sigma : ndarray
        Standard deviations of the plots, broadcasting with them.
    given : ndarray, shape (n_steps, n_tracks, n_axes)
        Plots as the run got them.
    rejected : ndarray of bool, shape (n_steps, n_tracks)
        Plots that it did not get.
    predicted : ndarray, shape (n_steps, n_tracks, n_axes)
        Predictions of the run.
    position : ndarray, shape (n_tracks, n_axes)
        Where the tracks were before these plots; NaN of new ones.
    memory : ndarray, shape (n_tracks, n_axes, 5)
        Memory before the first of these plots.
    """
    turns = np.zeros((1, 1, 1))
    if judge.circle is not None:
        near = predicted
        if (np.isnan(predicted) & ~np.isnan(plots)).any():
            # The second plot of a track lies near the first.
            near = np.where(np.isnan(predicted), _before(given, position), predicted)
        with np.errstate(invalid="ignore", over="ignore"):
            turns = np.round((near - plots) / judge.circle.period)
        # The first plot stays in its turn.
        turns = np.where(np.isfinite(turns), turns, 0.0)
        plots = plots + judge.circle.period * turns
    if judge.gate is None:
        nothing = np.zeros(rejected.shape, dtype=np.bool_)
        kept = np.broadcast_to(memory, (len(times) + 1, *memory.shape))
        return Verdict(nothing, nothing, turns, kept)
    numbers = _history(times, given, rejected, predicted, memory)
    first, last, count, innovation, row = (numbers[:-1, ..., k] for k in range(_NUMBERS))
    with np.errstate(all="ignore"):
        typical = (last - first) / (count - 1)
        growth = np.maximum(1.0, (times[..., None] - last) / (_GAP * typical))
        limit = judge.gate.width * sigma * (growth * growth) + innovation
        far = (count >= 2) & (np.abs(plots - predicted) > limit)
    beyond = far.any(axis=2)
    begins = beyond & (row[..., 0] >= judge.gate.again)
    return Verdict(beyond & ~begins, begins, turns, numbers)


def _history(times: Array, given: Array, rejected: Mask, predicted: Array, memory: Array) -> Array:
    """Memory before each plot and after the last, shape (n_steps + 1, n_tracks, n_axes, 5)."""
    steps = len(times)
    numbers = np.empty((steps + 1, *memory.shape))
    seen = ~np.isnan(given)
    count = numbers[..., _COUNT]
    count[0] = memory[..., _COUNT]
    np.cumsum(seen, axis=0, out=count[1:])
    count[1:] += count[0]
    # Place of the last plot used before each, -1 for one before all of these.
    place = np.full((steps + 1, *seen.shape[1:]), -1)
    np.maximum.accumulate(
        np.where(seen, np.arange(steps)[:, None, None], -1), axis=0, out=place[1:]
    )
    with np.errstate(invalid="ignore", over="ignore"):
        size = np.abs(given - predicted)
    # The first innovation is the way that the target went, and not an error.
    size = np.where((count[:-1] >= 2) & (size == size), size, 0.0)
    when = np.broadcast_to(times[..., None], seen.shape)
    for row, values in ((_LAST, when), (_INNOVATION, size)):
        at = np.take_along_axis(values, np.maximum(place, 0), axis=0) if steps else place
        numbers[..., row] = np.where(place < 0, memory[..., row], at)
    begun = memory[..., _COUNT] > 0
    earliest = np.where(seen, when, math.inf).min(axis=0, initial=math.inf)
    numbers[..., _FIRST] = np.where(begun, memory[..., _FIRST], earliest)
    missing = np.isinf(numbers[..., _FIRST])
    numbers[..., _FIRST][missing] = 0.0
    numbers[..., _REJECTED] = _in_a_row(np.asarray(seen.any(axis=2)), rejected, memory)[..., None]
    return numbers


def _in_a_row(accepted: Mask, rejected: Mask, memory: Array) -> Array:
    """Plots rejected in a row, before each plot and after the last."""
    total = np.zeros((len(rejected) + 1, rejected.shape[1]))
    total[0] = memory[:, 0, _REJECTED]
    np.cumsum(rejected, axis=0, out=total[1:])
    total[1:] += total[0]
    # Those until the last plot that was used; the sum never falls.
    until = np.zeros_like(total)
    np.maximum.accumulate(np.where(accepted, total[1:], 0.0), axis=0, out=until[1:])
    return total - until


# -------------------------------------------------------------------- a first guess


def guessed(
    judge: Judge, times: Array, plots: Array, sigma: Array, position: Array
) -> tuple[Mask, Array]:
    """Guess what will happen to plots, without predictions.

    Parameters
    ----------
    judge, times, plots, sigma
        As for `judged`.
    position : ndarray, shape (n_tracks, n_axes)
        Where the tracks are before these plots; NaN of new ones.

    Returns
    -------
    rejected : ndarray of bool, shape (n_steps, n_tracks)
    turns : ndarray
        Broadcasting with the plots.
    """
    rejected = np.zeros(plots.shape[:2], dtype=np.bool_)
    turns = np.zeros((1, 1, 1))
    if judge.circle is not None:
        turns = _turns(judge.circle.period, plots, position)
        plots = plots + judge.circle.period * turns
    if judge.gate is not None and len(plots) > 2:
        rejected[1:-1] = _spikes(judge.gate.width, times, plots, sigma)
    return rejected, turns


def _turns(period: float, plots: Array, position: Array) -> Array:
    """Turns that bring each plot near the one before it."""
    # A new track begins in the turn of its first plot, as if it had been there before.
    start = np.take_along_axis(plots, np.argmax(~np.isnan(plots), axis=0)[None], axis=0)[0]
    before = _before(plots, np.where(np.isnan(position), start, position))
    with np.errstate(invalid="ignore"):
        steps = np.round((before - plots) / period)
    return np.cumsum(np.where(np.isfinite(steps), steps, 0.0), axis=0)


def _before(plots: Array, position: Array) -> Array:
    """The plot before each that is not missed; at first where the tracks were."""
    series = np.concatenate([position[None], plots])
    steps = np.arange(len(series))[:, None, None]
    place = np.maximum.accumulate(np.where(np.isnan(series), 0, steps), axis=0)
    return np.asarray(np.take_along_axis(series, place[:-1], axis=0))


def _spikes(width: float, times: Array, plots: Array, sigma: Array) -> Mask:
    """Plots that are far from the line between their neighbors, and farther than these are."""
    before, after = np.diff(times, axis=0)[:-1], np.diff(times, axis=0)[1:]
    share = (before / (before + after))[..., None]
    full = np.broadcast_to(sigma, plots.shape)[1:-1]
    with np.errstate(all="ignore"):
        middle = plots[:-2] + (plots[2:] - plots[:-2]) * share
        sizes = np.abs(plots[1:-1] - middle) / full
    size = np.where(np.isnan(sizes), 0.0, sizes).max(axis=2)
    around = np.zeros((len(size) + 2, size.shape[1]))
    around[1:-1] = size
    return np.asarray((size > width) & (size >= around[:-2]) & (size >= around[2:]))
