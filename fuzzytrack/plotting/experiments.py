"""Simulated experiments: errors of trackers over many runs, and single runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.gains.checks import finite
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._maneuvers import Intervals, checked_intervals, shade_maneuvers
from fuzzytrack.plotting._track_styles import STYLES as TRACK_STYLES
from fuzzytrack.plotting._tracker_lines import scale_axis, tracker_look

__all__ = [
    "plot_consistency",
    "plot_error_distribution",
    "plot_error_over_time",
    "plot_trajectories",
]

Unit = Literal["m", "km"]

# Number of points of a curve of a distribution; more would not be visible.
POINTS = 400
# Share of the errors of the worst tracker that a distribution shows; outliers would squeeze the
# rest.
SHOWN = 0.99
# Meters beyond which positions are labeled in kilometers.
FAR = 5000.0
# Scans beyond which markers of every scan would run into each other.
DENSE = 150


def plot_error_over_time(
    time: ArrayLike,
    errors: Mapping[str, ArrayLike],
    bands: Mapping[str, tuple[ArrayLike, ArrayLike]] | None = None,
    *,
    measured: ArrayLike | None = None,
    scored_from: float | None = None,
    maneuvers: Intervals = (),
    what: str = "prediction error, RMS over runs",
    unit: str = "m",
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Error over time, one line for each tracker, with bands of its uncertainty.

    Parameters
    ----------
    time : array_like, shape (n_steps,)
        Times of the scans (s).
    errors : mapping of str to array_like, shape (n_steps,)
        Error of each tracker, by label; NaN where there is none.
    bands : mapping of str to (low, high), optional
        Lower and upper limit of the error of a tracker, each of shape (n_steps,).
    measured : array_like, shape (n_steps,), optional
        Error of the plots themselves.
    scored_from : float, optional
        Time of the first scan that counts (s); what is before it is shaded.
    maneuvers : sequence of (float, float)
        First and last times of maneuvers of the target (s), to be shaded.
    what, unit : str
        Error and its unit, for the label.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If there is no tracker, shapes do not fit, a band has the label of no tracker, or
        `maneuvers` are no pairs of times.

    Notes
    -----
    The scale of errors is logarithmic where one tracker is far worse than another.
    """
    steps = _times(time)
    curves = _curves("errors", errors, len(steps))
    limits = {}
    for label, pair in (bands or {}).items():
        if label not in curves:
            raise ValueError(f"bands: unknown {label!r}; one of {', '.join(curves)}")
        limits[label] = [_curve(f"bands: {label!r}", side, len(steps)) for side in pair]
    plots = None if measured is None else _curve("measured", measured, len(steps))
    shaded = checked_intervals(maneuvers)
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 4.2))
    for number, (label, curve) in enumerate(curves.items()):
        look = tracker_look(number)
        plane.plot(steps, curve, label=label, linewidth=1.6, **look)
        if label in limits:
            plane.fill_between(steps, *limits[label], color=look["color"], alpha=0.2, linewidth=0)
    if plots is not None:
        plane.plot(steps, plots, color=shared.GRAY, linewidth=1.2, label="plots", zorder=1)
    scale_axis(plane, "y", [*curves.values()])
    if scored_from is not None and scored_from > steps[0]:
        plane.axvspan(steps[0], scored_from, color="0.94", linewidth=0, label="not scored")
    shade_maneuvers(plane, shaded)
    _label_time(plane, steps, f"{what} ({unit})" if unit else what)
    return figure, plane


def plot_trajectories(
    time: ArrayLike,
    truth: ArrayLike,
    plots: ArrayLike,
    predicted: Mapping[str, ArrayLike],
    *,
    unit: Unit | None = None,
    axes_names: Sequence[str] | None = None,
    ax: Axes | Sequence[Axes] | None = None,
) -> tuple[Figure, Axes | shared.AxesArray]:
    """One run: true positions, plots and the predictions of each tracker.

    Parameters
    ----------
    time : array_like, shape (n_steps,)
        Times of the scans (s).
    truth, plots : array_like, shape (n_steps, n_axes)
        True positions and plots (m); NaN where missed. Two axes of space are drawn as a plane of
        equal scales, one or more than two against time.
    predicted : mapping of str to array_like, shape (n_steps, n_axes)
        Predicted positions of each tracker (m), by label; hollow where there was no plot.
    unit : {"m", "km"}, optional
        Unit to show; kilometers if the run spans more than 5 km unless given.
    axes_names : sequence of str, optional
        Names of the axes of space; x, y, z unless given.
    ax : Axes or sequence of Axes, optional
        Axes to draw into; with more than two axes of space, one each.

    Returns
    -------
    figure : Figure
    ax : Axes, or ndarray of Axes with more than two axes of space

    Raises
    ------
    ValueError
        If there is no tracker, shapes do not fit, or `unit` is unknown.

    Notes
    -----
    Llinas et al. (1998), Fig. 5.1.
    """
    steps = _times(time)
    actual = np.asarray(truth, dtype=np.float64)
    if actual.ndim != 2 or len(actual) != len(steps) or not actual.shape[1]:
        raise ValueError(f"truth: needs shape ({len(steps)}, n_axes), got {actual.shape}")
    seen = _fitting("plots", plots, actual.shape)
    tracks = {
        label: _fitting(f"predicted: {label!r}", p, actual.shape)
        for label, p in _some("predicted", predicted).items()
    }
    n_axes = actual.shape[1]
    names = tuple("xyz"[:n_axes]) if n_axes <= 3 else tuple(f"x{k + 1}" for k in range(n_axes))
    if axes_names is not None:
        names = tuple(axes_names)
        if len(names) != n_axes:
            raise ValueError(f"axes_names: needs {n_axes} names, got {len(names)}")
    if unit is None:
        known = actual[np.isfinite(actual).all(axis=1)]
        unit = "km" if len(known) and np.ptp(known, axis=0).max() > FAR else "m"
    shared.choice("unit", unit, ("m", "km"))
    size = 1000.0 if unit == "km" else 1.0
    run = _Run(steps, actual / size, seen / size, {k: p / size for k, p in tracks.items()})
    labels = [f"{name} ({unit})" for name in names]
    if n_axes == 2:
        figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 6.0))
        run.draw(plane, (0, 1))
        plane.set_aspect("equal", adjustable="datalim")
        plane.set(xlabel=labels[0], ylabel=labels[1])
        shared.legend_below(plane)
        return figure, plane
    height = 4.2 if n_axes == 1 else 2.4
    figure, grid = shared.panels("ax", ax, n_axes, columns=1, size=(6.4, height))
    for k, panel in enumerate(grid):
        run.draw(panel, (None, k))
        panel.set_ylabel(labels[k])
    grid[-1].set_xlabel("time (s)")
    shared.legend_below(grid[-1])
    return figure, grid[0] if n_axes == 1 else grid


class _Run:
    """One run, in the unit that is shown."""

    def __init__(self, time: Array, truth: Array, plots: Array, tracks: dict[str, Array]) -> None:
        self.time, self.truth, self.plots, self.tracks = time, truth, plots, tracks
        self.missed = np.asarray(np.isnan(plots).any(axis=1))

    def draw(self, ax: Axes, axes: tuple[int | None, int]) -> None:
        """Draw one axis of space over another, or over time (None)."""

        def on(positions: Array) -> list[Array]:
            return [self.time if k is None else positions[:, k] for k in axes]

        ax.plot(*on(self.truth), label="true", **TRACK_STYLES["true"])
        ax.plot(*on(self.plots), label="plots", **TRACK_STYLES["plots"])
        sparse = len(self.time) <= DENSE
        for number, (label, track) in enumerate(self.tracks.items()):
            marker = shared.MARKERS[number % len(shared.MARKERS)]
            look: dict[str, Any] = {"marker": marker, "markersize": 4.5, **tracker_look(number)}
            seen = np.flatnonzero(~self.missed).tolist() if sparse else []
            ax.plot(*on(track), linewidth=1.2, markevery=seen, label=label, zorder=3, **look)
            ax.plot(
                *on(np.where(self.missed[:, None], track, np.nan)),
                markerfacecolor="white",
                markeredgewidth=1.3,
                zorder=4,
                **{**look, "linestyle": "none", "markersize": 6.5},
            )
        if any(np.isfinite(track[self.missed]).any() for track in self.tracks.values()):
            ax.plot(
                [],
                [],
                linestyle="none",
                marker="o",
                markersize=6.5,
                markerfacecolor="white",
                markeredgewidth=1.3,
                color=shared.INK,
                label="hollow: coasted (no plot)",
            )
        shared.finish(ax)


def plot_error_distribution(
    errors: Mapping[str, ArrayLike],
    *,
    marked: Sequence[float] = (0.5, 0.95),
    what: str = "prediction error",
    unit: str = "m",
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Share of errors that stay below a size, one line for each tracker.

    Parameters
    ----------
    errors : mapping of str to array_like
        Errors of each tracker, by label, of any shape; NaN where there is none.
    marked : sequence of float
        Shares to mark, from 0 to 1; the median and 95 % unless given.
    what, unit : str
        Error and its unit, for the label.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If there is no tracker, or a share is not from 0 to 1.

    Notes
    -----
    The empirical distribution function. A mark is the smallest error that the share does not
    exceed. The axis ends where 99 % of the errors of every tracker are below. It is logarithmic
    where one tracker is far worse than another.
    """
    shares = np.ravel(finite("marked", marked))
    if len(shares) and not (shares.min() >= 0 and shares.max() <= 1):
        raise ValueError(f"marked: must be shares from 0 to 1, got {shares.tolist()}")
    samples = {label: _finite_sorted(values) for label, values in _some("errors", errors).items()}
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 4.6))
    for number, (label, sample) in enumerate(samples.items()):
        count = len(sample)
        shown = np.unique(np.linspace(0, count - 1, min(count, POINTS)).astype(int))
        plane.plot(
            sample[shown],
            100.0 * (shown + 1) / max(count, 1),
            drawstyle="steps-post",
            linewidth=1.6,
            label=label,
            **tracker_look(number),
        )
        if count:
            plane.plot(
                np.quantile(sample, shares, method="inverted_cdf"),
                100.0 * shares,
                linestyle="none",
                marker=shared.MARKERS[number % len(shared.MARKERS)],
                markersize=6.5,
                markeredgecolor="white",
                color=tracker_look(number)["color"],
                zorder=4,
            )
    for share in shares:
        plane.axhline(100.0 * share, color="0.7", linewidth=0.9, linestyle=(0, (4, 3)), zorder=1)
    scale_axis(plane, "x", [*samples.values()])
    largest = [np.quantile(sample, SHOWN) for sample in samples.values() if len(sample)]
    if largest and max(largest) > 0:
        plane.set_xlim(right=1.05 * max(largest))
    plane.set(
        ylim=(0, 101),
        xlabel=f"{what} ({unit})" if unit else what,
        ylabel="share of errors not above (%)",
    )
    shared.finish(plane)
    shared.legend_below(plane)
    return figure, plane


def plot_consistency(
    time: ArrayLike,
    statistics: Mapping[str, ArrayLike],
    band: tuple[ArrayLike, ArrayLike] | None = None,
    *,
    expected: float | None = None,
    what: str = "NIS, mean over runs",
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Normalized squared errors of trackers over time, and the range of a consistent one.

    Parameters
    ----------
    time : array_like, shape (n_steps,)
        Times of the scans (s).
    statistics : mapping of str to array_like, shape (n_steps,)
        Mean over runs of NIS or NEES of each tracker, by label; NaN where there is none.
    band : (low, high), optional
        Limits that a consistent filter keeps, numbers or of shape (n_steps,).
    expected : float, optional
        Mean of a consistent filter.
    what : str
        Statistic, for the label.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If there is no tracker, or shapes do not fit.

    Notes
    -----
    Above the band the covariances of a filter are too small, below it too large. The scale is
    logarithmic where one tracker is far off.
    """
    steps = _times(time)
    curves = _curves("statistics", statistics, len(steps))
    limits = []
    for side in band or ():
        whole = np.full(len(steps), side) if np.ndim(side) == 0 else side
        limits.append(_curve("band", whole, len(steps)))
    figure, (plane,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 4.2))
    if limits:
        plane.fill_between(steps, *limits, color="0.85", linewidth=0, label="consistent", zorder=1)
    if expected is not None:
        plane.axhline(expected, color=shared.GRAY, linewidth=1.0, zorder=1)
    for number, (label, curve) in enumerate(curves.items()):
        plane.plot(steps, curve, label=label, linewidth=1.4, **tracker_look(number))
    scale_axis(plane, "y", [*curves.values(), *limits])
    _label_time(plane, steps, what)
    return figure, plane


def _label_time(ax: Axes, time: Array, ylabel: str) -> None:
    ax.set(xlabel="time (s)", ylabel=ylabel)
    ax.margins(x=0.01)
    shared.finish(ax)
    shared.legend_below(ax)


def _times(time: ArrayLike) -> Array:
    steps = finite("time", time)
    if steps.ndim != 1 or not len(steps):
        raise ValueError(f"time: needs shape (n_steps,), got {steps.shape}")
    return steps


def _some(name: str, given: Mapping[str, ArrayLike]) -> Mapping[str, ArrayLike]:
    if not isinstance(given, Mapping) or not given:
        raise ValueError(f"{name}: must be a mapping from labels to arrays, at least one")
    return given


def _curves(name: str, given: Mapping[str, ArrayLike], count: int) -> dict[str, Array]:
    return {
        label: _curve(f"{name}: {label!r}", curve, count)
        for label, curve in _some(name, given).items()
    }


def _curve(name: str, values: ArrayLike, count: int) -> Array:
    return _fitting(name, values, (count,))


def _fitting(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Copy of `values` with NaN for whatever cannot be drawn."""
    array = np.asarray(values, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"{name}: needs shape {shape}, got {array.shape}")
    return np.where(np.isfinite(array), array, np.nan)


def _finite_sorted(values: ArrayLike) -> Array:
    array = np.ravel(np.asarray(values, dtype=np.float64))
    return np.sort(array[np.isfinite(array)])
