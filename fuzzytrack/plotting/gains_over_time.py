"""Gains of tracks over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fuzzytrack.arrays import Array
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._batch_track import Track, place_of
from fuzzytrack.plotting._maneuvers import Intervals, checked_intervals, shade_maneuvers
from fuzzytrack.plotting._position_axes import time_unit
from fuzzytrack.plotting._ragged_lines import is_ragged, running_quartiles
from fuzzytrack.plotting._shown_tracks import ShownTracks, shown_id
from fuzzytrack.plotting._track_styles import STYLES, track_colors
from fuzzytrack.trackers.result import TrackResult

__all__ = ["draw_gains", "plot_gains_over_time"]

_SYMBOLS = {"alpha": "α", "beta": "β", "gamma": "γ"}
_DASHES = ("-", (0, (5, 2)), (0, (1.5, 1.5)), "-.")
# Tracks that have a line each; the gains of more are a band.
_LINES = 3
_BLOCKS = 60
# Steps up to which each has a mark.
_MARKED = 150


def plot_gains_over_time(
    result: TrackResult | Sequence[TrackResult],
    ids: Sequence[str] | None = None,
    track: Track | None = None,
    *,
    axes_names: Sequence[str] | None = None,
    maneuvers: Intervals = (),
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Gains of one track or of several over time.

    Parameters
    ----------
    result : TrackResult or sequence of TrackResult
        The track, or several.
    ids : sequence of str, optional
        Identities of several tracks, for the legend.
    track : int or tuple of int, optional
        Which track of a batch; all of them unless given.
    axes_names : sequence of str, optional
        Names of the axes of space, for gains that differ between them; x, y, z unless given.
    maneuvers : sequence of (float, float)
        First and last times of maneuvers (s), to be shaded.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If there is no result, or `track` is not allowed.

    Notes
    -----
    One track has a line for each gain; where they differ between the axes of space, one for each
    axis, without γ. Two or three tracks have a line each for α, its mean over the axes. Of more
    tracks, and where lines are too ragged to be read, the median and the quartiles in sixty
    intervals of time are drawn.
    """
    if track is None:
        shown = ShownTracks.of(result, ids)
    else:
        place = place_of(result, track)
        # Anything else has no place.
        assert isinstance(result, TrackResult)
        shown = ShownTracks.one(result, place)
    names = axes_names or [f"x{k + 1}" for k in range(shown.alpha.shape[1])]
    figure, (panel,) = shared.panels("ax", ax, 1, columns=1, size=(6.4, 3.0))
    draw_gains(panel, shown, names, checked_intervals(maneuvers))
    return figure, panel


def draw_gains(
    ax: Axes, shown: ShownTracks, axes_names: Sequence[str], maneuvers: Intervals = ()
) -> None:
    """Draw the gains of tracks over time, with a legend below; see `plot_gains_over_time`."""
    unit, second = time_unit(shown.time)
    time = shown.time / second
    few = 1 < len(shown) <= _LINES
    if few:
        in_blocks = _draw_few(ax, time, shown)
    else:
        in_blocks = len(shown) > 1 or _is_too_ragged(shown)
        draw = _draw_bands if in_blocks else _draw_one
        draw(ax, time, shown, axes_names)
    shade_maneuvers(ax, maneuvers, second)
    ax.set(xlabel=f"time ({unit})", ylabel="α" if few else "gains")
    ax.set_ylim(0.0, None if np.isfinite(shown.alpha).any() else 1.0)
    ax.margins(x=0.01)
    shared.finish(ax)
    if not ax.get_legend_handles_labels()[0]:
        ax.set_title("no gains: a track needs two plots", fontsize="medium")
        return
    shared.legend_below(ax)
    legend = ax.get_legend()
    if in_blocks and legend is not None:
        of = " of all tracks" if len(shown) > _LINES else ""
        legend.set_title("running median" if few else f"running median and quartiles{of}")


def _is_too_ragged(shown: ShownTracks) -> bool:
    """Whether lines of all gains of one track could not be read."""
    return len(shown.time) > 4 * _BLOCKS and any(is_ragged(column) for column in shown.alpha.T)


def _draw_one(ax: Axes, time: Array, shown: ShownTracks, axes_names: Sequence[str]) -> None:
    """A line for each gain, and for each axis if α differs between them."""
    alike = all(np.array_equal(shown.alpha[:, 0], a, equal_nan=True) for a in shown.alpha.T)
    # Points between two missed plots would not be seen without marks.
    marks = {"marker": ".", "markersize": 3.0} if len(time) <= _MARKED else {}
    for name, gains in _gains_of(shown, gamma=alike).items():
        for axis, column in enumerate(gains.T[: 1 if alike else None]):
            style = {**STYLES[name], **marks, "linestyle": _DASHES[axis % len(_DASHES)]}
            label = _SYMBOLS[name] if alike else f"{_SYMBOLS[name]} of {axes_names[axis]}"
            ax.plot(time, column, label=label, **style)


def _draw_few(ax: Axes, time: Array, shown: ShownTracks) -> bool:
    """α of a few tracks, in the colors that these have everywhere; whether it is smoothed."""
    alpha = _mean_over_axes(shown.alpha)
    rows = [shown.rows(track) for track in range(len(shown))]
    ragged = any(is_ragged(alpha[each]) and each.stop - each.start > 4 * _BLOCKS for each in rows)
    for id, each, color in zip(shown.ids, rows, track_colors(len(shown)), strict=True):
        line = time[each], alpha[each]
        if ragged:
            middle, quartiles = running_quartiles(*line, _BLOCKS)
            line = middle, quartiles[1]
        ax.plot(*line, color=color, linewidth=1.3, label=f"α of {shown_id(id)}")
    return ragged


def _mean_over_axes(gains: Array) -> Array:
    known = np.isfinite(gains)
    total = np.where(known, gains, 0.0).sum(axis=1)
    return np.where(known.any(axis=1), total / np.maximum(known.sum(axis=1), 1), np.nan)


def _draw_bands(ax: Axes, time: Array, shown: ShownTracks, _: Sequence[str]) -> None:
    """Median and quartiles of each gain, over all axes and tracks."""
    for name, gains in _gains_of(shown, gamma=True).items():
        across = np.repeat(time, gains.shape[1])
        middle, (low, median, high) = running_quartiles(across, gains.ravel(), _BLOCKS)
        ax.plot(middle, median, label=_SYMBOLS[name], **STYLES[name])
        color = STYLES[name]["color"]
        ax.fill_between(middle, low, high, color=color, alpha=0.2, linewidth=0)


def _gains_of(shown: ShownTracks, *, gamma: bool) -> dict[str, Array]:
    """The gains that a tracker has used, by name."""
    found = {name: getattr(shown, name) for name in _SYMBOLS}
    if not gamma or not (np.nan_to_num(found["gamma"]) > 0).any():
        del found["gamma"]
    return {name: gains for name, gains in found.items() if np.isfinite(gains).any()}
