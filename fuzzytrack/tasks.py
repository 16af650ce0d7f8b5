"""Long work: as tasks, in this process or on an executor, and how it reports its progress."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass
from itertools import islice
from multiprocessing import parent_process
from typing import TypeVar

__all__ = ["Progress", "part", "run_tasks"]

#: Called with the share of the work that is done, 0 to 1.
Progress = Callable[[float], None]

# Tasks given to an executor at a time, done or not: bounds what waits in memory.
_AHEAD = 128
# Times that an executor is given a task that fails. Dask's reports a finished task as failed if its
# worker dies while the result is fetched.
_TRIES = 3

Task = TypeVar("Task", bound=Hashable)
Outcome = TypeVar("Outcome")


def part(progress: Progress, low: float, high: float) -> Progress:
    """Progress of one part of the work, from the share `low` to `high` of all of it."""
    return lambda share: progress(low + (high - low) * share)


def run_tasks(
    function: Callable[[Task], Outcome], tasks: Iterable[Task], executor: Executor | None = None
) -> Iterator[tuple[Task, Outcome]]:
    """Call a function with every task, and yield tasks and outcomes as they finish.

    Parameters
    ----------
    function : callable
        Called with one task; it can be called again with the same task. Pickled to an executor of
        other processes.
    tasks : iterable of hashable
        The tasks, each different from the others.
    executor : concurrent.futures.Executor, optional
        Runs the tasks; one after the other in this process unless given.

    Yields
    ------
    task, outcome
        In the order of the tasks without an executor, else in the order in which they finish.

    Raises
    ------
    Exception
        What a task raises. An executor is given a task that fails three times, unless it fails with
        a ValueError, which says that its input is wrong, or the executor itself is broken.

    Notes
    -----
    Tasks that have not begun are canceled when the iteration ends early, by an error, an interrupt
    or because the generator is closed. Warnings of other processes are issued in this one.
    """
    if executor is None:
        for task in tasks:
            yield task, function(task)
        return
    waiting = iter(tasks)
    running: dict[Future[tuple[Outcome | _Wrong, list[Warning]]], Task] = {}
    failures: Counter[Task] = Counter()
    try:
        while True:
            for task in islice(waiting, _AHEAD - len(running)):
                running[executor.submit(_with_warnings, function, task)] = task
            if not running:
                return
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                task = running.pop(future)
                try:
                    outcome, caught = future.result()
                except BrokenExecutor:
                    raise
                except Exception:
                    failures[task] += 1
                    if failures[task] == _TRIES:
                        raise
                    running[executor.submit(_with_warnings, function, task)] = task
                else:
                    for warning in caught:
                        warnings.warn(warning, stacklevel=2)
                    if isinstance(outcome, _Wrong):
                        raise outcome.error
                    yield task, outcome
    finally:
        for future in running:
            future.cancel()


@dataclass(frozen=True)
class _Wrong:
    """In place of an outcome: the error of a task whose input is wrong.

    Raised, it would look like a ValueError of the executor's own; Dask's has one if a worker dies.
    """

    error: ValueError


def _with_warnings(
    function: Callable[[Task], Outcome], task: Task
) -> tuple[Outcome | _Wrong, list[Warning]]:
    """What a function returns for a task, and the warnings that it issues in another process."""
    if parent_process() is None:
        return _outcome(function, task), []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        outcome = _outcome(function, task)
    return outcome, [w.message for w in caught if isinstance(w.message, Warning)]


def _outcome(function: Callable[[Task], Outcome], task: Task) -> Outcome | _Wrong:
    try:
        return function(task)
    except ValueError as error:
        return _Wrong(error)
