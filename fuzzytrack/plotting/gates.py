"""The gates of a scan: where tracks are expected, and which plots they took."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._ground_plane import GroundPlane
from fuzzytrack.plotting._reported_tracks import KIND_COLORS, TENTATIVE
from fuzzytrack.plotting._track_labels import label_ends
from fuzzytrack.plotting._track_styles import STYLES
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_gates import ScanGates, scan_gates
from fuzzytrack.scan.scan_session import ScanSession
from fuzzytrack.scan.track_reports import KINDS

__all__ = ["plot_gates"]

# Width of the picture in inches.
_WIDTH = 6.8
# Tracks up to which those with a free place are named.
_NAMED = 120


def plot_gates(
    session: ScanSession,
    scan: Scan,
    extent: tuple[tuple[float, float], tuple[float, float]] | None = None,
    axes_names: Sequence[str] = ("x", "y"),
    *,
    tentative: bool = True,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Where the tracks of a session are expected in the next scan, and which plots they take.

    Parameters
    ----------
    session : ScanSession
        After the scan before; it does not change.
    scan : Scan
        The next scan.
    extent : ((float, float), (float, float)), optional
        First and last value of each axis of space (m) that is shown; all gates unless given.
    axes_names : sequence of str
        Names of the two axes. North, or what begins with it, is drawn upwards.
    tentative : bool
        Whether tentative tracks are drawn.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    DataError
        If a plot cannot be used, or times go backwards.

    Notes
    -----
    A gate is drawn as its part accepts plots (`fuzzytrack.scan.scan_gates.scan_gates`): an ellipse,
    a circle, a box along range and bearing. Gates of tentative tracks are dotted.
    """
    gates = scan_gates(session, scan)
    drawn = np.ones(len(gates.predicted), bool)
    if not tentative:
        drawn &= gates.tracks.status != TENTATIVE
    if extent is not None:
        drawn &= _inside(gates.predicted, extent)
    corners = gates.outlines[drawn].reshape(-1, 2)
    plots = np.asarray(scan.positions, np.float64).reshape(-1, 2)
    shown = [corners, plots] if extent is None else [np.array(extent, np.float64).T]
    plane = GroundPlane.of(axes_names, np.concatenate(shown))
    figure, (panel,) = shared.panels("ax", ax, 1, columns=1, size=plane.size(_WIDTH))
    picture = _Picture(panel, plane, gates, drawn)
    picture.draw_plots(plots)
    picture.draw_gates(plots)
    ship = np.asarray(scan.own, np.float64)[None]
    if np.isfinite(ship).all() and (extent is None or _inside(ship, extent)[0]):
        panel.plot(*plane.shown(ship), label="radar", **STYLES["sensor"])
    plane.finish(panel, limits=None if extent is None else np.array(extent, np.float64).T)
    picture.explain(plots)
    return figure, panel


def _inside(points: Array, extent: tuple[tuple[float, float], tuple[float, float]]) -> Mask:
    low, high = np.array(extent, np.float64).T
    return np.asarray(((points >= low) & (points <= high)).all(axis=1))


@dataclass(frozen=True, eq=False)
class _Picture:
    """What is drawn into which axes, and which of the tracks are."""

    ax: Axes
    plane: GroundPlane
    gates: ScanGates
    drawn: Mask

    def draw_plots(self, plots: Array) -> None:
        """Plots; those that a track took are filled."""
        if not len(plots):
            return
        taken = np.zeros(len(plots), bool)
        taken[self.gates.taken[self.gates.taken >= 0]] = True
        style = {**STYLES["plots"], "markersize": 5.0, "zorder": 3.0}
        if (~taken).any():
            self.ax.plot(*self.plane.shown(plots[~taken]), label="plot", **style)
        if taken.any():
            filled = {**style, "markerfacecolor": shared.INK, "color": shared.INK}
            self.ax.plot(*self.plane.shown(plots[taken]), label="plot taken", **filled)

    def draw_gates(self, plots: Array) -> None:
        """Last and predicted places, outlines, and lines to the plots that were taken."""
        gates, tracks = self.gates, self.gates.tracks
        for kind, name in enumerate(KINDS):
            early = tracks.status == TENTATIVE
            for some, label in ((~early, name), (early, f"{name}, tentative")):
                rows = np.flatnonzero(self.drawn & some & (tracks.kind == kind))
                if len(rows):
                    self._draw_outlines(rows, KIND_COLORS[name], label, bool(some is early))
        rows = np.flatnonzero(self.drawn)
        if not len(rows):
            return
        self._draw_lines(tracks.position[rows], gates.predicted[rows], 0.8, ":")
        took = rows[gates.taken[rows] >= 0]
        self._draw_lines(gates.predicted[took], plots[gates.taken[took]], 1.1, "-")
        look = {**STYLES["predicted"], "color": shared.INK, "zorder": 3.2}
        self.ax.plot(*self.plane.shown(gates.predicted[rows]), label="predicted", **look)

    def _draw_outlines(self, rows: Any, color: str, label: str, dotted: bool) -> None:
        x, y = self.plane.shown(self.gates.outlines[rows].reshape(-1, 2))
        corners = np.stack([x, y], axis=1).reshape(len(rows), -1, 2)
        style: dict[str, Any] = {"linestyle": (0, (1.2, 1.4)) if dotted else "-", "linewidth": 1.3}
        self.ax.add_collection(
            PolyCollection(list(corners), facecolors=color, alpha=0.10, edgecolors="none", zorder=2)
        )
        closed = np.concatenate([corners, corners[:, :1]], axis=1)
        self.ax.add_collection(LineCollection(list(closed), colors=color, zorder=2.1, **style))
        self.ax.plot([], [], color=color, label=label, **style)
        self.ax.autoscale_view()

    def _draw_lines(self, begin: Array, end: Array, width: float, style: str) -> None:
        pairs = np.stack([begin, end], axis=1)
        x, y = self.plane.shown(pairs.reshape(-1, 2))
        lines = np.stack([x, y], axis=1).reshape(-1, 2, 2)
        self.ax.add_collection(
            LineCollection(
                list(lines), colors=shared.INK, linewidths=width, linestyles=style, zorder=2.9
            )
        )

    def explain(self, plots: Array) -> None:
        """Identities beside the predicted places, and the legend."""
        if self.ax.get_legend_handles_labels()[0]:
            shared.legend_below(self.ax)
        rows = np.flatnonzero(self.drawn)
        if not len(rows):
            self.ax.set_title("no track", fontsize="medium")
        elif len(rows) <= _NAMED:
            gates = self.gates
            outlines = np.insert(gates.outlines[rows], gates.outlines.shape[1], np.nan, axis=1)
            marks = np.concatenate([gates.predicted[rows], plots])
            # At the corner that is highest.
            tops = np.stack(self.plane.shown(gates.outlines[rows].reshape(-1, 2)), axis=1)
            tops = tops.reshape(len(rows), -1, 2)
            highest = tops[np.arange(len(rows)), tops[:, :, 1].argmax(axis=1)]
            label_ends(
                self.ax,
                [str(id) for id in gates.tracks.track_id[rows]],
                highest,
                [KIND_COLORS[KINDS[kind]] for kind in gates.tracks.kind[rows]],
                np.stack(self.plane.shown(outlines.reshape(-1, 2)), axis=1),
                np.stack(self.plane.shown(marks), axis=1),
                all_or_none=False,
            )
