"""Long work, one job after the other: in processes, with progress and what is left."""

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
# Seconds after which a job that waits looks again whether the one before it is stuck.
_LOOK = 1.0
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
    """One job: what it is, how far it is, and how it ended; it waits until it is told to begin.

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
        self.state = "waiting"
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
        """Whether it has begun, and has not ended."""
        return self.state == "running"

    @property
    def ended(self) -> bool:
        """Whether it has ended, in any way."""
        return self.state not in ("waiting", "running")

    @property
    def silent(self) -> float:
        """Seconds since it last made progress."""
        return time.monotonic() - self._heard

    def wait(self) -> None:
        """Tell that it waits for its turn."""
        with self._lock:
            if not self.ended:
                self.owner.report(self, False)

    def begin(self) -> None:
        """Let it run, and tell so before there is progress, which may take a while."""
        with self._lock:
            if not self.ended:
                self.state = "running"
                self._begun = self._heard = time.monotonic()
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
            if self.ended:
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
    """The jobs of a server, of which one runs at a time; the others wait in the order they came.

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
        # The first one runs, the others wait; some may have ended.
        self._line: list[Job] = []
        # Held until the processes of a job that is ended are given up: the next one has others.
        self._changed = threading.Condition()

    def start(self, kind: str, of: int, work: Work, owner: Owner) -> Job:
        """Start a job, which waits for those before it; one whose owner is gone ends for it.

        Raises
        ------
        ValueError
            If one of the same kind and owner has not ended.
        """
        with self._changed:
            self._clear()
            if any(each.kind == kind and each.owner is owner for each in self._line):
                raise ValueError(
                    f"a job ({kind}) is running, or waits for its turn; wait for its end, or "
                    "cancel it"
                )
            job = Job(next(self._numbers), kind, of, owner)
            self._line.append(job)
        # Not one of a pool of threads: a plug-in that hangs would keep the server from ending.
        threading.Thread(target=self._do, args=(job, work), daemon=True).start()
        return job

    def cancel(self, job: Job) -> None:
        """Cancel a job, unless it has ended."""
        with self._changed:
            self._end(job, "cancelled")

    def replace(self, job: Job) -> None:
        """End a job, unless it has ended, for another one that is wanted in its place."""
        with self._changed:
            self._end(job, "replaced")

    def close(self) -> None:
        """End all jobs, and the processes."""
        with self._changed:
            for job in self._line:
                job.end("cancelled")
            self._drop()
            self._changed.notify_all()

    def _clear(self) -> None:
        """Take out jobs that have ended, and a first one that is stuck or that nobody waits for."""
        self._line = [job for job in self._line if not job.ended]
        if not self._line:
            return
        first, *others = self._line
        if first.running and first.silent > SILENCE:
            why = f"no progress for {SILENCE:.0f} s; a tracker, or a plug-in, may hang"
            self._end(first, "failed", why)
        elif others and first.owner.gone:
            self._end(first, "cancelled")
        if first.ended:
            self._line = others

    def _end(self, job: Job, state: str, why: str | None = None) -> None:
        """End a job, with its processes if it has begun, unless it has ended already."""
        had_processes = job.running
        if job.end(state, why):
            if had_processes:
                self._drop()
            self._changed.notify_all()

    def _drop(self) -> None:
        pool, self._pool = self._pool, None
        if pool is not None:
            end_processes(pool)

    def _turn(self, job: Job) -> None:
        """Wait for the turn of a job, and begin it, unless it is ended meanwhile."""
        with self._changed:
            self._clear()
            if not job.ended and self._line[0] is not job:
                job.wait()
            while not job.ended and self._line[0] is not job:
                self._changed.wait(_LOOK)
                self._clear()
            job.begin()

    def _processes_of(self, job: Job) -> ProcessPoolExecutor:
        """Processes for a job; one that has ended gets none."""
        with self._changed:
            if job.ended:
                raise CancelledJobError
            self._pool = self._pool or process_pool(_processes())
            return self._pool

    def _do(self, job: Job, work: Work) -> None:
        """Do the work when it is its turn; runs in a thread of its own."""
        self._turn(job)
        pool = None
        try:
            pool = self._processes_of(job)
            with noted() as job.notes:
                job.finish(work(job, pool))
        except CancelledJobError:
            pass
        except BrokenExecutor:
            with self._changed:
                if self._pool is pool:
                    self._drop()
            job.end("failed", "a process ended, perhaps for lack of memory; try fewer runs")
        except ValueError as failure:
            job.end("failed", self._named(str(failure)))
        except Exception as failure:
            # What a plug-in raises is no mistake of the server.
            job.end("failed", self._named(in_one_sentence(failure)))
        with self._changed:
            self._changed.notify_all()


def _processes() -> int:
    return max(1, min(_MOST_PROCESSES, os.cpu_count() or 1))
