"""What `scan --follow` does: plots of a feed answered scan by scan as they come."""

from __future__ import annotations

import gc
import sys
from pathlib import Path
from typing import Any

import numpy as np

from fuzzytrack.cli.complaints import printable
from fuzzytrack.cli.live_run import LiveRun, SavedState, Stream
from fuzzytrack.cli.noise_words import noise_sentence
from fuzzytrack.cli.output import say_aside, say_notes
from fuzzytrack.cli.output_file import STANDARD_OUTPUT
from fuzzytrack.io.byte_stream import STANDARD_INPUT
from fuzzytrack.io.datagrams import DatagramStream, is_address
from fuzzytrack.io.formats import PARQUET
from fuzzytrack.io.line_stream import LineStream
from fuzzytrack.io.line_target import LineTarget
from fuzzytrack.io.reading import Reading
from fuzzytrack.io.track_formats import is_geo
from fuzzytrack.plurals import counted
from fuzzytrack.recordings.scan_feed import ScanFeed
from fuzzytrack.recordings.scan_plots import ScanPlots
from fuzzytrack.recordings.scan_state import ScanState
from fuzzytrack.scan.scan import Scan
from fuzzytrack.scan.scan_tracker import ScanTracker

__all__ = ["follow_scans"]

# Collections of younger objects before all are looked at.
_NEVER = 1_000_000_000


def follow_scans(
    files: list[str],
    reading: Reading,
    scanner: ScanTracker,
    how: dict[str, Any],
    output: str | None,
    saved: SavedState,
    **options: Any,
) -> None:
    """Answer the items of a feed until it ends.

    Parameters
    ----------
    files : list of str
        Standard input, or a port.
    reading, scanner, how
        As for `ScanFeed`.
    output : str or None
        File for the answers.
    saved : SavedState
        File of the state.
    **options
        As for `ScanFeed`.

    Raises
    ------
    KeyboardInterrupt
        If the user ends it, after what is held has been answered, or is saved.
    ValueError, DataError, OSError
        As the other commands.
    """
    _check(files, output)
    saved.check(output)
    feed = ScanFeed(
        reading,
        scanner,
        how,
        datagrams=is_address(files[0]),
        tell=lambda fault: say_aside(printable(fault)),
        begin=lambda plots: _begin(plots, scanner),
        **options,
    )
    stream = _stream(files[0])
    # Compiled code is there before the first plots come.
    scanner.start().step(Scan(0.0, np.zeros((1, 2))))
    thresholds = gc.get_threshold()
    # To look through all that lives for garbage takes as long as many scans.
    gc.set_threshold(*thresholds[:2], _NEVER)
    target = LineTarget(None if output == STANDARD_OUTPUT else output)
    try:
        LiveRun(feed, stream, target, lambda: _say_sums(feed), saved, ScanState).go()
    finally:
        target.close()
        gc.set_threshold(*thresholds)
        if isinstance(stream, DatagramStream):
            stream.close()


def _check(files: list[str], output: str | None) -> None:
    """Raise ValueError for what a live run cannot do."""
    if len(files) != 1 or not (files[0] == STANDARD_INPUT or is_address(files[0])):
        raise ValueError(
            "--follow: reads standard input or a port; write - or udp://127.0.0.1:PORT in place "
            "of files"
        )
    if output is None or output == STANDARD_OUTPUT:
        return
    if is_geo(output) or Path(output).suffix.lower() not in (".csv", ".txt", ".json", ".jsonl"):
        more = "needs the whole recording; " if Path(output).suffix.lower() in PARQUET else ""
        raise ValueError(f"--output: {output}: {more}--follow writes CSV or lines of JSON")


def _stream(place: str) -> Stream:
    if is_address(place):
        stream = DatagramStream(place)
        # What is sent before is lost.
        say_aside(f"listening at {stream.address}")
        return stream
    if sys.stdin is None:
        raise ValueError("--follow: reads standard input, which is closed; pipe the feed into it")
    return LineStream(sys.stdin.fileno())


def _begin(plots: ScanPlots, scanner: ScanTracker) -> None:
    """Say how plots are read, before the first answer."""
    decoder = plots.files.decoder
    say_aside(f"columns: {decoder.columns.sentence.replace('; no id: one track', '')}")
    say_aside(f"scans: {plots.said}")
    say_aside(f"configuration: {scanner.name}")
    say_aside(f"sigma: {noise_sentence(decoder) or 'that of the configuration'}")
    say_notes((*plots.files.notes, *plots.findings.notes))


def _say_sums(feed: ScanFeed) -> None:
    """Print what there was, on standard error."""
    found = feed.totals.summary
    parts = [
        counted(found["scans"], "scan"),
        counted(found["plots"], "plot"),
        counted(found["tracks"], "track"),
    ]
    say_aside("; ".join(parts))
    for fault in feed.sentences():
        say_aside(fault)
