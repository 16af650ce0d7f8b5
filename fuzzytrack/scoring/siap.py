"""SIAP: the metrics of a single integrated air picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.scored_scene import ScoredScene

__all__ = ["Siap", "nearest_objects", "siap"]

Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Siap:
    """SIAP metrics over all instants; NaN where there is nothing to count.

    Attributes
    ----------
    completeness : float
        Share of the true positions that have a track.
    ambiguity : float
        Tracks for each true position that has one; 1 is best.
    spuriousness : float
        Share of the positions of tracks that belong to no true object.
    position_accuracy, velocity_accuracy : float
        Mean error of the tracks that belong to one (m, m/s).
    rate_of_number_changes : float
        Changes of the track of a true object in a second that it is tracked (1/s); a track that
        is lost and found again is another one.
    longest_segment : float
        Share of the life of true objects for which the track that follows them longest does.
    """

    completeness: float
    ambiguity: float
    spuriousness: float
    position_accuracy: float
    velocity_accuracy: float
    rate_of_number_changes: float
    longest_segment: float


def nearest_objects(pairs: ClosePairs, reach: float) -> ClosePairs:
    """The nearest true object of each track at each instant, if it is within reach (m).

    Several tracks may have the same true object.
    """
    near = pairs.within(reach)
    order = np.lexsort((near.distance, near.track_row))
    first = np.unique(near.track_row[order], return_index=True)[1]
    return near.where(np.sort(order[first]))


def siap(scene: ScoredScene, found: ClosePairs) -> Siap:
    """Completeness, ambiguity, spuriousness, accuracy and continuity.

    Parameters
    ----------
    scene : ScoredScene
    found : ClosePairs
        To which true object each track belongs, from `nearest_objects`.

    Returns
    -------
    Siap

    Notes
    -----
    With J true positions, of which Jᵀ have a track, and N positions of tracks, of which Nᴬ belong
    to a true object, summed over all instants: C = Jᵀ/J, A = Nᴬ/Jᵀ, S = (N - Nᴬ)/N. Accuracies are
    sums of distances over Nᴬ. A segment is what one track follows of a true object without a break;
    it lasts from its first instant to its last one. R = Σ(NU - 1)/ΣTT: NU is the least number of
    segments that cover all instants at which the object is followed, TT the time that segments
    cover. LS = ΣTL/ΣT: TL is the time of the longest segment, T that of the life of the object.

    References
    ----------
    P. Votruba, R. Nisley, R. Rothrock, B. Zombro: Single integrated air picture (SIAP) metrics
    implementation. SIAP System Engineering Task Force, Technical report 2001-001 (2001).
    """
    n_true, n_tracks = len(scene.truth), len(scene.tracks)
    followed = len(np.unique(found.true_row))
    velocity = _velocity_errors(scene, found)
    changes, tracked, longest = _continuity(scene, found)

    def ratio(part: float, whole: float) -> float:
        return float(part / whole) if whole else math.nan

    return Siap(
        completeness=ratio(followed, n_true),
        ambiguity=ratio(len(found), followed),
        spuriousness=ratio(n_tracks - len(found), n_tracks),
        position_accuracy=ratio(found.distance.sum(), len(found)),
        velocity_accuracy=ratio(velocity.sum(), len(velocity)),
        rate_of_number_changes=ratio(changes, tracked),
        longest_segment=ratio(longest, _lives(scene)),
    )


def _velocity_errors(scene: ScoredScene, found: ClosePairs) -> NDArray[np.float64]:
    """Sizes of the errors of velocity, where both velocities are known."""
    error = scene.tracks.velocity[found.track_row] - scene.truth.velocity[found.true_row]
    sizes = np.sqrt((error**2).sum(axis=1))
    return np.asarray(sizes[~np.isnan(sizes)])


def _lives(scene: ScoredScene) -> float:
    """Sum over the true objects of the time from the first instant to the last one (s)."""
    order = np.argsort(scene.truth.id, kind="stable")
    time, id = scene.time[scene.truth.instant[order]], scene.truth.id[order]
    first = np.unique(id, return_index=True)[1]
    last = np.append(first[1:], len(id)) - 1
    return float((time[last] - time[first]).sum()) if len(id) else 0.0


def _continuity(scene: ScoredScene, found: ClosePairs) -> tuple[int, float, float]:
    """Changes of tracks, time tracked (s), and longest times of one track (s), of all objects."""
    id, track = scene.truth.id[found.true_row], scene.tracks.id[found.track_row]
    if not len(found):
        return 0, 0.0, 0.0
    order = np.lexsort((found.instant, track, id))
    id, track, instant = id[order], track[order], found.instant[order]
    new = (np.diff(id) != 0) | (np.diff(track) != 0) | (np.diff(instant) != 1)
    begin = np.concatenate([[0], np.flatnonzero(new) + 1])
    end = np.append(begin[1:], len(id)) - 1
    owner, first, last = id[begin], instant[begin], instant[end]
    changes, tracked, longest = 0, 0.0, 0.0
    bounds = np.flatnonzero(np.diff(owner)) + 1
    parts = zip(np.split(first, bounds), np.split(last, bounds), strict=True)
    for firsts, lasts in parts:
        changes += _fewest(firsts, lasts) - 1
        tracked += _covered(scene.time[firsts], scene.time[lasts])
        longest += float((scene.time[lasts] - scene.time[firsts]).max())
    return changes, tracked, longest


def _fewest(first: Integers, last: Integers) -> int:
    """The least number of segments that cover all instants which any of them covers."""
    order = np.argsort(first, kind="stable")
    starts, ends = first[order].tolist(), last[order].tolist()
    count, place, covered = 0, 0, -1
    while place < len(starts):
        if ends[place] <= covered:
            place += 1
            continue
        # The next instant to cover, and of the segments that cover it the one that goes farthest.
        begin = max(covered + 1, starts[place])
        farthest, other = ends[place], place
        while other < len(starts) and starts[other] <= begin:
            farthest = max(farthest, ends[other])
            other += 1
        count, covered = count + 1, farthest
    return count


def _covered(first: NDArray[np.float64], last: NDArray[np.float64]) -> float:
    """Time that segments cover together (s)."""
    order = np.argsort(first, kind="stable")
    total, reached = 0.0, -math.inf
    for begin, end in zip(first[order].tolist(), last[order].tolist(), strict=True):
        total += max(0.0, end - max(begin, reached))
        reached = max(reached, end)
    return total
