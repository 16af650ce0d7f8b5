"""Parsers of CSV on one large file, each in a process of its own, and what this package adds.

    python -m benchmarks.csv_files [--rows 27000000] [--rounds 1] [--file PLOTS.csv]

The file has a time, an identity and two axes; 27 million rows are about 1 GB, and the file is read
once before anything is measured. Shown for each reader are time, CPU time, rows a second, the peak
memory of its process, and time and CPU time over those of the bare parse: medians of the rounds, in
which all readers take turns. Readers that are not installed are left out. ``tables`` is
`Source.tables` of this package, which checks every cell and knows its row; it is to take no more
than 3 times as long as the bare parse by the same library.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from fuzzytrack.cli.output import progress
from fuzzytrack.tasks import Progress

# Rows that are made, and read by what reads in pieces, at a time.
BLOCK = 500_000
IDENTITIES = 500


def make(path: Path, rows: int, watch: Progress) -> None:
    """Write a recording of so many rows."""
    import pyarrow as pa
    import pyarrow.csv as pc

    random = np.random.default_rng(1)
    options = pc.WriteOptions(include_header=False, quoting_style="none")
    with open(path, "wb") as stream:
        stream.write(b"time,id,x,y\n")
        for start in range(0, rows, BLOCK):
            size = min(BLOCK, rows - start)
            places = np.round(random.normal(0.0, 5e4, (2, size)), 3)
            table = pa.table(
                {
                    "time": np.round(np.arange(start, start + size) * 0.01, 2),
                    "id": pa.array(random.integers(0, IDENTITIES, size)).cast(pa.string()),
                    "x": places[0],
                    "y": places[1],
                }
            )
            pc.write_csv(table, stream, options)
            watch((start + size) / rows)


# -------------------------------------------------------------------- readers


def pyarrow_whole(path: str) -> int:
    from pyarrow import csv

    options = csv.ConvertOptions(column_types={"id": "string"})
    return csv.read_csv(path, convert_options=options).num_rows


def pyarrow_stream(path: str) -> int:
    from pyarrow import csv

    options = csv.ConvertOptions(column_types={"id": "string"})
    return sum(batch.num_rows for batch in csv.open_csv(path, convert_options=options))


def polars_whole(path: str) -> int:
    import polars

    return polars.read_csv(path, schema_overrides={"id": polars.String}).height


def pandas_pieces(path: str) -> int:
    import pandas

    return sum(len(part) for part in pandas.read_csv(path, dtype={"id": str}, chunksize=BLOCK))


def standard_library(path: str) -> int:
    import csv

    rows = 0
    with open(path, newline="") as stream:
        reader = csv.reader(stream)
        next(reader)
        for when, _, x, y in reader:
            float(when), float(x), float(y)
            rows += 1
    return rows


def tables(path: str) -> int:
    return _tables(path, {"time": "number", "id": "word", "x": "gaps", "y": "gaps"})


def tables_with_times(path: str) -> int:
    """Times as they are written, as dates would be."""
    return _tables(path, {"time": "time", "id": "word", "x": "gaps", "y": "gaps"})


def tables_by_lines(path: str) -> int:
    """As without pyarrow."""
    sys.modules["pyarrow"] = None  # type: ignore[assignment]
    return tables(path)


def _tables(path: str, kinds: Any) -> int:
    from fuzzytrack.io.formats import open_table

    with open_table(path) as source:
        return sum(len(table.rows) for table in source.tables(kinds, BLOCK // 2))


READERS: tuple[Callable[[str], int], ...] = (
    pyarrow_stream, pyarrow_whole, polars_whole, pandas_pieces, standard_library, tables,
    tables_with_times, tables_by_lines,
)  # fmt: skip


def measure(name: str, path: str) -> dict[str, float]:
    """What a reader takes, in this process."""
    reader = next(reader for reader in READERS if reader.__name__ == name)
    started, cpu = time.perf_counter(), time.process_time()
    rows = reader(path)
    seconds, cpu_seconds = time.perf_counter() - started, time.process_time() - cpu
    return {"rows": rows, "seconds": seconds, "cpu": cpu_seconds, "peak": peak()}


def peak() -> float:
    """Peak memory of this process (MiB)."""
    status = Path("/proc/self/status")
    if status.exists():
        # Unlike `resource`, without what the process was before it became another program.
        line = next(row for row in status.read_text().splitlines() if row.startswith("VmHWM"))
        return int(line.split()[1]) / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def _in_a_process(name: str, path: Path) -> dict[str, float] | None:
    command = [sys.executable, "-m", "benchmarks.csv_files", "--reader", name, "--file", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if "ModuleNotFoundError" in done.stderr:
        return None
    done.check_returncode()
    found: dict[str, float] = json.loads(done.stdout)
    return found


def _show(results: dict[str, list[dict[str, float]]]) -> None:
    bare = {key: median(r[key] for r in results["pyarrow_stream"]) for key in ("seconds", "cpu")}
    for name, found in results.items():
        seconds, cpu, peak = (median(r[key] for r in found) for key in ("seconds", "cpu", "peak"))
        print(
            f"{name:18} {seconds:7.1f} s  {cpu:7.1f} s CPU  {found[0]['rows'] / seconds:12,.0f} "
            f"rows/s  {peak:6.0f} MiB  "
            f"{seconds / bare['seconds']:5.2f} x  {cpu / bare['cpu']:5.2f} x CPU"
        )


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="benchmarks.csv_files",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--rows", type=int, default=27_000_000)
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--readers", nargs="*", choices=[r.__name__ for r in READERS])
    parser.add_argument("--file", type=Path, help="a file with these columns; else one is made")
    parser.add_argument("--reader", help=argparse.SUPPRESS)
    given = parser.parse_args(arguments)
    if given.reader:
        print(json.dumps(measure(given.reader, str(given.file))))
        return 0
    names = given.readers or [reader.__name__ for reader in READERS]
    if "pyarrow_stream" not in names:
        names = ["pyarrow_stream", *names]
    results: dict[str, list[dict[str, float]]] = {}
    with tempfile.TemporaryDirectory() as folder, progress("reading") as watch:
        path = given.file or Path(folder) / "plots.csv"
        if given.file is None:
            make(path, given.rows, watch)
        with open(path, "rb") as stream:
            while stream.read(1 << 24):
                pass
        for turn in range(given.rounds):
            for number, name in enumerate(names):
                if (found := _in_a_process(name, path)) is not None:
                    results.setdefault(name, []).append(found)
                watch((turn * len(names) + number + 1) / (given.rounds * len(names)))
        print(f"{path.stat().st_size / 1e6:,.0f} MB")
    _show(results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
