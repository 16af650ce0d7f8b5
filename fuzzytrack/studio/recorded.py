"""Trackers on recorded plots, as the page shows them."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from fuzzytrack.io.decoder import PlotDecoder
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import Track
from fuzzytrack.recordings.ragged import run_tracks, sigmas_of
from fuzzytrack.recordings.used_plots import UsedPlots, read_used_plots
from fuzzytrack.studio.folder import naming
from fuzzytrack.studio.notes import by_name, noted
from fuzzytrack.studio.reading_arguments import check_truth
from fuzzytrack.studio.uploads import check_plots
from fuzzytrack.testbed.marks import best_of
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
    """A recording, and what a page says of it.

    Attributes
    ----------
    path : Path
    options : mapping of str to value
        See `fuzzytrack.studio.reading_arguments.reading_options`; what is not in it is found by the
        names of the columns, where that is certain, and the noise is estimated.
    true_file : Path or None
        File of true positions; ``truth`` of the options has columns of the recording unless given.
    """

    path: Path
    options: Mapping[str, Any] = field(default_factory=dict)
    true_file: Path | None = None

    @property
    def truth(self) -> str | None:
        """True positions, as functions take them: a file, or columns of the recording.

        Raises
        ------
        ValueError
            If there is no such column.
        """
        columns = self.options.get("truth")
        if self.true_file is not None or columns is None:
            return None if self.true_file is None else str(self.true_file)
        check_truth(self.columns(), columns)
        return ",".join(columns)

    @property
    def reading(self) -> dict[str, Any]:
        """How the file is read, without its truth."""
        return {name: value for name, value in self.options.items() if name != "truth"}

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
        with naming(self.path), naming(self.true_file or self.path):
            options = json.dumps(self.reading, sort_keys=True)
            files = [self.path] if self.true_file is None else [self.path, self.true_file]
            return _read(str(self.path), options, self.truth, tuple(map(_version, files)))


# A page asks what is in a recording before it has it tracked.
@lru_cache(maxsize=1)
def _read(path: str, options: str, truth: str | None, versions: tuple[object, ...]) -> UsedPlots:
    """Plots of a file; those of the last one are kept while no file changes."""
    return read_used_plots(path, Reading.of(**json.loads(options)), truth=truth)


def _version(path: Path) -> tuple[int, int, int]:
    found = path.stat()
    return found.st_ino, found.st_mtime_ns, found.st_size


def summary_of(used: UsedPlots) -> dict[str, Any]:
    """What was read, in numbers."""
    columns = used.decoder.columns
    return {
        "found": {
            "time": columns.time,
            "id": columns.id,
            "position": columns.position,
            "places": columns.read,
            "axes": columns.axes,
        },
        "plots": sum(int((~np.isnan(t.plots).any(axis=1)).sum()) for t in used.tracks),
        "tracks": len(used.tracks),
        "axes": used.tracks[0].plots.shape[1] if used.tracks else 0,
        "noise": _noise_as_json(used.decoder),
        "notes": used.notes,
    }


def _noise_as_json(decoder: PlotDecoder) -> list[dict[str, Any]]:
    """Standard deviation of each coordinate, or its column; what is estimated has an error."""
    errors = decoder.noise_errors or (None,) * len(decoder.noise)
    return [
        {
            "sigma": sigma,
            "error": error,
            "unit": "°" if decoder.noise_is_polar and k else "m",
        }
        for k, (sigma, error) in enumerate(zip(decoder.noise, errors, strict=True))
    ]


def tracked_as_json(used: UsedPlots, trackers: Mapping[str, Tracker]) -> dict[str, Any]:
    """Tracks of recorded plots, some of them to be drawn, and how the trackers compare.

    Parameters
    ----------
    used : UsedPlots
    trackers : mapping of str to Tracker

    Returns
    -------
    dict
        What `summary_of` gives; ``drawn``: the first tracks, with ``id``, ``time``,
        ``plots``, ``truth`` and for each of ``trackers`` ``predicted``, ``filtered``,
        ``innovation``; and ``comparison``: ``columns`` (key, title, unit) and ``rows``.
    """
    with noted() as warned:
        compared = compare_used(dict(trackers), used)
        drawn = [_track_as_json(track, used, trackers) for track in _drawn(used)]
    summary = summary_of(used)
    return {
        **summary,
        "notes": [*summary["notes"], *by_name(warned, trackers)],
        "drawn": drawn,
        "comparison": _comparison_as_json(compared),
    }


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
