"""Speed of the tracker on this machine: streaming and batch, fixed and fuzzy gains.

Every figure is the median of repeats that take turns, so that a busy machine slows all of them
alike; ratios are steadier than times. Compilation is timed apart.
"""

from __future__ import annotations

import argparse
import json
import platform
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import fuzzytrack as ft
from fuzzytrack.gains import noise_ratio

STREAM_STEPS = 400


def trackers() -> dict[str, ft.AlphaBetaTracker]:
    """The trackers that are measured."""
    rules = ft.load_rulebase("stiffness-damping")
    return {
        "fixed": ft.AlphaBetaTracker(ft.FixedGains(0.5377, 0.2018)),
        "fuzzy exact": ft.AlphaBetaTracker(ft.FuzzyScheduler(rules)),
        "fuzzy table": ft.AlphaBetaTracker(ft.FuzzyScheduler(rules, method="table")),
    }


def seconds(work: Callable[[], Any]) -> float:
    """Wall-clock time of one call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def take_turns(works: dict[str, Callable[[], Any]], repeats: int) -> dict[str, float]:
    """Median time of each, measured in turns."""
    times: dict[str, list[float]] = {name: [] for name in works}
    for _ in range(repeats):
        for name, work in works.items():
            times[name].append(seconds(work))
    return {name: statistics.median(values) for name, values in times.items()}


def stream(tracker: ft.AlphaBetaTracker, plots: np.ndarray) -> Callable[[], None]:
    """One two-axis track, plot by plot."""

    def work() -> None:
        state = tracker.start(plots[0], 0.0)
        for k in range(1, len(plots)):
            state = tracker.step(state, plots[k], float(k))

    return work


def filterpy_stream(plots: np.ndarray) -> Callable[[], None] | None:
    """The same track through FilterPy's fixed-gain filter, one axis after the other."""
    try:
        from filterpy.gh import GHFilter
    except ImportError:
        return None

    def work() -> None:
        filters = [GHFilter(x=x, dx=0.0, dt=1.0, g=0.5377, h=0.2018) for x in plots[0]]
        for plot in plots[1:]:
            for axis, filter_ in enumerate(filters):
                filter_.update(plot[axis])

    return work


def measure(tracks: int, steps: int, repeats: int) -> dict[str, Any]:
    """All figures, as a dict that `show` prints."""
    random = np.random.default_rng(1)
    walk = np.cumsum(random.normal(0.0, 10.0, (STREAM_STEPS, 2)), axis=0)
    works = {name: stream(tracker, walk) for name, tracker in trackers().items()}
    other = filterpy_stream(walk)
    if other is not None:
        works["FilterPy GHFilter"] = other
    streaming = take_turns(works, repeats)

    times = np.arange(float(steps))
    plots = np.cumsum(random.normal(0.0, 10.0, (steps, tracks, 1)), axis=0)
    batches = {
        name: (lambda tracker=tracker: tracker.run(times, plots))
        for name, tracker in trackers().items()
    }
    first = {name: seconds(work) for name, work in batches.items()}
    alpha, beta = random.uniform(0.05, 0.95, (2, 1_000_000))
    ratios = take_turns({"noise_ratio": lambda: noise_ratio(alpha, beta)}, repeats)
    batch = take_turns(batches, repeats)
    return {
        "machine": platform.processor() or platform.machine(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "stream_microseconds_a_step": {k: 1e6 * v / STREAM_STEPS for k, v in streaming.items()},
        "batch": {"tracks": tracks, "axes": 1, "steps": steps},
        "batch_million_updates_a_second": {k: tracks * steps / v / 1e6 for k, v in batch.items()},
        "first_run_seconds": first,
        "million_noise_ratios_seconds": ratios["noise_ratio"],
    }


def show(figures: dict[str, Any]) -> None:
    """Print the figures for people."""
    from rich.console import Console
    from rich.table import Table

    batch = figures["batch"]
    table = Table(title=f"fuzzytrack on {figures['machine']}, Python {figures['python']}")
    table.add_column("gains")
    table.add_column("stream, 2 axes\n(µs a step)", justify="right")
    table.add_column(
        f"batch, {batch['tracks']:,} tracks x {batch['steps']} steps\n(million updates/s)",
        justify="right",
    )
    table.add_column("first run, with\ncompilation (s)", justify="right")
    for name, stream_time in figures["stream_microseconds_a_step"].items():
        speed = figures["batch_million_updates_a_second"].get(name)
        first = figures["first_run_seconds"].get(name)
        table.add_row(
            name,
            f"{stream_time:.1f}",
            "" if speed is None else f"{speed:.1f}",
            "" if first is None else f"{first:.1f}",
        )
    Console().print(table)
    Console().print(
        "A batch keeps prediction, estimate, velocity, acceleration, innovation and three gains of "
        "every update, 64 bytes in all; an update is one axis of one track, on one core."
    )
    print(f"1,000,000 noise ratios: {figures['million_noise_ratios_seconds']:.3f} s")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tracks", type=int, default=100_000)
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", action="store_true", help="print JSON only")
    arguments = parser.parse_args()
    figures = measure(arguments.tracks, arguments.steps, arguments.repeats)
    print(json.dumps(figures, indent=2)) if arguments.json else show(figures)


if __name__ == "__main__":
    main()
