"""What `track --follow` does: lines of standard input answered as they come."""

from __future__ import annotations

import gc
import sys
from dataclasses import dataclass, field
from pathlib import Path
from threading import Timer
from typing import Annotated

import typer

from fuzzytrack.cli.complaints import printable
from fuzzytrack.cli.live_run import LiveRun, SavedState
from fuzzytrack.cli.noise_words import noise_sentence
from fuzzytrack.cli.options import LIVE, FeedWay, StateFile
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

__all__ = ["FollowOptions", "follow", "follow_options"]

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
    lateness, forget
        See the command.
    saved : SavedState
        Its state.
    compiled : bool
        Whether to compile before the first answer.
    """

    lateness: float | None = None
    forget: float | None = None
    saved: SavedState = field(default_factory=SavedState)
    compiled: bool = True

    def check_unused(self) -> None:
        """Raise ValueError if one is given, for a command that follows no feed."""
        for name in ("lateness", "forget"):
            if getattr(self, name) is not None:
                raise ValueError(f"--{name}: is for a live feed; give --follow as well")
        self.saved.check_unused()
        if not self.compiled:
            raise ValueError("--no-compile: is for a live feed; give --follow as well")


def follow_options(
    follow: Annotated[
        bool,
        typer.Option(
            "--follow",
            help="Read lines from standard input, and answer each at once.",
            rich_help_panel=LIVE,
        ),
    ] = False,
    lateness: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            help="With --follow, put plots up to S seconds late in place. [default: 0]",
            rich_help_panel=LIVE,
        ),
    ] = None,
    forget: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            help="With --follow, forget tracks silent for S seconds.",
            rich_help_panel=LIVE,
        ),
    ] = None,
    state: StateFile = None,
    feed: FeedWay = None,
    compiled: Annotated[
        bool,
        typer.Option(
            "--compile/--no-compile",
            help="With --follow, compile before answering.",
            rich_help_panel=LIVE,
        ),
    ] = True,
) -> FollowOptions | None:
    """Options of a live run; None without --follow, and then none of the others may be given."""
    found = FollowOptions(
        lateness=lateness, forget=forget, saved=SavedState(state, feed), compiled=compiled
    )
    if follow:
        return found
    found.check_unused()
    return None


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
        LiveRun(feed, lines, target, lambda: _say_sums(feed), options.saved, LiveState).go()
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
    options.saved.check(output)


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


def _say_sums(feed: LiveFeed) -> None:
    """Print what there was, on standard error."""
    tracks = feed.tracks
    assert tracks is not None
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
