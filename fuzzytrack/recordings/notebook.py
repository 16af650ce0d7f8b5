"""Tracked recordings in notebooks: a table of tracks with a small picture, as HTML."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fuzzytrack.html_reprs import as_text, block, paragraph, picture, table
from fuzzytrack.recordings.totals import Totals
from fuzzytrack.trackers.result import TrackResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["html_of"]

# Tracks in the table.
_LISTED = 10
_HEADS = ("plots", "missed", "duration (s)", "innovation RMS")


def html_of(
    title: str,
    tracks: Sequence[tuple[str, TrackResult]],
    faults: Sequence[str],
    figure: Figure,
) -> str:
    """HTML of tracks, with nothing in it from elsewhere.

    Parameters
    ----------
    title : str
        Line above the table.
    tracks : sequence of (str, TrackResult)
        Identity and result of each track.
    faults : sequence of str
        What was left out or put right.
    figure : Figure
        Picture of the tracks; it is closed.
    """
    rows = [_row(id or "track", result) for id, result in tracks[:_LISTED]]
    more = len(tracks) - len(rows)
    below = paragraph(f"and {more} more", note=True) if more > 0 else ""
    faulty = paragraph("; ".join(faults), note=True)
    return block(title, table(["", *_HEADS], rows), below, faulty, picture(figure, "tracks"))


def _row(name: str, result: TrackResult) -> list[str]:
    totals = Totals.of([result]).summary
    counts = [f"{totals[key]}" for key in ("plots", "missed")]
    return [name, *counts, as_text(totals["duration"]), as_text(totals["innovation_rms"])]
