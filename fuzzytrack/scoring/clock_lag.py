"""The constant time by which the clock of tracks is late against that of the truth, fitted."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.html_reprs import as_text
from fuzzytrack.reprs import summary
from fuzzytrack.scoring.instants import Timing
from fuzzytrack.scoring.interpolation import at_instants, usual_interval
from fuzzytrack.scoring.positions import Positions

__all__ = ["Lag", "TrackLag", "by_clock_of", "fitted_lag", "lag_of"]

#: A lag of the clock of tracks (s), or that of each group, or whether it is fitted.
Lag = float | Mapping[str, float] | Literal["auto"] | None

# Largest lag that is looked for, in usual times between rows of a track, and as a share of the
# time of the truth.
_INTERVALS, _SHARE = 12, 0.25
# Lags tried in a usual interval, and rows that are needed and that are looked at.
_STEPS, _LEAST, _MOST = 4, 20, 20_000
# The distance must become smaller than this part of that of the worst lag.
_DEEP = 0.95
_FEW = "there are too few rows of tracks"


@dataclass(frozen=True)
class TrackLag:
    """Lag of the clock of tracks against that of the truth.

    Attributes
    ----------
    lag : float
        Time of a track minus that of the truth (s); 0 where it cannot be told.
    distance : float
        Root mean square of the distances from the truth at this lag, each cut off (m).
    before : float
        The same without a lag (m).
    unknown : str
        Why it cannot be told; empty if it can.
    """

    lag: float
    distance: float
    before: float
    unknown: str = ""

    def __repr__(self) -> str:
        return summary(self, "lag", "distance", "before", "unknown")

    @property
    def sentence(self) -> str:
        """What was found, in words."""
        if self.unknown:
            return f"no lag was taken off: {self.unknown}"
        where = "behind" if self.lag >= 0 else "ahead of"
        change = f"{as_text(self.before)} to {as_text(self.distance)} m"
        return (
            f"the tracks are {as_text(abs(self.lag))} s {where} the truth (fitted; RMS distance "
            f"{change})"
        )


def fitted_lag(tracks: Positions, truth: Positions, cutoff: float, timing: Timing) -> TrackLag:
    """Fit the lag that brings the tracks nearest to any true objects.

    Parameters
    ----------
    tracks, truth : Positions
        Of one recording.
    cutoff : float
        Distances are cut off there (m), so that false tracks count the same at every lag.
    timing : Timing
        Its `max_gap` is that of the truth.

    Returns
    -------
    TrackLag

    Notes
    -----
    Least squares of the distance from each row of a track to the nearest true object at the time of
    the row minus the lag. Rows are those that are ever nearer than the cut-off within the lags that
    are tried, up to 12 times between rows each way. Along the path of objects that all move
    steadily in the same direction a lag and an offset of position are one and the same.
    """
    interval = usual_interval(tracks)
    if not len(truth) or math.isnan(interval):
        return TrackLag(0.0, math.nan, math.nan, _FEW)
    begin, end = float(truth.time.min()), float(truth.time.max())
    window = min(_INTERVALS * interval, _SHARE * (end - begin))
    count = math.ceil(window / interval * _STEPS)
    lags = np.arange(-count, count + 1) * (interval / _STEPS)
    # Rows at whose times the truth may be known, at every lag that is tried.
    inner = np.flatnonzero((tracks.time >= begin + lags[-1]) & (tracks.time <= end + lags[0]))
    rows = tracks.where(inner[:: max(1, len(inner) // _MOST)])
    if len(rows) < _LEAST:
        return TrackLag(0.0, math.nan, math.nan, _FEW)
    gap = timing.truth_gap(tracks, truth)
    tried = np.array([_nearest(rows, truth, lag, gap, cutoff) for lag in lags])
    used: NDArray[np.bool_] = np.asarray((tried < cutoff).any(axis=0))
    if used.sum() < _LEAST:
        return TrackLag(0.0, math.nan, math.nan, "too few rows come near the truth at any lag")
    sizes = np.sqrt((tried[:, used] ** 2).mean(axis=1))
    before, best = float(sizes[count]), int(np.argmin(sizes))
    if sizes[best] > _DEEP * sizes.max():
        return TrackLag(0.0, before, before, "the objects move too slowly to tell it")
    if best in (0, len(lags) - 1):
        return TrackLag(0.0, before, before, f"no lag within ±{window:.3g} s fits best")
    rows = rows.where(used)

    def size(lag: float) -> float:
        return math.sqrt(float((_nearest(rows, truth, lag, gap, cutoff) ** 2).mean()))

    lag = _refined(size, float(lags[best - 1]), float(lags[best + 1]), interval)
    return min((TrackLag(each, size(each), before) for each in (lag, float(lags[best]))), key=_size)


def lag_of(lag: Lag, group: str) -> float | Literal["auto"] | None:
    """Lag of one group.

    Parameters
    ----------
    lag : float, mapping from groups to float, "auto" or None
        As for `fuzzytrack.score`.
    group : str
        Name of the group; empty if there are none.

    Raises
    ------
    ValueError
        If it is no finite number, or none is given for this group.
    """
    if isinstance(lag, Mapping):
        if not group:
            raise ValueError("lag: is given by group, but there are no groups; expected one number")
        if group not in lag:
            raise ValueError(f"lag: has no group {group!r}; expected a lag of every group")
        lag = lag[group]
    if lag is None or lag == "auto":
        return lag
    if isinstance(lag, str | bool) or not math.isfinite(lag):
        raise ValueError(f"lag: must be a finite number of seconds, 'auto' or None, got {lag!r}")
    return float(lag)


def by_clock_of(
    tracks: Positions, truth: Positions, lag: float | Literal["auto"] | None, cutoff: float
) -> tuple[Positions, str]:
    """The truth by the clock of the tracks.

    Parameters
    ----------
    tracks, truth : Positions
        Of one recording.
    lag : float, "auto" or None
        Time by which the clock of the tracks is late (s); "auto" fits it.
    cutoff : float
        As for `fitted_lag` (m).

    Returns
    -------
    truth : Positions
    said : str
        What was fitted, in words; empty if nothing was.
    """
    said = ""
    if lag == "auto":
        found = fitted_lag(tracks, truth, cutoff, Timing())
        lag, said = found.lag, found.sentence
    return (replace(truth, time=truth.time + lag) if lag else truth), said


def _size(found: TrackLag) -> float:
    return found.distance


def _refined(size: Callable[[float], float], low: float, high: float, interval: float) -> float:
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        size, bounds=(low, high), method="bounded", options={"xatol": 1e-4 * interval}
    )
    return float(found.x)


def _nearest(rows: Positions, truth: Positions, lag: float, gap: float, cutoff: float) -> Array:
    """Distance of each row from the nearest true object at a lag, cut off (m)."""
    from scipy.spatial import KDTree

    instants, place = np.unique(rows.time - lag, return_inverse=True)
    there = at_instants(replace(truth, velocity=None), instants, gap, 0.0)
    if not len(there):
        return np.full(len(rows), cutoff)
    # One tree for all instants: another coordinate keeps them farther apart than the cut-off.
    apart = 2.0 * cutoff
    tree = KDTree(np.column_stack([there.position, apart * there.instant]))
    distances, _ = tree.query(
        np.column_stack([rows.position, apart * place]), distance_upper_bound=cutoff
    )
    return np.asarray(np.minimum(distances, cutoff))
