"""The constant time by which the clock of plots is late against that of the truth, fitted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.html_reprs import as_text
from fuzzytrack.io.recording import Recording, Track
from fuzzytrack.recordings.truth import true_positions
from fuzzytrack.reprs import summary

__all__ = ["ClockLag", "fitted_lag"]

# Largest lag that is looked for: in usual times between plots, and as a share of a track.
_INTERVALS, _SHARE = 40, 0.25
# Plots with a known truth that are needed, and plots that are looked at in the first search.
_LEAST, _MOST = 20, 4000
# A lag is used if its standard error moves the truth by less than this share of the distance from
# plots to truth, and if no other lag makes that distance smaller than this multiple of the least.
_CERTAIN, _ALIKE = 0.2, 1.05
# Standard errors within which a lag may be chance.
_CHANCE = 3.0
# How finely a lag is looked for, as a share of the usual time between plots; no error is smaller.
_FINEST = 5e-5
_STEADY = "the targets move too steadily to tell it from an offset"


@dataclass(frozen=True)
class ClockLag:
    """Lag of the clock of plots against that of the truth.

    Attributes
    ----------
    lag : float
        Time of a plot minus that of the truth (s); 0 where it cannot be told.
    error : float
        Its standard error (s); NaN where it cannot be told.
    unknown : str
        Why it cannot be told; empty if it can.
    """

    lag: float
    error: float
    unknown: str = ""

    def __repr__(self) -> str:
        return summary(self, "lag", "error", "unknown")

    @property
    def taken_off(self) -> float:
        """What is to be taken off the times of plots (s): 0 if it may be chance."""
        return self.lag if abs(self.lag) > _CHANCE * self.error else 0.0

    @property
    def sentence(self) -> str:
        """What was found and done, in words."""
        if self.unknown:
            return f"clock: no lag of the plots behind the truth was taken off: {self.unknown}."
        if not self.taken_off:
            lag = as_text(self.lag, self.error)
            return f"clock: plots and truth agree; the fitted lag is {lag} s."
        size, where = as_text(abs(self.lag), self.error), "behind" if self.lag > 0 else "ahead of"
        return f"clock: the plots are {size} s {where} the truth (fitted), which was taken off."


def fitted_lag(tracks: Sequence[Track], true: Recording) -> ClockLag:
    """Fit the lag that brings the truth nearest to the plots.

    Parameters
    ----------
    tracks : sequence of Track
        Plots, at least one track.
    true : Recording
        Their true positions.

    Returns
    -------
    ClockLag

    Raises
    ------
    DataError
        As `fuzzytrack.recordings.truth.true_positions`.

    Notes
    -----
    Least squares over all plots, with an offset of position that is the same for all of them and
    is fitted along: along the path of a target that moves steadily, an offset and a lag are one and
    the same, and only turns or other courses tell them apart. That offset is not taken off.
    """
    steps = np.concatenate([np.diff(track.time) for track in tracks])
    longest = max(float(track.time[-1] - track.time[0]) for track in tracks)
    if not len(steps) or longest <= 0:
        return ClockLag(0.0, math.nan, "there are too few plots")
    interval = float(np.median(steps))
    window = min(_INTERVALS * interval, _SHARE * longest)
    grid = np.arange(-math.ceil(2 * window / interval), math.ceil(2 * window / interval) + 1)
    lags = grid * interval / 2
    few = _some(tracks)
    sizes = np.array([_spread(_distances(few, true, lag)) for lag in lags])
    if not np.isfinite(sizes[len(sizes) // 2]):
        return ClockLag(0.0, math.nan, "the truth is known for too few plots")
    if np.nanmax(sizes) < _ALIKE * np.nanmin(sizes):
        return ClockLag(0.0, math.nan, _STEADY)
    best = int(np.nanargmin(sizes))
    if best in (0, len(sizes) - 1) or np.isnan(sizes[best - 1 : best + 2]).any():
        return ClockLag(0.0, math.nan, f"no lag within ±{window:.3g} s fits best")
    lag = _refined(tracks, true, float(lags[best]), interval)
    size = _spread(_distances(tracks, true, lag))
    away = np.abs(lags - lag) > 1.5 * interval
    apart = away[1:-1] & (sizes[1:-1] <= sizes[:-2]) & (sizes[1:-1] <= sizes[2:])
    if (sizes[1:-1][apart] < _ALIKE * size).any():
        return ClockLag(0.0, math.nan, "several lags fit alike")
    error, moved = _error(tracks, true, lag, interval / 4)
    if not moved < _CERTAIN * size:
        return ClockLag(0.0, math.nan, _STEADY)
    return ClockLag(lag, max(error, _FINEST * interval))


def _some(tracks: Sequence[Track]) -> list[Track]:
    """Every second, third... plot of the tracks, if there are many."""
    every = math.ceil(sum(len(track.time) for track in tracks) / _MOST)
    return [replace(t, time=t.time[::every], plots=t.plots[::every]) for t in tracks]


def _distances(tracks: Sequence[Track], true: Recording, lag: float) -> Array:
    """Plots minus the truth at a lag, shape (n, n_axes); of plots for which the truth is known."""
    each = [track.plots - true_positions(track, true, lag) for track in tracks]
    all_of_them = np.concatenate(each)
    return np.asarray(all_of_them[~np.isnan(all_of_them).any(axis=1)])


def _spread(distances: Array) -> float:
    """Root mean square about the mean; NaN for too few."""
    if len(distances) < _LEAST:
        return math.nan
    return float(np.sqrt(distances.var(axis=0).sum()))


def _refined(tracks: Sequence[Track], true: Recording, lag: float, interval: float) -> float:
    """The best lag between two neighbors of one of the first search."""
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda trial: _spread(_distances(tracks, true, trial)),
        bounds=(lag - interval / 2, lag + interval / 2),
        method="bounded",
        options={"xatol": _FINEST * interval},
    )
    return float(found.x)


def _error(
    tracks: Sequence[Track], true: Recording, lag: float, step: float
) -> tuple[float, float]:
    """Standard error of a lag (s), and how far it moves the truth (m)."""
    ahead = np.concatenate(
        [
            true_positions(track, true, lag - step) - true_positions(track, true, lag + step)
            for track in tracks
        ]
    )
    velocity = ahead[~np.isnan(ahead).any(axis=1)] / (2 * step)
    distances = _distances(tracks, true, lag)
    if not len(velocity):
        return math.nan, math.inf
    turning = float(((velocity - velocity.mean(axis=0)) ** 2).sum())
    if turning == 0:
        return math.inf, math.inf
    axes = distances.shape[1]
    error = _spread(distances) / math.sqrt(axes * turning)
    return error, error * math.sqrt(float((velocity**2).sum(axis=1).mean()))
