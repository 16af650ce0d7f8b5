"""Tracks: true, measured and estimated positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import ScalarFormatter
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._batch_track import Track, place_of, true_positions
from fuzzytrack.plotting._maneuvers import maneuvers_of
from fuzzytrack.plotting._plot_density import draw_density
from fuzzytrack.plotting._position_axes import PositionAxes, spread, time_unit
from fuzzytrack.plotting._shown_tracks import MARKED, Project, ShownTracks, shown_id
from fuzzytrack.plotting._track_labels import label_ends
from fuzzytrack.plotting._track_styles import STYLES, darken_plots, track_colors
from fuzzytrack.plotting.gains_over_time import draw_gains
from fuzzytrack.trackers.result import TrackResult

__all__ = ["plot_track", "plot_tracks"]

# Plots up to which they are drawn one by one.
_SINGLE = 20_000
# Tracks up to which each is named.
_NAMED = 20
# Width of the panels in inches.
_WIDTH = 6.4
# Points of all lines that are drawn; more could not be seen.
_POINTS = 200_000
# Plots that were not used are drawn up to this part of the picture beyond the rest.
_BEYOND = 0.25
# A time between two steps that is so many times longer than usual is a gap: where the track was
# meanwhile is not known.
_GAP = 5.0
# How the ends of a gap are joined.
_OVER_GAPS: dict[str, Any] = {"linestyle": ":", "linewidth": 0.8, "zorder": 2.7}


def plot_track(
    result: TrackResult,
    truth: ArrayLike | None = None,
    axes_names: Sequence[str] | None = None,
    unit: str | Sequence[str] | None = None,
    track: Track | None = None,
    *,
    gains: bool = False,
    ax: Axes | Sequence[Axes] | None = None,
) -> tuple[Figure, Axes | shared.AxesArray]:
    """One track: true, measured, predicted and filtered positions.

    Parameters
    ----------
    result : TrackResult
        Two axes of space are drawn as a plane, of equal scales where their units are the same; a
        third one against time below it. One axis or more than three are drawn against time.
    truth : array_like, optional
        True positions, shaped as the plots of the track, or of the batch.
    axes_names : sequence of str, optional
        Names of the axes of space; x, y, z unless given.
    unit : str or sequence of str, optional
        Unit of position, or one for each axis, for the labels. Unless given positions are in
        meters, and shown in kilometers if they span more than 5 km.
    track : int or tuple of int, optional
        Which track of a batch.
    gains : bool
        Whether the gains are drawn below, over time, with the maneuvers of the truth shaded.
    ax : Axes or sequence of Axes, optional
        Axes to draw into, as many as there are panels.

    Returns
    -------
    figure : Figure
    ax : Axes, or ndarray of Axes if there are several panels

    Raises
    ------
    ValueError
        If `track` is missing, not allowed or out of range, or shapes do not fit.

    Notes
    -----
    After Llinas et al. (1998), Fig. 5.1. Start and end of the track are marked, positions without a
    plot, and plots that were not used because a gate rejected them. A line is dotted over a time
    that is more than five times longer than usual. Tracks of more than 75 steps are drawn as lines
    with faint plots and without predictions, and more than 20,000 plots by their density.
    """
    place = place_of(result, track)
    shown = ShownTracks.one(result, place)
    actual = None if truth is None else true_positions(truth, result, place)
    extent = max(spread(shown.filtered), 0.0 if actual is None else spread(actual))
    axes = PositionAxes.of(shown.measured.shape[1], axes_names, unit, None, extent)
    picture = _Picture.of(shown, axes, actual)
    return picture.draw(gains, ax)


def plot_tracks(
    results: TrackResult | Sequence[TrackResult],
    ids: Sequence[str] | None = None,
    axes_names: Sequence[str] | None = None,
    unit: str | Sequence[str] | None = None,
    *,
    gains: bool = False,
    aspect: float | None = None,
    period: float | None = None,
    project: Project | None = None,
    sensor: tuple[float, float] | None = None,
    ax: Axes | Sequence[Axes] | None = None,
) -> tuple[Figure, Axes | shared.AxesArray]:
    """Several tracks, each in a color of its own and with its identity.

    Parameters
    ----------
    results : TrackResult, or sequence of TrackResult
        A batch of tracks, or single tracks of any lengths.
    ids : sequence of str, optional
        Identity of each; those with the same are parts of one track. Their numbers unless given.
    axes_names, unit
        As for `plot_track`.
    gains : bool
        Whether the gains are drawn below, over time; see `plot_gains_over_time`.
    aspect : float, optional
        Length of a unit of the second axis over one of the first, in the plane of the two. 1 where
        their units are the same unless given, and free otherwise.
    period : float, optional
        Full circle of a single axis that is an angle, in its unit; no line joins its end and its
        beginning.
    project : callable, optional
        Positions as they are drawn, of an array of shape (n, n_axes) with positions of the tracks:
        longitudes and latitudes of positions in a plane, for example.
    sensor : (float, float), optional
        Where the sensor is, to be marked.
    ax : Axes or sequence of Axes, optional
        Axes to draw into, as many as there are panels.

    Returns
    -------
    figure : Figure
    ax : Axes, or ndarray of Axes if there are several panels

    Raises
    ------
    ValueError
        If there is no result, numbers of identities, names or axes do not fit, or a result is no
        TrackResult.

    Notes
    -----
    Up to 7 tracks are named in the legend, and up to 20 at their ends where there is room. One
    track is drawn as by `plot_track`. More than 20,000 plots are drawn by their density; then only
    up to 20 tracks are drawn above it.
    """
    shown = ShownTracks.of(results, ids)
    if project is not None:
        shown = shown.projected(project)
    extent = spread(shown.filtered)
    axes = PositionAxes.of(shown.measured.shape[1], axes_names, unit, aspect, extent)
    picture = _Picture.of(shown, axes, None, period, sensor)
    return picture.draw(gains, ax)


@dataclass(frozen=True, eq=False)
class _Picture:
    """What is drawn: tracks and truth in the units that are shown."""

    shown: ShownTracks
    axes: PositionAxes
    truth: Array | None
    period: float | None
    sensor: tuple[float, float] | None
    time_unit: str
    second: float

    @classmethod
    def of(
        cls,
        shown: ShownTracks,
        axes: PositionAxes,
        truth: Array | None,
        period: float | None = None,
        sensor: tuple[float, float] | None = None,
    ) -> _Picture:
        if axes.scale != 1.0:
            shown = shown.projected(lambda positions: positions / axes.scale)
            truth = None if truth is None else truth / axes.scale
            sensor = None if sensor is None else (sensor[0] / axes.scale, sensor[1] / axes.scale)
        return cls(shown, axes, truth, period, sensor, *time_unit(shown.time))

    @property
    def dense(self) -> bool:
        """Whether the plots are too many to be drawn one by one."""
        return self.shown.plots > _SINGLE

    @property
    def with_lines(self) -> bool:
        """Whether tracks are drawn as lines."""
        return not self.dense or len(self.shown) <= _NAMED

    def draw(
        self, gains: bool, ax: Axes | Sequence[Axes] | None
    ) -> tuple[Figure, Axes | shared.AxesArray]:
        """Draw all panels."""
        panels = self.axes.panels
        heights = [*self._heights(), *([2.4] if gains else [])]
        figure, grid = shared.panels(
            "ax",
            ax,
            len(heights),
            columns=1,
            size=(_WIDTH, sum(heights) / len(heights)),
            gridspec_kw={"height_ratios": heights},
        )
        for panel, (x, y) in zip(grid, panels, strict=False):
            self._draw_panel(panel, x, y)
        self._explain(grid[: len(panels)])
        if gains:
            drawn = [] if self.truth is None else maneuvers_of(self.shown.time, self.truth)
            draw_gains(grid[-1], self.shown, self.axes.names, drawn)
        return figure, grid[0] if len(grid) == 1 else grid

    def _heights(self) -> list[float]:
        """Heights of the panels of positions, in inches: that of a plane follows the tracks."""
        panels = self.axes.panels
        if panels[0][0] is None:
            return [4.2 if len(panels) == 1 else 2.4] * len(panels)
        plane = _WIDTH if self.axes.aspect is None else self._height_over_width() * _WIDTH
        return [float(np.clip(plane, 3.2, 6.0)), *[2.4] * (len(panels) - 1)]

    def _height_over_width(self) -> float:
        """Of what is drawn in the plane, without plots that were not used."""
        parts = [self.shown.filtered, *([] if self.truth is None else [self.truth])]
        points = np.concatenate([part[:, :2] for part in parts])
        if self.sensor is not None:
            points = np.concatenate([points, [self.sensor]])
        known = points[np.isfinite(points).all(axis=1)]
        if not len(known):
            return 1.0
        width, height = np.ptp(known, axis=0)
        return float(height * (self.axes.aspect or 1.0) / width) if width > 0 else 1.0

    # ---------------------------------------------------------------- one panel

    def _draw_panel(self, ax: Axes, x: int | None, y: int) -> None:
        plane = x is not None
        on = _Coordinates(self.shown.time / self.second, x, y, None if plane else self.period)
        aspect = self.axes.aspect if plane else None
        self._draw_plots(ax, on, aspect)
        if self.truth is not None:
            # Above a broad line, below marks.
            above = {} if self.shown.marked else {"linewidth": 0.9, "zorder": 2.9}
            ax.plot(*on.line(self.truth), label="true", **{**STYLES["true"], **above})
        if self.shown.marked and np.isfinite(self.shown.predicted).any():
            ax.plot(*on.of(self.shown.predicted), label="predicted", **STYLES["predicted"])
        if self.with_lines:
            self._draw_lines(ax, on)
            self._draw_marks(ax, on)
        if plane and self.sensor is not None:
            ax.plot(*([value] for value in self.sensor), label="sensor", **STYLES["sensor"])
        ax.set_xlabel(self.axes.labels[x] if x is not None else f"time ({self.time_unit})")
        ax.set_ylabel(self.axes.labels[y])
        for axis in (ax.xaxis, ax.yaxis):
            # Others are of axes that a user has given.
            if isinstance(formatter := axis.get_major_formatter(), ScalarFormatter):
                formatter.set_useOffset(False)
        if aspect is not None:
            ax.set_aspect(aspect, adjustable="datalim")
            # Before the figure is laid out, which leaves room for the labels of the limits.
            ax.apply_aspect()
        shared.finish(ax)

    def _draw_plots(self, ax: Axes, on: _Coordinates, aspect: float | None) -> None:
        shown = self.shown
        used = np.where(shown.rejected[:, None], np.nan, shown.measured)
        if self.dense:
            draw_density(ax, *on.of(used), aspect, behind=self.with_lines)
            return
        style, count = dict(STYLES["plots"]), shown.plots
        if not count:
            return
        if count > MARKED:
            style |= {"markersize": 3.0 if count < 10 * MARKED else 2.0, "markeredgewidth": 0.6}
            style |= {"alpha": 0.7 if count < 10 * MARKED else 0.4}
        ax.plot(*on.of(used), label="plots", **style)

    def _draw_lines(self, ax: Axes, on: _Coordinates) -> None:
        shown, style = self.shown, dict(STYLES["filtered"])
        if self.shown.marked:
            style |= {"marker": "o", "markersize": 3.5}
        if self.dense:
            style |= {"linewidth": 0.8}
        elif not self.shown.marked:
            style |= {"linewidth": 1.6}
        if len(shown) == 1:
            if on.known(shown.filtered).any():
                ax.plot(*self._line(on, 0), label="filtered", **style)
                self._join(ax, on, [style["color"]])
            return
        lines = [self._line(on, track) for track in range(len(shown))]
        colors = track_colors(len(shown))
        if len(shown) <= _NAMED:
            for id, color, line in zip(shown.ids, colors, lines, strict=True):
                # A label that begins with an underscore would not be in the legend.
                ax.plot(*line, label=shown_id(id), **{**style, "color": color})
            self._join(ax, on, colors)
            return
        width = 0.9 if len(shown) < 200 else 0.6
        points = [np.stack(line, axis=1) for line in lines]
        ax.add_collection(LineCollection(points, colors=colors, linewidths=width, zorder=2.8))
        self._join(ax, on, colors)
        ax.autoscale_view()

    def _join(self, ax: Axes, on: _Coordinates, colors: Sequence[Any]) -> None:
        """Join the ends of all gaps, in the color of each track."""
        joints, their = [], []
        for track, color in enumerate(colors):
            rows = self.shown.rows(track)
            found = on.cut(rows).joints(self.shown.filtered[rows])
            joints += list(found)
            their += [color] * len(found)
        if joints:
            ax.add_collection(LineCollection(joints, colors=their, label="_gaps", **_OVER_GAPS))

    def _line(self, on: _Coordinates, track: int) -> tuple[Array, Array]:
        """Line of a track, with fewer points where there are too many of them to be seen."""
        rows = self.shown.rows(track)
        line = on.cut(rows).line(self.shown.filtered[rows])
        every = -(-len(self.shown.time) // _POINTS)
        if every == 1:
            return line
        kept = np.isnan(line[0]) | np.isnan(line[1])
        kept[::every] = True
        kept[-1:] = True
        return line[0][kept], line[1][kept]

    def _draw_marks(self, ax: Axes, on: _Coordinates) -> None:
        """Coasting, plots that were not used, and both ends of every track."""
        shown = self.shown
        few = len(shown) <= _NAMED
        if shown.coasted.any():
            style = dict(STYLES["coasted"])
            if shown.coasted.sum() > MARKED or not few:
                style |= {"markersize": 2.5, "markerfacecolor": style["color"]}
            elif len(shown) > 1:
                style |= {"markersize": 4.5, "markeredgewidth": 0.9}
            ax.plot(*on.of(shown.filtered, shown.coasted), label="coasted", **style)
        if shown.rejected.any():
            self._draw_rejected(ax, on)
        smaller = {} if few else {"markersize": 3.0, "markeredgewidth": 0.8}
        starts, ends = shown.ends(on.known(shown.filtered))
        # Of a single plot, the end is its start.
        for name, rows in (("start", starts), ("end", ends[ends != starts])):
            if len(rows):
                ax.plot(*on.of(shown.filtered, rows), label=name, **{**STYLES[name], **smaller})

    def _draw_rejected(self, ax: Axes, on: _Coordinates) -> None:
        """Plots that were not used; those far outside would make the rest too small to be seen."""
        x, y = on.of(self.shown.measured, self.shown.rejected)
        box = ax.dataLim
        wide, high = _BEYOND * box.width, _BEYOND * box.height
        if self.axes.aspect is not None and on.x is not None:
            wide = high = max(wide, high)
        near = (box.x0 - wide <= x) & (x <= box.x1 + wide)
        near &= (box.y0 - high <= y) & (y <= box.y1 + high)
        outside = int(np.sum(np.isfinite(x) & np.isfinite(y) & ~near))
        label = "plots not used" + (f" (+ {outside} outside)" if outside else "")
        smaller = {"markersize": 2.5, "markeredgewidth": 0.7} if near.sum() > MARKED else {}
        ax.plot(x[near], y[near], label=label, **{**STYLES["rejected"], **smaller})

    # ---------------------------------------------------------------- names and legend

    def _explain(self, grid: shared.AxesArray) -> None:
        """Name the tracks, and explain the marks below the panels."""
        first, last, shown = grid[0], grid[-1], self.shown
        named = self._label_tracks(first) if len(shown) > 1 and self.with_lines else False
        if named:
            for line in (line for panel in grid for line in panel.lines):
                if line.get_label() in {shown_id(id) for id in shown.ids}:
                    line.set_label("_named at its end")
        if last.get_legend_handles_labels()[0]:
            shared.legend_below(last)
            darken_plots(last)
        if not shown.plots:
            first.set_title("no plots")
        elif len(shown) > _NAMED:
            rest = "each in a color of its own" if self.with_lines else "not drawn one by one"
            first.set_title(f"{len(shown):,} tracks, {rest}", fontsize="medium")

    def _label_tracks(self, ax: Axes) -> bool:
        """Write identities at the ends of tracks that are too many for the legend."""
        shown = self.shown
        if not len(shared.COLORS) < len(shown) <= _NAMED:
            return False
        x, y = self.axes.panels[0]
        on = _Coordinates(self.shown.time / self.second, x, y, self.period)
        colors, lines, ends, ids = [], [], [], []
        for track, color in enumerate(track_colors(len(shown))):
            line = np.stack(self._line(on, track), axis=1)
            lines += [line, np.full((1, 2), np.nan)]
            known = line[np.isfinite(line).all(axis=1)]
            if len(known):
                ends.append(known[-1])
                colors.append(color)
                ids.append(shown.ids[track])
        rows = np.concatenate(shown.ends(on.known(shown.filtered)))
        marks = np.stack(on.of(shown.filtered, rows), axis=1)
        return label_ends(ax, ids, np.array(ends), colors, np.concatenate(lines), marks)


@dataclass(frozen=True, eq=False)
class _Coordinates:
    """Which coordinates of positions a panel shows: two axes of space, or one over time (None)."""

    time: Array
    x: int | None
    y: int
    period: float | None

    def of(
        self, positions: Array, rows: Mask | NDArray[np.int64] | slice = slice(None)
    ) -> tuple[Array, Array]:
        """Horizontal and vertical coordinates of some rows."""
        across = self.time if self.x is None else positions[:, self.x]
        return across[rows], positions[rows, self.y]

    def known(self, positions: Array) -> Mask:
        """Rows that have a place in the panel."""
        across, up = self.of(positions)
        return np.isfinite(across) & np.isfinite(up)

    def line(self, positions: Array) -> tuple[Array, Array]:
        """Those of a line, interrupted at gaps, and where an angle passes from 360° to 0."""
        across, up = self.of(positions)
        breaks = np.flatnonzero(self._gaps() | self._jumps(up)) + 1
        return np.insert(across, breaks, np.nan), np.insert(up, breaks, np.nan)

    def joints(self, positions: Array) -> Array:
        """First and second end of each gap that can be joined, shape (n, 2, 2)."""
        across, up = self.of(positions)
        ends = np.stack([across, up], axis=1)
        gaps = np.flatnonzero(self._gaps() & ~self._jumps(up))
        joints = np.stack([ends[gaps], ends[gaps + 1]], axis=1)
        return np.asarray(joints[np.isfinite(joints).all(axis=(1, 2))])

    def _gaps(self) -> Mask:
        """Whether the time to the next row is a gap; there is none to another part of a track."""
        steps = np.diff(self.time)
        known = steps[np.isfinite(steps)]
        return np.asarray(steps > _GAP * np.median(known)) if len(known) else steps > np.inf

    def _jumps(self, up: Array) -> Mask:
        """Whether an angle passes from a full circle to 0, or back, before the next row."""
        return np.asarray(
            np.abs(np.diff(up)) > (np.inf if self.period is None else self.period / 2)
        )

    def cut(self, rows: slice) -> _Coordinates:
        """The same for some rows."""
        return _Coordinates(self.time[rows], self.x, self.y, self.period)
