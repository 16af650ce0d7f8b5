"""Long work, one job at a time: in processes, with progress, what is left, and an end at once."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from itertools import count
from typing import Any, Protocol

from fuzzytrack.errors import in_one_sentence
from fuzzytrack.studio.limits import SILENCE
from fuzzytrack.studio.notes import noted
from fuzzytrack.workers import end_processes, process_pool

__all__ = ["CancelledJobError", "Job", "Jobs", "Owner", "Work"]

# Shortest time between two reports of one job, s.
_PAUSE = 0.1
# Processes; a computer with more cores keeps some for the page and everything else.
_MOST_PROCESSES = 8


class CancelledJobError(Exception):
    """Raised in the thread of a job that has been canceled, where it reports progress."""


class Owner(Protocol):
    """Who has started a job, and is told of it; see `fuzzytrack.studio.pages.Page`."""

    @property
    def gone(self) -> bool:
        """Whether nobody looks at its jobs any more."""

    def report(self, job: Job, with_results: bool) -> None:
        """Hear of a change of a job, in the thread in which it changes."""


class Job:
    """One job: what it is, how far it is, and how it ended.

    Parameters
    ----------
    number : int
    kind : str
        Such as ``run``.
    of : int
        How much there is to be done, in units that a reader counts.
    owner : Owner
        Is told of every change; after its end no more.
    """

    def __init__(self, number: int, kind: str, of: int, owner: Owner) -> None:
        self.number = number
        self.kind = kind
        self.of = of
        self.owner = owner
        self.state = "running"
        self.error: str | None = None
        self.results: dict[str, Any] | None = None
        self.notes: list[str] = []
        self._share = 0.0
        self._begun = self._heard = time.monotonic()
        self._reported = 0.0
        self._ended: float | None = None
        # Held while it is told what has changed, so that its end is the last of it.
        self._lock = threading.Lock()

    @property
    def running(self) -> bool:
        """Whether it has not ended."""
        return self.state == "running"

    @property
    def silent(self) -> float:
        """Seconds since it last made progress."""
        return time.monotonic() - self._heard

    def begin(self) -> None:
        """Tell that it runs, before there is progress, which may take a while."""
        with self._lock:
            if self.running:
                self.owner.report(self, False)

    def progress(self, share: float) -> None:
        """Take in how much is done; called by the work.

        Raises
        ------
        CancelledJobError
            If the job has ended meanwhile.
        """
        with self._lock:
            if not self.running:
                raise CancelledJobError
            self._heard = time.monotonic()
            self._share = share
            if self._heard - self._reported >= _PAUSE:
                self._reported = self._heard
                self.owner.report(self, False)

    def show(self, results: dict[str, Any]) -> None:
        """Take in results of a part of the work; called by the work."""
        with self._lock:
            if self.running:
                self.results = results
                self.owner.report(self, True)

    def end(self, state: str, error: str | None = None) -> bool:
        """End the job, unless it has ended already; whether it has ended by this."""
        with self._lock:
            if not self.running:
                return False
            self.state, self.error, self._ended = state, error, time.monotonic()
            self.owner.report(self, False)
        return True

    def finish(self, results: dict[str, Any]) -> None:
        """End the job with all results."""
        with self._lock:
            if not self.running:
                return
            self.results, self._share, self.state = results, 1.0, "done"
            self._ended = time.monotonic()
            self.owner.report(self, True)

    def as_json(self, results: bool) -> dict[str, Any]:
        """The job as the page is told of it."""
        spent = (self._ended or time.monotonic()) - self._begun
        left = spent * (1 - self._share) / self._share if self._share > 0 else None
        return {
            "id": self.number,
            "kind": self.kind,
            "done": round(self._share * self.of),
            "of": self.of,
            "seconds": spent,
            "seconds_left": left if self.running else None,
            "state": self.state,
            "error": self.error,
            "results": self.results if results else None,
        }


#: Does the work of a job with some processes, and returns its results.
Work = Callable[[Job, ProcessPoolExecutor], dict[str, Any]]


class Jobs:
    """The jobs of a server, of which one runs at a time.

    Processes stay for the next job, since a new one takes a second to begin. A job that is canceled
    or stuck takes its processes with it.

    Parameters
    ----------
    named : callable, optional
        Puts names of files in the place of paths, in messages.
    """

    def __init__(self, named: Callable[[str], str] = str) -> None:
        self._named = named
        self._numbers = count(1)
        self._pool: ProcessPoolExecutor | None = None
        self._current: Job | None = None
        # Held until the processes of a job that is ended are given up: the next one has others.
        self._lock = threading.Lock()

    def start(self, kind: str, of: int, work: Work, owner: Owner) -> Job:
        """Start a job; one whose owner is gone ends for it.

        Raises
        ------
        ValueError
            If another one is running.
        """
        with self._lock:
            self._end_if_stuck()
            current = self._current
            if current is not None and current.running:
                if current.owner is owner:
                    raise ValueError(
                        f"a job ({current.kind}) is running; wait for its end, or cancel it"
                    )
                if not current.owner.gone:
                    raise ValueError(
                        f"a job ({current.kind}) of another page is running; wait for its end, or "
                        "cancel it there"
                    )
                self._end(current, "cancelled")
            job = self._current = Job(next(self._numbers), kind, of, owner)
            pool = self._pool = self._pool or process_pool(_processes())
        # Not one of a pool of threads: a plug-in that hangs would keep the server from ending.
        threading.Thread(target=self._do, args=(job, work, pool), daemon=True).start()
        return job

    def cancel(self, number: int, owner: Owner) -> Job:
        """Cancel a job; one that has ended stays as it is.

        Raises
        ------
        ValueError
            If no such job is known any more, or it is not one of this owner.
        """
        with self._lock:
            job = self._current
            if job is None or job.number != number:
                raise ValueError(f"job: no job {number} is running")
            if job.owner is not owner:
                raise ValueError(f"job: {number} is a job of another page; cancel it there")
            self._end(job, "cancelled")
        return job

    def replace(self, job: Job) -> None:
        """End a job, unless it has ended, for another one that is wanted in its place."""
        with self._lock:
            self._end(job, "replaced")

    def close(self) -> None:
        """End the job that runs, and the processes."""
        with self._lock:
            if self._current is not None:
                self._current.end("cancelled")
            self._drop()

    def _end_if_stuck(self) -> None:
        """End the job that runs if it has made no progress for too long."""
        job = self._current
        if job is not None and job.running and job.silent > SILENCE:
            why = f"no progress for {SILENCE:.0f} s; a tracker, or a plug-in, may hang"
            self._end(job, "failed", why)

    def _end(self, job: Job, state: str, why: str | None = None) -> None:
        """End a job with its processes, unless it has ended already."""
        if job.end(state, why):
            self._drop()

    def _drop(self) -> None:
        pool, self._pool = self._pool, None
        if pool is not None:
            end_processes(pool)

    def _do(self, job: Job, work: Work, pool: ProcessPoolExecutor) -> None:
        """Do the work; runs in a thread of its own."""
        job.begin()
        try:
            with noted() as job.notes:
                job.finish(work(job, pool))
        except CancelledJobError:
            pass
        except BrokenExecutor:
            with self._lock:
                if self._pool is pool:
                    self._drop()
            job.end("failed", "a process ended, perhaps for lack of memory; try fewer runs")
        except ValueError as failure:
            job.end("failed", self._named(str(failure)))
        except Exception as failure:
            # What a plug-in raises is no mistake of the server.
            job.end("failed", self._named(in_one_sentence(failure)))


def _processes() -> int:
    return max(1, min(_MOST_PROCESSES, os.cpu_count() or 1))
