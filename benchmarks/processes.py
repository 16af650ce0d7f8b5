"""What shows in a new process only: starting up, and the largest memory."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.report import NotMeasured, Row, Target
from benchmarks.scale import Scale
from benchmarks.work import ROOT

__all__ = ["cold_start", "imports", "memory", "small_file"]

SECTION = "New processes"

START = """
import time
begin = time.perf_counter()
from benchmarks import work
times, plots = work.times_and_plots({tracks}, {steps})
ready = time.perf_counter()
work.predictions(work.fuzzy_tracker(), times, plots)
print(time.perf_counter() - ready)
"""

MEMORY = """
import json
from pathlib import Path
from benchmarks import work

def kilobytes(key):
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(key))

tracker = work.fuzzy_tracker()
tracker.compile(1)
work.predictions(tracker, *work.times_and_plots(2_000, 200))
times, plots = work.times_and_plots({tracks}, {steps})
# What compilation took at its height is forgotten.
Path("/proc/self/clear_refs").write_text("5")
before = kilobytes("VmRSS")
result = work.predictions(tracker, times, plots)
print(json.dumps([1024 * before, 1024 * kilobytes("VmHWM"), plots.nbytes]))
"""

COMMAND = "from fuzzytrack.cli import main; main()"

COMMANDS = (
    ("--help",),
    ("trackers", "--json"),
    ("gains", "--alpha", "0.5", "--beta", "0.2"),
    ("rulebase", "list"),
    ("design", "--help"),
)


def _run(*command: str, cache: str | None = None) -> subprocess.CompletedProcess[str]:
    environment = dict(os.environ, MPLBACKEND="Agg")
    if cache is not None:
        environment["FUZZYTRACK_CACHE_DIR"] = cache
    done = subprocess.run(
        [sys.executable, *command], cwd=ROOT, env=environment, capture_output=True, text=True
    )
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise RuntimeError(f"a new process failed: {last}")
    return done


def _needs_processes(scale: Scale) -> None:
    if not scale.processes:
        raise NotMeasured("no new processes are started at this size")


def cold_start(scale: Scale) -> list[Row]:
    """First large batch of a process, with nothing and with its kernel on disk."""
    _needs_processes(scale)
    code = START.format(tracks=scale.tracks, steps=scale.steps)
    without, with_kernels = [], []
    for _ in range(min(2, scale.processes)):
        with tempfile.TemporaryDirectory() as cache:
            begin = time.perf_counter()
            first = float(_run("-c", code, cache=cache).stdout)
            without.append((first, time.perf_counter() - begin))
            files = len(list(Path(cache).glob("fuzzytrack-kernel-*")))
            if not files:
                raise RuntimeError("nothing compiled was left on disk")
            for _ in range(scale.processes):
                begin = time.perf_counter()
                again = float(_run("-c", code, cache=cache).stdout)
                with_kernels.append((again, time.perf_counter() - begin))
    rows = []
    for name, pairs, target, disk in (
        ("with its kernel on disk", with_kernels, Target("<=", 2.5),
         f"The {files} files that the first process left: its steps, and the loop that all "
         "trackers share."),
        ("without", without, None, "An empty folder for compiled code."),
    ):  # fmt: skip
        run, whole = (statistics.median(column) for column in zip(*pairs, strict=True))
        rows.append(
            Row(SECTION, f"first large batch (fuzzy exact), {name}", run, "s", target=target,
                note=f"{scale.tracks:,} tracks x {scale.steps} steps, work included; the whole "
                f"process, with interpreter, imports and making the plots, {whole:.3g} s. {disk}")
        )  # fmt: skip
    return rows


def small_file(scale: Scale) -> list[Row]:
    """The command on a file of 1,000 rows."""
    _needs_processes(scale)
    random = np.random.default_rng(1)
    walk = np.cumsum(random.normal(0.0, 10.0, (1_000, 2)), axis=0)
    with tempfile.TemporaryDirectory() as folder:
        path, tracks = Path(folder, "plots.csv"), Path(folder, "tracks.csv")
        lines = [f"{k},{x:.3f},{y:.3f}" for k, (x, y) in enumerate(walk)]
        path.write_text("\n".join(["t,x,y", *lines]) + "\n")
        seconds = []
        for _ in range(1 + scale.processes):
            begin = time.perf_counter()
            _run("-c", COMMAND, "track", str(path), "-o", str(tracks))
            seconds.append(time.perf_counter() - begin)
        if len(tracks.read_text().splitlines()) != 1_001:
            raise RuntimeError("the command did not write 1,000 rows")
    return [
        Row(SECTION, "`fuzzytrack track` on 1,000 rows of two axes", statistics.median(seconds[1:]),
            "s", target=Target("<=", 1.0), note="The whole process, output written."),
    ]  # fmt: skip


def imports(scale: Scale) -> list[Row]:
    """Whether commands that need no kernel do without Numba."""
    _needs_processes(scale)
    guilty = []
    for command in COMMANDS:
        report = _run("-X", "importtime", "-c", COMMAND, *command).stderr
        names = [line.rpartition("|")[2].strip() for line in report.splitlines()]
        if "fuzzytrack" not in names:
            raise RuntimeError(f"no imports of {' '.join(command)} were listed")
        if any(name.split(".")[0] == "numba" for name in names):
            guilty.append(" ".join(command))
    tried = ", ".join(" ".join(command) for command in COMMANDS)
    return [
        Row(SECTION, "commands without kernels that import Numba", float(len(guilty)), "",
            target=Target("<=", 0.0),
            note=f"By -X importtime, of: {tried}." + (f" Do: {', '.join(guilty)}." * bool(guilty))),
    ]  # fmt: skip


def memory(scale: Scale) -> list[Row]:
    """Most memory of a run beyond its plots and what it was asked for."""
    _needs_processes(scale)
    if not os.access("/proc/self/clear_refs", os.W_OK):
        raise NotMeasured("this system does not tell the largest memory of a part of a process")
    code = MEMORY.format(tracks=scale.tracks, steps=scale.steps)
    before, most, plots = json.loads(_run("-c", code).stdout)
    beyond: Any = (most - before - plots) / 1e6
    return [
        Row(SECTION, "memory beyond inputs and outputs", beyond, "MB", target=Target("<=", 64.0),
            note=f"{scale.tracks:,} tracks x {scale.steps} steps: plots of {plots / 1e6:.0f} MB, "
            "predictions as many. Largest resident size of a process, less that before the run, "
            "less the predictions; the kernel was compiled before."),
    ]  # fmt: skip
