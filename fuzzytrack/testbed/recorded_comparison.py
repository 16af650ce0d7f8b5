"""Trackers compared on recorded plots, whose true positions need not be known."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import Track
from fuzzytrack.recordings.judging import GateWidth
from fuzzytrack.recordings.preparation import suited
from fuzzytrack.recordings.used_plots import UsedPlots, read_used_plots
from fuzzytrack.tasks import Progress, part, run_tasks
from fuzzytrack.testbed.block_bootstrap import rms_change
from fuzzytrack.testbed.innovations import Innovations, Positions, positions_of
from fuzzytrack.testbed.metrics import squared_distance
from fuzzytrack.testbed.recorded_scores import RecordedComparison, RecordedScore, TrueErrors
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import Trackers, as_trackers

__all__ = ["compare_recorded", "compare_used"]

# Plots of a track that are not scored: it starts with two.
_START = 2


def compare_recorded(
    trackers: Trackers,
    plots: Any,
    *,
    truth: str | os.PathLike[str] | None = None,
    gate: GateWidth = "auto",
    seed: int = 0,
    progress: Progress | None = None,
    **options: Any,
) -> RecordedComparison:
    """Compare trackers on recorded plots, as the command ``fuzzytrack compare`` does.

    Parameters
    ----------
    trackers : mapping of str to Tracker or str, or sequence of str
        The trackers; see `fuzzytrack.trackers.catalog.as_trackers`. The others are compared with
        the first one.
    plots : path, data frame, mapping or tuple
        As for `fuzzytrack.track`.
    truth : str or path, optional
        True positions: a file, or columns of the file of plots; see
        `fuzzytrack.recordings.truth.read_truth`.
    gate : float, "auto" or None
        As for `fuzzytrack.track`; plots that its default tracker does not use are used and scored
        for none.
    seed : int
        Of the intervals, not negative.
    progress : callable, optional
        Called with the share of the work that is done.
    **options
        How the plots are read, as for `fuzzytrack.track`.

    Returns
    -------
    RecordedComparison

    Raises
    ------
    DataError, TypeError, ValueError, OSError
        As `fuzzytrack.track`; and if no plot is scored.

    Examples
    --------
    >>> import numpy as np
    >>> from fuzzytrack.testbed import compare_recorded
    >>> t = np.arange(60.0)
    >>> z = 9 * t[:, None] + np.random.default_rng(1).standard_normal((60, 1))
    >>> found = compare_recorded(["maneuver", "fixed:alpha=0.9:beta=0.8"], (t, z), sigma=1.0)
    >>> found.scored, found.marks
    (58, ['best', ''])
    """
    made = as_trackers(trackers)  # first, since one that cannot be made needs no plots
    used = read_used_plots(
        plots,
        Reading.of(**options),
        truth=truth,
        gate=gate,
        progress=None if progress is None else part(progress, 0.0, 0.2),
    )
    texts = trackers if isinstance(trackers, Mapping) else {name: name for name in made}
    return compare_used(
        texts,
        used,
        seed=seed,
        progress=None if progress is None else part(progress, 0.2, 1.0),
    )


def compare_used(
    trackers: Mapping[str, Tracker | str],
    used: UsedPlots,
    *,
    seed: int = 0,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> RecordedComparison:
    """Compare trackers on plots that have been read; see `compare_recorded`.

    Parameters
    ----------
    trackers : mapping of str to Tracker or str
    used : UsedPlots
    seed, progress
        As for `compare_recorded`.
    executor : concurrent.futures.Executor, optional
        Runs the trackers, each as a task; in this process unless given.

    Raises
    ------
    DataError, ValueError
        As `compare_recorded`.
    """
    rows = _Rows.of(used)
    made = {
        name: suited(trackers[name], tracker, axes_differ=used.axes_differ)[1]
        for name, tracker in as_trackers(trackers).items()
    }
    found: dict[str, Positions] = {}
    for name, positions in run_tasks(partial(_positions, made, used.tracks), made, executor):
        found[name] = rows.followed(positions)
        if progress is not None:
            progress(len(found) / len(made))
    # As they were given: an executor finishes them in any order.
    runs = {name: found[name] for name in made}
    scored = rows.scored(list(runs.values()))
    if not scored.any():
        raise DataError(
            f"{used.name}: no plot has a prediction of every tracker; most trackers need a track "
            "of three plots"
        )
    known = scored & ~np.isnan(rows.truth).any(axis=1)
    if used.true is not None and not known.any():
        raise DataError(f"truth: is known at none of the plots of {used.name} that are scored")
    errors = [_Errors.of(rows, run, scored, known) for run in runs.values()]
    scores = [_score(name, each, errors[0], seed) for name, each in zip(runs, errors, strict=True)]
    return RecordedComparison(
        tuple(scores),
        tracks=len(used.tracks),
        plots=int(rows.seen.sum()),
        scored=int(scored.sum()),
        n_axes=rows.plots.shape[1],
        before=_root_mean(squared_distance((rows.plots - rows.before)[scored])),
        has_sigma=used.has_sigma,
        lag=used.lag,
        known=int(known.sum()),
        measured_rmse=_root_mean(squared_distance((rows.plots - rows.truth)[known])),
        seed=seed,
        notes=used.notes,
    )


def _positions(trackers: Mapping[str, Tracker], tracks: Sequence[Track], name: str) -> Positions:
    return positions_of(trackers[name], tracks)


# -------------------------------------------------------------------- the plots of all tracks


@dataclass(frozen=True, eq=False)
class _Rows:
    """The plots of all tracks, one track after the other.

    Attributes
    ----------
    plots, before, truth : ndarray, shape (n_plots, n_axes)
        Plots; the plot before each in its track; true positions. NaN where there is none.
    tracks : ndarray of int, shape (n_plots,)
    seen : ndarray of bool, shape (n_plots,)
        Plots that are not missed.
    count : ndarray of int, shape (n_plots,)
        Plots of the track so far.
    """

    plots: Array
    before: Array
    truth: Array
    tracks: NDArray[np.int64]
    seen: Mask
    count: NDArray[np.int64]

    @classmethod
    def of(cls, used: UsedPlots) -> _Rows:
        tracks = used.tracks
        seen: list[Mask] = [np.asarray(~np.isnan(t.plots).any(axis=1)) for t in tracks]
        before, truth = [], []
        for track, there in zip(tracks, seen, strict=True):
            last = np.maximum.accumulate(np.where(there, np.arange(len(there)), -1))
            place = np.concatenate([[-1], last[:-1]])
            before.append(np.where(place[:, None] < 0, np.nan, track.plots[place]))
            true = used.truth_of(track)
            truth.append(np.full(track.plots.shape, np.nan) if true is None else true)
        return cls(
            np.concatenate([track.plots for track in tracks]),
            np.concatenate(before),
            np.concatenate(truth),
            np.repeat(np.arange(len(tracks)), [len(there) for there in seen]),
            np.concatenate(seen),
            np.concatenate([np.cumsum(there) for there in seen]),
        )

    def followed(self, run: Positions) -> Positions:
        """Positions that are infinite, not NaN, where numbers have become too large."""
        begun = ~np.isnan(run.predicted).any(axis=1)
        starts = np.flatnonzero(np.diff(self.tracks, prepend=-1))
        total = np.cumsum(begun)
        started = total > (total - begun)[starts][self.tracks]
        lost = started[:, None] & np.isnan(run.predicted)
        predicted, filtered = (
            np.where(lost, np.inf, positions) for positions in (run.predicted, run.filtered)
        )
        return replace(run, predicted=predicted, filtered=filtered)

    def scored(self, runs: Sequence[Positions]) -> Mask:
        """Plots after the start of their track for which every tracker has a prediction."""
        scored = self.seen & (self.count > _START)
        for run in runs:
            scored &= ~np.isnan(run.predicted).any(axis=1)
        return scored


# -------------------------------------------------------------------- one tracker


@dataclass(frozen=True, eq=False)
class _Errors:
    """Errors of a tracker at the scored plots, and at those of them where the truth is known."""

    innovations: Innovations
    predicted: Array
    filtered: Array
    tracks: NDArray[np.int64]

    @classmethod
    def of(cls, rows: _Rows, run: Positions, scored: Mask, known: Mask) -> _Errors:
        variance = None if run.variance is None else run.variance[scored]
        values = (rows.plots - run.predicted)[scored]
        truth = rows.truth[known]
        return cls(
            Innovations(values, variance, rows.tracks[scored]),
            squared_distance(run.predicted[known] - truth),
            squared_distance(run.filtered[known] - truth),
            rows.tracks[known],
        )


def _score(name: str, own: _Errors, first: _Errors, seed: int) -> RecordedScore:
    """Statistics of a tracker, and its changes against the first one."""
    mine, true = own.innovations, None
    if len(own.predicted):
        change = None
        if own is not first:
            change = rms_change(first.predicted, own.predicted, own.tracks, seed=seed)
        true = TrueErrors(_root_mean(own.predicted), _root_mean(own.filtered), change)
    return RecordedScore(
        name,
        mine.rms,
        None
        if own is first
        else rms_change(first.innovations.squares, mine.squares, mine.tracks, seed=seed),
        mine.log_likelihood,
        mine.outside,
        mine.whiteness,
        true,
    )


def _root_mean(squares: Array) -> float:
    return math.sqrt(float(squares.mean())) if len(squares) else math.nan
