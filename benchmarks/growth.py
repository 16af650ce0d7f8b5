"""Throughput against the number of tracks, and of threads."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from benchmarks import machine
from benchmarks.report import NotMeasured, Row, Target
from benchmarks.scale import Scale
from benchmarks.timing import Ratio, Timing, take_turns
from benchmarks.work import (
    fixed_tracker,
    fuzzy_tracker,
    predictions,
    times_and_plots,
    updates_a_second,
    warm,
)

__all__ = ["curve_rows", "thread_rows", "threads_curve", "tracks_curve"]

SECTION = "Growth"
#: Plot and prediction, and some air.
BYTES_AN_UPDATE = 20
#: Of a lane's state, before and after a run.
BYTES_A_TRACK = 400

#: Tracks from which on the speed should not depend on their number.
LARGE = 10_000

Curve = list[dict[str, Any]]
TRACKERS = {"fixed gains": fixed_tracker, "fuzzy exact": fuzzy_tracker}


def tracks_curve(scale: Scale) -> Curve:
    """Batches from small to large, one thread, into existing arrays.

    Sizes for which there is no memory say so.
    """
    curve: Curve = []
    for tracks, steps in scale.growth:
        point: dict[str, Any] = {"tracks": tracks, "steps": steps}
        curve.append(point)
        needed = tracks * (steps * BYTES_AN_UPDATE + BYTES_A_TRACK)
        if needed > machine.available_memory():
            point["why"] = f"{needed / 1e9:.0f} GB are not free"
            continue
        times, plots = times_and_plots(tracks, steps)
        large = plots.size > 2_000_000
        # A small job is done many times over, so that a round is long enough to time.
        times_over = 1 if scale.name == "tiny" else max(1, 300_000 // plots.size)
        works, out = {}, np.zeros_like(plots)
        for name, tracker in TRACKERS.items():
            warm(scale, tracker(), 1)
            works[name] = partial(_many, tracker(), times, plots, out, times_over)
        repeats = min(3, scale.repeats) if large else scale.repeats
        for name, timing in take_turns(works, repeats).items():
            point[name] = updates_a_second(plots, timing.median / times_over)
        del times, plots, out, works
    return curve


def _many(tracker: Any, times: Any, plots: Any, out: Any, count: int) -> None:
    for _ in range(count):
        predictions(tracker, times, plots, out=out)


def threads_curve(scale: Scale) -> Curve:
    """A large batch on one processor, and on more, up to all."""
    times, plots = times_and_plots(scale.tracks, scale.steps)
    counts = sorted({2**k for k in range(8) if 2**k < machine.cores()} | {machine.cores()})
    works = {}
    for name, tracker in TRACKERS.items():
        warm(scale, tracker(), 1)
        for count in counts:
            works[name, count] = partial(predictions, tracker(), times, plots, threads=count)
    found: dict[Any, Timing] = take_turns(works, scale.repeats)
    return [
        {
            "threads": count,
            **{name: updates_a_second(plots, found[name, count].median) for name in TRACKERS},
        }
        for count in counts
    ]


def curve_rows(curve: Curve) -> list[Row]:
    """Spread of the time per update from `LARGE` tracks on, by tracker."""
    rows = []
    for name in TRACKERS:
        large = [p for p in curve if p["tracks"] >= LARGE and name in p]
        if len(large) < 2:
            rows.append(Row(SECTION, name, why=f"no two batches of {LARGE:,} tracks or more"))
            continue
        rates = [p[name] for p in large]
        spread = max(rates) / min(rates)
        missing = [f"{p['tracks']:,} tracks: {p['why']}" for p in curve if "why" in p]
        listed = ", ".join(
            f"{p['tracks']:,} x {p['steps']} steps {p[name]:.4g}" for p in curve if name in p
        )
        first, last = large[0]["tracks"], large[-1]["tracks"]
        rows.append(
            Row(SECTION, f"{name}, {first:,} to {last:,} tracks", max(rates), "M/s", "slowest size",
                min(rates), Ratio(spread, spread, spread), Target("<=", 1.25),
                note="Into existing arrays. M/s by size: " + "; ".join([listed, *missing]) + ".")
        )  # fmt: skip
    return rows


def thread_rows(curve: Curve) -> list[Row]:
    """All processors against one, by tracker."""
    one, most = curve[0], curve[-1]
    if one is most:
        raise NotMeasured("one processor only")
    rows = []
    for name in TRACKERS:
        times = most[name] / one[name]
        rows.append(
            Row(SECTION, f"{name}, {most['threads']} threads", most[name], "M/s", "one thread",
                one[name], Ratio(times, times, times))
        )  # fmt: skip
    return rows
