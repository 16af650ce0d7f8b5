"""A live run that ends before anything could be answered."""

import signal
from contextlib import suppress

import pytest

from fuzzytrack.cli.live_run import LiveRun, SavedState
from fuzzytrack.io.line_target import LineTarget
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.scan_feed import ScanFeed
from fuzzytrack.recordings.scan_state import ScanState
from fuzzytrack.scan.scan_tracker import ScanTracker


class Interrupted:
    """A stream that Ctrl-C ends after some lines."""

    def __init__(self, lines):
        self.lines = lines

    def take(self, timeout=None):
        lines, self.lines = self.lines, []
        if not lines:
            signal.raise_signal(signal.SIGINT)
        return lines


class Unnoticed(Interrupted):
    """As if Ctrl-C came just before a wait, which it then does not end."""

    def take(self, timeout=None):
        lines, self.lines = self.lines, []
        if not lines:
            assert timeout is not None
            with suppress(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
        return lines


def test_ctrl_c_just_before_a_wait_ends_a_run_after_it():
    feed = ScanFeed(Reading(), ScanTracker(), {"period": 2.0})
    lines = Unnoticed([b"t,x,y\n", b"0,1,2\n"])
    run = LiveRun(feed, lines, LineTarget(None), lambda: None, SavedState(), ScanState)
    with pytest.raises(KeyboardInterrupt):
        run.go()


def test_ctrl_c_before_an_answer_says_why_there_was_none(capfd):
    feed = ScanFeed(Reading(), ScanTracker(), {"period": 2.0})
    lines = Interrupted([b"t,x\n", b"0,1\n"])
    run = LiveRun(feed, lines, LineTarget(None), lambda: None, SavedState(), ScanState)
    with pytest.raises(KeyboardInterrupt):
        run.go()
    out, said = capfd.readouterr()
    assert out == ""
    assert said.startswith("the feed: column x: plots of a scan have two coordinates")
