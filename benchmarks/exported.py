"""Batches in exported C, compiled for this processor, against this package's own compiled code."""

from __future__ import annotations

from typing import Any

from benchmarks.batch import SECTION
from benchmarks.report import NotMeasured, Row
from benchmarks.scale import Scale
from benchmarks.timing import ratio, take_turns
from benchmarks.work import (
    difference,
    fuzzy_tracker,
    predictions,
    times_and_plots,
    updates_a_second,
    warm,
)
from fuzzytrack.interop.c99.build import CompilerError
from fuzzytrack.interop.c99.compiled_filter import compiled_c
from fuzzytrack.interop.c99.compiled_lanes import FAST, CompiledLanes

__all__ = ["c99"]

RATE = "M/s"


def c99(scale: Scale) -> list[Row]:
    """The 49 rules in C: the exported filter track by track, and its step over lanes."""
    tracker = fuzzy_tracker()
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=0.1)
    try:
        alone = compiled_c(tracker, axes=plots.shape[-1], flags=FAST)
        lanes = CompiledLanes(tracker, axes=plots.shape[-1])
    except CompilerError as error:
        raise NotMeasured(str(error)) from None
    warm(scale, tracker, 1)
    works: dict[str, Any] = {
        "ours": lambda: predictions(tracker, times, plots),
        "alone": lambda: alone.run(times, plots, keep=("predicted",)).predicted,
        "lanes": lambda: lanes(times, plots),
    }
    found = take_turns(works, scale.repeats)
    rate = {name: updates_a_second(plots, timing.median) for name, timing in found.items()}
    rows = []
    for name, peer, note in (
        ("lanes", "C99, lanes side by side",
         "The same step, translated to C and compiled by the C compiler of this machine with -O3 "
         "-march=native, over blocks of lanes."),
        ("alone", "C99 as exported, a track at a time",
         "The filter as devices get it, one struct for each track, compiled in the same way."),
    ):  # fmt: skip
        apart = difference(works["ours"](), works[name]())
        rows.append(
            Row(SECTION, "fuzzy exact, 10 % missed", rate["ours"], RATE, peer, rate[name],
                ratio(found[name], found["ours"]),
                note=f"{note} Predictions differ by {apart:.1g} m at most.")
        )  # fmt: skip
    return rows
