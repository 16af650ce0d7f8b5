"""Whether the gains of a run suit the times of its plots; `LaneTracker.run` warns if not.

Gains without a unit belong to one sampling time. Where times differ much, such gains can multiply
the noise of the plots until a track consists of nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.gains.track_noise import largest_noise
from fuzzytrack.trackers.state import Gains

__all__ = ["WRONG_GAINS", "TrackTimes"]

#: What is wrong, for messages.
WRONG_GAINS = (
    "its gains do not suit times between plots that differ so much, and make the noise of the "
    "plots more than ten times larger; use gains with a period, maneuver or kalman-cv"
)

# Of a larger batch so many tracks are looked at, evenly spread.
_TRACKS = 200
# Times that differ by less do no harm to gains that are stable at a constant T.
_ALIKE = 2.0
# Standard deviation of a position in those of a plot; with the gains of a Kalman filter at most 1.
_NOISE = 10.0


@dataclass(frozen=True, eq=False)
class TrackTimes:
    """Times between the plots of some tracks of a run, which differ.

    Attributes
    ----------
    tracks : slice
        Which tracks, counted over all axes of the batch.
    elapsed : ndarray, shape (n_steps, n_tracks, n_axes)
        Time since the last plot (s); NaN where there was none.
    dt : ndarray, shape (n_steps, n_tracks, n_axes)
        Time step with which gains were used (s).
    """

    tracks: slice
    elapsed: Array
    dt: Array

    @classmethod
    def of(cls, times: Array, plots: NDArray[Any], coupled: bool, missed: str) -> TrackTimes | None:
        """Times of some of the tracks; None if they hardly differ: then there is nothing to check.

        Parameters
        ----------
        times : ndarray, shape (n_steps,) or (n_steps, ...batch)
            Times (s).
        plots : ndarray, shape (n_steps,) or (n_steps, ...batch, n_axes)
            Plots (m); NaN where missed.
        coupled : bool
            Whether a plot is missed on all axes or on none.
        missed : {"elapsed", "step"}
            See `LaneTracker`.
        """
        n_steps = len(times)
        if n_steps < 2 or not plots.size:
            return None
        batch = _by_track(plots)
        tracks = slice(None, None, -(-batch.shape[1] // _TRACKS))
        own = times.reshape(n_steps, -1, 1)[:, tracks if times.ndim > 1 else slice(None)]
        steps = own[1:] - own[:-1]
        seen = ~np.isnan(batch[:, tracks])
        if not _differ(steps) and (missed == "step" or seen.all()):
            return None
        if coupled:
            seen[:] = seen.all(axis=2, keepdims=True)
        last = np.maximum.accumulate(np.where(seen, own, -np.inf), axis=0)
        elapsed, dt = (np.full(seen.shape, np.nan) for _ in range(2))
        elapsed[1:] = own[1:] - last[:-1]
        elapsed[~(seen & np.isfinite(elapsed))] = np.nan
        dt[1:] = steps if missed == "step" else elapsed[1:]
        return cls(tracks, elapsed, dt) if _differ(dt[1:]) else None

    def are_wrong_for(self, gains: Gains) -> bool:
        """Whether with the gains of a run any of these tracks becomes mostly noise."""
        alpha, beta, gamma = (
            _by_track(gain)[:, self.tracks] for gain in (gains.alpha, gains.beta, gains.gamma)
        )
        alpha = np.where(np.isnan(self.elapsed), np.nan, alpha)
        elapsed, alpha, beta, gamma, dt = (
            values.reshape(len(values), -1)
            for values in (self.elapsed, alpha, beta, gamma, self.dt)
        )
        return bool(largest_noise(elapsed, alpha, beta, gamma, dt).max() > _NOISE)


def _by_track(values: NDArray[Any]) -> NDArray[Any]:
    """Values shaped as the plots, as (n_steps, n_tracks, n_axes)."""
    n_axes = values.shape[-1] if values.ndim > 1 else 1
    return values.reshape(len(values), -1, n_axes)


def _differ(steps: Array) -> bool:
    """Whether the largest time of any track is over twice its smallest."""
    largest, smallest = np.fmax.reduce(steps), np.fmin.reduce(steps)
    return bool((largest > _ALIKE * smallest).any())
