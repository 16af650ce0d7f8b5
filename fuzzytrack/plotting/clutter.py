"""The clutter that a scan tracker has learned, as a map."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatterSciNotation, LogLocator
from numpy.typing import ArrayLike

from fuzzytrack.arrays import Array
from fuzzytrack.plotting import _figures as shared
from fuzzytrack.plotting._ground_plane import GroundPlane
from fuzzytrack.plotting._reported_tracks import plots_of
from fuzzytrack.plotting._track_styles import STYLES
from fuzzytrack.scan.scan import Scan

__all__ = ["plot_clutter_map"]

# Width of the picture in inches.
_WIDTH = 6.8
# Part of the plots on each side that the map may leave out, and its margin.
_OUTSIDE, _MARGIN = 0.005, 0.03
# Densities below this part of the largest one have the color of the least.
_RANGE = 1e-5

#: Density (plots/m² and scan) at places (m).
Density = Callable[[Array, Array], ArrayLike]


def plot_clutter_map(
    density: Density | Any,
    scans: Sequence[Scan] | None = None,
    extent: tuple[tuple[float, float], tuple[float, float]] | None = None,
    axes_names: Sequence[str] = ("x", "y"),
    *,
    cells: int = 150,
    recent: int = 10,
    ax: Axes | None = None,
) -> tuple[Figure, Axes]:
    """Density of clutter over the plane, on a logarithmic scale of colors.

    Parameters
    ----------
    density : ScanSession or callable
        A session after some scans, or a function of two arrays (m) that gives plots/m² and scan.
    scans : sequence of Scan, optional
        The scans so far: the map shows where they have plots, those of the last ones as dots, and
        where the radar is.
    extent : ((float, float), (float, float)), optional
        First and last value of each axis of space (m) in place of that.
    axes_names : sequence of str
        Names of the two axes. North, or what begins with it, is drawn upwards.
    cells : int
        Places at which the density is read along the longer side.
    recent : int
        Of how many of the last scans the plots are drawn.
    ax : Axes, optional
        Axes to draw into.

    Returns
    -------
    figure : Figure
    ax : Axes

    Raises
    ------
    ValueError
        If there is neither an extent nor a plot, the extent is empty, or a density is not positive.
    """
    (x0, x1), (y0, y1) = _extent(scans, extent)
    plane = GroundPlane.of(axes_names, np.array([[x0, y0], [x1, y1]]))
    step = max(x1 - x0, y1 - y0) / cells
    x, y = (_middles(low, high, step) for low, high in ((x0, x1), (y0, y1)))
    values = _density(density, x, y)
    figure, (panel,) = shared.panels("ax", ax, 1, columns=1, size=plane.size(_WIDTH))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    across, up = plane.shown(grid.reshape(-1, 2))
    mesh = panel.pcolormesh(
        across.reshape(values.shape),
        up.reshape(values.shape),
        values,
        norm=LogNorm(max(values.min(), _RANGE * values.max()), values.max()),
        cmap=shared.COLORMAP,
        shading="nearest",
        rasterized=True,
        zorder=1,
    )
    _draw_bar(figure, panel, mesh)
    if scans and recent > 0:
        _draw_scans(panel, plane, scans, recent)
    plane.finish(panel, limits=np.array([[x0, y0], [x1, y1]]))
    panel.grid(visible=False)
    if panel.get_legend_handles_labels()[0]:
        shared.legend_below(panel)
    return figure, panel


def _extent(
    scans: Sequence[Scan] | None, given: tuple[tuple[float, float], tuple[float, float]] | None
) -> tuple[tuple[float, float], tuple[float, float]]:
    if given is None:
        plots = plots_of(scans)
        plots = plots[np.isfinite(plots).all(axis=1)]
        if not len(plots):
            raise ValueError("extent: must be given if there are no scans with a plot")
        low, high = np.quantile(plots, [_OUTSIDE, 1 - _OUTSIDE], axis=0)
        room = _MARGIN * max(float((high - low).max()), 1.0)
        low, high = low - room, high + room
        return (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))
    (x0, x1), (y0, y1) = given
    if not (-np.inf < x0 < x1 < np.inf and -np.inf < y0 < y1 < np.inf):
        raise ValueError(f"extent: needs a first and a larger last value (m) twice, got {given}")
    return (float(x0), float(x1)), (float(y0), float(y1))


def _middles(low: float, high: float, step: float) -> Array:
    """Middles of cells from one end to the other, one at least."""
    count = max(1, round((high - low) / step))
    return low + (high - low) * (np.arange(count) + 0.5) / count


def _density(density: Density | Any, x: Array, y: Array) -> Array:
    """Values at all places, shape (len(x), len(y))."""
    read = getattr(density, "clutter_density", density)
    if not callable(read):
        raise ValueError(
            "density: must be a session of a scan tracker, or a function of x and y; "
            f"got {type(density).__name__}"
        )
    places = np.meshgrid(x, y, indexing="ij")
    values = np.asarray(read(*places), np.float64)
    values = np.array(np.broadcast_to(values, places[0].shape))
    if not (values > 0).all():
        raise ValueError(f"density: must be positive everywhere, got {values.min():g} at a place")
    return values


def _draw_bar(figure: Figure, ax: Axes, mesh: Any) -> None:
    # As high as the map.
    place = ax.inset_axes((1.02, 0.0, 0.03, 1.0))
    bar = figure.colorbar(mesh, cax=place, label="clutter (plots per m² and scan)")
    low, high = mesh.norm.vmin, mesh.norm.vmax
    # Between powers of ten too where there are few of them.
    subs = (1.0, 2.0, 5.0) if high < 100 * low else (1.0,)
    bar.locator = LogLocator(subs=subs)
    bar.formatter = LogFormatterSciNotation(labelOnlyBase=False)
    bar.minorlocator = LogLocator(subs=())
    bar.update_ticks()


def _draw_scans(ax: Axes, plane: GroundPlane, scans: Sequence[Scan], recent: int) -> None:
    """Plots of the last scans as dots, and the place of the radar."""
    plots = plots_of(scans[-recent:])
    if len(plots):
        label = f"plots of the last {min(recent, len(scans))} scans"
        # With an edge, since the legend is on white.
        look: dict[str, Any] = {
            "markerfacecolor": "white",
            "markeredgecolor": "0.25",
            "markeredgewidth": 0.5,
        }
        ax.plot(*plane.shown(plots), "o", label=label, markersize=3.0, zorder=2, **look)
    ship = np.asarray(scans[-1].own, np.float64)[None]
    style = {**STYLES["sensor"], "markeredgecolor": "white", "markeredgewidth": 0.8}
    if np.isfinite(ship).all():
        ax.plot(*plane.shown(ship), label="radar", **style)
