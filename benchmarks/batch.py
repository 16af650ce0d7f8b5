"""Batches: against hand-written loops, the memory, NumPy, one another, and fewer or more tracks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import fuzzytrack as ft
from benchmarks import handwritten, machine
from benchmarks.report import NotMeasured, Row, Target
from benchmarks.scale import Scale
from benchmarks.timing import Timing, ratio, take_turns
from benchmarks.work import (
    ALPHA,
    BETA,
    BuiltInTwoSpeed,
    GivenGains,
    difference,
    fixed_tracker,
    fuzzy_tracker,
    keeps_only_predictions,
    option,
    plugin_tracker,
    predictions,
    times_and_plots,
    updates_a_second,
    warm,
)

__all__ = ["fixed", "float32", "fuzzy", "numpy_gains", "plugin", "table", "threads"]

SECTION = "Batches, one thread unless said (million updates a second)"
RATE = "M/s"


def _kept() -> str:
    if keeps_only_predictions():
        return "Predictions kept by both"
    return "This version cannot be asked for predictions alone, so fuzzytrack keeps all outputs"


def _rate(plots: Any, timing: Timing) -> float:
    return updates_a_second(plots, timing.median)


def fuzzy(scale: Scale) -> list[Row]:
    """The 49 rules, exact, against a loop that knows them by heart."""
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=0.1)
    flat = np.ascontiguousarray(plots[..., 0])
    tracker = fuzzy_tracker()
    warm(scale, tracker, 1)
    found = take_turns(
        {
            "ours": lambda: predictions(tracker, times, plots),
            "loop": lambda: handwritten.fuzzy(times, flat),
        },
        scale.repeats,
    )
    apart = difference(predictions(tracker, times, plots)[..., 0], handwritten.fuzzy(times, flat))
    rate, base = _rate(plots, found["ours"]), _rate(plots, found["loop"])
    shape = f"{scale.tracks:,} tracks x {scale.steps} steps"
    return [
        Row(SECTION, f"fuzzy exact, {shape}", rate, RATE, target=Target(">=", 300.0),
            note=f"{_kept()}. 10 % of plots missed, irregular times."),
        Row(SECTION, "fuzzy exact", rate, RATE, "hand-written Numba loop", base,
            ratio(found["loop"], found["ours"]), Target(">=", 0.9),
            note="The loop serves this one rule base with an α-β filter: it has no acceleration, "
            "no checks of its input, and need not divide by the sum of strengths. Its "
            f"predictions differ by {apart:.1g} m at most."),
    ]  # fmt: skip


def table(scale: Scale) -> list[Row]:
    """An interpolated table in place of the rules."""
    if scale.name != "full":
        raise NotMeasured("in a full run only")
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=0.1)
    exact, tabled = fuzzy_tracker(), fuzzy_tracker("table")
    for each in (exact, tabled):
        warm(scale, each, 1)
    found = take_turns(
        {
            "exact": lambda: predictions(exact, times, plots),
            "table": lambda: predictions(tabled, times, plots),
        },
        scale.repeats,
    )
    apart = difference(predictions(exact, times, plots), predictions(tabled, times, plots))
    return [
        Row(SECTION, "fuzzy table", _rate(plots, found["table"]), RATE, "fuzzy exact",
            _rate(plots, found["exact"]), ratio(found["exact"], found["table"]),
            note=f"Predictions differ by {apart:.1g} m at most."),
    ]  # fmt: skip


def float32(scale: Scale) -> list[Row]:
    """The same in single precision."""
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=0.1)
    single = plots.astype(np.float32)
    tracker = fuzzy_tracker()
    if predictions(tracker, times[:3], single[:3, :1]).dtype != np.float32:
        raise NotMeasured("float32 plots are tracked in float64")
    warm(scale, tracker, 1)
    found = take_turns(
        {
            "double": lambda: predictions(tracker, times, plots),
            "single": lambda: predictions(tracker, times, single),
        },
        scale.repeats,
    )
    apart = difference(predictions(tracker, times, single), predictions(tracker, times, plots))
    return [
        Row(SECTION, "fuzzy exact, float32", _rate(plots, found["single"]), RATE, "float64",
            _rate(plots, found["double"]), ratio(found["double"], found["single"]),
            Target(">=", 1.5), note=f"Predictions differ by {apart:.1g} m at most."),
    ]  # fmt: skip


def fixed(scale: Scale) -> list[Row]:
    """Fixed gains against the memory's speed and against loops with more and less in them."""
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=0.1)
    flat = np.ascontiguousarray(plots[..., 0])
    bare = np.nan_to_num(flat)
    tracker = fixed_tracker()
    warm(scale, tracker, 1)
    triad = machine.Triad(scale.triad)
    found = take_turns(
        {
            "ours": lambda: predictions(tracker, times, plots),
            "loop": lambda: handwritten.fixed(times, flat, ALPHA, BETA),
            "bare": lambda: handwritten.bare(times, bare, ALPHA, BETA),
            "fill": lambda: np.full(plots.shape, 1.0),
            "triad": triad,
        },
        scale.repeats,
    )
    apart = difference(
        predictions(tracker, times, plots)[..., 0],
        handwritten.fixed(times, flat, ALPHA, BETA),
    )
    asked = 16 if keeps_only_predictions() else 72
    rate = _rate(plots, found["ours"])
    bound = triad.bytes / asked / found["triad"].median / 1e6
    share = asked * plots.size / triad.bytes
    return [
        Row(SECTION, "fixed gains", rate, RATE, target=Target(">=", 1000.0), note=f"{_kept()}."),
        Row(SECTION, "fixed gains", rate, RATE, "triad bound", bound,
            ratio(found["triad"], found["ours"], share), Target(">=", 0.6),
            note=f"{asked} bytes an update are counted: 8 of the plot and 8 for each output kept. "
            "As for the triad's 24, lines that are read only to be overwritten are not counted, "
            "nor is the first touch of a fresh result, which the triad does not have: to fill one "
            f"of this size alone takes {1e3 * found['fill'].median:.3g} ms, the whole run "
            f"{1e3 * found['ours'].median:.3g} ms."),
        Row(SECTION, "fixed gains", rate, RATE, "hand-written Numba loop",
            _rate(plots, found["loop"]), ratio(found["loop"], found["ours"]),
            note="The loop has missed plots, irregular times and the two-point start in it; no "
            f"acceleration and no checks. Its predictions differ by {apart:.1g} m at most."),
        Row(SECTION, "fixed gains", rate, RATE, "bare Numba loop", _rate(plots, found["bare"]),
            ratio(found["bare"], found["ours"]),
            note="Not the same work: the loop has no missed plots, no start and no checks. It "
            "shows what the bare recursion does in this memory."),
    ]  # fmt: skip


def threads(scale: Scale) -> list[Row]:
    """Two threads against one."""
    tracker = fuzzy_tracker()
    if not option(tracker.run, "threads", 2):
        raise NotMeasured("`run` has no option threads")
    if machine.cores() < 2:
        raise NotMeasured("one processor only")
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=0.1)
    rows = []
    for name, each in (("fuzzy exact", tracker), ("fixed gains", fixed_tracker())):
        warm(scale, each, 1)
        found = take_turns(
            {
                "one": lambda each=each: predictions(each, times, plots),
                "two": lambda each=each: predictions(each, times, plots, threads=2),
            },
            scale.repeats,
        )
        target = Target(">=", 1.9) if each is tracker else None
        rows.append(
            Row(SECTION, f"{name}, two threads", _rate(plots, found["two"]), RATE, "one thread",
                _rate(plots, found["one"]), ratio(found["one"], found["two"]), target)
        )  # fmt: skip
    return rows


def numpy_gains(scale: Scale) -> list[Row]:
    """Gains of each track and axis, irregular times and missed plots, against NumPy."""
    tracks, steps = min(1_000, scale.tracks), scale.steps
    times, plots = times_and_plots(tracks, steps, axes=2, missed=0.1)
    alpha = np.random.default_rng(2).uniform(0.2, 0.8, plots.shape[1:])
    beta = alpha * alpha / (2.0 - alpha)
    tracker = ft.AlphaBetaTracker(GivenGains(), start="one-point")
    warm(scale, tracker, 2)
    works: dict[str, Callable[[], Any]] = {
        "ours": lambda: predictions(tracker, times, plots, alpha),
        "numpy": lambda: handwritten.vectorised(times, plots, alpha, beta),
    }
    found = take_turns(works, 3 * scale.repeats)
    apart = difference(works["ours"](), works["numpy"]())
    return [
        Row(SECTION, f"given gains, {tracks:,} tracks x 2 axes", _rate(plots, found["ours"]), RATE,
            "NumPy", _rate(plots, found["numpy"]), ratio(found["numpy"], found["ours"]),
            Target(">=", 5.0),
            note="Gains for each track and axis, irregular times common to all, 10 % missed; "
            "predictions kept by NumPy. fuzzytrack makes β from α by a scheduler, NumPy has both. "
            f"Predictions differ by {apart:.1g} m at most."),
    ]  # fmt: skip


def plugin(scale: Scale) -> list[Row]:
    """The plug-in's kernel as it is written, and as a built-in one would be."""
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=0.1)
    theirs, ours = plugin_tracker(), ft.AlphaBetaTracker(BuiltInTwoSpeed())
    for each in (theirs, ours):
        warm(scale, each, 1)
    found = take_turns(
        {
            "plug-in": lambda: predictions(theirs, times, plots, 10.0),
            "built in": lambda: predictions(ours, times, plots, 10.0),
        },
        scale.repeats,
    )
    apart = difference(
        predictions(theirs, times, plots, 10.0), predictions(ours, times, plots, 10.0)
    )
    return [
        Row(SECTION, "plug-in scheduler", _rate(plots, found["plug-in"]), RATE,
            "same kernel, built in", _rate(plots, found["built in"]),
            ratio(found["built in"], found["plug-in"]), Target(">=", 0.8),
            note="TwoSpeed of examples/plugin, against the same rule in the idiom of the built-in "
            f"kernels. Predictions differ by {apart:.1g} m at most."),
    ]  # fmt: skip
