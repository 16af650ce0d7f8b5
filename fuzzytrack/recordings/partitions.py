"""Recordings tracked in partitions, as tasks for one core, many cores or a cluster."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TypeVar

from fuzzytrack.io.files import PathLike, whole_folder
from fuzzytrack.io.findings import Findings
from fuzzytrack.io.plot_files import ROWS, PlotFiles
from fuzzytrack.io.table import no_rows
from fuzzytrack.recordings.judge import Judge
from fuzzytrack.recordings.partition_files import read_partition, write_partitions
from fuzzytrack.recordings.pipeline import track_pieces
from fuzzytrack.recordings.totals import Totals
from fuzzytrack.tasks import Progress, run_tasks
from fuzzytrack.trackers.catalog import as_lane_tracker
from fuzzytrack.trackers.compilation import announce
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["track_partitions"]

Part = TypeVar("Part")


@dataclass(frozen=True)
class _Job:
    tracker: LaneTracker
    files: PlotFiles
    partitions: int
    rows: int
    folder: str
    judge: Judge | None
    expected: int = 0  # rows of a partition

    def sorted_file(self, number: int) -> Path:
        """Input file `number`, in partitions."""
        return Path(self.folder) / "sorted" / f"file-{number:06d}.parquet"

    def part(self, partition: int) -> Path:
        return Path(self.folder) / f"part-{partition:05d}.parquet"


def track_partitions(
    tracker: LaneTracker | str,
    files: PlotFiles,
    output: PathLike,
    *,
    partitions: int = 16,
    rows: int = ROWS,
    judge: Judge | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Totals:
    """Track a recording, its tracks divided among partitions by their identity.

    Parameters
    ----------
    tracker : LaneTracker or str
        The tracker, or what names it, see `fuzzytrack.trackers.catalog.make_tracker`.
    files : PlotFiles
        Files of the recording, in order of time.
    output : str or path
        Folder to be made, with one Parquet file for each partition, ``part-00000.parquet`` and on;
        see `fuzzytrack.recordings.track_writer`. It appears whole or not at all.
    partitions : int
        Number of partitions.
    rows : int
        Rows that a task holds at a time.
    judge : Judge, optional
        What happens to plots before they are used.
    executor : concurrent.futures.Executor, optional
        Runs the tasks; its workers must find the same files under the same names. Unless given, the
        tasks run in this process, one after the other.
    progress : callable, optional
        Called with the share of the tasks that are done.

    Returns
    -------
    Totals

    Raises
    ------
    DataError, ValueError, OSError
        As `fuzzytrack.io.PlotFiles.pieces`, `fuzzytrack.recordings.run_iter` and
        `fuzzytrack.io.files.whole_folder`.

    Notes
    -----
    First each input file is sorted into partitions, a task for each file; then each partition is
    tracked through all files, a task for each partition, with the states of its own tracks only. A
    task reads files and writes one, whole or not at all, so it can be repeated on any worker when
    the first one is lost. Until the end the disk holds a second copy of the plots.

    All rows of a track are in one file, in order of time, with the same numbers as in one run; rows
    of different tracks are in the order of the recording.
    """
    if partitions < 1:
        raise ValueError(f"partitions must be at least 1, got {partitions}")
    made, totals = as_lane_tracker(tracker), Totals()
    with whole_folder(output) as draft:
        job = _Job(made, files.absolute(), partitions, rows, str(draft), judge)
        job.sorted_file(0).parent.mkdir()
        steps = _Steps(len(files.inputs) + partitions, progress)
        sort = partial(_sort_file, job)
        found = 0
        sorted_files = dict(steps.counted(run_tasks(sort, range(len(files.inputs)), executor)))
        for number in sorted(sorted_files):
            count, findings = sorted_files[number]
            found += count
            totals.findings.merge(findings)
        job = replace(job, expected=found // partitions)
        track = partial(_track_partition, job)
        parts = dict(steps.counted(run_tasks(track, range(partitions), executor)))
        # In this order, whatever the order in which tasks finish: rounding depends on it.
        for partition in range(partitions):
            totals.merge(parts[partition])
        if not totals.tracks:
            raise no_rows(files.names[0])
        _keep_only(draft, {job.part(number) for number in range(partitions)})
    return totals


@dataclass
class _Steps:
    """Progress of a number of tasks."""

    total: int
    progress: Progress | None
    done: int = 0

    def counted(self, parts: Iterable[Part]) -> Iterator[Part]:
        for part in parts:
            self.done += 1
            if self.progress is not None:
                self.progress(self.done / self.total)
            yield part


def _keep_only(folder: Path, parts: set[Path]) -> None:
    """Remove the sorted files, and files that a lost worker left unfinished."""
    for path in folder.iterdir():
        if path.is_dir():
            shutil.rmtree(path)
        elif path not in parts:
            path.unlink(missing_ok=True)


# -------------------------------------------------------------------- tasks


def _sort_file(job: _Job, number: int) -> tuple[int, Findings]:
    findings = Findings()
    one = job.files.only(number)
    pieces = one.pieces(rows=job.rows, findings=findings)
    count = write_partitions(job.sorted_file(number), pieces, len(one.columns.axes), job.partitions)
    return count, findings


def _track_partition(job: _Job, partition: int) -> Totals:
    n_axes = len(job.files.columns.axes)
    # A worker that has not run the tracker yet compiles it at once, if the work is large enough.
    announce(job.tracker, n_axes, n_axes * job.expected)
    pieces = (
        piece
        for number, file in enumerate(job.files.names)
        for piece in read_partition(
            job.sorted_file(number), n_axes, partition, job.partitions, file=file, rows=job.rows
        )
    )
    return track_pieces(job.tracker, job.files, pieces, job.part(partition), judge=job.judge)
