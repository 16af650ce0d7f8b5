"""Trackers on a recording as a job of the studio: compared, and some tracks to be drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any

from fuzzytrack.arrays import Array
from fuzzytrack.io.recording import Track
from fuzzytrack.recordings.ragged import run_tracks, sigmas_of
from fuzzytrack.recordings.used_plots import UsedPlots
from fuzzytrack.studio.folder import naming
from fuzzytrack.studio.jobs import Job, Work
from fuzzytrack.studio.notes import by_name
from fuzzytrack.studio.recorded import Recorded, summary_of
from fuzzytrack.studio.tracker_texts import MakeTrackers
from fuzzytrack.tasks import part, run_tasks
from fuzzytrack.testbed.marks import best_of
from fuzzytrack.testbed.recorded_comparison import compare_used
from fuzzytrack.testbed.recorded_scores import RecordedComparison, RecordedScore
from fuzzytrack.trackers.base import Tracker

__all__ = ["track_work"]

# Share of the work that is done when the trackers are compared; the rest is for the pictures.
_COMPARED = 0.9
# Tracks and plots that are drawn.
_TRACKS, _PLOTS = 8, 2_000

# What is drawn of a tracker on each track, by name.
_Drawn = list[dict[str, Array]]


def track_work(recorded: Recorded, make: MakeTrackers) -> Work:
    """The work of a job that tracks a recording.

    Parameters
    ----------
    recorded : Recorded
    make : callable
        Makes the trackers, by name.

    Returns
    -------
    callable
        Its results are what `summary_of` gives; ``name``; ``drawn``: the first tracks, with ``id``,
        ``time``, ``plots``, ``truth`` and for each of the ``trackers`` ``predicted``, ``filtered``,
        ``innovation``; and ``comparison``: ``columns`` (key, title, unit) and ``rows``.
    """

    def work(job: Job, pool: ProcessPoolExecutor) -> dict[str, Any]:
        with naming(recorded.path):
            used = recorded.read()
            trackers, left_out = _fitting(make(used.axes_differ), used)
            compared = compare_used(
                trackers, used, executor=pool, progress=part(job.progress, 0.0, _COMPARED)
            )
        tracks = _drawn(used)
        runs: dict[str, _Drawn] = {}
        for name, run in run_tasks(partial(_followed, trackers, tracks), trackers, pool):
            runs[name] = run
            job.progress(_COMPARED + (1 - _COMPARED) * len(runs) / len(trackers))
        summary = summary_of(used)
        return {
            **summary,
            "name": recorded.path.name,
            "notes": [*summary["notes"], *left_out, *by_name(job.notes, trackers)],
            "drawn": [
                {
                    "id": track.id,
                    "time": track.time,
                    "plots": track.plots,
                    "truth": used.truth_of(track),
                    "trackers": {name: runs[name][k] for name in trackers},
                }
                for k, track in enumerate(tracks)
            ],
            "comparison": _comparison_as_json(compared),
        }

    return work


def _fitting(trackers: dict[str, Tracker], used: UsedPlots) -> tuple[dict[str, Tracker], list[str]]:
    """Trackers without those that need a noise that is not known, and what is said of these.

    Where all need it they stay, and are refused.
    """
    found = {name: t for name, t in trackers.items() if not getattr(t, "needs_sigma", False)}
    if used.has_sigma or not found or len(found) == len(trackers):
        return trackers, []
    names = ", ".join(name for name in trackers if name not in found)
    return found, [f"compared without {names}: the noise of the plots is needed; give `sigma`"]


def _drawn(used: UsedPlots) -> list[Track]:
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


def _followed(trackers: Mapping[str, Tracker], tracks: Sequence[Track], name: str) -> _Drawn:
    """What one of the trackers makes of some tracks."""
    pairs = [(track.time, track.plots) for track in tracks]
    return [
        {
            "predicted": result.predicted,
            "filtered": result.filtered,
            "innovation": result.innovation,
        }
        for result in run_tracks(trackers[name], pairs, sigmas=sigmas_of(tracks))
    ]


def _comparison_as_json(found: RecordedComparison) -> dict[str, Any]:
    columns = [
        ("rms", "RMS innovation", "m"),
        ("change", "Change", "%"),
        ("log_likelihood", "Log-likelihood", "nats"),
        ("outside", "Beyond 3\N{NO-BREAK SPACE}σ", "%"),
        ("whiteness", "Correlation", ""),
    ]
    if found.has_truth:
        columns[:0] = [
            ("predicted", "RMSE predicted", "m"),
            ("filtered", "RMSE filtered", "m"),
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
        "expected_correlation": found.scores[best_of(found.errors) or 0].whiteness.reach,
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
