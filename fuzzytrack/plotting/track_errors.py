"""Errors of tracks over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._batch_track import (
    Track,
    batch_of,
    one_track,
    place_of,
    true_positions,
)
from fuzzytrack.plotting._maneuvers import (
    Intervals,
    checked_intervals,
    maneuvers_of,
    shade_maneuvers,
)
from fuzzytrack.plotting._position_axes import time_unit
from fuzzytrack.plotting._ragged_lines import is_ragged, running_rms
from fuzzytrack.plotting._tracker_lines import (
    draw_rest,
    scale_axis,
    tracker_look,
    with_a_line,
)
from fuzzytrack.trackers.result import TrackResult

__all__ = ["plot_errors"]

# Part of a track over which errors are smoothed where they are too ragged.
_SMOOTHED = 1 / 30


def plot_errors(
    results: TrackResult | Mapping[str, TrackResult],
    truth: ArrayLike,
    unit: str = "m",
    track: Track | None = None,
    *,
    maneuvers: Intervals | Literal["auto"] = "auto",
    smooth: int | None = None,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Prediction error over time, one line for each tracker, with maneuvers shaded.

    Parameters
    ----------
    results : TrackResult, or mapping of str to TrackResult
        With labels for the legend. Of more than six, the first and the four with the smallest
        median errors are lines; of the others the median and the quartiles are a band.
    truth : array_like
        True positions, shaped as the plots of a track, or of the batch.
    unit : str
        Unit of position, for the label.
    track : int or tuple of int, optional
        Which track of a batch; the root mean square over all of them unless given.
    maneuvers : sequence of (float, float), or "auto"
        First and last times of maneuvers (s). "auto" takes the times at which the truth
        accelerates, if it is the same for all tracks: with more than a fifth of its largest
        acceleration. None is found where it always does, or in a truth with noise of its own.
    smooth : int, optional
        Number of plots over which errors are averaged (root mean square), an odd one; 1 is not at
        all. Unless given, about a thirtieth of all where lines would be too ragged to be read.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If no result is given, `track` is not allowed or out of range, shapes do not fit, tracks
        with different times have no mean, or `maneuvers` or `smooth` is wrong.

    Notes
    -----
    The error of one prediction is its distance from the truth over all axes of space. The scale is
    logarithmic where one tracker is far worse than another.
    """
    given = _checked(results)
    if smooth is not None and (smooth < 1 or smooth % 2 == 0):
        raise ValueError(f"smooth: must be an odd number of plots, at least 1, got {smooth}")
    shaded = None if isinstance(maneuvers, str) else checked_intervals(maneuvers)
    if shaded is None and maneuvers != "auto":
        raise ValueError(f"maneuvers: must be pairs of times, or 'auto', got {maneuvers!r}")
    lines, batch = [], False
    for label, result in given.items():
        mean = track is None and batch_of(result) != ()
        batch = batch or mean
        place = () if mean else place_of(result, track)
        if mean and result.time.ndim > 1:
            raise ValueError("track: tracks with times of their own have no common mean; give one")
        time = one_track(result.time, place)[:, 0] if result.time.ndim > 1 else result.time
        error = np.sqrt(_squares(result, truth, place, mean))
        lines.append((label, time, error))
        if shaded is None:
            actual = _common_truth(truth, result, place, mean)
            shaded = [] if actual is None else maneuvers_of(time, actual)
    what = "prediction error, RMS over tracks" if batch else "prediction error"
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 4.2))
    _draw(plane, lines, smooth, shaded or [], f"{what} ({unit})" if unit else what)
    return figure, plane


def _checked(results: object) -> dict[str, TrackResult]:
    if isinstance(results, TrackResult):
        return {"prediction": results}
    if not isinstance(results, Mapping) or not results:
        raise ValueError(
            "results: must be a TrackResult or a mapping from labels to at least one, "
            f"got {results!r}"
        )
    for label, result in results.items():
        if not isinstance(result, TrackResult):
            raise ValueError(f"results: {label!r} must be a TrackResult, got {result!r}")
    return {str(label): result for label, result in results.items()}


def _draw(
    ax: Axes,
    lines: list[tuple[str, Array, Array]],
    smooth: int | None,
    maneuvers: Intervals,
    what: str,
) -> None:
    unit, second = time_unit(np.concatenate([time for _, time, _ in lines]))
    count = smooth or _suitable(lines)
    curves = [(label, time / second, running_rms(e, count)) for label, time, e in lines]
    same = all(np.array_equal(time, curves[0][1]) for _, time, _ in curves)
    errors = [error for _, _, error in curves]
    lines_of = with_a_line(errors) if same else list(range(len(curves)))
    for number in lines_of:
        label, time, error = curves[number]
        ax.plot(time, error, label=label, linewidth=1.6, **tracker_look(number))
    rest = [error for number, error in enumerate(errors) if number not in lines_of]
    draw_rest(ax, curves[0][1], rest)
    shade_maneuvers(ax, maneuvers, second)
    ax.set(xlabel=f"time ({unit})", ylabel=what)
    scale_axis(ax, "y", errors)
    ax.margins(x=0.01)
    shared.finish(ax)
    shared.legend_below(ax)
    legend = ax.get_legend()
    if count > 1 and legend is not None:
        legend.set_title(f"root mean square of {count} plots")


def _suitable(lines: list[tuple[str, Array, Array]]) -> int:
    """An odd number of plots to smooth errors over; 1 if all lines can be read."""
    ragged = [len(error) for _, _, error in lines if is_ragged(error)]
    return 2 * round(max(ragged) * _SMOOTHED / 2) + 1 if ragged else 1


def _squares(result: TrackResult, truth: ArrayLike, place: tuple[int, ...], mean: bool) -> Array:
    """Squared distance at every step, averaged over a batch; NaN where nothing is predicted."""
    if not mean:
        distance = one_track(result.predicted, place) - true_positions(truth, result, place)
        return np.asarray((distance**2).sum(axis=1))
    shape = result.measured.shape
    actual = np.asarray(truth, dtype=np.float64)
    if actual.shape != shape:
        actual = true_positions(truth, result, (0,) * len(batch_of(result)))
        actual = actual.reshape(shape[0], *(1,) * len(batch_of(result)), shape[-1])
    squares = ((result.predicted - actual) ** 2).sum(axis=-1).reshape(shape[0], -1)
    known = np.isfinite(squares)
    counts = known.sum(axis=1)
    total = np.where(known, squares, 0.0).sum(axis=1)
    return np.where(counts > 0, total / np.maximum(counts, 1), np.nan)


def _common_truth(
    truth: ArrayLike, result: TrackResult, place: tuple[int, ...], mean: bool
) -> Array | None:
    """True positions of a track; None where those of a batch differ."""
    if not mean:
        return true_positions(truth, result, place)
    first = true_positions(truth, result, (0,) * len(batch_of(result)))
    actual = np.asarray(truth, dtype=np.float64)
    if actual.shape == result.measured.shape:
        same = first.reshape(len(first), *(1,) * len(batch_of(result)), -1)
        if not np.array_equal(actual, np.broadcast_to(same, actual.shape), equal_nan=True):
            return None
    return first
