"""All measurements, one after the other."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable
from typing import Any

from benchmarks import (
    batch,
    engines,
    exported,
    growth,
    kalman,
    machine,
    maneuver,
    processes,
    profile,
    streaming,
)
from benchmarks.report import Row, as_dict, collect
from benchmarks.scale import Scale

__all__ = ["JOBS", "measure", "plain"]

Job = tuple[str, str, Callable[[Scale], Iterable[Row]]]

JOBS: tuple[Job, ...] = (
    (batch.SECTION, "fuzzy exact", batch.fuzzy),
    (batch.SECTION, "fuzzy table", batch.table),
    (batch.SECTION, "fuzzy exact, float32", batch.float32),
    (batch.SECTION, "fixed gains", batch.fixed),
    (batch.SECTION, "two threads", batch.threads),
    (batch.SECTION, "given gains", batch.numpy_gains),
    (batch.SECTION, "plug-in scheduler", batch.plugin),
    (batch.SECTION, "exported C99", exported.c99),
    (profile.SECTION, "where the time goes", profile.where),
    (maneuver.SECTION, "maneuver, by hand", maneuver.loop),
    (maneuver.SECTION, "maneuver, imm-three", maneuver.imm),
    (kalman.SECTION, "Kalman CV", kalman.velocity),
    (kalman.SECTION, "Kalman CA", kalman.acceleration),
    (kalman.SECTION, "Kim-Lee", kalman.kim_lee),
    (kalman.SECTION, "IMM", kalman.imm),
    (kalman.SECTION, "Kalman CV against simdkalman", kalman.simd),
    (streaming.SECTION, "one track", streaming.single),
    (streaming.SECTION, "scan", streaming.scan),
    (engines.SECTION, "one pair at a time", engines.points),
    (engines.SECTION, "arrays", engines.arrays),
    (processes.SECTION, "first large batch", processes.cold_start),
    (processes.SECTION, "`fuzzytrack track`", processes.small_file),
    (processes.SECTION, "commands without kernels", processes.imports),
    (processes.SECTION, "memory beyond inputs and outputs", processes.memory),
)


def measure(scale: Scale, say: Callable[[str], object] = lambda text: None) -> dict[str, Any]:
    """Run all jobs.

    Parameters
    ----------
    scale : Scale
    say : callable, optional
        Told of each job as it starts.

    Returns
    -------
    dict
        machine, scale, bandwidth (GB/s by threads), rows (list of `Row`), curves, seconds.
    """
    begin = time.perf_counter()
    described = machine.describe()
    say("    0 s  memory bandwidth")
    bandwidth = {
        str(n): machine.bandwidth(scale.triad, n, scale.repeats)
        for n in sorted({1, machine.cores()})
    }
    rows: list[Row] = []
    for section, what, job in JOBS:
        say(f"{time.perf_counter() - begin:5.0f} s  {what}")
        rows += collect(section, what, lambda job=job: job(scale))
    curves: dict[str, Any] = {}

    def grow() -> Iterable[Row]:
        curves["tracks"] = growth.tracks_curve(scale)
        return growth.curve_rows(curves["tracks"])

    def share() -> Iterable[Row]:
        curves["threads"] = growth.threads_curve(scale)
        return growth.thread_rows(curves["threads"])

    say(f"{time.perf_counter() - begin:5.0f} s  growth")
    rows += collect(growth.SECTION, "growth", grow)
    say(f"{time.perf_counter() - begin:5.0f} s  threads")
    rows += collect(growth.SECTION, "more threads", share)
    if hasattr(os, "getloadavg"):
        described["load_average_after"] = os.getloadavg()[0]
    return {
        "machine": described,
        "scale": scale.name,
        "bandwidth": bandwidth,
        "rows": rows,
        "curves": curves,
        "seconds": time.perf_counter() - begin,
    }


def plain(figures: dict[str, Any]) -> dict[str, Any]:
    """The figures as plain data, for JSON."""
    return {**figures, "rows": [as_dict(row) for row in figures["rows"]]}
