"""Times of jobs that take turns, and their ratios."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

__all__ = ["Ratio", "Timing", "ratio", "take_turns"]

Work = Callable[[], Any]


@dataclass(frozen=True)
class Timing:
    """Wall-clock times of one job (s), round by round."""

    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        return statistics.median(self.seconds)

    @property
    def best(self) -> float:
        return min(self.seconds)


@dataclass(frozen=True)
class Ratio:
    """Ratio of two jobs, taken in every round: median and quartiles."""

    median: float
    low: float
    high: float


def take_turns(works: Mapping[str, Work], repeats: int) -> dict[str, Timing]:
    """Time jobs in turns, so that a busy machine slows all of them alike.

    Each is done once before, untimed, so compilation and first accesses to memory are not measured.
    Every second round goes backwards, lest one job always find the cache as the same other left it.
    """
    for work in works.values():
        work()
    times: dict[str, list[float]] = {name: [] for name in works}
    order = list(works)
    for _ in range(repeats):
        for name in order:
            start = time.perf_counter()
            works[name]()
            times[name].append(time.perf_counter() - start)
        order.reverse()
    return {name: Timing(tuple(seconds)) for name, seconds in times.items()}


def ratio(upper: Timing, lower: Timing, factor: float = 1.0) -> Ratio:
    """Ratio of two timings of the same rounds, times a factor for unequal amounts of work."""
    ratios = [factor * u / max(v, 1e-9) for u, v in zip(upper.seconds, lower.seconds, strict=True)]
    if len(ratios) < 2:
        return Ratio(ratios[0], ratios[0], ratios[0])
    low, middle, high = statistics.quantiles(ratios, n=4, method="inclusive")
    return Ratio(middle, low, high)
