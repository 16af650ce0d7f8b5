"""Trackers compared on recorded plots, whose true positions need not be known."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fuzzytrack.arrays import Array, Mask
from fuzzytrack.errors import DataError
from fuzzytrack.html_reprs import as_text, block, paragraph, table
from fuzzytrack.io.reading import Reading
from fuzzytrack.plurals import counted
from fuzzytrack.recordings.clock_lag import ClockLag, fitted_lag
from fuzzytrack.recordings.judging import GateWidth
from fuzzytrack.recordings.preparation import suited
from fuzzytrack.recordings.truth import true_positions
from fuzzytrack.recordings.used_plots import UsedPlots, read_used_plots
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress, part
from fuzzytrack.testbed.block_bootstrap import RmsChange, rms_change
from fuzzytrack.testbed.innovations import (
    Innovations,
    Positions,
    Whiteness,
    expected_outside,
    positions_of,
)
from fuzzytrack.testbed.marks import WORSE, best_of, marks_of
from fuzzytrack.testbed.metrics import squared_distance
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import Trackers, as_trackers

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "RecordedComparison",
    "RecordedScore",
    "TrueErrors",
    "compare_recorded",
    "compare_used",
]

# Plots of a track that are not scored: it starts with two.
_START = 2


@dataclass(frozen=True)
class TrueErrors:
    """Errors of a tracker against the truth, over the scored plots where it is known.

    Attributes
    ----------
    predicted, filtered : float
        RMSE of predicted and filtered positions (m).
    change : RmsChange or None
        Of the predicted RMSE against the first tracker; None for that one.
    """

    predicted: float
    filtered: float
    change: RmsChange | None

    def __repr__(self) -> str:
        return summary(self, "predicted", "filtered")


@dataclass(frozen=True)
class RecordedScore:
    """What recorded plots say of a tracker.

    Attributes
    ----------
    name : str
        As it was named.
    rms : float
        RMS of its innovations (m); infinite if it cannot follow a track with numbers.
    change : RmsChange or None
        Of that RMS against the first tracker; None for that one.
    log_likelihood : float
        Mean logarithm of the likelihood of a plot (nats); NaN if the noise is not known, or the
        tracker predicts no variance.
    outside : float
        Share of plots more than three predicted deviations off on some axis; NaN likewise.
    whiteness : Whiteness
        Correlation of each innovation with the one before.
    true : TrueErrors or None
        Errors, if the truth is known.
    """

    name: str
    rms: float
    change: RmsChange | None
    log_likelihood: float
    outside: float
    whiteness: Whiteness
    true: TrueErrors | None

    def __repr__(self) -> str:
        return summary(self, "name", "rms")


@dataclass(frozen=True, eq=False)
class RecordedComparison:
    """Trackers on the same recorded plots.

    Attributes
    ----------
    scores : tuple of RecordedScore
        One for each tracker.
    tracks : int
        Number of tracks, or parts of tracks that were divided.
    plots, scored : int
        Number of plots, and of those that are scored: all but the first two of each track, and
        those before every tracker has a prediction.
    n_axes : int
        Axes of a plot.
    before : float
        RMS of the difference between each scored plot and the plot before it in its track (m).
    has_sigma : bool
        Whether the noise of the plots is known.
    lag : ClockLag or None
        Lag of the clock of the plots against that of the truth, if that has a file of its own.
    known : int
        Scored plots for which the truth is known.
    measured_rmse : float
        RMSE of these plots themselves (m); NaN without truth.
    seed : int
        Of the intervals.
    notes : tuple of str
        What was guessed, left out or put right, each in a sentence.
    """

    scores: tuple[RecordedScore, ...]
    tracks: int
    plots: int
    scored: int
    n_axes: int
    before: float
    has_sigma: bool
    lag: ClockLag | None
    known: int
    measured_rmse: float
    seed: int
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return summary(self, "names", "tracks", "scored")

    def plot(self) -> Figure:
        """Picture of the errors of prediction, or of the RMS of innovations without truth."""
        from fuzzytrack.plotting import plot_comparison

        values = dict(zip(self.names, self.errors, strict=True))
        if self.has_truth:
            return plot_comparison(values, reference={"plots": self.measured_rmse}, unit="")[0]
        return plot_comparison(
            values, reference={"the plot before": self.before}, what="RMS of innovations", unit=""
        )[0]

    def _repr_html_(self) -> str:
        """Table of errors, or of innovations without truth, for notebooks."""
        told = f"{counted(self.tracks, 'track')}, {self.scored} of {self.plots} plots scored"
        rows = []
        for score, error, mark in zip(self.scores, self.errors, self.marks, strict=True):
            change = score.change if score.true is None else score.true.change
            filtered = [] if score.true is None else [as_text(score.true.filtered)]
            rows.append(
                [score.name, as_text(error), *filtered, "" if change is None else change.text, mark]
            )
        if self.has_truth:
            what = ["RMSE of position", "predicted", "filtered"]
            rows.append(["the plots themselves", "", as_text(self.measured_rmse), "", ""])
        else:
            what = ["RMS of innovations", ""]
            rows.append(["the plot before", as_text(self.before), "", ""])
        heads = [*what, f"vs {self.names[0]} (95 %)", ""]
        notes = (paragraph(note, note=True) for note in self.notes)
        best = best_of(self.errors)
        title = "Trackers on recorded plots"
        return block(title, table(heads, rows, best=best), paragraph(told), *notes)

    @property
    def has_truth(self) -> bool:
        """Whether the truth is known."""
        return not math.isnan(self.measured_rmse)

    @property
    def names(self) -> tuple[str, ...]:
        """The trackers."""
        return tuple(score.name for score in self.scores)

    @property
    def expected_outside(self) -> float:
        """Share of plots outside 3σ of a tracker whose predicted variances are right."""
        return expected_outside(self.n_axes)

    @property
    def errors(self) -> list[float]:
        """By which the best tracker is found: RMSE of predictions, or RMS of innovations (m)."""
        return [score.rms if score.true is None else score.true.predicted for score in self.scores]

    @property
    def marks(self) -> list[str]:
        """Which tracker is best, and which are worse than the plots themselves.

        With truth, a tracker is worse if its filtered positions are farther from the truth than
        the plots are. Without, that cannot be known; it is worse for certain if its predictions are
        farther from the next plot than the plot before is.
        """
        if not self.has_truth:
            return marks_of(self.errors, self.errors, self.before)
        filtered = [score.true.filtered for score in self.scores if score.true is not None]
        return marks_of(self.errors, filtered, self.measured_rmse)

    def to_json_dict(self) -> dict[str, Any]:
        """Everything in plain types, for JSON."""
        best = best_of(self.errors)
        given = {**asdict(self), "notes": list(self.notes)}
        if self.lag is not None:
            given["lag"]["taken_off"] = self.lag.taken_off
        scores = given.pop("scores")
        for score, mark in zip(scores, self.marks, strict=True):
            score["worse_than_plots"] = WORSE in mark
        return {
            **given,
            "expected_outside": self.expected_outside,
            "best": None if best is None else self.names[best],
            "trackers": scores,
        }


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
    progress: Progress | None = None,
) -> RecordedComparison:
    """Compare trackers on plots that have been read; see `compare_recorded`.

    Parameters
    ----------
    trackers : mapping of str to Tracker or str
    used : UsedPlots
    seed, progress
        As for `compare_recorded`.

    Raises
    ------
    DataError, ValueError
        As `compare_recorded`.
    """
    lag = None
    if used.true is not None and used.true_has_own_clock:
        lag = fitted_lag(used.tracks, used.true)
    rows = _Rows.of(used, 0.0 if lag is None else lag.taken_off)
    runs = {}
    made = as_trackers(trackers)
    for number, (name, text) in enumerate(trackers.items(), 1):
        tracker = suited(text, made[name], axes_differ=used.axes_differ)[1]
        runs[name] = rows.followed(positions_of(tracker, used.tracks))
        if progress is not None:
            progress(number / len(made))
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
        lag=lag,
        known=int(known.sum()),
        measured_rmse=_root_mean(squared_distance((rows.plots - rows.truth)[known])),
        seed=seed,
        notes=used.notes,
    )


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
    def of(cls, used: UsedPlots, lag: float) -> _Rows:
        tracks = used.tracks
        seen: list[Mask] = [np.asarray(~np.isnan(t.plots).any(axis=1)) for t in tracks]
        before, truth = [], []
        for track, there in zip(tracks, seen, strict=True):
            last = np.maximum.accumulate(np.where(there, np.arange(len(there)), -1))
            place = np.concatenate([[-1], last[:-1]])
            before.append(np.where(place[:, None] < 0, np.nan, track.plots[place]))
            if used.true is None:
                truth.append(np.full(track.plots.shape, np.nan))
            else:
                truth.append(true_positions(track, used.true, lag))
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
