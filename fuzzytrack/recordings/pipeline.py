"""From the pieces of a recording to the file of its tracks."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import ExitStack

from fuzzytrack.io.files import PathLike
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.plot_files import PlotFiles
from fuzzytrack.recordings.judge import Judge
from fuzzytrack.recordings.restarts import Restarts
from fuzzytrack.recordings.streaming import OpenTracks
from fuzzytrack.recordings.totals import Totals
from fuzzytrack.recordings.track_table import TrackTable
from fuzzytrack.recordings.track_writer import track_writer
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["track_pieces"]


def track_pieces(
    tracker: LaneTracker,
    files: PlotFiles,
    pieces: Iterable[Piece],
    output: PathLike | None,
    *,
    inputs: tuple[PathLike, ...] = (),
    judge: Judge | None = None,
    quote_formulas: bool = False,
) -> Totals:
    """Clean and track pieces, count them, and write them as they come.

    Parameters
    ----------
    tracker : LaneTracker
        The tracker.
    files : PlotFiles
        What the pieces are from: columns, noise and cleaning.
    pieces : iterable of Piece
        As they were read, with their faults.
    output : str, path or None
        File for the tracks, if there is to be one.
    inputs : tuple of str or path
        Files that must not be overwritten.
    judge : Judge, optional
        What happens to plots before they are used.
    quote_formulas : bool
        As for `fuzzytrack.io.table_writer`.

    Returns
    -------
    Totals
    """
    table = TrackTable.of(files.decoder, tracker)
    tracks = OpenTracks(tracker, files.decoder.sigma, table.outputs, judge)
    totals, restarts = Totals(), Restarts()
    with ExitStack() as stack:
        write = None
        if output is not None:
            writer = track_writer(output, table, inputs, quote_formulas=quote_formulas)
            write = stack.enter_context(writer)
        for piece in files.cleaned(pieces, totals.findings):
            tracked = tracks.advance(piece)
            totals.add(tracked)
            parts = tracked.piece
            if tracked.begins is not None:
                parts = restarts.advance(parts, tracked.begins)
            if write is not None:
                write(parts, tracked.outputs)
    totals.close(len(tracks), tracks.duration)
    return totals
