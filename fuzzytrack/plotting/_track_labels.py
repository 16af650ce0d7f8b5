"""Identities written at the ends of tracks, where they cover nothing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from matplotlib.text import Text

from fuzzytrack.arrays import Array
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._track_styles import darker

__all__ = ["label_ends"]

# Distances from the end of a track to its label, in points, and directions that are tried.
_DISTANCES = (7.0, 12.0)
_DIRECTIONS = ((1, 0), (1, 1), (1, -1), (-1, 0), (-1, 1), (-1, -1), (0, 1), (0, -1))
_ANCHORS = {1: ("left", "bottom"), 0: ("center", "center"), -1: ("right", "top")}
# Half the side of a mark, in points.
_MARK = 4.0
# Side of the squares in which the picture is divided to find free places, in pixels.
_CELL = 3


def label_ends(
    ax: Axes,
    ids: Sequence[str],
    ends: Array,
    colors: Sequence[Any],
    lines: Array,
    marks: Array,
    *,
    all_or_none: bool = True,
) -> bool:
    """Write the identities of tracks at their ends.

    Parameters
    ----------
    ax : Axes
        With all that is drawn in it.
    ids : sequence of str
    ends : ndarray, shape (n_tracks, 2)
        Where the tracks end.
    colors : sequence
        Colors of the tracks.
    lines : ndarray, shape (n, 2)
        Points of all lines, which labels must not cover; a row of NaN between two lines.
    marks : ndarray, shape (n, 2)
        Where marks are, which they must not cover either.
    all_or_none : bool
        Whether nothing is written if there is no free place for one of them; else only that one is
        left out.

    Returns
    -------
    bool
        Whether all are written.
    """
    # Places depend on the limits of the axes, which are known when the figure is laid out.
    shared.figure_of(ax).draw_without_rendering()
    taken = _Taken(ax)
    taken.take_lines(lines)
    taken.take_marks(marks)
    written: list[Text] = []
    for id, end, color in zip(ids, ends, colors, strict=True):
        text = _free_text(ax, taken, id, end, color)
        if text is not None:
            written.append(text)
        elif all_or_none:
            for each in written:
                each.remove()
            return False
    return len(written) == len(ids)


def _free_text(ax: Axes, taken: _Taken, id: str, end: Array, color: Any) -> Text | None:
    for distance in _DISTANCES:
        for right, up in _DIRECTIONS:
            long = distance if 0 in (right, up) else 0.7 * distance
            text = ax.annotate(
                id,
                (end[0], end[1]),
                (right * long, up * long),
                textcoords="offset points",
                ha=_ANCHORS[right][0],
                va=_ANCHORS[up][1],
                fontsize=8.5,
                color=darker(color),
                zorder=4,
                parse_math=False,
                path_effects=[withStroke(linewidth=2.0, foreground="white")],
            )
            box = np.asarray(text.get_window_extent().extents)
            if taken.is_free(box):
                taken.take(box)
                return text
            text.remove()
    return None


class _Taken:
    """Which squares of the pixels of some axes are taken."""

    def __init__(self, ax: Axes) -> None:
        self._ax, self._box = ax, ax.get_window_extent()
        shape = np.array([self._box.height, self._box.width]) / _CELL
        self._cells = np.zeros(np.ceil(shape).astype(int) + 1, dtype=bool)

    def take_lines(self, points: Array) -> None:
        """Take the squares that lines pass, from point to point."""
        pixels = self._ax.transData.transform(points)
        steps = np.abs(np.diff(pixels, axis=0)).max(axis=1)
        joined = np.isfinite(steps)
        begins, moves = pixels[:-1][joined], np.diff(pixels, axis=0)[joined]
        counts = np.minimum(np.ceil(steps[joined] / _CELL).astype(int) + 1, max(self._cells.shape))
        which = np.repeat(np.arange(len(counts)), counts)
        place = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
        passed = begins[which] + moves[which] * (place / counts[which])[:, None]
        single = pixels[np.isfinite(pixels).all(axis=1)]
        column, row = ((np.concatenate([passed, single]) - self._box.p0) / _CELL).astype(int).T
        inside = (column >= 0) & (row >= 0)
        inside &= (row < self._cells.shape[0]) & (column < self._cells.shape[1])
        self._cells[row[inside], column[inside]] = True

    def take_marks(self, points: Array) -> None:
        """Take the squares of marks."""
        half = _MARK * shared.figure_of(self._ax).dpi / 72
        for x, y in self._ax.transData.transform(points):
            self.take(np.array([x - half, y - half, x + half, y + half]))

    def is_free(self, extents: Array) -> bool:
        """Whether a box lies inside of the axes, and nothing in it is taken."""
        x0, y0, x1, y1 = extents
        inside = self._box.x0 <= x0 and self._box.y0 <= y0
        inside = inside and x1 <= self._box.x1 and y1 <= self._box.y1
        return inside and not self._cells[self._squares(extents)].any()

    def take(self, extents: Array) -> None:
        """Take a box."""
        self._cells[self._squares(extents)] = True

    def _squares(self, extents: Array) -> tuple[slice, slice]:
        x0, y0, x1, y1 = (extents - [*self._box.p0, *self._box.p0]) / _CELL
        return slice(max(int(y0), 0), int(y1) + 1), slice(max(int(x0), 0), int(x1) + 1)
