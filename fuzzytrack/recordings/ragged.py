"""Tracks of different lengths, run as batches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzytrack.arrays import Array
from fuzzytrack.io.recording import Track
from fuzzytrack.recordings.judge import Judge, JudgeMemory
from fuzzytrack.recordings.judged import Judged, run_judged
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_tracker
from fuzzytrack.trackers.result import TrackResult
from fuzzytrack.trackers.state import Gains

__all__ = ["Batch", "batches", "run_judged_tracks", "run_tracks", "sigmas_of"]


# Tracks of one batch are at least this part of the longest: padding costs a quarter at most.
_ALIKE = 0.8


@dataclass(frozen=True, eq=False)
class Batch:
    """Tracks of about one length, padded at their ends.

    Attributes
    ----------
    members : ndarray of int, shape (n_tracks,)
        Which tracks.
    times : ndarray, shape (n_steps, n_tracks)
        Their times (s); those of a shorter track continue beyond its end.
    places : ndarray of int, shape (n_steps, n_tracks)
        Positions of their scans in the sequence of all scans of all tracks; those of the padding
        are one beyond its end.
    """

    members: NDArray[np.int64]
    times: Array
    places: NDArray[np.int64]

    def __repr__(self) -> str:
        return summary(self, "members", "places")


def sigmas_of(tracks: Sequence[Track]) -> list[Array] | None:
    """Standard deviations of the plots of each track (m); None unless all have them."""
    found = [track.sigma for track in tracks if track.sigma is not None]
    return found if len(found) == len(tracks) else None


def batches(times: Sequence[Array]) -> tuple[Batch, ...]:
    """Put tracks into batches of about one length.

    Parameters
    ----------
    times : sequence of ndarray, shape (n_steps,)
        Times of each track (s).

    Returns
    -------
    tuple of Batch
        The longest tracks first; each track is in one batch.
    """
    lengths = np.array([len(t) for t in times], dtype=np.int64)
    starts = np.cumsum(lengths) - lengths
    order = np.argsort(-lengths, kind="stable")
    found, first = [], 0
    while first < len(order):
        longest = lengths[order[first]]
        alike = int((lengths[order[first:]] >= _ALIKE * longest).sum())
        members = np.sort(order[first : first + alike])
        first += alike
        steps = np.arange(longest)[:, None]
        places = np.where(steps < lengths[members], starts[members] + steps, lengths.sum())
        padded = np.stack([_padded(times[k], int(longest)) for k in members], axis=1)
        found.append(Batch(members, padded, places))
    return tuple(found)


def _padded(t: Array, length: int) -> Array:
    spare = length - len(t)
    if not spare or not len(t):
        return t
    # Large enough to change a time of any size.
    step = max(1.0, 1e-9 * abs(float(t[-1])))
    return np.concatenate([t, t[-1] + step * np.arange(1, spare + 1)])


def run_tracks(
    tracker: Tracker | str,
    tracks: Sequence[tuple[Array, Array]],
    sigma: ArrayLike | None = None,
    progress: Progress | None = None,
    *,
    sigmas: Sequence[Array] | None = None,
    keep: Sequence[str] | None = None,
) -> list[TrackResult]:
    """Run a tracker over many tracks in batches, with the same results as one by one, but faster.

    Parameters
    ----------
    tracker : Tracker or str
        The tracker, or what names it, see `fuzzytrack.trackers.catalog.make_tracker`.
    tracks : sequence of (t, z)
        Times, shape (n_steps,), and plots, shape (n_steps, n_axes), of each track.
    sigma : array_like, optional
        Standard deviation of the plots (m): one, or one for each axis.
    progress : callable, optional
        Called with the share of the work that is done.
    sigmas : sequence of ndarray, optional
        Standard deviations of the plots of each track, shaped as these, in place of `sigma`.
    keep : sequence of str, optional
        Which outputs to keep, as for `fuzzytrack.AlphaBetaTracker.run`.

    Returns
    -------
    list of TrackResult
        One for each track; the state is None where several tracks were run together.

    Raises
    ------
    DataError, ValueError
        As `fuzzytrack.AlphaBetaTracker.run`.
    """
    tracker = as_tracker(tracker)
    if not tracks:
        return []
    gap = np.full((1, tracks[0][1].shape[1]), np.nan)
    pool = np.concatenate([*(z for _, z in tracks), gap])
    noise = None if sigmas is None else np.concatenate([*sigmas, gap])
    results: dict[int, TrackResult] = {}
    # Trackers of plug-ins need not take the argument.
    kept: dict[str, Any] = {} if keep is None else {"keep": keep}
    done = 0
    for batch in batches([t for t, _ in tracks]):
        if len(batch.members) == 1:
            alone = int(batch.members[0])
            own = sigma if sigmas is None else sigmas[alone]
            results[alone] = tracker.run(*tracks[alone], own, **kept)
        else:
            own = sigma if noise is None else noise[batch.places]
            whole = tracker.run(batch.times, pool[batch.places], own, **kept)
            for column, member in enumerate(batch.members.tolist()):
                results[member] = _member(whole, column, len(tracks[member][0]))
        done += len(batch.members)
        if progress is not None:
            progress(done / len(tracks))
    return [results[k] for k in range(len(tracks))]


def run_judged_tracks(
    tracker: Tracker | str,
    tracks: Sequence[tuple[Array, Array]],
    sigma: ArrayLike | None,
    judge: Judge,
    progress: Progress | None = None,
    *,
    sigmas: Sequence[Array] | None = None,
    keep: Sequence[str] | None = None,
) -> list[Judged]:
    """Run a tracker over many tracks whose plots are judged, with the same results as one by one.

    Parameters
    ----------
    tracker, tracks, sigma, progress, sigmas, keep
        As for `run_tracks`.
    judge : Judge
        What happens to plots; see `fuzzytrack.recordings.judged.run_judged`.

    Returns
    -------
    list of Judged
        One for each track. Its `measured` are the plots as they were given, and positions on a
        circle are within one turn. The state is None.

    Raises
    ------
    DataError, ValueError
        As `fuzzytrack.recordings.judged.run_judged`.
    """
    tracker = as_tracker(tracker)
    if not tracks:
        return []
    gap = np.full((1, tracks[0][1].shape[1]), np.nan)
    pool = np.concatenate([*(z for _, z in tracks), gap])
    noise = None if sigmas is None else np.concatenate([*sigmas, gap])
    results: dict[int, Judged] = {}
    for batch in batches([t for t, _ in tracks]):
        own = sigma if noise is None else noise[batch.places]
        whole = run_judged(tracker, batch.times, pool[batch.places], own, judge, keep=keep)
        for column, member in enumerate(batch.members.tolist()):
            t, z = tracks[member]
            cut = np.s_[: len(t), column]
            result = _member(whole.result, column, len(t))
            kept = {name: getattr(result, name) for name in result.kept}
            if judge.circle is not None:
                for name in {"predicted", "filtered"} & kept.keys():
                    kept[name] = judge.circle.wrapped(kept[name])
            memory = JudgeMemory(whole.memory.numbers[column : column + 1])
            result = TrackResult.of(result.time, z, None, kept)
            results[member] = Judged(result, whole.rejected[cut], whole.begins[cut], memory)
        if progress is not None:
            progress(len(results) / len(tracks))
    return [results[k] for k in range(len(tracks))]


def _member(whole: TrackResult, column: int, length: int) -> TrackResult:
    def cut(values: Array) -> Any:
        return values[:length, column]

    kept = {name: cut(getattr(whole, name)) for name in whole.kept if name != "gains"}
    if "gains" in whole.kept:
        gains = whole.gains
        kept["gains"] = Gains(*(cut(g) for g in (gains.alpha, gains.beta, gains.gamma)))
    return TrackResult.of(cut(whole.time), cut(whole.measured), None, kept)
