"""Plots, times and standard deviations as a user gives them: checked, and laid out as lanes.

`fuzzytrack.trackers.lane_tracker` uses it for the arguments of `run`, `start` and `step`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.gains.checks import SQUARES

__all__ = [
    "SIGMAS", "PlotLayout", "as_plots", "as_times", "check_single_precision", "gains_as_plots",
    "infinite_plot", "plot_sigmas", "time_steps",
    "with_time_axis",
]  # fmt: skip


#: Least and largest standard deviation of a plot: its square is a variance to calculate with.
SIGMAS: dict[type, tuple[float, float]] = {np.float64: SQUARES, np.float32: (1e-18, 1e18)}


@dataclass(frozen=True)
class PlotLayout:
    """How plots over time are laid out as lanes, see `fuzzytrack.lanes.layout.Rows`.

    Attributes
    ----------
    shape : tuple of int
        Shape of the plots: (n_steps, ...batch, n_axes), or (n_steps,) for one axis alone.
    lane_axes : int
        Axes of a lane: 1, or all of a track.
    lanes : int
        Number of lanes.
    """

    shape: tuple[int, ...]
    lane_axes: int
    lanes: int

    @classmethod
    def of(cls, shape: tuple[int, ...], coupled: bool) -> PlotLayout:
        """Layout of plots of a shape; a lane is a whole track if the tracker is `coupled`.

        Raises
        ------
        ValueError
            If there is no time axis, or no axis of space.
        """
        if not shape:
            raise ValueError("z: needs a time axis; got a single number")
        n_axes = shape[-1] if len(shape) > 1 else 1
        if n_axes == 0:
            raise ValueError(f"z: needs at least one axis of space; got shape {shape}")
        lane_axes = n_axes if coupled else 1
        return cls(shape, lane_axes, math.prod(shape[1:]) // lane_axes)

    def to_lanes(self, values: NDArray[Any]) -> NDArray[Any]:
        """Array that broadcasts with the plots, as one that does with (n_steps, lanes, axes)."""
        if math.prod(values.shape[1:]) == 1:
            return values.reshape(-1, 1, 1)
        # What is the same at all times is not repeated.
        full = np.broadcast_to(values, (len(values), *self.shape[1:]))
        return full.reshape(len(values), self.lanes, self.lane_axes)

    def track_of(self, lane: int) -> tuple[int, ...]:
        """Index of the track of a lane in the batch; empty for a track alone."""
        batch = self.shape[1:-1]
        per_track = self.lanes // math.prod(batch)
        return tuple(int(k) for k in np.unravel_index(lane // per_track, batch)) if batch else ()

    def times_to_lanes(self, times: Array) -> Array:
        """Times, common or each track's own, shape (n_steps, lanes or 1)."""
        if times.ndim == 1:
            return times[:, None]
        tracks = math.prod(times.shape[1:])
        return np.repeat(times.reshape(len(times), tracks), self.lanes // max(tracks, 1), axis=1)

    def from_lanes(self, values: Array) -> Array:
        """Output of a run, shape (n_steps, lanes[, axes]), in the shape of the plots."""
        if values.ndim == 3:
            return values.reshape(self.shape)
        return gains_as_plots(values, self.shape, self.lane_axes)


def gains_as_plots(gains: Array, shape: tuple[int, ...], lane_axes: int) -> Array:
    """Gains of lanes in the shape of the plots; those that axes share become repeated views."""
    if lane_axes == 1:
        return gains.reshape(shape)
    return np.broadcast_to(gains.reshape(*shape[:-1], 1), shape)


def as_plots(z: ArrayLike, dtype: DTypeLike) -> NDArray[Any]:
    """Plots as numbers of a type; NaN where they are masked.

    Raises
    ------
    ValueError
        If they are not real numbers, or the type is neither float64 nor float32.
    """
    kind = np.dtype(dtype)
    if kind not in (np.dtype(np.float64), np.dtype(np.float32)):
        raise ValueError(f"dtype must be float64 or float32, got {kind}")
    if isinstance(z, np.ma.MaskedArray):
        z = np.ma.filled(z.astype(np.float64), np.nan)
    given = _real("z", z)
    # A number too large for the type becomes infinite, and is refused as an infinite plot.
    with np.errstate(over="ignore"):
        return np.asarray(given, dtype=kind)


def with_time_axis(values: ArrayLike) -> NDArray[Any]:
    """Values of one step as those of a run of one step; masks are kept."""
    given = values if isinstance(values, np.ma.MaskedArray) else np.asarray(values)
    return given.reshape((1, *given.shape))


def as_times(t: ArrayLike, before: ArrayLike | None) -> Array:
    """Times (s) of the plots, each track's own if those of the state, `before`, are.

    Raises
    ------
    ValueError
        If they are not real numbers.
    DataError
        If a time is masked: a plot has a time, or it is left out.
    """
    if np.ma.is_masked(t):
        place = tuple(int(k) for k in np.argwhere(np.ma.getmaskarray(np.ma.asarray(t)))[0])
        at = f" at index {place if len(place) > 1 else place[0]}" if place else ""
        raise DataError(f"t: time{at} is masked; leave such rows out")
    times = np.asarray(_real("t", t), dtype=np.float64)
    own = np.shape(before) if before is not None else ()
    if times.ndim != 1 or not own:
        return times
    common = times.reshape(-1, *(1,) * len(own))
    return np.broadcast_to(common, (len(times), *own))


def time_steps(times: Array, shape: tuple[int, ...], before: ArrayLike | None) -> Array:
    """Time since the step before (s), shaped as the times; 0 at the first step of new tracks.

    Parameters
    ----------
    times : ndarray
        From `as_times`.
    shape : tuple of int
        Shape of the plots.
    before : array_like or None
        Time of the state from which tracks continue (s); None for new tracks.

    Raises
    ------
    DataError
        If times are not finite and increasing; says where.
    ValueError
        If their shape does not fit that of the plots.
    """
    if not times.ndim or times.shape not in (shape[:1], shape[:-1]):
        own = f" or {shape[:-1]}" if len(shape) > 2 else ""
        raise ValueError(
            f"t: shape {times.shape} does not fit plots of shape {shape}; {shape[:1]}{own} does"
        )
    if not np.isfinite(times).all():
        place = int(np.argwhere(~np.isfinite(times))[0][0])
        raise DataError(f"t: time at index {place} is not finite")
    start = times[:1] if before is None else np.broadcast_to(before, times.shape[1:])[None]
    # In place: times of each track's own take as much memory as its plots.
    dts = np.empty(times.shape)
    np.subtract(times[:1], start, out=dts[:1])
    np.subtract(times[1:], times[:-1], out=dts[1:])
    bad = dts <= 0
    if before is None:
        bad[:1] = False
    if bad.any():
        step, *track = (int(k) for k in np.argwhere(bad)[0])
        where = (step, *track) if track else step
        earlier = "the one before" if step else f"that of the state ({start[where]} s)"
        raise DataError(
            f"t: times must increase; the one at index {where} ({times[where]} s) is not later "
            f"than {earlier}"
        )
    return dts


def plot_sigmas(sigma: ArrayLike | None, plots: Array, needed_by: str | None) -> Array:
    """Standard deviations (m) with as many axes as the plots, and broadcasting with them.

    Parameters
    ----------
    sigma : array_like or None
        None is NaN for every plot.
    plots : ndarray
    needed_by : str or None
        Name of the tracker, if it cannot do without.

    Raises
    ------
    ValueError
        If they are needed and missing, do not broadcast with the plots, or where there is a plot
        are masked, not positive, or so small or large that their squares are no numbers.
    """
    if sigma is None:
        if needed_by is not None:
            raise ValueError(f"sigma: {needed_by} needs the standard deviation of the plots (m)")
        return np.full((1,) * plots.ndim, np.nan)
    hidden = np.ma.is_masked(sigma)
    if hidden:
        sigma = np.ma.filled(np.ma.asarray(sigma, dtype=np.float64), np.nan)
    values = np.asarray(_real("sigma", sigma), dtype=np.float64)
    try:
        full = np.broadcast_to(values, plots.shape)
    except ValueError:
        raise ValueError(
            f"sigma: shape {values.shape} does not broadcast with the plots' {plots.shape}"
        ) from None
    least, most = SIGMAS[plots.dtype.type]
    fits = (values >= least) & (values <= most)
    if not fits.all():
        bad = ~np.broadcast_to(fits, plots.shape) & ~np.isnan(plots)
        for place in np.argwhere(bad)[:1].tolist():
            value = full[tuple(place)]
            squared = f", from {least:g} to {most:g} since it is squared,"
            between = squared if 0 < value < np.inf else ""
            raise ValueError(
                f"sigma must be positive and finite{between} where there is a plot; at index "
                f"{tuple(place)} it is {'masked' if hidden else f'{value:g}'}"
            )
    return values.reshape((1,) * (plots.ndim - values.ndim) + values.shape)


def check_single_precision(what: str, values: Array, needed: NDArray[Any]) -> None:
    """Check that single precision rounds no number to 0 or infinity, unless `needed` is NaN there.

    Raises
    ------
    ValueError
        If there is one; the message begins with `what`.
    """
    with np.errstate(over="ignore", under="ignore"):
        single = values.astype(np.float32)
    lost = (values > 0) & np.isfinite(values) & ~((single > 0) & np.isfinite(single))
    if lost.any():
        lost = lost & ~np.isnan(needed)
    if lost.any():
        value = np.broadcast_to(values, lost.shape)[lost][0]
        raise ValueError(f"{what} {value:g} is out of the range of float32; use float64")


def infinite_plot(plots: Array) -> DataError:
    """Error that says which of some plots is infinite."""
    place = tuple(int(k) for k in np.argwhere(np.isinf(plots))[0])
    large = " (or too large for float32)" if plots.dtype == np.float32 else ""
    return DataError(f"z: infinite plot{large} at index {place}; use NaN for a missed one")


def _real(name: str, values: ArrayLike) -> NDArray[Any]:
    given = np.asarray(values)
    if given.dtype.kind in "mMc":
        seconds = "seconds as " if name == "t" else ""
        raise ValueError(f"{name}: needs {seconds}real numbers, got {given.dtype}")
    return given
