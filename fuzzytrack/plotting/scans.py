"""Tracks of a scan tracker, with the plots that they were made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._ground_plane import GroundPlane
from fuzzytrack.plotting._plot_density import draw_density
from fuzzytrack.plotting._reported_tracks import (
    COASTING,
    STATIC,
    TENTATIVE,
    ReportedTracks,
    plots_of,
    runs,
)
from fuzzytrack.plotting._track_labels import label_ends
from fuzzytrack.plotting._track_styles import STYLES, darken_plots, track_colors
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.track_reports import TrackReports
from fuzzytrack.scoring.object_paths import ObjectPaths

__all__ = ["plot_scan"]

# Plots up to which they are drawn one by one.
_SINGLE = 20_000
# Tracks and their rows up to which they are drawn one by one.
_LINES, _ROWS = 4000, 300_000
# Tracks up to which those with a free place at their end are named.
_NAMED = 120
# Tracks up to which marks have their full size, and up to which starts and ends are marked.
_FEW, _MARKED = 20, 200
# Width of the picture in inches.
_WIDTH = 6.8


def plot_scan(
    result: TrackReports | Any,
    scans: Sequence[Scan] | None = None,
    truth: Any = None,
    axes_names: Sequence[str] = ("x", "y"),
    *,
    own: ArrayLike | None = None,
    static: bool = True,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Tracks that a scan tracker reported, in the plane, over the plots of all scans.

    Parameters
    ----------
    result : ScanResult or TrackReports
        What was reported. Moving tracks have a color each, static ones are gray; both are dashed
        where they coast, and dotted while they are tentative. Tracks that were never confirmed are
        gray and dotted, without marks.
    scans : sequence of Scan, optional
        The scans, for the plots and the path of the own ship.
    truth : tuple, mapping or Positions, optional
        True positions as `fuzzytrack.score` takes them: (time, id, position), for example.
    axes_names : sequence of str
        Names of the two axes. North, or what begins with it, is drawn upwards.
    own : array_like, shape (n, 2), optional
        Path of the own ship (m). Unless given, that of the scans, or else of the result.
    static : bool
        Whether static tracks are drawn.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    TypeError, ValueError
        If `result` has no reports, or shapes do not fit.

    Notes
    -----
    Up to 120 tracks are named at their ends where the name covers nothing, and up to 200 have marks
    at both ends. More than 20,000 plots are drawn by their density. So are, without the plots, more
    than 4,000 tracks, or tracks with more than 300,000 rows.
    """
    tracks = ReportedTracks.of(result)
    if not static:
        tracks = tracks.where((tracks.kind != STATIC) | ~tracks.confirmed)
    paths = ObjectPaths.of(truth)
    plots, ship = plots_of(scans), _own_path(own, scans, result)
    everything = np.concatenate([tracks.reports.position, paths.position, plots, ship])
    plane = GroundPlane.of(axes_names, everything)
    figure, (panel,) = shared.panels("ax", ax, 1, columns=1, size=plane.size(_WIDTH))
    picture = _Picture(panel, plane, tracks)
    picture.draw_plots(plots)
    if len(paths):
        picture.draw_truth(paths)
    picture.draw_tracks()
    picture.draw_own(ship)
    plane.finish(panel)
    picture.explain(ship)
    return figure, panel


def _own_path(own: ArrayLike | None, scans: Sequence[Scan] | None, result: Any) -> Array:
    """Path of the own ship, shape (n, 2)."""
    given = own
    if given is None and scans is not None:
        given = [scan.own for scan in scans]
    if given is None:
        given = getattr(result, "own", None)
    path = np.empty((0, 2)) if given is None else np.asarray(given, np.float64).reshape(-1, 2)
    return path[np.isfinite(path).all(axis=1)]


@dataclass(frozen=True, eq=False)
class _Picture:
    """What is drawn into which axes."""

    ax: Axes
    plane: GroundPlane
    tracks: ReportedTracks

    @property
    def with_lines(self) -> bool:
        """Whether tracks are drawn one by one."""
        return len(self.tracks) <= _LINES and len(self.tracks.reports) <= _ROWS

    @property
    def moving(self) -> Mask:
        """Tracks with a color of their own: those that were confirmed, and are not static."""
        return np.asarray(self.tracks.confirmed & (self.tracks.kind != STATIC))

    @property
    def static(self) -> Mask:
        """Static tracks."""
        return np.asarray(self.tracks.confirmed & (self.tracks.kind == STATIC))

    @property
    def count(self) -> int:
        """Number of tracks that were confirmed, which have marks and names."""
        return int(self.tracks.confirmed.sum())

    @property
    def colors(self) -> list[Any]:
        """Color of each track, gray if it has none of its own."""
        count = int(self.moving.sum())
        # Black is that of the truth.
        own = iter(track_colors(count if count < len(shared.COLORS) else max(count, 8)))
        return [next(own) if each else shared.GRAY for each in self.moving.tolist()]

    def draw_plots(self, plots: Array) -> None:
        """Plots one by one and faint, or by their density."""
        if not self.with_lines:
            # They would be covered by the density of the tracks.
            return
        if len(plots) > _SINGLE:
            x, y = self.plane.shown(plots)
            draw_density(self.ax, x, y, 1.0, behind=True)
        elif len(plots):
            style = {**STYLES["plots"], "marker": "o", "markeredgewidth": 0.0}
            style |= {"markerfacecolor": shared.GRAY, "alpha": 0.75 if len(plots) < 500 else 0.4}
            style |= {"markersize": 2.6 if len(plots) < 2000 else 1.8}
            self.ax.plot(*self.plane.shown(plots), label="plots", **style)

    def draw_truth(self, paths: ObjectPaths) -> None:
        """Lines of true targets, with a gap between two."""
        points = np.insert(paths.position, paths.edges[1:-1], np.nan, axis=0)
        # A broad line below those of tracks, which would hide a thin one.
        style = {**STYLES["true"], "color": "0.78", "linewidth": 3.6, "zorder": 2.2}
        self.ax.plot(*self.plane.shown(points), label="true", **style)

    def draw_own(self, ship: Array) -> None:
        """Path of the own ship, with a mark where it is at the end."""
        if not len(ship):
            return
        x, y = self.plane.shown(ship)
        if np.ptp(ship, axis=0).max() > 0:
            self.ax.plot(x, y, color=shared.INK, linewidth=1.0, linestyle=(0, (6, 2)), zorder=2.25)
        self.ax.plot(x[-1:], y[-1:], label="radar", **STYLES["sensor"])

    def draw_tracks(self) -> None:
        """Lines of tracks and their ends, or the density of their rows."""
        if not len(self.tracks):
            return
        if not self.with_lines:
            x, y = self.plane.shown(self.tracks.reports.position)
            draw_density(self.ax, x, y, 1.0, what="tracks in a cell, over all scans")
            return
        for name, (steps, style) in self._styles().items():
            self._draw_lines(name, steps, style)
        self._draw_ends()

    def _styles(self) -> dict[str, tuple[Mask, dict[str, Any]]]:
        """Steps from row to row that are drawn alike, and how; one step has one style."""
        rows, joined = self.tracks.reports, self.tracks.joined
        moving = self.moving[self.tracks.track][1:]
        wide = 1.7 if self.count <= _MARKED else 1.0
        coasts = rows.status[1:] == COASTING
        early = ~coasts & (rows.status[1:] == TENTATIVE)
        steady = joined & ~coasts & ~early
        return {
            "moving": (steady & moving, {"linewidths": wide, "zorder": 2.8}),
            "static": (steady & ~moving, {"linewidths": 1.1, "alpha": 0.8, "zorder": 2.3}),
            "coasting": (
                joined & coasts,
                {"linewidths": 0.85 * wide, "linestyles": [(0, (3.5, 1.8))], "zorder": 2.7},
            ),
            "tentative": (
                joined & early,
                {"linewidths": 0.75 * wide, "linestyles": [(0, (0.8, 1.4))], "zorder": 2.6},
            ),
        }

    def _draw_lines(self, name: str, steps: Mask, style: dict[str, Any]) -> None:
        found = runs(steps)
        if not len(found):
            return
        points = np.stack(self.plane.shown(self.tracks.reports.position), axis=1)
        colors, track = self.colors, self.tracks.track
        lines = LineCollection(
            [points[first : last + 1] for first, last in found.tolist()],
            colors=[colors[k] for k in track[found[:, 0]]],
            capstyle="butt",
            **style,
        )
        self.ax.add_collection(lines)
        self.ax.autoscale_view()
        # One line of the legend stands for all colors.
        dashes = {"linestyle": style["linestyles"][0]} if "linestyles" in style else {}
        ink = shared.GRAY if name == "static" else shared.INK
        self.ax.plot([], [], color=ink, linewidth=style["linewidths"], label=name, **dashes)

    def _draw_ends(self) -> None:
        """Where tracks began and ended, or are in the last scan; squares for static ones."""
        tracks = self.tracks
        moving, static, count = self.moving, self.static, self.count
        lives = tracks.reports.scan[tracks.last] == tracks.reports.scan.max()
        small = {} if count <= _FEW else {"markersize": 3.2, "markeredgewidth": 0.8}
        ended = moving & ~lives
        for name, rows in (("start", tracks.first[moving]), ("end", tracks.last[ended])):
            if len(rows) and count <= _MARKED:
                self._draw_marks(rows, label=name, **{**STYLES[name], "markersize": 4.5, **small})
        here = tracks.last[moving & lives]
        if len(here):
            kept = (moving & lives).tolist()
            face = [color for color, each in zip(self.colors, kept, strict=True) if each]
            x, y = self.plane.shown(tracks.reports.position[here])
            size = 26.0 if count <= _FEW else 12.0 if count <= _MARKED else 4.0
            edge = "white" if count <= _MARKED else "none"
            self.ax.scatter(x, y, s=size, c=face, zorder=3.2, edgecolors=edge)
            look: dict[str, Any] = {"linestyle": "none", "marker": "o", "color": shared.INK}
            self.ax.plot([], [], label="in the last scan", markersize=size**0.5, **look)
        if static.any():
            look = {"linestyle": "none", "marker": "s", "color": shared.GRAY, "zorder": 2.5}
            look |= {"markersize": 4.2 if count <= _FEW else 2.8, "markerfacecolor": "white"}
            self._draw_marks(tracks.last[static], label="_static", **look)

    def _draw_marks(self, rows: NDArray[np.int64], **style: Any) -> None:
        self.ax.plot(*self.plane.shown(self.tracks.reports.position[rows]), **style)

    def explain(self, ship: Array) -> None:
        """Name the tracks, and explain marks and lines below."""
        tracks = self.tracks
        if self.ax.get_legend_handles_labels()[0]:
            shared.legend_below(self.ax)
            darken_plots(self.ax)
        if not len(tracks):
            self.ax.set_title("no track", fontsize="medium")
        elif not self.with_lines:
            self.ax.set_title(f"{len(tracks):,} tracks, not drawn one by one", fontsize="medium")
        elif self.count <= _NAMED:
            self._name_tracks(ship)

    def _name_tracks(self, ship: Array) -> None:
        """Identities at the ends of tracks, those of moving ones first."""
        tracks, plane = self.tracks, self.plane
        points = np.stack(plane.shown(tracks.reports.position), axis=1)
        path = np.stack(plane.shown(ship), axis=1)
        lines = np.insert(points, tracks.edges[1:-1], np.nan, axis=0)
        lines = np.concatenate([lines, np.full((1, 2), np.nan), path])
        order = np.concatenate([np.flatnonzero(self.moving), np.flatnonzero(self.static)])
        colors = self.colors
        label_ends(
            self.ax,
            [str(id) for id in tracks.ids[order]],
            points[tracks.last[order]],
            [colors[k] for k in order],
            lines,
            np.concatenate([points[tracks.first], points[tracks.last], path[-1:]]),
            all_or_none=False,
        )
