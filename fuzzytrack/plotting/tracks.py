"""Tracks: true, measured and estimated positions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.trackers.result import TrackResult

__all__ = ["plot_errors", "plot_track"]

Track = int | tuple[int, ...]


def plot_track(
    result: TrackResult,
    truth: ArrayLike | None = None,
    axes_names: Sequence[str] | None = None,
    unit: str = "m",
    track: Track | None = None,
    *,
    ax: Axes | Sequence[Axes] | None = None,
) -> tuple[Figure, Axes | shared.AxesArray]:
    """One track: true, measured, predicted and filtered positions.

    Parameters
    ----------
    result : TrackResult
        Two axes of space are drawn as a plane of equal scales, one or more than two against time.
    truth : array_like, optional
        True positions, shaped as the plots of the track, or of the batch.
    axes_names : sequence of str, optional
        Names of the axes of space; x, y, z unless given.
    unit : str
        Unit of position, for the labels.
    track : int or tuple of int, optional
        Which track of a batch.
    ax : Axes or sequence of Axes, optional
        Axes to draw into; with more than two axes of space, one each.

    Returns
    -------
    figure : Figure
    ax : Axes, or ndarray of Axes with more than two axes of space

    Raises
    ------
    ValueError
        If `track` is missing, not allowed or out of range, or shapes do not fit.

    Notes
    -----
    Llinas et al. (1998), Fig. 5.1.
    """
    place = _place(result, track)
    shown = _Shown(result, place)
    n_axes = shown.measured.shape[1]
    names = tuple("xyz"[:n_axes]) if n_axes <= 3 else tuple(f"x{k + 1}" for k in range(n_axes))
    if axes_names is not None:
        names = tuple(axes_names)
        if len(names) != n_axes:
            raise ValueError(
                f"axes_names: needs {n_axes} names, got {len(names)}: {', '.join(names)}"
            )
    actual = None if truth is None else _truth(truth, result, place)
    labels = [f"{name} ({unit})" if unit else name for name in names]
    if n_axes == 2:
        figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 6.0))
        shown.draw(plane, (0, 1), actual)
        plane.set_aspect("equal", adjustable="datalim")
        plane.set(xlabel=labels[0], ylabel=labels[1])
        shared.legend_below(plane)
        return figure, plane
    height = 4.2 if n_axes == 1 else 2.4
    figure, grid = shared.panels("ax", ax, n_axes, columns=1, size=(6.4, height))
    for k, panel in enumerate(grid):
        shown.draw(panel, (None, k), actual)
        panel.set_ylabel(labels[k])
    grid[-1].set_xlabel("time (s)")
    shared.legend_below(grid[-1])
    return figure, grid[0] if n_axes == 1 else grid


class _Shown:
    """One track of a result, shape (n_steps, n_axes)."""

    def __init__(self, result: TrackResult, place: tuple[int, ...]) -> None:
        self.time = _time(result, place)
        self.measured = _one(result.measured, place)
        self.predicted = _one(result.predicted, place)
        self.filtered = _one(result.filtered, place)
        self.coasted = np.any(_one(result.coasted, place), axis=1)

    def draw(self, ax: Axes, axes: tuple[int | None, int], truth: Array | None) -> None:
        """Draw one axis of space over another, or over time (None)."""

        def on(positions: Array) -> list[Array]:
            return [self.time if k is None else positions[:, k] for k in axes]

        if truth is not None:
            ax.plot(*on(truth), color=shared.INK, linewidth=1.2, label="true", zorder=2)
        ax.plot(
            *on(self.measured),
            linestyle="none",
            marker="s",
            markersize=4.5,
            markerfacecolor="none",
            color=shared.GRAY,
            label="measured",
            zorder=1,
        )
        ax.plot(
            *on(self.predicted),
            linestyle="none",
            marker="x",
            markersize=4.5,
            color=shared.VERMILION,
            label="predicted",
            zorder=3,
        )
        ax.plot(
            *on(self.filtered),
            marker="o",
            markersize=3.5,
            linewidth=1.2,
            color=shared.BLUE,
            label="filtered",
            zorder=4,
        )
        if self.coasted.any():
            ax.plot(
                *(values[self.coasted] for values in on(self.filtered)),
                linestyle="none",
                marker="o",
                markersize=9,
                markerfacecolor="none",
                markeredgewidth=1.4,
                color=shared.ORANGE,
                label="coasted (no plot)",
                zorder=5,
            )
        shared.finish(ax)


def plot_errors(
    results: TrackResult | Mapping[str, TrackResult],
    truth: ArrayLike,
    unit: str = "m",
    track: Track | None = None,
    *,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Prediction error over time, one line for each tracker.

    Parameters
    ----------
    results : TrackResult, or mapping of str to TrackResult
        With labels for the legend.
    truth : array_like
        True positions, shaped as the plots of a track, or of the batch.
    unit : str
        Unit of position, for the label.
    track : int or tuple of int, optional
        Which track of a batch; the root mean square over all of them unless given.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If no result is given, `track` is not allowed or out of range, shapes do not fit, or tracks
        with different times have no mean.

    Notes
    -----
    The error of one prediction is its distance from the truth over all axes of space.
    """
    if isinstance(results, TrackResult):
        results = {"prediction": results}
    if not isinstance(results, Mapping) or not results:
        raise ValueError(
            "results: must be a TrackResult or a mapping from labels to at least one, "
            f"got {results!r}"
        )
    lines, batch = [], False
    for label, result in results.items():
        if not isinstance(result, TrackResult):
            raise ValueError(f"results: {label!r} must be a TrackResult, got {result!r}")
        mean = track is None and _batch(result) != ()
        batch = batch or mean
        place = () if mean else _place(result, track)
        if mean and result.time.ndim > 1:
            raise ValueError("track: tracks with times of their own have no common mean; give one")
        square = _squares(result, truth, place, mean)
        lines.append((str(label), _time(result, place), np.sqrt(square)))
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 4.2))
    styles = ("-", "--", "-.", ":")
    for number, (label, time, error) in enumerate(lines):
        plane.plot(
            time,
            error,
            label=label,
            color=shared.COLORS[number % len(shared.COLORS)],
            linestyle=styles[number % len(styles)],
            linewidth=1.6,
        )
    what = "prediction error, RMS over tracks" if batch else "prediction error"
    plane.set(xlabel="time (s)", ylabel=f"{what} ({unit})" if unit else what)
    plane.set_ylim(bottom=0.0)
    shared.finish(plane)
    shared.legend_below(plane)
    return figure, plane


def _squares(result: TrackResult, truth: ArrayLike, place: tuple[int, ...], mean: bool) -> Array:
    """Squared distance at every step, averaged over a batch; NaN where nothing is predicted."""
    if not mean:
        distance = _one(result.predicted, place) - _truth(truth, result, place)
        return np.asarray((distance**2).sum(axis=1))
    shape = result.measured.shape
    actual = np.asarray(truth, dtype=np.float64)
    if actual.shape == (shape[0], shape[-1]):
        actual = actual.reshape(shape[0], *(1,) * len(_batch(result)), shape[-1])
    elif actual.shape != shape:
        raise ValueError(_wrong_shape(actual.shape, result))
    squares = ((result.predicted - actual) ** 2).sum(axis=-1).reshape(shape[0], -1)
    known = np.isfinite(squares)
    counts = known.sum(axis=1)
    total = np.where(known, squares, 0.0).sum(axis=1)
    return np.where(counts > 0, total / np.maximum(counts, 1), np.nan)


def _batch(result: TrackResult) -> tuple[int, ...]:
    return result.measured.shape[1:-1]


def _place(result: object, track: Track | None) -> tuple[int, ...]:
    """Index of the track in the batch; () where there is no batch."""
    if not isinstance(result, TrackResult):
        raise ValueError(f"result: must be a TrackResult, got {type(result).__name__}")
    batch = _batch(result)
    place = () if track is None else tuple(np.atleast_1d(track).tolist())
    if len(place) != len(batch) or any(not -n <= k < n for k, n in zip(place, batch, strict=True)):
        allowed = f"an index into a batch of shape {batch}" if batch else "None, there is one track"
        raise ValueError(f"track: must be {allowed}; got {track!r}")
    return place


def _one(values: NDArray[Any], place: tuple[int, ...]) -> NDArray[Any]:
    """Values of one track, shape (n_steps, n_axes)."""
    # The batch in front, to be indexed away.
    return np.asarray(np.moveaxis(values, 0, len(place))[place]).reshape(len(values), -1)


def _time(result: TrackResult, place: tuple[int, ...]) -> Array:
    return _one(result.time, place)[:, 0] if result.time.ndim > 1 else result.time


def _truth(truth: ArrayLike, result: TrackResult, place: tuple[int, ...]) -> Array:
    actual = np.asarray(truth, dtype=np.float64)
    if actual.shape == result.measured.shape:
        return _one(actual, place)
    track = (len(result.measured), *result.measured.shape[len(place) + 1 :])
    if actual.shape != track:
        raise ValueError(_wrong_shape(actual.shape, result))
    return actual.reshape(len(actual), -1)


def _wrong_shape(shape: tuple[int, ...], result: TrackResult) -> str:
    whole = result.measured.shape
    allowed = f"{whole} or {(whole[0], whole[-1])}" if len(whole) > 2 else f"{whole}"
    return f"truth: shape {shape} does not fit the plots; needed is {allowed}"
