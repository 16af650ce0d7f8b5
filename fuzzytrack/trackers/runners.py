"""The runner of a tracker, with what was compiled for it; equal trackers share one."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

from fuzzytrack.lanes.program import LaneProgram
from fuzzytrack.lanes.runner import Runner

__all__ = ["Compilable", "runner"]


class Compilable(Hashable, Protocol):
    """What a runner needs of a tracker, see `fuzzytrack.trackers.lane_tracker.LaneTracker`."""

    @property
    def missed(self) -> str:
        """From where time counts: ``elapsed`` or ``step``."""

    def program(self, n_axes: int) -> LaneProgram:
        """Arithmetic of a lane."""


# The cache is looked up by identity first, since comparing two rule bases takes longer than a step.
@dataclass(frozen=True, eq=False)
class _Identity:
    tracker: Compilable

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Identity) and self.tracker is other.tracker

    def __hash__(self) -> int:
        return id(self.tracker)


def runner(tracker: Compilable, n_axes: int) -> Runner:
    """Runner of a tracker; equal trackers share one, and what was compiled for it.

    Parameters
    ----------
    tracker : LaneTracker
    n_axes : int
        Axes of a lane: 1 unless the tracker is coupled.
    """
    return _runner_of_this(_Identity(tracker), n_axes)


@lru_cache(maxsize=256)
def _runner_of_this(key: _Identity, n_axes: int) -> Runner:
    return _runner_of_equal(key.tracker, n_axes)


@lru_cache(maxsize=64)
def _runner_of_equal(tracker: Compilable, n_axes: int) -> Runner:
    return Runner(tracker.program(n_axes), tracker.missed == "elapsed")
