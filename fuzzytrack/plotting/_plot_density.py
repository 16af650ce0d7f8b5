"""How dense plots are, where there are too many to be drawn one by one."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize
from matplotlib.ticker import LogLocator

from fuzzytrack.arrays import Array
from fuzzytrack.plotting import _figures as shared

__all__ = ["draw_density"]

# Without the palest, so that single plots are seen.
_GRAYS = LinearSegmentedColormap.from_list("grays", ["0.85", "0.35"])
# Cells along the longer side: so many that each has some plots, between these limits.
_CELLS = (60, 160)
# Counts that differ by more than this factor are colored on a logarithmic scale.
_APART = 30.0


def draw_density(
    ax: Axes,
    x: Array,
    y: Array,
    aspect: float | None,
    *,
    behind: bool = False,
    what: str = "plots in a cell",
) -> None:
    """Draw the number of plots in each cell, with a colorbar.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        Coordinates of the plots; those with NaN are left out.
    aspect : float or None
        Length of a unit of y over one of x: cells are then square. None for axes that cannot be
        compared.
    behind : bool
        Whether lines are drawn above: then in gray, as plots are.
    what : str
        What is counted, for the colorbar.
    """
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    width, height = np.ptp(x) or 1.0, np.ptp(y) or 1.0
    along = int(np.clip(np.sqrt(len(x)) / 2, *_CELLS))
    across, up = along, 3 * along // 4
    if aspect is not None:
        cell = max(width, height * aspect) / along
        across, up = (max(1, int(np.ceil(side / cell))) for side in (width, height * aspect))
    counts, left, below = np.histogram2d(x, y, bins=(across, up))
    most, middle = counts.max(), np.median(counts[counts > 0])
    scale = LogNorm(1, most) if most > _APART * middle else Normalize(0, most)
    mesh = ax.pcolormesh(
        left,
        below,
        np.ma.masked_equal(counts.T, 0),
        cmap=_GRAYS if behind else shared.COLORMAP,
        norm=scale,
        rasterized=True,
        zorder=1.5,
    )
    bar = shared.figure_of(ax).colorbar(mesh, ax=ax, label=what, shrink=0.9)
    if isinstance(scale, LogNorm):
        bar.locator = LogLocator(subs=(1.0, 2.0, 5.0))
        bar.formatter = shared.PLAIN
        bar.minorlocator = LogLocator(subs=())
        bar.update_ticks()
