"""Inputs that the rule base of a tracker had at each plot."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fuzzytrack.arrays import Array
from fuzzytrack.schedulers.fuzzy import FuzzyScheduler
from fuzzytrack.trackers.alpha_beta import AlphaBetaTracker
from fuzzytrack.trackers.base import Tracker

__all__ = ["rule_inputs", "scheduler_of"]


def scheduler_of(tracker: Tracker) -> FuzzyScheduler | None:
    """The fuzzy scheduler of a tracker; None if it has none."""
    found = getattr(tracker, "scheduler", None)
    fits = isinstance(tracker, AlphaBetaTracker) and isinstance(found, FuzzyScheduler)
    return found if fits else None


def rule_inputs(tracker: Tracker, times: Array, z: Array, sigma: Array) -> Array | None:
    """Inputs of the rules along one track.

    Parameters
    ----------
    tracker : Tracker
    times : ndarray, shape (n_steps,)
        s.
    z, sigma : ndarray, shape (n_steps, n_axes)
        Plots and their standard deviations (m); NaN where missed.

    Returns
    -------
    ndarray, shape (n_steps, n_lanes, n_inputs), or None
        One lane for each axis, or a single one where all axes share their gains; NaN where the
        rules were not asked. None if the tracker has no rule base.

    Notes
    -----
    The track is run in plain Python, step by step, with the rules replaced by ones that note what
    they are asked.
    """
    scheduler = scheduler_of(tracker)
    if scheduler is None:
        return None
    asked: list[tuple[float, ...]] = []
    watched = _watched(scheduler, asked.append)
    follower = copy.copy(tracker)
    assert isinstance(follower, AlphaBetaTracker)  # `scheduler_of` finds no others
    object.__setattr__(follower, "scheduler", watched)
    n_axes = z.shape[1]
    lanes = 1 if scheduler.coupled else n_axes
    found = np.full((len(z), lanes, len(scheduler.rules.inputs)), np.nan)
    state = None
    for k, (time, plot, noise) in enumerate(zip(times, z, sigma, strict=True)):
        asked.clear()
        one = follower.run([time], plot[None], noise[None], state=state, keep=())
        state = one.state
        seen = ~np.isnan(plot)
        places = [0] if scheduler.coupled else [j for j in range(n_axes) if seen[j]]
        # At the first plots, and where one was missed, the rules may be asked for nothing.
        if seen.all() and len(asked) == len(places):
            found[k, places] = np.array(asked)[:, : found.shape[2]]
    return found


@dataclass(frozen=True, eq=False, init=False)
class _Watched(FuzzyScheduler):
    """A scheduler of which no other is an equal: compiled code of equal ones is shared."""

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)


def _watched(scheduler: FuzzyScheduler, note: Callable[[tuple[float, ...]], Any]) -> FuzzyScheduler:
    """A copy of a scheduler that notes the inputs of its rules."""
    infer = scheduler.inference

    def watch(signals: tuple[float, ...]) -> tuple[float, ...]:
        note(tuple(signals))
        return infer(signals)

    made = object.__new__(_Watched)
    vars(made).update(vars(scheduler))
    vars(made)["converter"] = scheduler.converter
    vars(made)["inference"] = watch
    return made
