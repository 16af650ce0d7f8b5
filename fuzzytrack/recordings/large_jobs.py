"""Recordings larger than memory, tracked from files to files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from fuzzytrack.io.files import PathLike, check_output_folder
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.piece import Piece
from fuzzytrack.io.plot_files import ROWS, PlotFiles
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import recording_files
from fuzzytrack.io.table import no_rows
from fuzzytrack.recordings.judge import Judge
from fuzzytrack.recordings.partitions import track_partitions
from fuzzytrack.recordings.pipeline import track_pieces
from fuzzytrack.recordings.totals import Totals
from fuzzytrack.recordings.track_table import TrackTable
from fuzzytrack.recordings.track_writer import check_tracks
from fuzzytrack.reprs import summary
from fuzzytrack.tasks import Progress
from fuzzytrack.trackers.base import Tracker
from fuzzytrack.trackers.catalog import as_lane_tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker
from fuzzytrack.workers import workers

__all__ = ["LargeJob"]


@dataclass(frozen=True)
class LargeJob:
    """A recording that is tracked in pieces.

    Attributes
    ----------
    files : PlotFiles
        The recording.
    tracker : LaneTracker
        The tracker.
    rows : int
        Rows of a piece.
    judge : Judge, optional
        What happens to plots before they are used.
    """

    files: PlotFiles
    tracker: LaneTracker
    rows: int = ROWS
    judge: Judge | None = None

    def __repr__(self) -> str:
        return summary(self, "tracker", "rows", files=len(self.files.inputs))

    @classmethod
    def of(
        cls,
        path: PathLike,
        tracker: Tracker | str,
        sigma: float | None = None,
        rows: int | None = None,
        **options: Any,
    ) -> LargeJob:
        """Make the job of a file or folder.

        Parameters
        ----------
        path : str or path
            A file, or a folder of them.
        tracker : Tracker or str
            Any of this package, or what names it, see
            `fuzzytrack.trackers.catalog.make_tracker`.
        sigma : float, optional
            Standard deviation of the plots (m).
        rows : int, optional
            Rows of a piece; 250,000 unless given.
        **options
            How the files are read, see `fuzzytrack.io.read_tracks`.

        Raises
        ------
        ValueError
            If the tracker has no state with which it can continue from piece to piece.
        DataError
            If a column is missing, or its type differs between files.
        OSError
            If a file cannot be read.
        """
        made = as_lane_tracker(tracker)
        reading = Reading.of(sigma=sigma, **options)
        files = PlotFiles.of(recording_files(path), reading)
        return cls(files, made, ROWS if rows is None else rows)

    def track(
        self,
        output: PathLike | None,
        progress: Progress | None = None,
        *,
        quote_formulas: bool = False,
    ) -> Totals:
        """Track piece by piece.

        Parameters
        ----------
        output : str or path, optional
            File for the tracks; see `fuzzytrack.recordings.track_writer`.
        progress : callable, optional
            Called with the share that is done.
        quote_formulas : bool
            As for `fuzzytrack.io.table_writer`.

        Returns
        -------
        Totals

        Raises
        ------
        DataError, ValueError, OSError
            As `fuzzytrack.io.PlotFiles.pieces`, `fuzzytrack.recordings.run_iter` and
            `fuzzytrack.recordings.track_writer`.
        """
        if output is not None:
            table = TrackTable.of(self.files.decoder, self.tracker)
            check_tracks(output, table, self.files.paths)
        findings = Findings()
        pieces = self.files.pieces(rows=self.rows, findings=findings, progress=progress)
        some = _with_rows(pieces, self.files.names[0])
        totals = track_pieces(
            self.tracker,
            self.files,
            some,
            output,
            inputs=self.files.paths,
            judge=self.judge,
            quote_formulas=quote_formulas,
        )
        findings.merge(totals.findings)
        totals.findings = findings
        return totals

    def track_apart(
        self,
        output: PathLike,
        jobs: int = 1,
        scheduler: str | None = None,
        partitions: int = 16,
        progress: Progress | None = None,
    ) -> Totals:
        """Track in partitions, on several processes or a cluster.

        Parameters
        ----------
        output : str or path
            Folder for the tracks, one file for each partition.
        jobs, scheduler
            Who does the work; see `fuzzytrack.workers.workers`.
        partitions : int
            Number of partitions.
        progress : callable, optional
            Called with the share of the tasks that are done.

        Returns
        -------
        Totals

        Raises
        ------
        DataError, ValueError, OSError
            As `fuzzytrack.recordings.partitions.track_partitions` and `fuzzytrack.workers.workers`.
        """
        check_output_folder(output)
        with workers(jobs, scheduler) as executor:
            return track_partitions(
                self.tracker,
                self.files,
                output,
                partitions=partitions,
                rows=self.rows,
                judge=self.judge,
                executor=executor,
                progress=progress,
            )


def _with_rows(pieces: Iterable[Piece], file: str) -> Iterator[Piece]:
    """The pieces; DataError at their end if there was no row, so that nothing is written."""
    rows = 0
    for piece in pieces:
        rows += len(piece.time)
        yield piece
    if not rows:
        raise no_rows(file)
