"""The instants at which tracks and truth are compared, and the scene at them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.errors import DataError
from fuzzytrack.scoring.interpolation import at_instants, usual_interval
from fuzzytrack.scoring.positions import Positions
from fuzzytrack.scoring.scored_scene import ScoredScene

__all__ = ["Timing", "added_at_ends", "make_scene"]

# Distinct times nearer than this part of the time between rows of a track: tracks have times of
# their own, and are compared on a grid.
_SHARED = 0.75
# A longer time without a row than this multiple of the usual one is a gap.
_GAP = 1.5
# The same between rows of a track that have times of their own: one at the beginning of a scan, and
# one at the end of the next scan, or a coasting one there, are up to two scans apart.
_OWN_GAP = 2.1
# Usual times between samples of the truth, or between rows of a track, over which the truth is
# interpolated.
_TRUE_GAP, _TRACK_GAP = 10.0, 3.0
# More instants than this are a mistake in the times.
_MOST = 5_000_000


@dataclass(frozen=True, eq=False)
class Timing:
    """When tracks and truth are compared.

    Attributes
    ----------
    times : ndarray, optional
        The instants (s), as those of all scans of a radar, those without a track included.
    step : float, optional
        Without them: the time between instants (s). Otherwise the times of the rows of tracks are
        the instants, and where these are missing for longer than one and a half usual intervals,
        more are put between, also before and after, as far as the truth goes. If tracks have times
        of their own, instants follow each other at the usual interval.
    max_gap : float, optional
        Longest time between two samples of the truth (s) over which it is interpolated; unless
        given, ten times the usual one, or three times that between rows of a track if it is longer.
    lag : float
        Time by which the clock of the tracks is late against that of the truth (s).
    """

    times: Array | None = None
    step: float | None = None
    max_gap: float | None = None
    lag: float = 0.0

    def __post_init__(self) -> None:
        for name in ("step", "max_gap"):
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise ValueError(f"{name}: must be a finite number of seconds > 0, got {value:g}")
        if not math.isfinite(self.lag):
            raise ValueError(f"lag: must be a finite number of seconds, got {self.lag:g}")

    def truth_gap(self, tracks: Positions, truth: Positions) -> float:
        """Longest time over which the truth is interpolated (s)."""
        if self.max_gap is not None:
            return self.max_gap
        usual = (_TRUE_GAP * usual_interval(truth), _TRACK_GAP * usual_interval(tracks))
        return max((gap for gap in usual if not math.isnan(gap)), default=0.0)


def make_scene(tracks: Positions, truth: Positions, timing: Timing) -> ScoredScene:
    """Tracks and truth at common instants.

    Parameters
    ----------
    tracks, truth : Positions
        Of one recording.
    timing : Timing

    Returns
    -------
    ScoredScene
        Its instants are within the times of the truth: what is there before and after is not known.

    Raises
    ------
    DataError
        If there is no truth, or no instant within its times.
    """
    if not len(truth):
        raise DataError("truth: has no positions; there is nothing to compare tracks with")
    there = replace(truth, time=truth.time + timing.lag)
    instants, interval = _instants(tracks, there, timing)
    begin, end = float(there.time.min()), float(there.time.max())
    instants = instants[(instants >= begin) & (instants <= end)]
    if not len(instants):
        raise DataError(
            f"truth: known from {begin:.6g} to {end:.6g} s by the clock of the tracks, which have "
            f"no time within that{_span(tracks)}; a lag, or another column of time, may be meant"
        )
    seen = tracks.where((tracks.time >= instants[0]) & (tracks.time <= instants[-1]))
    shared = bool(np.isin(seen.time, instants).all())
    own = (0.0, interval, 0.0) if shared else (_OWN_GAP * interval, interval, interval / 2)
    return ScoredScene(
        instants,
        at_instants(there, instants, timing.truth_gap(tracks, truth), interval),
        at_instants(tracks, instants, *own),
    )


def _span(tracks: Positions) -> str:
    if not len(tracks):
        return ""
    return f" (they go from {tracks.time.min():.6g} to {tracks.time.max():.6g} s)"


def _instants(tracks: Positions, truth: Positions, timing: Timing) -> tuple[Array, float]:
    """Instants, and the usual time between rows of a track (s)."""
    interval = usual_interval(tracks)
    begin, end = float(truth.time.min()), float(truth.time.max())
    if timing.times is not None:
        given = np.unique(np.asarray(timing.times, dtype=np.float64))
        if given.size == 0 or not np.isfinite(given).all():
            raise ValueError("scans: must be finite times, at least one")
        if math.isnan(interval):
            interval = float(np.median(np.diff(given))) if len(given) > 1 else 0.0
        return given, interval
    distinct = np.unique(tracks.time)
    if timing.step is None and len(distinct) > 1:
        apart = float(np.median(np.diff(distinct)))
        if math.isnan(interval):
            interval = apart
        if apart >= _SHARED * interval:
            return _filled(distinct, interval, begin, end), interval
    step = timing.step
    if step is None:
        step = interval if not math.isnan(interval) else usual_interval(truth)
        step = step if not math.isnan(step) else 1.0
    if (end - begin) / step > _MOST:
        raise DataError(
            f"truth: goes on for {end - begin:.6g} s, in steps of {step:g} s; expected at most "
            f"{_MOST:,} instants. `step` makes them longer"
        )
    start = float(distinct[0]) if len(distinct) else begin
    first, last = math.ceil((begin - start) / step), math.floor((end - start) / step)
    grid = start + step * np.arange(first, last + 1, dtype=np.float64)
    return grid, interval if interval > 0 else step


def added_at_ends(scene: ScoredScene, tracks: Positions) -> int:
    """Instants of a scene before the first row of any track and after the last one."""
    if not len(tracks):
        return len(scene.time)
    outside = (scene.time < tracks.time.min()) | (scene.time > tracks.time.max())
    return int(outside.sum())


def _filled(distinct: Array, interval: float, begin: float, end: float) -> Array:
    """Times with more of them where they are missing, from beginning to end of the truth."""
    known = np.concatenate([[min(begin, distinct[0])], distinct, [max(end, distinct[-1])]])
    steps = np.diff(known)
    more = [distinct]
    for place in np.flatnonzero(steps > _GAP * interval).tolist():
        low, high = known[place], known[place + 1]
        if place == 0:
            count = min(int((high - low) / interval), _MOST)
            more.append(high - interval * np.arange(1, count + 1))
        elif place == len(steps) - 1:
            count = min(int((high - low) / interval), _MOST)
            more.append(low + interval * np.arange(1, count + 1))
        else:
            count = min(round((high - low) / interval), _MOST)
            more.append(np.linspace(low, high, count + 1)[1:-1])
    # At an end even one interval is enough for another instant.
    if begin <= distinct[0] - interval and steps[0] <= _GAP * interval:
        more.append(np.array([distinct[0] - interval]))
    if end >= distinct[-1] + interval and steps[-1] <= _GAP * interval:
        more.append(np.array([distinct[-1] + interval]))
    return np.unique(np.concatenate(more))
