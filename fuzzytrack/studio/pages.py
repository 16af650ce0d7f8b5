"""What the pages of the studio work on: sessions, scenarios and results, each page its own."""

from __future__ import annotations

import contextlib
import secrets
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Protocol

from fuzzytrack.studio.folder import Folder
from fuzzytrack.studio.jobs import Job, Jobs, Work
from fuzzytrack.studio.limits import MOST_SESSIONS, RESULT_BYTES
from fuzzytrack.studio.messages import event
from fuzzytrack.studio.run_jobs import Run
from fuzzytrack.studio.session import Session
from fuzzytrack.studio.tracker_texts import listed_trackers
from fuzzytrack.studio.uploads import Uploads
from fuzzytrack.testbed.results import Results

__all__ = ["CommandLine", "Line", "Page", "Studio"]

#: Writes a command line: the command, what follows it, and its options by their names.
CommandLine = Callable[[str, Sequence[str], Mapping[str, object]], str]


# Seconds that a command waits for the one before it.
_PATIENCE = 20
# Seconds without a browser after which nobody waits for the jobs of a page; a reload takes less.
_AWAY = 10.0


class Line(Protocol):
    """A connection to a browser; see `fuzzytrack.studio.connection.Connection`."""

    def send(self, message: str | bytes) -> None:
        """Send a message, from any thread."""

    def move(self) -> None:
        """End the connection, since the page has another one; from any thread."""


class Page:
    """What one page works on.

    Parameters
    ----------
    key : str
        By which the page finds it again after a reload.
    studio : Studio
    session : Session
        The rule base and the scenario that are edited.

    Attributes
    ----------
    version : int
        Grows with every change.
    jobs : dict of str to Job
        The last one of each kind that the page has started, in the order in which they began.
    run : Run or None
        The last Monte Carlo experiment that the page has started.
    """

    def __init__(self, key: str, studio: Studio, session: Session) -> None:
        self.key = key
        self.studio = studio
        self.session = session
        self._lock = threading.Lock()
        self._saving = threading.Lock()
        self.version = 0
        self._drags = 0
        self.jobs: dict[str, Job] = {}
        self.run: Run | None = None
        self.used = time.monotonic()
        self._connection: Line | None = None

    @contextlib.contextmanager
    def turn(self) -> Iterator[None]:
        """Be alone on the page for one command.

        Raises
        ------
        ValueError
            If another command does not come to an end.
        """
        if not self._lock.acquire(timeout=_PATIENCE):
            raise ValueError("this page is busy with work that does not end; open the studio anew")
        try:
            yield
        finally:
            self._lock.release()

    def gesture(self, draft: bool) -> str:
        """Name of the drag that goes on, whose changes are undone together; the last is no draft.

        A change by itself is a drag of its own.
        """
        name = f"drag {self._drags}"
        if not draft:
            self._drags += 1
        return name

    @property
    def connected(self) -> bool:
        """Whether a browser shows it now."""
        return self._connection is not None

    @property
    def gone(self) -> bool:
        """Whether it was closed, and not only to be loaded again."""
        return not self.connected and time.monotonic() - self.used > _AWAY

    def join(self, connection: Line) -> Line | None:
        """Take a connection; gives the one that it had."""
        before, self._connection = self._connection, connection
        self.used = time.monotonic()
        return before

    def leave(self, connection: Line) -> None:
        """Give a connection up, unless the page has another one already."""
        if self._connection is connection:
            self._connection = None
            self.used = time.monotonic()

    def save_draft(self) -> None:
        """Keep texts that are not saved, so that they are there after a start of the server."""
        # One at a time: an older draft must not replace a newer one, or come after it was dropped.
        with self._saving, contextlib.suppress(OSError, ValueError):
            # The folder may be gone, or be full.
            self.session.autosave()

    @property
    def results(self) -> Results:
        """Results of the last Monte Carlo experiment.

        Raises
        ------
        ValueError
            If there are none, or they are no longer kept.
        """
        if self.run is None or self.run.results is None:
            why = "there are no results yet; run an experiment to its end first"
            if "run" in self.jobs and self.jobs["run"].state == "done":
                why = "the results were dropped for large ones of another page; run it again"
            raise ValueError(why)
        return self.run.results

    def start(self, kind: str, of: int, work: Work) -> Job:
        """Start a job; see `fuzzytrack.studio.jobs.Jobs.start`."""
        job = self.studio.jobs.start(kind, of, work, self)
        self.jobs.pop(kind, None)
        self.jobs[kind] = job
        return job

    def cancel(self, number: int) -> Job:
        """Cancel a job that the page has started; one that has ended stays as it is.

        Raises
        ------
        ValueError
            If it is none of the last ones of this page.
        """
        # A copy: another thread may start a job meanwhile.
        for job in list(self.jobs.values()):
            if job.number == number:
                self.studio.jobs.cancel(job)
                return job
        raise ValueError(f"job: this page has no job {number}; a page cancels only its own")

    def replace(self, kind: str) -> None:
        """End the job of a kind that the page has started, if it runs, for another one."""
        if kind in self.jobs:
            self.studio.jobs.replace(self.jobs[kind])

    def report(self, job: Job, with_results: bool) -> None:
        """Tell the page of a job."""
        # It may be given up meanwhile, in another thread.
        connection = self._connection
        if connection is not None:
            connection.send(event("job", job=job.as_json(with_results)))


class Studio:
    """All that a server of the studio holds.

    Parameters
    ----------
    folder : Folder
        Files of the user.
    command : callable, optional
        Writes a command line that does the same as the page.
    """

    def __init__(self, folder: Folder, command: CommandLine | None = None) -> None:
        self.folder = folder
        self.command = command
        self.jobs = Jobs(folder.without_path)
        self.uploads = Uploads(self.folder)
        self._pages: dict[str, Page] = {}
        self._lock = threading.Lock()
        self._trackers: list[dict[str, Any]] | None = None

    def trackers(self) -> list[dict[str, Any]]:
        """Trackers that a page can choose from."""
        if self._trackers is None:
            self._trackers = listed_trackers()
        return self._trackers

    def closed_drafts(self) -> list[str]:
        """Keys of the drafts that no open page goes on with, the latest first."""
        with self._lock:
            shown = {key for key, page in self._pages.items() if page.connected}
        return [key for key in self.folder.drafts() if key not in shown]

    def warm(self) -> None:
        """Do once what takes long for the first time."""
        session = Session()
        session.surfaces(session.reading.rules.output_names)
        session.explain(dict.fromkeys(session.reading.rules.input_names, 0.0))
        self.trackers()

    def open(self, key: str | None) -> Page:
        """The page of a key, with its draft if there is one; a new page without a key.

        Raises
        ------
        ValueError
            If too many are open.
        """
        with self._lock:
            page = self._pages.get(key) if key else None
            if page is None:
                self._make_room()
                page = self._new(key)
                self._pages[page.key] = page
            return page

    def _new(self, key: str | None) -> Page:
        if key is not None and key in self.folder.drafts():
            session = Session(self.folder, key=key)
            # A damaged draft is left where it is.
            with contextlib.suppress(ValueError):
                session.restore(key)
                return Page(key, self, session)
        key = secrets.token_hex(12)
        return Page(key, self, Session(self.folder, key=key))

    def _make_room(self) -> None:
        """Forget the page that was closed first, if there are as many as there may be."""
        if len(self._pages) < MOST_SESSIONS:
            return
        closed = [page for page in self._pages.values() if not page.connected]
        if not closed:
            raise ValueError(f"{MOST_SESSIONS} pages are open; close one, and load this one again")
        del self._pages[min(closed, key=lambda page: page.used).key]

    def make_room_for(self, run: Run, asking: Page) -> None:
        """Forget results of other pages where all together are too large, of closed ones first."""
        with self._lock:
            pages = [page for page in self._pages.values() if page is not asking]
        kept = [(page.connected, page.used, page.run) for page in pages]
        total = run.size
        for _, _, each in sorted(kept, key=lambda found: found[:2], reverse=True):
            if each is not None and each.results is not None:
                total += each.size
                if total > RESULT_BYTES:
                    each.results = None

    def close(self) -> None:
        """End the job that runs, keep drafts of what has changed, and drop recordings."""
        self.jobs.close()
        self.uploads.close()
        for page in self._pages.values():
            page.save_draft()
