"""Trackers on recorded plots, as the page shows them."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import Track
from fuzzytrack.recordings.ragged import run_tracks, sigmas_of
from fuzzytrack.recordings.used_plots import UsedPlots, read_used_plots
from fuzzytrack.studio.folder import naming
from fuzzytrack.studio.uploads import check_plots
from fuzzytrack.testbed.recorded_comparison import compare_used
from fuzzytrack.testbed.recorded_scores import RecordedComparison, RecordedScore
from fuzzytrack.trackers.base import Tracker

__all__ = ["Recorded", "summary_of", "tracked_as_json"]

# Tracks and plots that are drawn.
_TRACKS, _PLOTS = 8, 2_000
# Characters of the first line that are read.
_LINE = 100_000


@dataclass(frozen=True)
class Recorded:
    """A recording, and what a page says of its columns.

    Attributes
    ----------
    path : Path
    time, id : str or None
        Columns; found by their names unless given, where that is certain.
    axes : sequence of str or None
        Columns of positions; likewise.
    sigma : float or None
        Standard deviation of the plots (m); estimated from them unless given.
    truth : sequence of str or None
        Columns with true positions.
    """

    path: Path
    time: str | None = None
    id: str | None = None
    axes: Sequence[str] | None = None
    sigma: float | None = None
    truth: Sequence[str] | None = None

    @property
    def options(self) -> dict[str, Any]:
        """What is said of the columns, as functions take it."""
        given = {
            "time": self.time,
            "id": self.id,
            "axes": None if self.axes is None else list(self.axes),
            "sigma": self.sigma,
        }
        return {name: value for name, value in given.items() if value is not None}

    @property
    def true_columns(self) -> str | None:
        """Columns with true positions, as functions take them."""
        return None if self.truth is None else ",".join(self.truth)

    def columns(self) -> list[str]:
        """Names in the first line of the file."""
        with open(self.path, encoding="utf-8", errors="replace", newline="") as stream:
            return next(csv.reader([stream.readline(_LINE)]), [])

    def read(self) -> UsedPlots:
        """Read the plots as ``fuzzytrack compare`` does.

        Raises
        ------
        ValueError, OSError
            If there are too many plots, or they cannot be read.
        """
        check_plots(self.path)
        with naming(self.path):
            reading = Reading.of(**self.options)
            return read_used_plots(self.path, reading, truth=self.true_columns)


def summary_of(used: UsedPlots) -> dict[str, Any]:
    """What was read, in numbers."""
    return {
        "plots": sum(int((~np.isnan(t.plots).any(axis=1)).sum()) for t in used.tracks),
        "tracks": len(used.tracks),
        "axes": used.tracks[0].plots.shape[1] if used.tracks else 0,
        "sigma": used.decoder.sigma,
        "notes": used.notes,
    }


def tracked_as_json(used: UsedPlots, trackers: Mapping[str, Tracker]) -> dict[str, Any]:
    """Tracks of recorded plots, some of them to be drawn, and how the trackers compare.

    Parameters
    ----------
    used : UsedPlots
    trackers : mapping of str to Tracker

    Returns
    -------
    dict
        What `summary_of` gives; ``shown`` and ``tracks``: the first tracks with ``id``, ``time``,
        ``plots``, ``truth`` and for each of ``trackers`` ``predicted``, ``filtered``,
        ``innovation``; and ``comparison``: ``columns`` (key, title, unit) and ``rows``.
    """
    compared = compare_used(dict(trackers), used)
    shown = _shown(used)
    return {
        **summary_of(used),
        "shown": len(shown),
        "tracks": [_track_as_json(track, used, trackers) for track in shown],
        "comparison": _comparison_as_json(compared),
    }


def _shown(used: UsedPlots) -> list[Track]:
    """Tracks that are drawn: the first ones, up to so many plots."""
    found: list[Track] = []
    left = _PLOTS
    for track in used.tracks[:_TRACKS]:
        if left < 2:
            break
        # A track without its end keeps the noise of its plots.
        found.append(track.part(slice(0, left)) if len(track.time) > left else track)
        left -= len(track.time)
    return found


def _track_as_json(
    track: Track, used: UsedPlots, trackers: Mapping[str, Tracker]
) -> dict[str, Any]:
    pairs = [(track.time, track.plots)]
    runs = {}
    for name, tracker in trackers.items():
        (result,) = run_tracks(tracker, pairs, sigmas=sigmas_of([track]))
        runs[name] = {
            "predicted": result.predicted,
            "filtered": result.filtered,
            "innovation": result.innovation,
        }
    return {
        "id": track.id,
        "time": track.time,
        "plots": track.plots,
        "truth": used.truth_of(track),
        "trackers": runs,
    }


def _comparison_as_json(found: RecordedComparison) -> dict[str, Any]:
    columns = [
        ("rms", "RMS of innovations", "m"),
        ("change", "against the first", "%"),
        ("log_likelihood", "log-likelihood of a plot", "nats"),
        ("outside", "plots beyond three sigma", "%"),
        ("whiteness", "correlation of innovations", ""),
    ]
    if found.has_truth:
        columns[:0] = [
            ("predicted", "RMSE of prediction", "m"),
            ("filtered", "RMSE of estimate", "m"),
        ]
    rows = [
        {"name": each.name, "mark": mark, **_row(each)}
        for each, mark in zip(found.scores, found.marks, strict=True)
    ]
    return {
        "columns": columns,
        "rows": rows,
        "scored": found.scored,
        "before": found.before,
        "measured_rmse": found.measured_rmse,
        "expected_outside": 100 * found.expected_outside,
    }


def _row(score: RecordedScore) -> dict[str, Any]:
    own = score.true.change if score.true else score.change
    return {
        "rms": score.rms,
        "change": own and 100 * own.change,
        "change_low": own and 100 * own.low,
        "change_high": own and 100 * own.high,
        "log_likelihood": score.log_likelihood,
        "outside": 100 * score.outside,
        "whiteness": score.whiteness.correlation,
        "predicted": score.true and score.true.predicted,
        "filtered": score.true and score.true.filtered,
    }
