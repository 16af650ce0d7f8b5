"""A live run from the first item of a feed to the last, which is saved, and goes on from there."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from fuzzytrack.cli.complaints import one_line
from fuzzytrack.cli.interrupts import Interrupts
from fuzzytrack.cli.output import say_aside
from fuzzytrack.errors import DataError
from fuzzytrack.io.line_target import LineTarget
from fuzzytrack.recordings.resumed_lines import ResumedLines
from fuzzytrack.recordings.run_state import RunState
from fuzzytrack.recordings.state_file import StateFile

__all__ = ["Feed", "LiveRun", "SavedState", "Stream"]

# Seconds of one wait. Ctrl-C that comes just before a wait does not end it, and is seen after it.
_LONGEST_WAIT = 1.0


class Stream(Protocol):
    """Items of a feed as they come."""

    def take(self, timeout: float | None = None) -> list[bytes] | None:
        """Take those that are there; none if none has come in time, None at the end."""


class Feed(Protocol):
    """What answers the items of a feed."""

    @property
    def begun(self) -> bool:
        """Whether the first items have said how the others are read."""

    @property
    def header(self) -> bytes:
        """First line of the answers; empty if there is none."""

    @property
    def pause_after(self) -> float | None:
        """Seconds without an item after which `pause` is due; None if it never is."""

    def push(self, items: Sequence[bytes]) -> bytes:
        """Take items, and give the answers to them."""

    def pause(self) -> bytes:
        """Answers that need not wait for more items."""

    def finish(self) -> bytes:
        """End the feed, and give the last answers."""


@dataclass(frozen=True)
class SavedState:
    """Options of a live run that is saved.

    Attributes
    ----------
    path : str or None
        File of the state.
    feed : str or None
        Whether items come ``again`` from the first one, or go ``onward``.
    """

    path: str | None = None
    feed: str | None = None

    def __post_init__(self) -> None:
        if self.feed not in (None, "again", "onward"):
            raise ValueError(f"--feed: expected again or onward, got {self.feed!r}")
        if self.feed is not None and self.path is None:
            raise ValueError("--feed: says how to go on from a state; --state names its file")

    def check_unused(self) -> None:
        """Raise ValueError if one is given, for a command that follows no feed."""
        for option, given in (("--state", self.path), ("--feed", self.feed)):
            if given is not None:
                raise ValueError(f"{option}: is for a live feed; give --follow as well")

    def check(self, output: str | None) -> None:
        """Raise ValueError if the state would be written where the answers are."""
        if None not in (self.path, output) and _same(str(self.path), str(output)):
            raise ValueError("--state: is the file of --output; name another")


def _same(one: str, other: str) -> bool:
    return Path(one).resolve() == Path(other).resolve()


class LiveRun:
    """A run from the first item to the last.

    Parameters
    ----------
    feed : Feed
    stream : Stream
        Where items come from.
    target : LineTarget
        Where the answers go.
    say_sums : callable
        Prints what there was, at the end.
    saved : SavedState
        Where the state is, and how the feed goes on.
    kind : type of RunState
        What makes a state of the feed.
    """

    def __init__(
        self,
        feed: Feed,
        stream: Stream,
        target: LineTarget,
        say_sums: Callable[[], None],
        saved: SavedState,
        kind: Any,
    ) -> None:
        self._feed, self._stream, self._target = feed, stream, target
        self._say_sums, self._kind = say_sums, kind
        self._pause_at: float | None = None
        self._resumed: ResumedLines | None = None
        self._file = None if saved.path is None else StateFile(saved.path)
        if self._file is not None and os.path.exists(self._file.path):
            state: RunState = kind.load(self._file.path)
            state.resume(feed, self._file.path)  # type: ignore[attr-defined]
            target.resume(state.written)
            if saved.feed != "onward":
                self._resumed = ResumedLines(state)
            say_aside(f"goes on after line {state.lines} of the feed")

    def go(self) -> None:
        """Answer items until they end or the user ends it, or until nobody reads the answers.

        Raises
        ------
        KeyboardInterrupt
            If the user ends it, after all is saved.
        """
        with Interrupts() as interrupts:
            try:
                self._answer_all(interrupts)
                self._end(interrupted=interrupts.wanted)
            except BrokenPipeError:
                # The answers since the last save have not been read, so that stays.
                pass
            finally:
                if self._feed.begun:
                    self._say_sums()
        if interrupts.wanted:
            raise KeyboardInterrupt

    def _answer_all(self, interrupts: Interrupts) -> None:
        while not interrupts.wanted:
            timeout = self._timeout()
            items = interrupts.wait(lambda: self._stream.take(timeout))  # noqa: B023
            if items is None:
                break
            if self._resumed is not None:
                items = self._resumed.new(items)
            if items:
                self._answer(self._feed.push(items))
                wait = self._feed.pause_after
                self._pause_at = None if wait is None else time.monotonic() + wait
            elif self._pause_at is not None and time.monotonic() >= self._pause_at:
                self._pause_at = None
                self._answer(self._feed.pause())
            if self._file is not None and self._file.due_in == 0.0:
                self._save(self._file)

    def _timeout(self) -> float:
        """Seconds until something is due without an item, or a second at most."""
        due = [_LONGEST_WAIT]
        if self._file is not None and self._file.due_in is not None:
            due.append(self._file.due_in)
        if self._pause_at is not None:
            due.append(max(0.0, self._pause_at - time.monotonic()))
        return min(due)

    def _end(self, *, interrupted: bool) -> None:
        if self._resumed is not None and not interrupted:
            self._resumed.finish()
        if self._file is not None and self._feed.begun:
            # Before the last answers, so that a run goes on as if the feed had not ended.
            self._save(self._file)
        if not self._feed.begun and interrupted:
            self._say_why()
        elif not interrupted or self._file is None:
            answers = self._feed.finish()
            # Without an answer the header is written alone, as for a file without tracks.
            self._target.write(self._feed.header, answers)
        if self._file is not None:
            self._file.wait()

    def _say_why(self) -> None:
        """Say why nothing was answered, if the feed had anything."""
        try:
            self._write(self._feed.finish())
        except DataError as error:
            say_aside(one_line(error).removeprefix("error: "))

    def _save(self, file: StateFile) -> None:
        """Save the state; a run goes on without, as long as it can say so."""
        try:
            file.save(lambda: self._kind.of(self._feed, self._target.written))
        except OSError as error:
            why = one_line(error).removeprefix("error: ")
            say_aside(f"{file.path}: the state was not saved: {why}")

    def _answer(self, answers: bytes) -> None:
        self._write(answers)
        # Before the first row there is nothing to save.
        if self._file is not None and self._feed.begun:
            self._file.has_changed = True

    def _write(self, answers: bytes) -> None:
        if answers:
            self._target.write(self._feed.header, answers)
