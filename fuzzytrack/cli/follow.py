"""What `track --follow` does: lines of standard input answered as they come."""

from __future__ import annotations

import gc
import math
import os
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from threading import Thread, Timer
from typing import Any

from fuzzytrack.cli.complaints import one_line, printable
from fuzzytrack.cli.noise_words import noise_sentence
from fuzzytrack.cli.output import say_aside
from fuzzytrack.cli.output_file import STANDARD_OUTPUT
from fuzzytrack.errors import DataError
from fuzzytrack.io.byte_stream import STANDARD_INPUT
from fuzzytrack.io.files import check_output
from fuzzytrack.io.formats import PARQUET
from fuzzytrack.io.line_stream import LineStream
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.track_formats import is_geo
from fuzzytrack.plurals import counted
from fuzzytrack.recordings.judging import GateWidth
from fuzzytrack.recordings.live import LiveTracks
from fuzzytrack.recordings.live_feed import LiveFeed
from fuzzytrack.recordings.live_state import LiveState
from fuzzytrack.recordings.resumed_lines import ResumedLines

__all__ = ["FollowOptions", "follow"]

# Seconds between two saves of the state, and from which on a compilation is told of.
_SAVE_EVERY, _LONG = 5.0, 2.0
# A feed that has ended after fewer lines is done sooner without compiled code.
_FEW = 20_000


@dataclass(frozen=True, kw_only=True)
class FollowOptions:
    """Options of `track` that are those of a live run alone.

    Attributes
    ----------
    lateness, forget, state, feed
        See the command.
    compiled : bool
        Whether to compile before the first answer.
    """

    lateness: float | None = None
    forget: float | None = None
    state: str | None = None
    feed: str | None = None
    compiled: bool = True

    def __post_init__(self) -> None:
        if self.feed not in (None, "again", "onward"):
            raise ValueError(f"--feed: expected again or onward, got {self.feed!r}")
        if self.feed is not None and self.state is None:
            raise ValueError("--feed: says how to go on from a state; --state names its file")

    def check_unused(self) -> None:
        """Raise ValueError if one is given, for a command that follows no feed."""
        for name in ("lateness", "forget", "state", "feed"):
            if getattr(self, name) is not None:
                raise ValueError(f"--{name}: is for a live feed; give --follow as well")
        if not self.compiled:
            raise ValueError("--no-compile: is for a live feed; give --follow as well")


def follow(
    files: list[str],
    reading: Reading,
    tracker: str | None,
    gate: GateWidth,
    output: str | None,
    options: FollowOptions,
    *,
    json: bool,
    quote_formulas: bool,
) -> None:
    """Answer the lines of standard input until it ends.

    Raises
    ------
    KeyboardInterrupt
        If the user ends it, after all is saved.
    ValueError, DataError, OSError
        As the other commands.
    """
    _check(files, output, options)
    feed = LiveFeed(
        reading,
        tracker,
        gate=gate,
        lateness=options.lateness or 0.0,
        forget=options.forget,
        json=True if json else None,
        quote_formulas=quote_formulas,
        tell=lambda fault: say_aside(printable(fault)),
        begin=lambda tracks: _begin(tracks, lines, options.compiled),
    )
    lines = LineStream(sys.stdin.fileno())
    target = _Target(None if output == STANDARD_OUTPUT else output)
    try:
        _Run(feed, lines, target, options).go()
    finally:
        target.close()
        gc.unfreeze()


def _check(files: list[str], output: str | None, options: FollowOptions) -> None:
    """Raise ValueError for what a live run cannot do."""
    if files != [STANDARD_INPUT]:
        raise ValueError("--follow: reads standard input; write - in place of a file")
    if output is None or output == STANDARD_OUTPUT:
        return
    if is_geo(output) or Path(output).suffix.lower() in PARQUET:
        raise ValueError(
            f"--output: {output}: needs the whole recording; --follow writes CSV or lines of JSON"
        )
    if options.state is not None and Path(options.state).resolve() == Path(output).resolve():
        raise ValueError("--state: is the file of --output; name another")


def _begin(tracks: LiveTracks, lines: LineStream, compiled: bool) -> None:
    """Say how the plots are read, and compile what tracks them, before the first answer."""
    ready = tracks.prepared
    decoder = ready.files.decoder
    say_aside(f"columns: {decoder.columns.sentence}")
    say_aside(f"tracker: {ready.spec}")
    noise = noise_sentence(decoder)
    if noise:
        say_aside(f"sigma: {noise}")
    for note in ready.findings.notes:
        say_aside(f"note: {note}")
    if compiled and not lines.look_ahead(_FEW):
        told = Timer(_LONG, say_aside, ("compiling the tracker; the next run finds it on disk",))
        told.daemon = True
        told.start()
        try:
            tracks.warm_up()
        finally:
            told.cancel()
    # What is there now stays; the collector need not look at it again and again.
    gc.collect()
    gc.freeze()


class _Run:
    """A run from the first line to the last."""

    def __init__(
        self, feed: LiveFeed, lines: LineStream, target: _Target, options: FollowOptions
    ) -> None:
        self.feed, self.lines, self.target = feed, lines, target
        self._resumed: ResumedLines | None = None
        self._state = None if options.state is None else _StateFile(options.state)
        if self._state is not None and self._state.exists():
            state = self._state.load()
            state.resume(feed, self._state.path)
            target.resume(state.written)
            if options.feed != "onward":
                self._resumed = ResumedLines(state)
            say_aside(f"goes on after line {state.lines} of the feed")

    def go(self) -> None:
        """Answer lines until they end or the user ends it, or until nobody reads the answers."""
        with _Interrupts() as interrupts:
            try:
                self._answer_all(interrupts)
                if self._state is not None:
                    self._state.save(self.feed, self.target.written, wait=True)
            except BrokenPipeError:
                # The answers since the last save have not been read, so that stays.
                pass
            finally:
                if self.feed.tracks is not None:
                    _say_sums(self.feed, self.feed.tracks)
        if interrupts.wanted:
            raise KeyboardInterrupt

    def _answer_all(self, interrupts: _Interrupts) -> None:
        while not interrupts.wanted:
            timeout = None if self._state is None else self._state.due_in
            lines = interrupts.wait(lambda: self.lines.take(timeout))  # noqa: B023
            if lines is None:
                break
            if self._resumed is not None:
                lines = self._resumed.new(lines)
            if lines:
                self._answer(lines)
            if self._state is not None:
                self._state.save_if_due(self.feed, self.target.written)
        if not interrupts.wanted:
            if self._resumed is not None:
                self._resumed.finish()
            self.feed.finish()

    def _answer(self, lines: list[bytes]) -> None:
        answers = self.feed.push(lines)
        if answers:
            self.target.write(self.feed.header, answers)
        if self._state is not None:
            self._state.has_changed = True


def _say_sums(feed: LiveFeed, tracks: LiveTracks) -> None:
    """Print what there was, on standard error."""
    counts = tracks.counts
    again = ""
    if tracks.lateness:
        late = counted(counts["late"], "late plot")
        again = f", {counts['revisions']} of them again after {late}"
    parts = [
        counted(feed.lines, "line"),
        counted(counts["answers"], "answer") + again,
        counted(len(tracks), "track"),
    ]
    if counts["forgotten"]:
        parts.append(f"{counted(counts['forgotten'], 'silent track')} forgotten")
    say_aside("; ".join(parts))
    for fault in feed.sentences():
        say_aside(fault)


# -------------------------------------------------------------------- files


class _Target:
    """Where answers go: standard output, or a file to which they are added.

    Attributes
    ----------
    written : int
        Bytes that it has.
    """

    def __init__(self, path: str | None) -> None:
        self.path, self.written = path, 0
        self._needs_header = True
        self._descriptor = 1
        if path is not None:
            check_output(path)
            self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
            self.written = os.lseek(self._descriptor, 0, os.SEEK_END)

    def resume(self, written: int) -> None:
        """Cut a file back to the answers that a state knows of."""
        if self.path is None:
            return
        if self.written < written:
            raise DataError(
                f"{self.path}: has {self.written} bytes, and the state knows of {written}; give "
                "the same file, or remove the state to begin anew"
            )
        os.ftruncate(self._descriptor, written)
        self.written = os.lseek(self._descriptor, 0, os.SEEK_END)

    def write(self, header: bytes, answers: bytes) -> None:
        """Write answers, under a line of names where there is none yet."""
        if self._needs_header:
            self._needs_header = False
            if self.path is not None and self.written:
                self._check_header(header)
            else:
                answers = header + answers
        rest = memoryview(answers)
        while rest:
            rest = rest[os.write(self._descriptor, rest) :]
        self.written += len(answers)

    def close(self) -> None:
        """Close the file."""
        if self.path is not None:
            os.close(self._descriptor)

    def _check_header(self, header: bytes) -> None:
        os.lseek(self._descriptor, 0, os.SEEK_SET)
        start = os.read(self._descriptor, len(header))
        os.lseek(self._descriptor, 0, os.SEEK_END)
        if start != header:
            raise DataError(
                f"{self.path}: holds something else than these answers; name another file"
            )


class _StateFile:
    """The file of the state, which is written while lines are answered.

    Attributes
    ----------
    path : str
        Its name.
    has_changed : bool
        Whether lines were taken since it was saved.
    """

    def __init__(self, path: str) -> None:
        self.path, self.has_changed = path, False
        check_output(path)
        # The first time at once.
        self._saved = -math.inf
        self._thread: Thread | None = None
        self._failure: Exception | None = None

    def exists(self) -> bool:
        """Whether there is a state to go on from."""
        return os.path.exists(self.path)

    def load(self) -> LiveState:
        """Read it."""
        return LiveState.load(self.path)

    @property
    def due_in(self) -> float | None:
        """Seconds until it must be saved; None if nothing has changed."""
        if not self.has_changed:
            return None
        return max(0.0, self._saved + _SAVE_EVERY - time.monotonic())

    def save_if_due(self, feed: LiveFeed, written: int) -> None:
        """Save it in the background, if it is time for that."""
        if self.due_in == 0.0:
            self.save(feed, written)
            if self._failure is not None:
                say_aside(f"the state is not saved: {one_line(self._failure)}")

    def save(self, feed: LiveFeed, written: int, *, wait: bool = False) -> None:
        """Save it in the background; raises OSError if that fails while it is waited for."""
        if self._thread is not None:
            self._thread.join()
            self._thread = None
        if feed.tracks is not None and (self.has_changed or self._failure is not None):
            self.has_changed, self._saved = False, time.monotonic()
            self._thread = Thread(target=self._write, args=(LiveState.of(feed, written),))
            self._thread.start()
        if wait and self._thread is not None:
            self._thread.join()
            if self._failure is not None:
                raise self._failure

    def _write(self, state: LiveState) -> None:
        try:
            state.save(self.path)
            self._failure = None
        except OSError as error:
            self._failure = error


# -------------------------------------------------------------------- interrupts


class _Interrupts:
    """Ctrl-C ends a run between two lines; the second time at once.

    Attributes
    ----------
    wanted : bool
        Whether the user has asked for the end.
    """

    def __init__(self) -> None:
        self.wanted = self._waits = False
        self._before: Any = None

    def __enter__(self) -> _Interrupts:
        self._before = signal.signal(signal.SIGINT, self._take)
        return self

    def __exit__(self, *_: object) -> None:
        signal.signal(signal.SIGINT, self._before)

    def wait(self, until: Callable[[], list[bytes] | None]) -> list[bytes] | None:
        """Call a function that waits; None if it is interrupted."""
        try:
            self._waits = True
            return until()
        except KeyboardInterrupt:
            return None
        finally:
            self._waits = False

    def _take(self, *_: object) -> None:
        again, self.wanted = self.wanted, True
        if self._waits or again:
            raise KeyboardInterrupt
