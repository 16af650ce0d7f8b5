"""OSPA(2): the distance between sets of whole tracks over a window of time, at each instant."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.scoring.assignment import best_assignment
from fuzzytrack.scoring.close_pairs import ClosePairs
from fuzzytrack.scoring.ospa import Ospa
from fuzzytrack.scoring.scored_scene import ObjectRows, ScoredScene

__all__ = ["ospa2"]

Integers = NDArray[np.int64]

# Pairs of identities times instants that are looked at together.
_CELLS = 4_000_000


def ospa2(scene: ScoredScene, pairs: ClosePairs, cutoff: float, order: float, window: int) -> Ospa:
    """OSPA of tracks: a switch of identity costs as long as it is in the window.

    The points of OSPA are the tracks of the last instants. Two tracks f and g are as far from each
    other as they are on average over the instants T at which either exists:

    ``d(f, g)ᵖ = (1/|T|) Σ min(|f(t) - g(t)|, c)ᵖ`` over T, with cᵖ where only one of them exists.

    Parameters
    ----------
    scene : ScoredScene
    pairs : ClosePairs
        Must reach as far as the cut-off.
    cutoff, order : float
        Cut-off c (m), and order p of both means.
    window : int
        Number of instants in a window, which ends at the instant for which the value holds; the
        first ones are shorter.

    Returns
    -------
    Ospa

    References
    ----------
    M. Beard, B. T. Vo, B.-N. Vo: A solution for large-scale multi-object tracking. IEEE
    Transactions on Signal Processing 68 (2020), section II, with equal weights and q = p.
    """
    count, whole = len(scene.time), cutoff**order
    window = min(window, count)
    true_key, true_rows = _in_windows(scene.truth, count, window)
    track_key, track_rows = _in_windows(scene.tracks, count, window)
    gain = whole - pairs.distance**order
    near = gain > 0
    end, place = _windows(pairs.instant[near], count, window)
    true_id = scene.truth.id[pairs.true_row[near]][place]
    track_id = scene.tracks.id[pairs.track_row[near]][place]
    left = np.searchsorted(true_key, end * len(scene.truth.names) + true_id)
    right = np.searchsorted(track_key, end * len(scene.tracks.names) + track_id)
    # Pairs of tracks that are ever near each other in a window, with the sums over it.
    both, first, which = np.unique(
        left * max(1, len(track_key)) + right, return_index=True, return_inverse=True
    )
    left, right = left[first], right[first]
    gains = np.bincount(which, gain[near][place], minlength=len(both))
    # Both exist also at instants at which they are far from each other.
    together = _together(scene, true_key, track_key, left, right, window)
    union = true_rows[left] + track_rows[right] - together
    mean = gains / union
    chosen = best_assignment(left, right, mean, end[first])
    return _distance(
        count,
        np.bincount(true_key // max(1, len(scene.truth.names)), minlength=count),
        np.bincount(track_key // max(1, len(scene.tracks.names)), minlength=count),
        np.bincount(end[first][chosen], mean[chosen], minlength=count).astype(np.float64),
        whole,
        order,
    )


def _windows(instant: Integers, count: int, window: int) -> tuple[Integers, Integers]:
    """Windows, by their last instants, that rows are in, and for each of them which row."""
    place = np.repeat(np.arange(len(instant)), window)
    end = (instant[:, None] + np.arange(window)).ravel()
    inside = end < count
    return end[inside], place[inside]


def _in_windows(rows: ObjectRows, count: int, window: int) -> tuple[Integers, Integers]:
    """Objects of each window, as window × number of objects + object, and how often each is."""
    end, place = _windows(rows.instant, count, window)
    return np.unique(end * len(rows.names) + rows.id[place], return_counts=True)


def _together(
    scene: ScoredScene,
    true_key: Integers,
    track_key: Integers,
    left: Integers,
    right: Integers,
    window: int,
) -> Integers:
    """In how many instants of a window both members of a pair exist."""
    objects, tracks = len(scene.truth.names), len(scene.tracks.names)
    end = true_key[left] // max(1, objects)
    pair = (true_key[left] % max(1, objects)) * max(1, tracks) + track_key[right] % max(1, tracks)
    # Of each pair of identities that matters: in how many instants so far both exist.
    wanted, which = np.unique(pair, return_inverse=True)
    count = len(scene.time)
    there, here = _presence(scene.truth, count), _presence(scene.tracks, count)
    total = np.empty(len(pair), dtype=np.int64)
    order = np.argsort(which, kind="stable")
    size = max(1, _CELLS // count)
    for begin in range(0, len(wanted), size):
        codes = wanted[begin : begin + size]
        both = there[codes // max(1, tracks)] & here[codes % max(1, tracks)]
        so_far = np.zeros((len(codes), count + 1), dtype=np.int64)
        np.cumsum(both, axis=1, out=so_far[:, 1:])
        low, high = np.searchsorted(which[order], [begin, begin + len(codes)])
        mine = order[low:high]
        row, last = which[mine] - begin, end[mine] + 1
        total[mine] = so_far[row, last] - so_far[row, np.maximum(last - window, 0)]
    return total


def _presence(rows: ObjectRows, count: int) -> NDArray[np.bool_]:
    """Whether each object exists at each instant, shape (n_objects, n_instants)."""
    found = np.zeros((len(rows.names), count), dtype=np.bool_)
    found[rows.id, rows.instant] = True
    return found


def _distance(
    count: int,
    n_true: Integers,
    n_tracks: Integers,
    saved: Array,
    whole: float,
    order: float,
) -> Ospa:
    """OSPA of sets in which the best assignment saves a part of the greatest cost."""
    most, least = np.maximum(n_true, n_tracks), np.minimum(n_true, n_tracks)
    size, root = np.maximum(most, 1), 1 / order
    # Rounding may make a sum that is nothing negative.
    near = np.maximum(whole * least - saved, 0.0) / size
    many = whole * (most - least) / size
    return Ospa((near + many) ** root, near**root, many**root)
