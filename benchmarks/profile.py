"""Where the time of a batch goes: the run, its compiled loop, a step, and the memory."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.report import NotMeasured, Row
from benchmarks.scale import Scale
from benchmarks.timing import ratio, take_turns
from benchmarks.work import (
    fixed_tracker,
    fuzzy_tracker,
    predictions,
    times_and_plots,
    updates_a_second,
    warm,
)
from fuzzytrack.kernels.llvm import call, pointer
from fuzzytrack.lanes import block_loop
from fuzzytrack.lanes.layout import BLOCK, OUTPUTS, aligned
from fuzzytrack.trackers.runners import runner

__all__ = ["parts", "where"]

SECTION = "Where the time of a batch goes (ms, float64, one thread)"
UNIT = "ms"
#: Steps of plots that go round in the first cache, beside the state of a block.
ROUND = 4

Array = NDArray[np.float64]
Work = Callable[[], Any]


def where(scale: Scale) -> list[Row]:
    """Parts of a batch with fixed and with fuzzy gains."""
    if scale.name != "full":
        raise NotMeasured("in a full run only")
    named = {"fixed gains": fixed_tracker(), "fuzzy exact": fuzzy_tracker()}
    return [row for name, tracker in named.items() for row in parts(scale, name, tracker)]


def parts(scale: Scale, name: str, tracker: Any) -> list[Row]:
    """Parts of a batch, against the whole run in the same rounds."""
    times, plots = times_and_plots(scale.tracks, scale.steps, missed=0.1)
    warm(scale, tracker, 1)
    result, copied = np.zeros(plots.size), np.zeros_like(plots)
    works: dict[str, Work] = {
        "whole": lambda: predictions(tracker, times, plots),
        "loop": _loop(tracker, times, plots, result),
        "no output": _loop(tracker, times, plots, np.empty(0)),
        "step": _steps(tracker, plots),
        "fill": lambda: np.full(plots.shape, 1.0),
        "copy": lambda: np.copyto(copied, plots),
    }
    found = take_turns(works, scale.repeats)
    whole = found["whole"]
    speed = updates_a_second(plots, found["step"].median)
    notes = {
        "loop": ("compiled loop, into an existing result",
                    "With new lanes each time. The whole run also has checks, and the first "
                    "access to a new result."),
        "no output": ("compiled loop, without output",
                      "Predictions go to one block in the cache."),
        "step": ("steady steps alone, one block in the first cache",
                 f"For as many updates: {speed:.4g} M/s. Plots, state and predictions stay there."),
        "fill": ("memory: filling a new result", "np.full; most of it is the first access."),
        "copy": ("memory: copying the plots", "Into an existing array."),
    }  # fmt: skip
    rows = [
        Row(SECTION, f"{name}, whole `run`", 1e3 * whole.median, UNIT,
            note=f"{scale.tracks:,} tracks x {scale.steps} steps, {plots.size / 1e6:.3g} million "
            "updates; a ratio below is the time of this over that of the part."),
    ]  # fmt: skip
    for key, (what, note) in notes.items():
        rows.append(
            Row(SECTION, f"{name}, {what}", 1e3 * found[key].median, UNIT, "whole `run`",
                1e3 * whole.median, ratio(whole, found[key]), note=note)
        )  # fmt: skip
    return rows


def _loop(tracker: Any, times: Array, plots: Array, predicted: Array) -> Work:
    """The loop that `run` calls after its checks; an empty array gets no predictions."""
    core, (steps, tracks, _) = runner(tracker, 1), plots.shape
    fresh = core.fresh(tracks).reshape(-1)
    lanes, nothing = fresh.copy(), np.empty(0)
    outputs = (predicted, *(nothing for _ in OUTPUTS[1:]))
    steady = (core.steady_code(False, common).address for common in (True, False))
    code = (core.step_code().address, *steady, False, core.elapsed)
    room = core.room(np.float64)
    # One time and one sigma for all tracks.
    given = (
        plots.reshape(-1),
        times,
        np.full(1, np.nan),
        (1, 0),
        (0, 0, 0),
        lanes,
        outputs,
        nothing,
    )
    run, places = block_loop.compiled_run(), core.places

    def work() -> None:
        lanes[:] = fresh
        run(*code, *places, *room, steps, tracks, 0, tracks, *given)

    return work


def _steps(tracker: Any, plots: Array) -> Work:
    """The steady step of one block over and over, as many updates as the plots have."""
    core = runner(tracker, 1)
    steady, buffer = core.steady_code(False, True).address, aligned(core.rows.total * BLOCK)
    # Tracks that stand at 0 and have seen two plots.
    buffer[core.rows.plots * BLOCK : (core.rows.plots + 1) * BLOCK] = 2.0
    few = aligned(ROUND * BLOCK)
    few[:] = np.resize(plots[-ROUND:].reshape(-1), few.size)
    predicted = aligned(BLOCK)
    rounds = max(1, plots.size // few.size)
    return lambda: _go_round(steady, buffer, few, predicted, rounds)


@numba.njit(nogil=True, cache=True)
def _go_round(steady, buffer, plots, predicted, rounds):
    for _ in range(rounds):
        for k in range(ROUND):
            call(
                steady,
                (pointer(buffer, 0), BLOCK, 1.0, pointer(plots, k * BLOCK), pointer(predicted, 0)),
            )
