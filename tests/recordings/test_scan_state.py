"""The state of a live run of scans: kept in a file, and gone on from."""

import numpy as np
import pytest
from turning_radar import turning_radar

from fuzzytrack import DataError
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.live_state import LiveState
from fuzzytrack.recordings.plain_values import PlainValues
from fuzzytrack.recordings.scan_feed import ScanFeed
from fuzzytrack.recordings.scan_state import ScanState
from fuzzytrack.scan.scan_tracker import ScanTracker
from fuzzytrack.scan.update.tracker import TrackerUpdate


def lines_of(late=False):
    columns, *_ = turning_radar(8, targets=12, turns=24, clutter=4)
    order = np.argsort(columns["t"] + (np.arange(len(columns["t"])) % 5) * 0.1 * late)
    rows = zip(*(column[order].tolist() for column in columns.values()), strict=True)
    return [b"t,x,y\n", *(b"%r,%r,%r\n" % row for row in rows), b"faulty\n"]


WAYS = [
    ({"period": 2.5}, ScanTracker()),
    ({}, ScanTracker()),
    ({"sectors": 8}, ScanTracker()),
    ({"period": 2.5, "lateness": 0.5}, ScanTracker()),
    ({"period": 2.5}, ScanTracker(update=TrackerUpdate("fixed:alpha=0.5:beta=0.2"))),
]


@pytest.mark.parametrize(("how", "scanner"), WAYS)
def test_a_feed_that_goes_on_from_a_state_gives_the_same_answers(how, scanner, tmp_path):
    lines = lines_of(late="lateness" in how)
    whole = ScanFeed(Reading(), scanner, how)
    cut = 203
    first = whole.push(lines[:cut])
    assert whole.begun
    ScanState.of(whole, len(first)).save(tmp_path / "state")
    rest = whole.push(lines[cut:]) + whole.finish()
    later = ScanFeed(Reading(), scanner, how)
    loaded = ScanState.load(tmp_path / "state")
    loaded.resume(later, "state")
    assert (loaded.written, loaded.lines) == (len(first), cut)
    assert later.push(lines[cut:]) + later.finish() == rest
    assert len(rest) > 1000
    assert later.sentences() == whole.sentences()
    assert later.totals == whole.totals
    assert (later.items, later.checksum) == (len(lines), whole.checksum)
    assert later.beginning == whole.beginning


def a_state(tmp_path):
    feed = ScanFeed(Reading(), ScanTracker(), {"period": 2.5})
    feed.push(lines_of()[:50])
    ScanState.of(feed, 0).save(tmp_path / "state")
    return ScanState.load(tmp_path / "state")


@pytest.mark.parametrize(
    ("how", "scanner", "said"),
    [
        ({"period": 2.4}, ScanTracker(), "was made with period 2.5, and not 2.4"),
        ({"period": 2.5}, ScanTracker(name="mine", update=TrackerUpdate()), "is not this mine"),
    ],
)
def test_other_options_and_configurations_are_refused(how, scanner, said, tmp_path):
    state = a_state(tmp_path)
    with pytest.raises(DataError, match=said):
        state.resume(ScanFeed(Reading(), scanner, how), "state")


def test_other_states_and_damaged_ones_are_refused(tmp_path):
    state = a_state(tmp_path)
    with pytest.raises(DataError, match="is no state of a live run of track"):
        LiveState.load(tmp_path / "state")
    for damage in (
        lambda: state.facts["stream"]["dict"].append(["_x", {"class": "Popen", "state": {}}]),
        lambda: state.arrays.pop("array_0"),
    ):
        damage()
        with pytest.raises(DataError, match="state: is damaged"):
            state.resume(ScanFeed(Reading(), ScanTracker(), {"period": 2.5}), "state")


def test_objects_of_other_classes_are_not_written():
    with pytest.raises(TypeError, match="a Reading cannot be written"):
        PlainValues((ScanFeed,), {}, {}).written([Reading()])
