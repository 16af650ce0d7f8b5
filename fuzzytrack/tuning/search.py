"""The search for the parameters with the least loss, by CMA-ES; several of them side by side."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from typing import Any

import numpy as np

from fuzzytrack.tasks import Progress, run_tasks
from fuzzytrack.tuning.journal import Journal
from fuzzytrack.tuning.parameters import Numbers, Space

__all__ = ["Search", "run_searches", "search_seed"]

#: Number of a search, and numbers that it asks for.
Task = tuple[int, tuple[Numbers, ...]]


class Search:
    """A search by CMA-ES that asks for the losses of some numbers, a generation at a time.

    Parameters
    ----------
    space : Space
        At least one parameter.
    seed : int
        The same seed and losses give the same numbers.
    trials : int
        Number of trials after which it ends.

    Attributes
    ----------
    losses : list of float
        What it was told so far, in order. A search that is told the same again continues where
        this one is.
    best : tuple of float
        Numbers with the least loss so far.
    best_loss : float

    Notes
    -----
    Hansen (2016), The CMA evolution strategy: a tutorial. It begins with the start of the space
    itself, so that what it finds is not worse.
    """

    def __init__(self, space: Space, seed: int, trials: int) -> None:
        from cmaes import CMA

        self.space, self.trials = space, trials
        self.losses: list[float] = []
        self.best, self.best_loss = space.start, math.inf
        self._optimizer: Any = CMA(
            mean=np.zeros(len(space.parameters)), sigma=1.0, bounds=space.bounds, seed=seed
        )
        self._asked: list[Any] = [np.zeros(len(space.parameters)), *self._generation()]

    def __repr__(self) -> str:
        return f"<Search: {len(self.losses)} of {self.trials} trials>"

    @property
    def finished(self) -> bool:
        """Whether the trials are used up, or they no longer differ."""
        return len(self.losses) >= self.trials or (
            bool(self.losses) and bool(self._optimizer.should_stop())
        )

    def ask(self) -> list[Numbers]:
        """Numbers to be tried next."""
        return [self.space.numbers(place) for place in self._asked]

    def tell(self, losses: Sequence[float]) -> None:
        """Take the losses of the numbers that were asked for, in the same order."""
        for numbers, loss in zip(self.ask(), losses, strict=True):
            if loss < self.best_loss:
                self.best, self.best_loss = numbers, loss
        # The start, which is tried first, is no member of a generation.
        count = self._optimizer.population_size
        self._optimizer.tell(list(zip(self._asked, losses, strict=True))[-count:])
        self.losses += losses
        self._asked = self._generation()

    def _generation(self) -> list[Any]:
        return [self._optimizer.ask() for _ in range(self._optimizer.population_size)]

    def replay(self, losses: Sequence[float]) -> None:
        """Take the losses of an earlier search, as far as its generations are whole."""
        told = 0
        while len(losses) - told >= len(self._asked) and not self.finished:
            count = len(self._asked)
            self.tell(losses[told : told + count])
            told += count


def search_seed(seed: int, number: int) -> int:
    """Seed of one of several searches."""
    return int(np.random.SeedSequence([seed, number]).generate_state(1)[0])


def run_searches(
    searches: Sequence[Search],
    losses: Callable[[Task], list[float]],
    executor: Executor | None,
    journal: Journal,
    progress: Progress | None,
) -> None:
    """Do all searches, a generation of each at a time; continues what the journal holds.

    Parameters
    ----------
    searches : sequence of Search
    losses : callable
        ``losses((k, numbers))``: those of the numbers that search k asks for.
    executor : concurrent.futures.Executor or None
        Runs them; in this process unless given.
    journal : Journal
        Where the losses are kept.
    progress : callable or None
        Called with the share of the trials that are done.
    """
    for search, told in zip(searches, journal.losses, strict=False):
        search.replay(told)
    while True:
        tasks = [(k, tuple(s.ask())) for k, s in enumerate(searches) if not s.finished]
        if not tasks:
            return
        try:
            for (number, _), found in run_tasks(losses, tasks, executor):
                searches[number].tell(found)
                if progress is not None:
                    progress(_share(searches))
        finally:
            journal.write([search.losses for search in searches])


def _share(searches: Sequence[Search]) -> float:
    done = sum(s.trials if s.finished else min(len(s.losses), s.trials) for s in searches)
    return done / sum(search.trials for search in searches)
