"""Plot by plot: one track, and a scan of many."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from benchmarks import peers
from benchmarks.report import NotMeasured, Row, Target
from benchmarks.scale import Scale
from benchmarks.timing import ratio, take_turns
from benchmarks.work import (
    ALPHA,
    BETA,
    fixed_tracker,
    fuzzy_tracker,
    maneuver_tracker,
    times_and_plots,
    warm,
)
from fuzzytrack.trackers import TrackStore

__all__ = ["scan", "single"]

SECTION = "Streaming (µs a step)"
UNIT = "µs"
#: Asked of one step with fuzzy gains (µs), on a machine on which those others took so long.
LIMIT = 3.0
#: How much longer a scan may take if each track has its own time.
OWN_TIMES = 1.3
THERE = {"FilterPy GHFilter": 2.6, "FilterPy KalmanFilter": 13.5, "Stone Soup Kalman": 210.0}


def _stream(
    tracker: Any, plots: Any, delays: Any = 0.0, sigma: float | None = None
) -> Callable[[], Any]:
    times = [float(k) + delays for k in range(len(plots))]

    def work() -> Any:
        state = tracker.start(plots[0], times[0], sigma)
        for k in range(1, len(plots)):
            state = tracker.step(state, plots[k], times[k], sigma)
        return state

    return work


def _store(tracker: Any, plots: Any, delays: Any) -> Callable[[], Any]:
    def work() -> Any:
        store = TrackStore(tracker, plots.shape[-1])
        slots = store.add(tracker.start(plots[0], delays))
        for k in range(1, len(plots)):
            store.step(slots, plots[k], k + delays)
        return store

    return work


def single(scale: Scale) -> list[Row]:
    """One track of two axes."""
    _, plots = times_and_plots(1, scale.stream_steps, axes=2)
    walk = np.ascontiguousarray(plots[:, 0])
    model = peers.Model(2, 1.0)
    for tracker in (fuzzy_tracker(), fixed_tracker(), maneuver_tracker()):
        warm(scale, tracker, 2)
    works = {
        "fuzzy gains": _stream(fuzzy_tracker(), walk),
        "fixed gains": _stream(fixed_tracker(), walk),
        "maneuver": _stream(maneuver_tracker(), walk, sigma=10.0),
    }
    makers = {
        "FilterPy GHFilter": lambda: peers.filterpy_fixed(ALPHA, BETA),
        "FilterPy KalmanFilter": lambda: peers.filterpy_kalman(model),
        "Stone Soup Kalman": lambda: peers.stonesoup_kalman(model),
    }
    rows = []
    for name, make in makers.items():
        try:
            works[name] = partial(make(), walk)
        except NotMeasured as why:
            rows.append(Row(SECTION, f"one track, against {name}", why=str(why)))
    found = take_turns(works, scale.repeats)
    each = 1e6 / scale.stream_steps
    fuzzy, fixed = found["fuzzy gains"], found["fixed gains"]
    ours = fuzzy.median * each
    rows.insert(
        0,
        Row(SECTION, "one track of 2 axes, fuzzy gains", ours, UNIT, target=Target("<=", LIMIT),
            note="One plot after the other through `step`, which checks them."),
    )  # fmt: skip
    rows.insert(
        1,
        Row(SECTION, "one track of 2 axes, maneuver", found["maneuver"].median * each, UNIT,
            "fixed gains", fixed.median * each, ratio(fixed, found["maneuver"]),
            Target(">=", 0.5), note="A step may take twice as long as with fixed gains."),
    )  # fmt: skip
    for name in (name for name in makers if name in found):
        theirs = found[name].median * each
        if name == "FilterPy GHFilter":
            rows.append(
                Row(SECTION, "one track of 2 axes, fixed gains", fixed.median * each, UNIT, name,
                    theirs, ratio(found[name], fixed),
                    note="FilterPy's filter takes the vector, T = 1 and no missed plot; it checks "
                    "nothing, and its state is changed in place.")
            )  # fmt: skip
        rows.append(
            Row(SECTION, "one track of 2 axes, fuzzy gains", ours, UNIT, name, theirs,
                ratio(found[name], fuzzy), Target(">=", round(THERE[name] / LIMIT, 2)),
                note=f"{name} is not the same filter: it is what a user would use instead. On the "
                f"machine of the targets it took {THERE[name]:g} µs.")
        )  # fmt: skip
    return rows


def scan(scale: Scale) -> list[Row]:
    """A scan of many tracks at once."""
    tracker = fuzzy_tracker()
    # Without a compiled step a scan takes long.
    tracks, steps = scale.scan_tracks, 200 if scale.compiles else 5
    _, plots = times_and_plots(tracks, steps, axes=2)
    warm(scale, tracker, 2)
    # A turning radar sees each track at its own time.
    delays = np.linspace(0.0, 0.5, tracks)
    works = {
        "ours": _stream(tracker, plots),
        "own times": _stream(tracker, plots, delays),
        "store": _store(tracker, plots, delays),
    }
    try:
        track = peers.filterpy_kalman(peers.Model(2, 1.0))
        works["FilterPy"] = lambda: track(plots[:, 0])
    except NotMeasured:
        track = None
    found = take_turns(works, scale.repeats if scale.compiles else 2)
    each = 1e6 / steps
    what = f"scan of {tracks:,} tracks x 2 axes, fuzzy gains"
    ours = found["ours"].median * each
    own = found["own times"].median * each
    rows = [
        Row(SECTION, what, ours, UNIT, target=Target("<=", 60.0)),
        Row(SECTION, f"{what}, times of each track", own, UNIT, "one time for all", ours,
            ratio(found["ours"], found["own times"]), Target(">=", round(1 / OWN_TIMES, 2))),
        Row(SECTION, f"{what}, times of each track, in a store", found["store"].median * each, UNIT,
            "without a store", own, ratio(found["own times"], found["store"])),
    ]  # fmt: skip
    if track is not None:
        rows.append(
            Row(SECTION, what, ours, UNIT, "FilterPy KalmanFilter",
                found["FilterPy"].median * each * tracks,
                ratio(found["FilterPy"], found["ours"], tracks),
                note="FilterPy was given one track, the rest is extrapolated; not the same filter.")
        )  # fmt: skip
    return rows
