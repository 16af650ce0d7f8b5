"""What a comparison on recorded plots has found: scores of trackers, as table, picture and JSON."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from fuzzytrack.html_reprs import as_text, block, paragraph, table
from fuzzytrack.plurals import counted
from fuzzytrack.recordings.clock_lag import ClockLag
from fuzzytrack.reprs import summary
from fuzzytrack.testbed.block_bootstrap import RmsChange
from fuzzytrack.testbed.innovations import Whiteness, expected_outside
from fuzzytrack.testbed.marks import WORSE, best_of, marks_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["RecordedComparison", "RecordedScore", "TrueErrors"]


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
