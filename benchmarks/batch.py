"""Batches: against hand-written loops, the memory, NumPy, one another, and fewer or more tracks."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
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
    plugin_tracker,
    predictions,
    times_and_plots,
    updates_a_second,
    warm,
)

__all__ = ["fixed", "float32", "fuzzy", "numpy_gains", "plugin", "single", "table", "threads"]

SECTION = "Batches, one thread unless stated (million updates a second)"
RATE = "M/s"
#: Of an update: the plot is read, the prediction written.
BYTES = 16


def _rate(plots: Any, timing: Timing) -> float:
    return updates_a_second(plots, timing.median)


def fuzzy(scale: Scale) -> list[Row]:
    """The 49 rules, exact, against a loop that knows them by heart."""
    warm(scale, fuzzy_tracker(), 1)
    return [*_fuzzy(scale, 0.1, "10 % missed"), *_fuzzy(scale, 0.0, "none missed")]


def _fuzzy(scale: Scale, missed: float, how: str) -> list[Row]:
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=missed)
    flat = np.ascontiguousarray(plots[..., 0])
    tracker = fuzzy_tracker()
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
        Row(SECTION, f"fuzzy exact, {shape}, {how}", rate, RATE, target=Target(">=", 300.0),
            note="Predictions kept, irregular times."),
        Row(SECTION, f"fuzzy exact, {how}", rate, RATE, "hand-written Numba loop", base,
            ratio(found["loop"], found["ours"]), Target(">=", 0.9),
            note="The loop serves this one rule base with an α-β filter, its rule table worked out "
            "by hand: it has no acceleration, no checks of its input, and no results but the "
            "predictions. Blocks, memory and width of vectors are as in fuzzytrack. Its "
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
    if not scale.compiles:
        raise NotMeasured("single precision is always compiled, and nothing is at this size")
    return [
        single(scale, "fuzzy exact", fuzzy_tracker(), Target(">=", 1.5)),
        single(scale, "fixed gains", fixed_tracker()),
    ]


def single(scale: Scale, name: str, tracker: Any, target: Target | None = None) -> Row:
    """A tracker in single precision against itself in double."""
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=0.1)
    short = plots.astype(np.float32)
    warm(scale, tracker, 1)
    works: dict[str, Callable[[], Any]] = {
        "double": lambda: predictions(tracker, times, plots),
        "single": lambda: predictions(tracker, times, short, dtype=np.float32),
    }
    found = take_turns(works, scale.repeats)
    apart = difference(works["single"](), works["double"]())
    return Row(
        SECTION, f"{name}, float32", _rate(plots, found["single"]), RATE, "float64",
        _rate(plots, found["double"]), ratio(found["double"], found["single"]), target,
        note="Plots and predictions are float32 in the one, float64 in the other. Predictions "
        f"differ by {apart:.1g} m at most, of plots up to {np.nanmax(np.abs(plots)):.0f} m.",
    )  # fmt: skip


def fixed(scale: Scale) -> list[Row]:
    """Fixed gains against the memory's speed and against loops with more and less in them."""
    warm(scale, fixed_tracker(), 1)
    return [*_fixed(scale, 0.1, "10 % missed"), *_fixed(scale, 0.0, "none missed")]


def _fixed(scale: Scale, missed: float, how: str) -> list[Row]:
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=missed)
    flat = np.ascontiguousarray(plots[..., 0])
    bare, ours, theirs = np.nan_to_num(flat), np.zeros_like(plots), np.zeros_like(flat)
    tracker, triad = fixed_tracker(), machine.Triad(scale.triad)
    found = take_turns(
        {
            "new": lambda: predictions(tracker, times, plots),
            "ours": lambda: predictions(tracker, times, plots, out=ours),
            "loop": lambda: handwritten.fixed(times, flat, ALPHA, BETA, theirs),
            "bare": lambda: handwritten.bare(times, bare, ALPHA, BETA, theirs),
            "triad": triad,
        },
        scale.repeats,
    )
    apart = difference(
        predictions(tracker, times, plots)[..., 0],
        handwritten.fixed(times, flat, ALPHA, BETA),
    )
    rate, what = _rate(plots, found["ours"]), f"fixed gains into an existing array, {how}"
    bound = triad.bytes / BYTES / found["triad"].median / 1e6
    share = BYTES * plots.size / triad.bytes
    new = _rate(plots, found["new"])
    return [
        Row(SECTION, f"fixed gains, {how}", new, RATE, target=Target(">=", 1000.0),
            note="Predictions kept, in a new array."),
        Row(SECTION, what, rate, RATE, "in a new array", new, ratio(found["new"], found["ours"]),
            note="`run(..., out=)` against `run(..., keep=)`: the difference is the first access "
            "to new memory."),
        Row(SECTION, what, rate, RATE, "triad bound", bound,
            ratio(found["triad"], found["ours"], share), Target(">=", 0.7),
            note=f"{BYTES} bytes an update are counted: 8 of the plot and 8 of the prediction. As "
            "for the triad's 24, lines that are read only to be overwritten are not counted."),
        Row(SECTION, what, rate, RATE, "hand-written Numba loop",
            _rate(plots, found["loop"]), ratio(found["loop"], found["ours"]), Target(">=", 0.95),
            note="The loop has missed plots, irregular times and the two-point start in it; no "
            "acceleration, no last plot, no checks, and no state at the end. It writes into an "
            f"existing array, too. Its predictions differ by {apart:.1g} m at most."),
        Row(SECTION, what, rate, RATE, "bare Numba loop", _rate(plots, found["bare"]),
            ratio(found["bare"], found["ours"]),
            note="Not the same work: the loop has no missed plots, no start and no checks. It "
            "shows the speed of the bare recursion with this memory."),
    ]  # fmt: skip


def threads(scale: Scale) -> list[Row]:
    """Two threads against one, of ours and of the machine, all in the same rounds."""
    if machine.cores() < 2:
        raise NotMeasured("one processor only")
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=0.1)
    works: dict[str, Callable[[], Any]] = {}
    for n in (1, 2):
        works[f"arithmetic {n}"] = machine.Arithmetic(scale.triad // 100, n)
        works[f"copy {n}"] = machine.Copy(scale.triad, n)
    trackers = {"fuzzy exact": fuzzy_tracker(), "fixed gains": fixed_tracker()}
    for name, tracker in trackers.items():
        warm(scale, tracker, 1)
        for n in (1, 2):
            works[f"{name} {n}"] = partial(predictions, tracker, times, plots, threads=n)
    found = take_turns(works, scale.repeats)
    bounds = {
        name: ratio(found[f"{name} 1"], found[f"{name} 2"]) for name in ("arithmetic", "copy")
    }
    note = (
        f"In the same rounds a second thread made the machine {bounds['arithmetic'].median:.2f} "
        f"times as fast at arithmetic in the first cache, and {bounds['copy'].median:.2f} times "
        "at copying an array larger than the caches."
    )
    rows = []
    for name, tracker in trackers.items():
        one, two = found[f"{name} 1"], found[f"{name} 2"]
        target = Target(">=", 1.9) if tracker is fuzzy_tracker() else None
        rows.append(
            Row(SECTION, f"{name}, two threads", _rate(plots, two), RATE, "one thread",
                _rate(plots, one), ratio(one, two), target, note)
        )  # fmt: skip
    count = machine.Arithmetic.BLOCK * (scale.triad // 100) / 1e6
    one, two = found["arithmetic 1"], found["arithmetic 2"]
    rows.append(
        Row(SECTION, "machine: arithmetic loop, two threads", count / two.median, RATE,
            "one thread", count / one.median, bounds["arithmetic"],
            note="Not fuzzytrack: seven operations on each number of a block in the first cache. "
            "No program can gain more from a second thread here, unless it waits for memory.")
    )  # fmt: skip
    return rows


def numpy_gains(scale: Scale) -> list[Row]:
    """Gains of each track and axis, irregular times and missed plots, against NumPy."""
    tracks, steps = min(1_000, scale.tracks), scale.steps
    times, plots = times_and_plots(tracks, steps, axes=2, missed=0.1)
    alpha = np.random.default_rng(2).uniform(0.2, 0.8, plots.shape[1:])
    beta = alpha * alpha / (2.0 - alpha)
    # NumPy goes from time to time.
    tracker = ft.AlphaBetaTracker(GivenGains(), start="one-point", missed="step")
    warm(scale, tracker, 2)
    works: dict[str, Callable[[], Any]] = {
        "ours": lambda: predictions(tracker, times, plots, alpha),
        "numpy": lambda: handwritten.vectorized(times, plots, alpha, beta),
    }
    apart = difference(works["ours"](), works["numpy"]())
    one, other = np.zeros_like(plots), np.zeros_like(plots)
    works["ours, existing"] = lambda: predictions(tracker, times, plots, alpha, out=one)
    works["numpy, existing"] = lambda: handwritten.vectorized(times, plots, alpha, beta, other)
    found = take_turns(works, 3 * scale.repeats)
    what = f"given gains, {tracks:,} tracks x 2 axes"
    note = (
        "Gains for each track and axis, irregular times common to all, 10 % missed; predictions "
        "kept by NumPy. fuzzytrack makes β from α by a scheduler, NumPy has both. Predictions "
        f"differ by {apart:.1g} m at most."
    )
    return [
        Row(SECTION, f"{what}{how}", _rate(plots, found[f"ours{kind}"]), RATE, "NumPy",
            _rate(plots, found[f"numpy{kind}"]), ratio(found[f"numpy{kind}"], found[f"ours{kind}"]),
            Target(">=", least), note)
        for kind, how, least in (
            ("", "", 5.0), (", existing", ", into existing arrays", 3.0),
        )
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
            note="TwoSpeed of examples/plugin, against the same rule written like the built-in "
            f"kernels. Predictions differ by {apart:.1g} m at most."),
    ]  # fmt: skip
