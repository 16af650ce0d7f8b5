"""The plane in which scans are drawn: names and units of its axes, north upwards, equal scales."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import ScalarFormatter

from fuzzytrack.arrays import Array
from fuzzytrack.io.map_axes import map_axes
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._position_axes import PositionAxes, spread

__all__ = ["GroundPlane"]

# Limits of a picture's height over its width.
_HEIGHTS = (0.5, 1.1)


@dataclass(frozen=True)
class GroundPlane:
    """How positions of shape (n, 2) are drawn.

    Attributes
    ----------
    labels : tuple of str
        What is written at the horizontal and at the vertical axis.
    order : tuple of int
        Which axis of space is horizontal, and which is vertical.
    scale : float
        By what positions are divided to be shown.
    height : float
        That of the picture over its width.
    """

    labels: tuple[str, str]
    order: tuple[int, int]
    scale: float
    height: float

    @classmethod
    def of(cls, names: Sequence[str], points: Array) -> GroundPlane:
        """Plane that shows some points, shape (n, 2).

        Raises
        ------
        ValueError
            If there are not two names.
        """
        shown, order = map_axes(names)
        axes = PositionAxes.of(2, shown, None, None, spread(points))
        known = points[np.isfinite(points).all(axis=1)]
        width, height = np.ptp(known, axis=0)[list(order)] if len(known) else (1.0, 1.0)
        shape = float(np.clip(height / width if width > 0 else 1.0, *_HEIGHTS))
        across, up = axes.labels
        return cls((across, up), order, axes.scale, shape)

    def size(self, width: float) -> tuple[float, float]:
        """Size of a picture of some width, in inches."""
        # With room for the labels and the legend.
        return width, self.height * (width - 0.9) + 1.0

    def shown(self, positions: Array) -> tuple[Array, Array]:
        """Horizontal and vertical coordinates."""
        across, up = self.order
        return positions[:, across] / self.scale, positions[:, up] / self.scale

    def finish(self, ax: Axes, *, limits: Array | None = None) -> None:
        """Labels, equal scales and the grid.

        Parameters
        ----------
        limits : ndarray, shape (2, 2), optional
            Corners of what is shown (m); the axes are then as long as that. Else all that is drawn
            is shown, and more to one side or the other, so that the axes fill their place.
        """
        ax.set_xlabel(self.labels[0])
        ax.set_ylabel(self.labels[1])
        for axis in (ax.xaxis, ax.yaxis):
            # Others are of axes that a user has given.
            if isinstance(formatter := axis.get_major_formatter(), ScalarFormatter):
                formatter.set_useOffset(False)
        if limits is None:
            ax.set_aspect(1.0, adjustable="datalim")
            # Before the figure is laid out, which leaves room for the labels of the limits.
            ax.apply_aspect()
        else:
            x, y = self.shown(limits)
            ax.set_xlim(x.min(), x.max())
            ax.set_ylim(y.min(), y.max())
            ax.set_aspect(1.0, adjustable="box")
        shared.finish(ax)
