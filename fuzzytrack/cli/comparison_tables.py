"""Tables of comparisons: on true tracks with simulated noise, and on recorded plots."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from fuzzytrack.cli.noise_words import noise_sentence
from fuzzytrack.cli.output import paragraph, print_table, say, say_notes, show, with_error
from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.plurals import counted
from fuzzytrack.testbed.block_bootstrap import RmsChange
from fuzzytrack.testbed.comparison import Comparison
from fuzzytrack.testbed.marks import BEST, WORSE, best_of
from fuzzytrack.testbed.recorded_scores import RecordedComparison

__all__ = ["print_comparison", "print_marks", "print_recorded"]

# What marks mean where the truth is known, and where it is not.
_OF_ERRORS = {
    BEST: "the least RMSE of predicted positions",
    WORSE: "the filtered positions are worse than the plots themselves",
}
_OF_INNOVATIONS = {
    BEST: "the least RMS of innovations",
    WORSE: "worse than the plots themselves; the plot before predicts better",
}


def print_comparison(found: Comparison) -> None:
    """Table of a comparison, RMSE ± its standard error."""
    rows = [
        [
            name,
            with_error(found.predicted_rmse[k], found.predicted_error[k]),
            with_error(found.filtered_rmse[k], found.filtered_error[k]),
            "" if k == 0 else f"{100 * found.predicted_change[k]:+.1f} %",
            mark,
        ]
        for k, (name, mark) in enumerate(zip(found.names, found.marks, strict=True))
    ]
    rows += [[], ["the plots themselves", "", show(found.measured_rmse), "", ""]]
    print_table(
        ["RMSE of position (m)", "predicted", "filtered", "vs first", ""],
        rows,
        title=(
            f"{counted(found.runs, 'run')} of {counted(found.scans.mean(), 'scan')}, "
            f"noise {found.sigma:g} m on each axis, seed {found.seed}"
        ),
    )
    print_marks(found.marks)
    if len(found.names) > 1:
        paragraph("vs first: change of the predicted RMSE against the first tracker.")


def print_marks(marks: Sequence[str], meanings: Mapping[str, str] | None = None) -> None:
    """Say what the marks in a table mean.

    Parameters
    ----------
    marks : sequence of str
        Of the trackers, see `fuzzytrack.testbed.marks.marks_of`.
    meanings : mapping of str to str, optional
        Of each mark; unless given, those of errors against the truth.
    """
    for mark, meaning in (_OF_ERRORS if meanings is None else meanings).items():
        if any(mark in each for each in marks):
            paragraph(f"{mark}: {meaning}.")


def print_recorded(found: RecordedComparison, decoder: PlotDecoder) -> None:
    """Print how far predictions are off, how consistent they are, and what the words mean."""
    unit = "deg" if decoder.columns.position == "angle" else "m"
    say(f"columns: {decoder.columns.sentence}")
    sigma = noise_sentence(decoder)
    if sigma:
        paragraph(f"sigma: {sigma}")
    say_notes(found.notes)
    if found.lag is not None:
        paragraph(found.lag.sentence)
    say()
    (_print_errors if found.has_truth else _print_innovations)(found, unit)
    say()
    _print_consistency(found)


def _title(found: RecordedComparison, scored: int) -> str:
    return (
        f"{counted(found.tracks, 'track')}, {scored} of {counted(found.plots, 'plot')} scored: "
        "all after the start of their track"
    )


def _text(change: RmsChange | None) -> str:
    return "" if change is None else change.text


# -------------------------------------------------------------------- accuracy


def _print_innovations(found: RecordedComparison, unit: str) -> None:
    """Table where the truth is not known."""
    rows = [
        [score.name, show(score.rms), _text(score.change), mark]
        for score, mark in zip(found.scores, found.marks, strict=True)
    ]
    rows += [[], ["the plot before", show(found.before), "", ""]]
    print_table(
        [f"RMS of innovations ({unit})", "RMS", "vs first (95 %)", ""],
        rows,
        title=_title(found, found.scored),
    )
    paragraph(
        "RMS: distance from predictions to plots. The noise of the plots is in it, the same for "
        "all trackers: they rank as by their errors, but differ by less."
    )
    print_marks(found.marks, _OF_INNOVATIONS)
    _explain_changes(found, "RMS of innovations")


def _print_errors(found: RecordedComparison, unit: str) -> None:
    """Table where it is."""
    rows = []
    for score, mark in zip(found.scores, found.marks, strict=True):
        assert score.true is not None
        errors = score.true.predicted, score.true.filtered
        rows.append([score.name, *map(show, errors), _text(score.true.change), mark])
    rows += [[], ["the plots themselves", "", show(found.measured_rmse), "", ""]]
    print_table(
        [f"RMSE of position ({unit})", "predicted", "filtered", "vs first (95 %)", ""],
        rows,
        title=_title(found, found.known),
    )
    print_marks(found.marks)
    _explain_changes(found, "predicted RMSE")


def _explain_changes(found: RecordedComparison, compared: str) -> None:
    if len(found.scores) > 1:
        paragraph(
            f"vs first: change of the {compared} against the first tracker, and its 95 % interval; "
            "where that holds 0, the plots do not tell which of the two is better."
        )


# -------------------------------------------------------------------- consistency


def _print_consistency(found: RecordedComparison) -> None:
    rows = [
        [
            score.name,
            _or_dash(score.whiteness.correlation, "{:+.2f}"),
            _share(score.outside),
            _or_dash(score.log_likelihood, "{:.3f}"),
        ]
        for score in found.scores
    ]
    best = found.scores[best_of(found.errors) or 0]
    reach = best.whiteness.reach
    rows += [
        [],
        ["expected", _or_dash(reach, "± {:.2f}"), _share(found.expected_outside), "largest"],
    ]
    print_table(["innovations", "correlation", "outside 3σ", "log-likelihood"], rows)
    paragraph(
        "correlation: of each innovation with the one before. Above the range gains are too small, "
        "and the tracker is late; below it they are too large."
    )
    paragraph("outside 3σ: share of plots more than three predicted deviations off on some axis.")
    paragraph("log-likelihood: mean over plots (nats).")
    without = [score.name for score in found.scores if math.isnan(score.outside)]
    if not found.has_sigma:
        paragraph("–: the noise of the plots is not known.")
    elif without:
        names = ", ".join(without)
        paragraph(f"–: no variance of its predictions, for {names}.")


def _share(share: float) -> str:
    return _or_dash(100 * share, "{:.1f} %")


def _or_dash(value: float, form: str) -> str:
    return "–" if math.isnan(value) else form.format(value)
