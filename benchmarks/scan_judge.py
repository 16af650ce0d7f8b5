"""How well tracks follow targets with known positions, by one rule for every tracker.

At each scan tracks and true targets are paired one to one within reach, as many as can be, at the
least sum of squared distances. A track without a pair is *false*, and *fast* where it moved fast
over its last seconds, whatever its tracker says of its kind.

In a recording the truth is not complete: there are moored boats, a shore, and others that sail by.
There a track farther than the cutoff from every true target does not count in OSPA, and only such a
track is false.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from benchmarks.peers import Array
from benchmarks.scan_peers import Followed

__all__ = ["Judgment", "Rule", "fast_rows", "judged", "mean_judgment"]

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Rule:
    """Numbers of a judgment.

    Attributes
    ----------
    cutoff : float
        Of OSPA, whose order is 2 (m).
    reach : float
        Greatest distance of a pair (m).
    fast, window : float
        Speed from which a track is fast (m/s), over its last seconds (s), at least half of them.
    """

    cutoff: float = 20.0
    reach: float = 15.0
    fast: float = 0.5
    window: float = 10.0


@dataclass(frozen=True)
class Judgment:
    """Figures of one tracker on one recording.

    Attributes
    ----------
    ospa : float
        Mean over scans (m).
    ospa_fast : float
        The same where false tracks count that are fast.
    tracked : float
        Share of target-scans with a track within reach.
    delay : float
        Time from the first scan with a target to its first pair (s), mean over targets.
    switches : float
        Changes of the paired identity, per target.
    breaks : float
        Times that a paired target is without a track and is paired again later, per target.
    fast, false : float
        Track-seconds a minute of false tracks that move fast, and of all.
    false_tracks : float
        Tracks that are false in more than half of their scans, a minute.
    rmse : float
        Root mean square distance of pairs (m).
    milliseconds : float
        Median time of a scan.
    """

    ospa: float
    ospa_fast: float
    tracked: float
    delay: float
    switches: float
    breaks: float
    fast: float
    false: float
    false_tracks: float
    rmse: float
    milliseconds: float


def judged(
    found: Followed,
    times: Sequence[float],
    truth: Mapping[int, Array],
    period: float,
    *,
    complete: bool,
    rule: Rule = Rule(),
) -> Judgment:
    """Judge tracks.

    Parameters
    ----------
    found : Followed
    times : sequence of float
        Of the scans (s), by the clock of `found`.
    truth : mapping of target to ndarray, shape (n, 3)
        Time by the same clock, and position.
    period : float
        Of a scan (s): what a track in it counts.
    complete : bool
        Whether every target is in `truth`, so that every track counts in OSPA.
    """
    fast = fast_rows(found, rule)
    ospas, squares, pairs = [], [], dict[int, list[int]]()
    wrong = np.zeros(len(found.time), bool)
    scans = 0
    for time in times:
        present, places = _at(truth, time)
        if not present:
            continue
        scans += 1
        rows = np.flatnonzero(found.time == time)
        distance = np.linalg.norm(found.position[rows][:, None] - places, axis=2)
        far = distance.min(axis=1) > rule.cutoff
        counts = complete | ~far
        ospas.append([_ospa(distance[each], rule.cutoff) for each in (counts, counts | fast[rows])])
        paired = dict(_pairs(distance, rule.reach))
        squares += [distance[row, target] ** 2 for target, row in paired.items()]
        for target, name in enumerate(present):
            pairs.setdefault(name, []).append(
                int(found.track_id[rows[paired[target]]]) if target in paired else -1
            )
        unpaired = np.ones(len(rows), bool)
        unpaired[list(paired.values())] = False
        wrong[rows[unpaired & (complete | far)]] = True
    histories = [np.array(each) for each in pairs.values()]
    minutes = scans * period / 60
    ospa, ospa_fast = np.mean(ospas, axis=0)
    return Judgment(
        ospa=float(ospa),
        ospa_fast=float(ospa_fast),
        tracked=float(np.mean(np.concatenate(histories) >= 0)),
        delay=period * float(np.mean([_first(each) for each in histories])),
        switches=float(np.mean([_switches(each) for each in histories])),
        breaks=float(np.mean([_breaks(each) for each in histories])),
        fast=float((wrong & fast).sum()) * period / minutes,
        false=float(wrong.sum()) * period / minutes,
        false_tracks=_mostly(wrong, found.track_id) / minutes,
        rmse=float(np.sqrt(np.mean(squares))) if squares else float("nan"),
        milliseconds=1e3 * float(np.median(found.seconds)),
    )


def mean_judgment(each: Sequence[Judgment]) -> Judgment:
    """Mean of the figures of several recordings."""
    return Judgment(
        *(float(np.mean([getattr(one, field.name) for one in each])) for field in fields(Judgment))
    )


def fast_rows(found: Followed, rule: Rule) -> Mask:
    """Rows whose track moved fast, by its positions; what has moved little is not fast yet."""
    fast = np.zeros(len(found.time), bool)
    for track in np.unique(found.track_id):
        rows = np.flatnonzero(found.track_id == track)
        time, place = found.time[rows], found.position[rows]
        before = np.searchsorted(time, time - rule.window)
        path = np.linalg.norm(place - place[before], axis=1)
        fast[rows] = path > rule.fast * np.maximum(time - time[before], rule.window / 2)
    return fast


def _at(truth: Mapping[int, Array], time: float) -> tuple[list[int], Array]:
    present = [name for name, path in truth.items() if path[0, 0] <= time <= path[-1, 0]]
    places = [
        [np.interp(time, truth[name][:, 0], truth[name][:, axis]) for axis in (1, 2)]
        for name in present
    ]
    return present, np.array(places).reshape(-1, 2)


def _pairs(distance: Array, reach: float) -> list[tuple[int, int]]:
    """Target and row of each pair within reach."""
    # A pair within reach is worth more than all distances together.
    cost = np.where(distance <= reach, (distance / reach) ** 2, 1.0 + max(distance.shape))
    rows, targets = linear_sum_assignment(cost)
    return [
        (int(target), int(row))
        for row, target in zip(rows, targets, strict=True)
        if distance[row, target] <= reach
    ]


def _ospa(distance: Array, cutoff: float) -> float:
    tracks, targets = distance.shape
    if not tracks:
        return cutoff
    cut = np.minimum(distance, cutoff) ** 2
    rows, columns = linear_sum_assignment(cut)
    missing = cutoff**2 * abs(tracks - targets)
    return float(np.sqrt((cut[rows, columns].sum() + missing) / max(tracks, targets)))


def _mostly(wrong: Mask, track_id: NDArray[np.int64]) -> int:
    """Number of tracks that are wrong in more than half of their rows."""
    _, track = np.unique(track_id, return_inverse=True)
    return int((np.bincount(track, weights=wrong) > 0.5 * np.bincount(track)).sum())


def _first(history: Array) -> int:
    return int(np.argmax(history >= 0)) if (history >= 0).any() else len(history)


def _switches(history: Array) -> int:
    paired = history[history >= 0]
    return int((paired[1:] != paired[:-1]).sum())


def _breaks(history: Array) -> int:
    """Ends of a run of pairs that another run follows."""
    ends = int(((history[:-1] >= 0) & (history[1:] < 0)).sum())
    lost = (history >= 0).any() and history[-1] < 0
    return ends - int(lost)
