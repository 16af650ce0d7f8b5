"""A large CSV file from its text to a file of tracks, beside the bare parse of the same file.

    python -m benchmarks.track_files [--rows 10000000] [--tracks 10000] [--rounds 1]

The file has a time, an identity and two axes; its tracks take turns, one plot each. Each job is a
process of its own, and all of them take turns. ``parse`` is the bare parse by pyarrow; ``track`` is
``fuzzytrack track FILE --id id -o out.parquet``, which estimates the noise of the plots, judges
them by a gate, and writes standard deviations; ``fixed`` is the same with fixed gains, given noise
and no gate. Shown are medians of time and CPU time, with the start of the process and the loading
of compiled code, rows a second, peak memory, and time over that of the bare parse.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import numpy as np

from benchmarks.csv_files import peak
from fuzzytrack.cli.output import progress
from fuzzytrack.tasks import Progress

BLOCK = 500_000
JOBS = {
    "parse": None,
    "track": (),
    "fixed": ("--gate", "none", "--sigma", "5", "--tracker", "fixed:alpha=.5:beta=.2"),
}


def make(path: Path, rows: int, tracks: int, watch: Progress) -> None:
    """Write a recording of so many rows: straight tracks with an error of 5 m."""
    import pyarrow as pa
    import pyarrow.csv as pc

    random = np.random.default_rng(1)
    options = pc.WriteOptions(include_header=False, quoting_style="none")
    with open(path, "wb") as stream:
        stream.write(b"time,id,x,y\n")
        for start in range(0, rows, BLOCK):
            row = np.arange(start, min(start + BLOCK, rows))
            when, track = row // tracks, row % tracks
            places = [100.0 * track + 10.0 * when, 50.0 * track - 7.0 * when]
            x, y = np.round(random.normal(places, 5.0), 3)
            pc.write_csv(pa.table({"time": when, "id": track, "x": x, "y": y}), stream, options)
            watch(min((start + BLOCK) / rows, 1.0))


def run(job: str, path: str, output: str) -> None:
    """Do a job."""
    options = JOBS[job]
    if options is None:
        from benchmarks.csv_files import pyarrow_stream

        pyarrow_stream(path)
        return
    from fuzzytrack.cli.app import app

    command = ["track", path, "--id", "id", "--chunk-rows", "250000", "-o", output, *options]
    try:
        app(command)
    except SystemExit as left:
        if left.code:
            raise


def measure(job: str, path: str, output: str) -> dict[str, float]:
    """What a job takes, in a process of its own."""
    words = [job, "--file", path, "--output", output]
    started = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.track_files", "--job", *words],
        capture_output=True,
        text=True,
        check=False,
    )
    seconds = time.perf_counter() - started
    if done.returncode:
        raise RuntimeError(f"{job}: {done.stderr}")
    return {"seconds": seconds, **json.loads(done.stdout.splitlines()[-1])}


def _show(rows: int, results: dict[str, list[dict[str, float]]]) -> None:
    bare = median(found["seconds"] for found in results["parse"])
    for job, found in results.items():
        seconds, cpu, most = (median(r[key] for r in found) for key in ("seconds", "cpu", "peak"))
        print(
            f"{job:6} {seconds:7.1f} s  {cpu:7.1f} s CPU  {rows / seconds:12,.0f} rows/s  "
            f"{most:6.0f} MiB  {seconds / bare:6.2f} x"
        )


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.track_files",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--rows", type=int, default=10_000_000)
    parser.add_argument("--tracks", type=int, default=10_000)
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--job", choices=JOBS, help=argparse.SUPPRESS)
    parser.add_argument("--file", help=argparse.SUPPRESS)
    parser.add_argument("--output", help=argparse.SUPPRESS)
    given = parser.parse_args(arguments)
    if given.job:
        run(given.job, given.file, given.output)
        print(json.dumps({"cpu": time.process_time(), "peak": peak()}))
        return 0
    results: dict[str, list[dict[str, float]]] = {job: [] for job in JOBS}
    with tempfile.TemporaryDirectory() as folder, progress("tracking") as watch:
        path = Path(folder) / "plots.csv"
        make(path, given.rows, given.tracks, watch)
        for turn in range(given.rounds):
            for number, job in enumerate(JOBS):
                output = Path(folder) / f"{job}.parquet"
                results[job].append(measure(job, str(path), str(output)))
                output.unlink(missing_ok=True)
                watch((turn * len(JOBS) + number + 1) / (given.rounds * len(JOBS)))
        print(f"{path.stat().st_size / 1e6:,.0f} MB, {given.rows:,} rows")
    _show(given.rows, results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
