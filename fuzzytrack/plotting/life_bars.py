"""When tracks lived, and which true object each of them followed: a bar for each over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._followed_objects import FollowedObjects
from fuzzytrack.plotting._position_axes import time_unit
from fuzzytrack.plotting._reported_tracks import (
    COASTING,
    MOVING,
    STATIC,
    TENTATIVE,
    ReportedTracks,
    runs,
)
from fuzzytrack.plotting._track_styles import track_colors
from fuzzytrack.scan.track_reports import KINDS, STATUSES

__all__ = ["plot_life_bars"]

# Width of the picture and height of a bar, in inches.
_WIDTH, _ROW = 7.2, 0.2
# Heights of bars, in parts of a row, and their opacity, by status.
_LOOKS = {"tentative": (0.22, 0.55), "confirmed": (0.72, 1.0), "coasting": (0.38, 0.55)}
# Letters of a name.
_LONGEST = 18


def plot_life_bars(
    result: Any,
    truth: Any = None,
    *,
    times: Sequence[float] | Array | None = None,
    within: float = 15.0,
    lag: float = 0.0,
    most: int = 50,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """A bar for each track over time, by status, below those of the true objects.

    Parameters
    ----------
    result : ScanResult or TrackReports
        What was reported.
    truth : tuple, mapping or Positions, optional
        True positions as `fuzzytrack.score` takes them: (time, id, position), for example.
    times : array_like, optional
        Times of the scans (s); those of the result unless given.
    within : float
        Largest distance between a true object and the track that follows it (m).
    lag : float
        Time by which the clock of the tracks is late against that of the truth (s).
    most : int
        Bars of true objects, and of tracks, at most: those of tracks that follow a true object come
        first, then moving ones, the longest ones before the others.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    DataError
        If the truth is empty, or has no time in common with the scans.
    TypeError, ValueError
        If `result` has no reports, or shapes do not fit.

    Notes
    -----
    A true object has the color of the track that follows it, and a thin line where none does. A
    track that follows none is gray. A triangle marks where another track takes over. Which track
    follows which object is decided as for CLEAR MOT: see `fuzzytrack.score`.
    """
    tracks = ReportedTracks.of(result)
    when = _times(result, tracks, times)
    followed = None
    if truth is not None:
        followed = FollowedObjects.of(tracks.reports, truth, when, within, lag)
    bars = _Bars.of(tracks, followed, when, most)
    count = bars.rows + (1 if followed is not None else 0)
    size = (_WIDTH, 1.4 + _ROW * max(count, 4))
    figure, (panel,) = shared.panels("ax", ax, 1, columns=1, size=size)
    bars.draw(panel)
    return figure, panel


def _times(result: Any, tracks: ReportedTracks, given: Any) -> Array:
    """Times of all scans, the first one at number 0."""
    known = getattr(result, "times", None) if given is None else given
    if known is not None:
        return np.asarray(known, np.float64)
    rows = tracks.reports
    times = np.full(int(rows.scan.max(initial=-1)) + 1, np.nan)
    np.fmax.at(times, rows.scan, rows.time)
    numbers, seen = np.arange(len(times)), np.isfinite(times)
    return np.interp(numbers, numbers[seen], times[seen]) if seen.any() else times


@dataclass(frozen=True, eq=False)
class _Bars:
    """Rows of the picture: true objects from above, then tracks."""

    tracks: ReportedTracks
    followed: FollowedObjects | None
    edges: Array
    objects: NDArray[np.int64]
    shown: NDArray[np.int64]
    colors: dict[int, Any]

    @classmethod
    def of(
        cls, tracks: ReportedTracks, followed: FollowedObjects | None, times: Array, most: int
    ) -> _Bars:
        used = np.empty(0, np.int64) if followed is None else np.unique(followed.track)
        matched = np.isin(tracks.ids, used[used > 0])
        moved = tracks.kind == MOVING
        lengths = np.diff(tracks.edges)
        order = np.lexsort((-lengths, ~moved, ~matched))[:most]
        # In the order in which they begin, within those that follow an object and the others.
        begin = tracks.reports.scan[tracks.first]
        still = tracks.kind == STATIC
        shown = np.sort(order)
        shown = shown[np.lexsort((begin[shown], still[shown], ~matched[shown]))]
        objects = np.arange(0 if followed is None else min(len(followed.names), most))
        named = shown[matched[shown]] if followed is not None else shown[moved[shown]]
        palette = track_colors(len(named) if len(named) != len(shared.COLORS) else len(named) + 1)
        own = dict(zip(tracks.ids[named].tolist(), palette, strict=False))
        step = float(np.median(np.diff(times))) if len(times) > 1 else 1.0
        edges = np.append(times, times[-1:] + step)
        return cls(tracks, followed, edges, objects, shown, own)

    @property
    def rows(self) -> int:
        """Number of bars."""
        return len(self.objects) + len(self.shown)

    def draw(self, ax: Axes) -> None:
        """Draw all bars, with their names and a legend."""
        unit, second = time_unit(self.edges)
        labels: list[tuple[float, str]] = []
        for place, number in enumerate(self.objects.tolist()):
            self._draw_object(ax, place, number, second)
            assert self.followed is not None
            labels.append((place, _short(self.followed.names[number])))
        gap = 0.8 if len(self.objects) else 0.0
        for place, number in enumerate(self.shown.tolist(), len(self.objects)):
            self._draw_track(ax, place + gap, number, second)
            labels.append((place + gap, self._name(number)))
        if gap:
            ax.axhline(len(self.objects) - 0.1, color="0.75", linewidth=0.8)
        ax.set_yticks([row for row, _ in labels], [name for _, name in labels], fontsize=8.5)
        ax.set_ylim(max(self.rows + gap, 1) - 0.4, -0.6)
        ax.set_xlabel(f"time ({unit})")
        ax.tick_params(axis="y", length=0)
        if len(self.edges):
            ax.set_xlim(self.edges[0] / second, self.edges[-1] / second)
        shared.finish(ax)
        ax.grid(visible=False, axis="y")
        self._explain(ax)

    def _name(self, number: int) -> str:
        """Identity of a track, and its kind where it follows no true object."""
        id = int(self.tracks.ids[number])
        return str(id) if id in self.colors else f"{id} {KINDS[self.tracks.kind[number]]}"

    def _draw_object(self, ax: Axes, row: float, number: int, second: float) -> None:
        """Thin where an object is there, and a bar in the color of each track that follows it."""
        followed = self.followed
        assert followed is not None
        place = np.searchsorted(self.edges[:-1], followed.time)
        there = self._spans(place[followed.there[number]])
        ax.broken_barh(_widths(there / second), (row - 0.06, 0.12), color=shared.INK)
        track = followed.track[number]
        for id in np.unique(track[track > 0]).tolist():
            spans = self._spans(place[track == id]) / second
            color = self.colors.get(id, shared.GRAY)
            ax.broken_barh(_widths(spans), (row - 0.36, 0.72), color=color, zorder=2)
        switches = followed.time[followed.switched[number]] / second
        ax.plot(
            switches, np.full(len(switches), row - 0.3), "v", color=shared.INK, markersize=6,
            markeredgecolor="white", markeredgewidth=0.7, zorder=3, clip_on=False,
        )  # fmt: skip

    def _draw_track(self, ax: Axes, row: float, number: int, second: float) -> None:
        """A bar whose height and opacity say the status."""
        rows = slice(self.tracks.edges[number], self.tracks.edges[number + 1])
        scan, status = self.tracks.reports.scan[rows], self.tracks.reports.status[rows]
        color = self.colors.get(int(self.tracks.ids[number]), shared.GRAY)
        for kind, word in enumerate(STATUSES):
            height, opacity = _LOOKS[word]
            spans = self._spans(scan[status == kind]) / second
            ax.broken_barh(
                _widths(spans), (row - height / 2, height), facecolor=color, alpha=opacity,
                linewidth=0, zorder=2,
            )  # fmt: skip

    def _spans(self, scans: NDArray[np.int64]) -> Array:
        """Times from the first to after the last of scans that follow one another, shape (n, 2)."""
        seen = np.zeros(max(len(self.edges) - 1, 0), bool)
        seen[scans] = True
        # A run of steps from edge to edge.
        return self.edges[runs(seen)]

    def _explain(self, ax: Axes) -> None:
        reports = self.tracks.reports
        followed = self.followed
        for kind, word in ((1, "confirmed"), (COASTING, "coasting"), (TENTATIVE, "tentative")):
            if (reports.status == kind).any():
                height, opacity = _LOOKS[word]
                look: dict[str, Any] = {"solid_capstyle": "butt", "linewidth": 72 * _ROW * height}
                ax.plot([], [], color=shared.INK, alpha=opacity, label=word, **look)
        if followed is not None and followed.switched.any():
            ax.plot([], [], "v", color=shared.INK, markersize=6, label="another track takes over")
        if followed is not None:
            ax.text(
                1.0, 1.01, "above the line: true objects, in the colors of their tracks",
                transform=ax.transAxes, ha="right", va="bottom", fontsize=8.5, color="0.35",
            )  # fmt: skip
        left = len(self.tracks) - len(self.shown)
        if followed is not None and len(followed.names) > len(self.objects):
            ax.set_title(
                f"{len(self.objects)} of {len(followed.names)} true objects", fontsize="medium"
            )
        if left:
            more = f"{left:,} more track{'s' if left > 1 else ''}, not drawn"
            ax.text(
                0.0, 1.01, more, transform=ax.transAxes, va="bottom", fontsize=8.5, color="0.35"
            )
        if not self.rows:
            ax.set_title("no track", fontsize="medium")
        if ax.get_legend_handles_labels()[0]:
            shared.legend_below(ax)


def _widths(spans: Array) -> list[tuple[float, float]]:
    """First values and widths, as `broken_barh` takes them."""
    return [(first, last - first) for first, last in spans.tolist()]


def _short(name: str) -> str:
    return name if len(name) <= _LONGEST else f"{name[: _LONGEST - 1]}…"
