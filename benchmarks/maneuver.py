"""The rule base maneuver in batches: against a loop written by hand, and interacting models."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks import handwritten_maneuver
from benchmarks.report import Row, Target
from benchmarks.scale import Scale
from benchmarks.timing import Timing, ratio, take_turns
from benchmarks.work import (
    LEVEL,
    difference,
    maneuver_tracker,
    predictions,
    times_and_plots,
    warm,
)
from fuzzytrack.trackers import three_model_imm

__all__ = ["SECTION", "imm", "loop"]

SECTION = "Rule base maneuver, batch of two-axis tracks (ns a plot of a track, one thread)"
UNIT = "ns"


def _job(scale: Scale, missed: float) -> tuple[Any, Any, Any]:
    """Times, plots, and a standard deviation for each track."""
    times, plots = times_and_plots(scale.tracks // 2, scale.steps, axes=2, missed=missed)
    return times, plots, np.random.default_rng(3).uniform(8.0, 12.0, plots.shape[1])


def _each(plots: Any, timing: Timing) -> float:
    steps, tracks, _ = plots.shape
    return 1e9 * timing.median / (steps * tracks)


def loop(scale: Scale) -> list[Row]:
    """Against a loop that knows the rule base by heart, with and without missed plots."""
    warm(scale, maneuver_tracker(), 2)
    return [
        _against_loop(scale, 0.1, "maneuver, 10 % missed"),
        _against_loop(scale, 0.0, "maneuver, none missed"),
    ]


def _against_loop(scale: Scale, missed: float, what: str) -> Row:
    times, plots, sigmas = _job(scale, missed)
    tracker, of_plots = maneuver_tracker(), sigmas[:, None]
    ours, theirs = np.zeros_like(plots), np.zeros_like(plots)
    found = take_turns(
        {
            "ours": lambda: predictions(tracker, times, plots, of_plots, out=ours),
            "loop": lambda: handwritten_maneuver.maneuver(times, plots, sigmas, LEVEL, theirs),
        },
        scale.repeats,
    )
    return Row(
        SECTION, what, _each(plots, found["ours"]), UNIT, "hand-written Numba loop",
        _each(plots, found["loop"]), ratio(found["loop"], found["ours"]), Target(">=", 0.9),
        note="Predictions into an existing array in both, irregular times. The loop serves two "
        "axes, one level and one noise a track; it uses the Kalman gains as they are, has its "
        "rules worked out by hand, and no checks, no state and no S for gates at the end. Its "
        f"predictions differ by {difference(ours, theirs):.1g} m at most.",
    )  # fmt: skip


def imm(scale: Scale) -> list[Row]:
    """Three interacting models on the same plots."""
    times, plots, sigmas = _job(scale, 0.1)
    trackers = {"maneuver": maneuver_tracker(), "imm-three": three_model_imm(level=LEVEL)}
    works, out = {}, np.zeros_like(plots)
    for name, tracker in trackers.items():
        warm(scale, tracker, 2)
        works[name] = lambda tracker=tracker: predictions(
            tracker, times, plots, sigmas[:, None], out=out
        )
    found = take_turns(works, scale.repeats)
    ours, theirs = found["maneuver"], found["imm-three"]
    return [
        Row(SECTION, "maneuver", _each(plots, ours), UNIT, "imm-three", _each(plots, theirs),
            ratio(theirs, ours), Target(">=", 2.5),
            note="Both in the batch runner, predictions into an existing array, irregular times, "
            "10 % missed: at most 0.4 of its time an update."),
    ]  # fmt: skip
