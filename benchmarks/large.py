"""Recordings larger than memory, measured: ``python -m benchmarks.large``.

    make DIR --gigabytes G           writes a recording of G GB in Parquet files
    one DIR -o FILE                  tracks it in one process, piece by piece (`run_iter`)
    cluster DIR -o FOLDER --kill     tracks it on a Dask cluster of two processes of this computer,
                                     of which one is killed half way
    compare FILE FOLDER              whether both came to the same, to the last bit

10 GB need 50 GB of disk: the recording, its plots sorted once more, and two outputs. Processes are
measured and killed as POSIX has it; on Windows this does not run.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq

from benchmarks.large_files import LIVE, Progress, compare, make
from benchmarks.work import ROOT
from fuzzytrack.io.plot_files import ROWS, PlotFiles
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.recording import recording_files
from fuzzytrack.recordings.partitions import track_partitions
from fuzzytrack.recordings.streaming import run_iter
from fuzzytrack.recordings.track_table import TrackTable
from fuzzytrack.recordings.track_writer import track_writer
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.lane_tracker import LaneTracker

__all__ = ["cluster", "main", "one", "track"]

ID = "track"
# Seconds that a cluster may take to start another worker.
PATIENCE = 60

# ru_maxrss is counted in kilobytes, but for one system.
_UNIT = 1 if sys.platform == "darwin" else 1024

CHILD = "import sys; from benchmarks.large import track; track(*sys.argv[1:])"


# -------------------------------------------------------------------- one process


def one(folder: Path, output: Path, tracker: str, rows: int) -> dict[str, Any]:
    """Track in a new process: its largest memory is that of the job."""
    files = _recording(folder).paths
    begin = time.perf_counter()
    given = (str(folder.resolve()), str(output.resolve()), tracker, str(rows))
    child = subprocess.Popen([sys.executable, "-c", CHILD, *given], cwd=ROOT)
    try:
        _, status, used = os.wait4(child.pid, 0)
    except BaseException:
        child.kill()
        raise
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise SystemExit(child.returncode)
    return {
        **_work(files, time.perf_counter() - begin),
        "processor seconds": used.ru_utime + used.ru_stime,
        "peak bytes": used.ru_maxrss * _UNIT,
        "output bytes": output.stat().st_size,
    }


def track(folder: str, output: str, tracker: str, rows: str) -> None:
    """Body of that process."""
    files = _recording(Path(folder))
    pieces = files.pieces(rows=int(rows), progress=_Shown("tracking"))
    made = _tracker(tracker)
    table = TrackTable.of(files.decoder, made)
    with track_writer(output, table, files.paths) as write:
        for tracked in run_iter(made, pieces, keep=table.outputs):
            write(tracked.piece, tracked.outputs)


def _tracker(spec: str) -> LaneTracker:
    tracker = make_tracker(spec)
    if not isinstance(tracker, LaneTracker):
        raise SystemExit(f"--tracker: {spec} cannot go on from piece to piece")
    return tracker


def _recording(folder: Path) -> PlotFiles:
    return PlotFiles.of(recording_files(folder), Reading.of(id=ID))


def _work(files: tuple[str, ...], seconds: float) -> dict[str, Any]:
    rows = sum(pq.read_metadata(file).num_rows for file in files)
    size = sum(os.path.getsize(file) for file in files)
    return {"rows": rows, "bytes": size, "seconds": seconds, "rows a second": rows / seconds}


# -------------------------------------------------------------------- a cluster


def cluster(
    folder: Path, output: Path, tracker: str, rows: int, partitions: int, kill: bool
) -> dict[str, Any]:
    """Track on two worker processes; a lost one is replaced by Dask."""
    from distributed import Client, LocalCluster

    files = _recording(folder)
    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, memory_limit=0,
            dashboard_address=":0",
        ) as workers,
        Client(workers) as client,
    ):  # fmt: skip
        watch = _Watch(client, len(files.inputs) + partitions, kill)
        begin = time.perf_counter()
        track_partitions(
            _tracker(tracker), files, output, partitions=partitions, rows=rows,
            executor=client.get_executor(), progress=watch,
        )  # fmt: skip
        seconds = time.perf_counter() - begin
        watch.finish()
    used = watch.workers.values()
    return {
        **_work(files.paths, seconds),
        "partitions": partitions,
        "workers": list(used),
        "killed": watch.killed,
        "processor seconds": sum(worker["processor seconds"] for worker in used),
        "peak bytes": max(worker["peak bytes"] for worker in used),
        "peak bytes of the client": _usage()[1]["peak bytes"],
        "output bytes": sum(map(os.path.getsize, recording_files(output))),
        "drafts left": {
            path.name: path.stat().st_size for path in output.iterdir() if path.name[0] == "."
        },
    }


class _Watch:
    """Progress of a cluster: who works, with how much memory, and who is killed half way."""

    def __init__(self, client: Any, tasks: int, kill: bool) -> None:
        self._client, self._tasks, self._kill = client, tasks, kill
        self._shown = _Shown("tracking")
        self.workers: dict[int, dict[str, float]] = {}
        self.killed: dict[str, Any] | None = None
        self._look()

    def __call__(self, share: float) -> None:
        self._shown(share)
        done = round(share * self._tasks)
        # Later than half by one: with as many files as partitions nobody has work at half.
        if self._kill and self.killed is None and done > self._tasks // 2:
            self._end_one(done)

    def _look(self) -> dict[str, int]:
        """Processes by the address of their worker; notes what they have used."""
        used = self._client.run(_usage)
        self.workers.update((pid, figures) for pid, figures in used.values())
        return {address: pid for address, (pid, _) in used.items()}

    def _end_one(self, done: int) -> None:
        pids = self._look()
        tasks = {address: len(keys) for address, keys in self._client.processing().items()}
        address = max(pids, key=lambda address: tasks.get(address, 0))
        os.kill(pids[address], signal.SIGKILL)
        self.killed = {
            "after tasks": done, "of": self._tasks, "tasks it had": tasks.get(address, 0),
            "pid": pids[address],
        }  # fmt: skip

    def finish(self) -> None:
        self._client.wait_for_workers(2, timeout=PATIENCE)
        pids = self._look()
        if self._kill and (self.killed is None or self.killed["pid"] in pids.values()):
            raise RuntimeError("no worker was killed")


def _usage() -> tuple[int, dict[str, float]]:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return os.getpid(), {
        "peak bytes": used.ru_maxrss * _UNIT,
        "processor seconds": used.ru_utime + used.ru_stime,
    }


# -------------------------------------------------------------------- the command


class _Shown:
    """Progress in a line of the standard error output."""

    def __init__(self, what: str) -> None:
        self._what, self._begin, self._last = what, time.perf_counter(), -1

    def __call__(self, share: float) -> None:
        percent = int(100 * min(share, 1.0))
        if percent > self._last:
            self._last = percent
            spent = time.perf_counter() - self._begin
            end = "\n" if percent == 100 else ""
            print(
                f"\r{self._what} {percent:3d} %, {spent:.0f} s",
                end=end,
                file=sys.stderr,
                flush=True,
            )


def _some(kind: type) -> Any:
    def number(text: str) -> Any:
        value = kind(text)
        if not value > 0:
            raise argparse.ArgumentTypeError(f"must be more than 0, got {text}")
        return value

    return number


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="benchmarks.large", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    commands = parser.add_subparsers(dest="command", required=True)
    making, alone, together, comparing = map(
        commands.add_parser, ("make", "one", "cluster", "compare")
    )
    making.add_argument("folder", type=Path)
    making.add_argument("--gigabytes", type=_some(float), default=10.0, metavar="G")
    making.add_argument("--files", type=_some(int), default=32)
    making.add_argument("--live", type=_some(int), default=LIVE, help="tracks at a time")
    making.add_argument("--seed", type=int, default=1)
    for tracking in alone, together:
        tracking.add_argument("folder", type=Path)
        tracking.add_argument("-o", "--output", type=Path, required=True)
        tracking.add_argument("--tracker", default="stiffness-damping")
        tracking.add_argument("--rows", type=_some(int), default=ROWS, help="rows of a piece")
    together.add_argument("--partitions", type=_some(int), default=32)
    together.add_argument("--kill", action="store_true", help="kill a worker half way")
    comparing.add_argument("one", type=Path)
    comparing.add_argument("folder", type=Path)
    for command in making, alone, together, comparing:
        command.add_argument("--json", type=Path, metavar="FILE", help="write the figures")
    return parser


def _figures(given: argparse.Namespace, shown: Progress) -> dict[str, Any]:
    if given.command == "make":
        size = 1e9 * given.gigabytes
        return make(given.folder, size, given.files, given.live, given.seed, shown)
    if given.command == "one":
        return one(given.folder, given.output, given.tracker, given.rows)
    if given.command == "cluster":
        return cluster(
            given.folder, given.output, given.tracker, given.rows, given.partitions, given.kill
        )
    return compare(given.one, given.folder, ID, shown)


def main(arguments: list[str] | None = None) -> int:
    given = _parser().parse_args(arguments)
    begin = time.perf_counter()
    figures = _figures(given, _Shown(given.command))
    figures = {"command": given.command, "seconds": time.perf_counter() - begin, **figures}
    for name, value in figures.items():
        print(f"{name}: {f'{value:,.1f}' if isinstance(value, float) else value}")
    if given.json:
        given.json.write_text(json.dumps(figures, indent=2) + "\n")
    return int(not figures.get("identical", True))


if __name__ == "__main__":
    sys.exit(main())
