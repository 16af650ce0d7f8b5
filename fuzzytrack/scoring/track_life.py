"""What a watch officer asks: how soon, how long, how steadily, and how many tracks of nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.scoring.correspondences import Correspondences
from fuzzytrack.scoring.positions import KINDS
from fuzzytrack.scoring.scored_scene import ScoredScene

__all__ = ["TrackLife", "track_life"]


@dataclass(frozen=True)
class TrackLife:
    """Times of right and of false tracks; NaN where there is nothing to count.

    Attributes
    ----------
    share_tracked : float
        Share of the time of true objects for which they have a track.
    first_match : float
        Mean time from the first instant of a true object to that of its first track (s). One that
        never has a track counts with the whole time from its first instant to its last one.
    never_matched : int
        True objects that never have a track.
    breaks : float
        Times that a true object loses its track and gets one again, for each true object.
    switches : float
        Times that it has another track than the last time, for each true object.
    rmse : float
        Root mean square of the distance of pairs (m).
    false_time : float
        Sum of the times for which tracks are far from every true object (s).
    false_per_minute, moving_false_per_minute, static_false_per_minute : float
        The same in a minute of the recording (s/min): of all tracks, of those that move, and of
        those that are known to be static or of which it is undecided. Tracks without a kind move.
    redundant_per_minute : float
        Time in a minute for which tracks are near a true object, but are not the one that it has
        (s/min).
    """

    share_tracked: float
    first_match: float
    never_matched: int
    breaks: float
    switches: float
    rmse: float
    false_time: float
    false_per_minute: float
    moving_false_per_minute: float
    static_false_per_minute: float
    redundant_per_minute: float


def track_life(scene: ScoredScene, found: Correspondences, near: NDArray[np.bool_]) -> TrackLife:
    """Share tracked, time to the first match, breaks, switches and false tracks.

    A row of an instant lasts until the next one.

    Parameters
    ----------
    scene : ScoredScene
    found : Correspondences
        Which track belongs to which true object.
    near : ndarray of bool, shape (n_track_rows,)
        Whether a track is near any true object; those that are not are false.

    Returns
    -------
    TrackLife
    """
    duration, objects = scene.durations, len(np.unique(scene.truth.id))
    total = float(duration.sum())
    lasting = duration[scene.truth.instant]
    distance = found.pairs.distance
    breaks = found.gaps(scene)[0].sum()
    delays = _first_matches(scene, found)
    alone = np.ones(len(scene.tracks), dtype=np.bool_)
    alone[found.pairs.track_row] = False
    false = alone & ~near
    moves = np.ones(len(scene.tracks), dtype=np.bool_)
    if scene.tracks.kind is not None:
        moves = scene.tracks.kind == KINDS.index("moving")

    def time(rows: NDArray[np.bool_]) -> float:
        return float(duration[scene.tracks.instant[rows]].sum())

    def per_minute(rows: NDArray[np.bool_]) -> float:
        return 60 * time(rows) / total if total else math.nan

    def each(count: float) -> float:
        return count / objects if objects else math.nan

    return TrackLife(
        share_tracked=_ratio(duration[found.pairs.instant].sum(), lasting.sum()),
        first_match=float(delays[0].mean()) if objects else math.nan,
        never_matched=delays[1],
        breaks=each(float(breaks)),
        switches=each(float(found.switched.sum())),
        rmse=math.sqrt(float((distance**2).mean())) if len(distance) else math.nan,
        false_time=time(false),
        false_per_minute=per_minute(false),
        moving_false_per_minute=per_minute(false & moves),
        static_false_per_minute=per_minute(false & ~moves),
        redundant_per_minute=per_minute(alone & near),
    )


def _ratio(part: float, whole: float) -> float:
    return float(part / whole) if whole else math.nan


def _first_matches(scene: ScoredScene, found: Correspondences) -> tuple[Array, int]:
    """Time to the first track of each true object that is there, and how many never have one."""
    there = np.unique(scene.truth.id)
    count = len(scene.truth.names)
    first, last, match = np.full(count, np.inf), np.full(count, -np.inf), np.full(count, np.inf)
    when = scene.time[scene.truth.instant]
    np.minimum.at(first, scene.truth.id, when)
    np.maximum.at(last, scene.truth.id, when)
    np.minimum.at(match, scene.truth.id[found.pairs.true_row], scene.time[found.pairs.instant])
    never = np.isinf(match[there])
    delay = np.where(never, last[there], match[there]) - first[there]
    return delay, int(never.sum())
