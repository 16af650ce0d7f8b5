"""What `track --follow` does: lines of standard input answered as they come."""

from __future__ import annotations

import gc
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from threading import Timer

from fuzzytrack.cli.complaints import one_line, printable
from fuzzytrack.cli.interrupts import Interrupts
from fuzzytrack.cli.noise_words import noise_sentence
from fuzzytrack.cli.output import say_aside, say_notes
from fuzzytrack.cli.output_file import STANDARD_OUTPUT
from fuzzytrack.io.byte_stream import STANDARD_INPUT
from fuzzytrack.io.formats import PARQUET
from fuzzytrack.io.line_stream import LineStream
from fuzzytrack.io.line_target import LineTarget
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.track_formats import is_geo
from fuzzytrack.plurals import counted
from fuzzytrack.recordings.judging import GateWidth
from fuzzytrack.recordings.live import LiveTracks
from fuzzytrack.recordings.live_feed import LiveFeed
from fuzzytrack.recordings.live_state import LiveState
from fuzzytrack.recordings.resumed_lines import ResumedLines
from fuzzytrack.recordings.state_file import StateFile

__all__ = ["FollowOptions", "follow"]

# Seconds from which on a compilation is told of.
_LONG = 2.0
# A feed that has ended after fewer lines is done sooner without compiled code.
_FEW = 20_000
# Collections of younger objects before all are looked at.
_NEVER = 1_000_000_000


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
    if sys.stdin is None:
        raise ValueError("--follow: reads standard input, which is closed; pipe the feed into it")
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
    thresholds = gc.get_threshold()
    target = LineTarget(None if output == STANDARD_OUTPUT else output)
    try:
        _Run(feed, lines, target, options).go()
    finally:
        target.close()
        gc.set_threshold(*thresholds)


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
    say_notes(ready.findings.notes)
    if compiled and not lines.look_ahead(_FEW):
        told = Timer(_LONG, say_aside, ("compiling the tracker; the next run finds it on disk",))
        told.daemon = True
        told.start()
        try:
            tracks.warm_up()
        finally:
            told.cancel()
    # Only what is young may be garbage in circles. To look through the rows of all tracks for it
    # takes a tenth of a second.
    gc.set_threshold(*gc.get_threshold()[:2], _NEVER)


class _Run:
    """A run from the first line to the last."""

    def __init__(
        self, feed: LiveFeed, lines: LineStream, target: LineTarget, options: FollowOptions
    ) -> None:
        self.feed, self.lines, self.target = feed, lines, target
        self._resumed: ResumedLines | None = None
        self._state = None if options.state is None else StateFile(options.state)
        if self._state is not None and os.path.exists(self._state.path):
            state = LiveState.load(self._state.path)
            state.resume(feed, self._state.path)
            target.resume(state.written)
            if options.feed != "onward":
                self._resumed = ResumedLines(state)
            say_aside(f"goes on after line {state.lines} of the feed")

    def go(self) -> None:
        """Answer lines until they end or the user ends it, or until nobody reads the answers."""
        with Interrupts() as interrupts:
            try:
                self._answer_all(interrupts)
                if self._state is not None and self.feed.tracks is not None:
                    self._save(self._state)
                    self._state.wait()
            except BrokenPipeError:
                # The answers since the last save have not been read, so that stays.
                pass
            finally:
                if self.feed.tracks is not None:
                    _say_sums(self.feed, self.feed.tracks)
        if interrupts.wanted:
            raise KeyboardInterrupt

    def _answer_all(self, interrupts: Interrupts) -> None:
        while not interrupts.wanted:
            timeout = None if self._state is None else self._state.due_in
            lines = interrupts.wait(lambda: self.lines.take(timeout))  # noqa: B023
            if lines is None:
                break
            if self._resumed is not None:
                lines = self._resumed.new(lines)
            if lines:
                self._answer(lines)
            if self._state is not None and self._state.due_in == 0.0:
                self._save(self._state)
        if not interrupts.wanted:
            if self._resumed is not None:
                self._resumed.finish()
            self.feed.finish()

    def _save(self, state: StateFile) -> None:
        """Save the state; a run goes on without, as long as it can say so."""
        try:
            state.save(self.feed, self.target.written)
        except OSError as error:
            why = one_line(error).removeprefix("error: ")
            say_aside(f"{state.path}: the state was not saved: {why}")

    def _answer(self, lines: list[bytes]) -> None:
        answers = self.feed.push(lines)
        if answers:
            self.target.write(self.feed.header, answers)
        # Before the first row there is nothing to save.
        if self._state is not None and self.feed.tracks is not None:
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
