"""Recordings larger than memory, tracked from files to files."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass

from fuzzytrack.errors import DataError
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.files import check_output
from fuzzytrack.io.piece_writer import OUTPUTS, piece_writer
from fuzzytrack.io.recording import ROWS, find_columns, read_pieces, recording_files
from fuzzytrack.io.table import table_writer
from fuzzytrack.recordings.partitions import check_output_folder, track_partitions
from fuzzytrack.recordings.streaming import OpenTracks
from fuzzytrack.recordings.totals import Totals
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.workers import workers

__all__ = ["LargeJob"]


@dataclass(frozen=True)
class LargeJob:
    """A recording to be tracked in pieces.

    Attributes
    ----------
    files : tuple of str
        Files of the recording.
    columns : Columns
        Of the files.
    tracker : LaneTracker
        The tracker.
    sigma : float or None
        Standard deviation of the plots.
    rows : int
        Rows of a piece.
    """

    files: tuple[str, ...]
    columns: Columns
    tracker: LaneTracker
    sigma: float | None
    rows: int

    @classmethod
    def of(
        cls,
        path: str,
        tracker: Tracker,
        sigma: float | None,
        rows: int | None,
        *,
        time: str | None,
        id: str | None,
        axes: list[str] | None,
    ) -> LargeJob:
        """Job for a file or folder; finds its columns."""
        if not isinstance(tracker, LaneTracker):
            raise ValueError(
                f"--tracker: {type(tracker).__name__} cannot go on from piece to piece; it needs a "
                "file that is tracked as a whole"
            )
        files = recording_files(path)
        columns = find_columns(files, time=time, id=id, axes=axes)
        return cls(files, columns, tracker, sigma, rows or ROWS)

    def track(self, output: str | None, progress: Progress | None = None) -> Totals:
        """Track piece by piece, and write one file."""
        if output is not None:
            table_writer(output)
            check_output(output, self.files)
        tracks, totals = OpenTracks(self.tracker, self.sigma, OUTPUTS), Totals()
        with ExitStack() as stack:
            write = None
            if output is not None:
                write = stack.enter_context(piece_writer(output, self.columns, self.files))
            for piece in read_pieces(self.files, self.columns, rows=self.rows, progress=progress):
                tracked = tracks.advance(piece)
                totals.add(tracked)
                if write is not None:
                    write(piece, tracked.outputs)
            if not len(tracks):
                raise DataError(f"{self.files[0]}: holds no rows, only column names")
        totals.close(tracks)
        return totals

    def track_apart(
        self,
        output: str | None,
        jobs: int,
        scheduler: str | None,
        partitions: int,
        progress: Progress | None = None,
    ) -> Totals:
        """Track in partitions, on several processes or a cluster, and write a folder."""
        if output is None:
            raise ValueError("--jobs and --scheduler need -o DIR, a folder for the tracks")
        if scheduler is not None and jobs > 1:
            raise ValueError("--jobs and --scheduler: give one; a cluster has workers of its own")
        check_output_folder(output)
        with workers(jobs, scheduler) as executor:
            return track_partitions(
                self.tracker,
                self.files,
                self.columns,
                output,
                sigma=self.sigma,
                partitions=partitions,
                rows=self.rows,
                executor=executor,
                progress=progress,
            )
