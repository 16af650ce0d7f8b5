"""Long work, one job at a time: in processes, with progress, what is left, and an end at once."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from itertools import count
from typing import Any

from fuzzytrack.errors import in_one_sentence
from fuzzytrack.studio.limits import SILENCE
from fuzzytrack.studio.notes import noted
from fuzzytrack.workers import end_processes, process_pool

__all__ = ["CancelledJobError", "Job", "Jobs", "Report", "Work"]

# Shortest time between two reports of one job, s.
_PAUSE = 0.1
# Processes; a computer with more cores keeps some for the page and everything else.
_MOST_PROCESSES = 8


class CancelledJobError(Exception):
    """Raised in the thread of a job that has been canceled, where it reports progress."""


class Job:
    """One job: what it is, how far it is, and how it ended.

    Parameters
    ----------
    number : int
    kind : str
        Such as ``run``.
    of : int
        How much there is to be done, in units that a reader counts.
    report : callable
        Called with the job and whether it has new results whenever something changes, in the thread
        in which it changes.
    """

    def __init__(self, number: int, kind: str, of: int, report: Report) -> None:
        self.number = number
        self.kind = kind
        self.of = of
        self.state = "running"
        self.error: str | None = None
        self.results: dict[str, Any] | None = None
        self.notes: list[str] = []
        self._report = report
        self._share = 0.0
        self._begun = self._heard = time.monotonic()
        self._reported = 0.0
        self._ended: float | None = None
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
        self._report(self, False)

    def progress(self, share: float) -> None:
        """Take in how much is done; called by the work.

        Raises
        ------
        CancelledJobError
            If the job has ended meanwhile.
        """
        if not self.running:
            raise CancelledJobError
        self._heard = time.monotonic()
        self._share = share
        if self._heard - self._reported >= _PAUSE:
            self._reported = self._heard
            self._report(self, False)

    def show(self, results: dict[str, Any]) -> None:
        """Take in results of a part of the work; called by the work."""
        if self.running:
            self.results = results
            self._report(self, True)

    def end(self, state: str, error: str | None = None) -> bool:
        """End the job, unless it has ended already; whether it has ended by this."""
        with self._lock:
            if not self.running:
                return False
            self.state, self.error, self._ended = state, error, time.monotonic()
        self._report(self, False)
        return True

    def finish(self, results: dict[str, Any]) -> None:
        """End the job with all results."""
        with self._lock:
            if not self.running:
                return
            self.results, self._share, self.state = results, 1.0, "done"
            self._ended = time.monotonic()
        self._report(self, True)

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


#: Called with a job, and whether it has new results.
Report = Callable[[Job, bool], None]
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
        self._lock = threading.Lock()

    def start(self, kind: str, of: int, work: Work, report: Report) -> Job:
        """Start a job.

        Raises
        ------
        ValueError
            If another one is running.
        """
        with self._lock:
            self.check()
            if self._current is not None and self._current.running:
                raise ValueError(
                    f"a job ({self._current.kind}) is running; wait for its end, or cancel it"
                )
            job = self._current = Job(next(self._numbers), kind, of, report)
            pool = self._pool = self._pool or process_pool(_processes())
        # Not one of a pool of threads: a plug-in that hangs would keep the server from ending.
        threading.Thread(target=self._do, args=(job, work, pool), daemon=True).start()
        return job

    def cancel(self, number: int) -> Job:
        """Cancel a job; one that has ended stays as it is.

        Raises
        ------
        ValueError
            If no such job is known any more.
        """
        job = self._current
        if job is None or job.number != number:
            raise ValueError(f"job: no job {number} is running")
        if job.end("cancelled"):
            self._drop()
        return job

    def check(self) -> None:
        """End the job that runs if it has made no progress for too long."""
        job = self._current
        if job is not None and job.running and job.silent > SILENCE:
            why = f"no progress for {SILENCE:.0f} s; a tracker, or a plug-in, may hang"
            if job.end("failed", why):
                self._drop()

    def close(self) -> None:
        """End the job that runs, and the processes."""
        if self._current is not None:
            self._current.end("cancelled")
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
