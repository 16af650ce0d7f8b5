"""One time far ahead of all others does not silence a feed."""

import numpy as np
import pytest

from fuzzytrack import track_scans
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.live_feed import LiveFeed
from fuzzytrack.recordings.live_state import LiveState
from fuzzytrack.recordings.scan_feed import ScanFeed
from fuzzytrack.recordings.scan_state import ScanState
from fuzzytrack.scan.scan_tracker import ScanTracker

# -------------------------------------------------------------------- tracks with identities


def a_feed(lateness=0.0, **options):
    return LiveFeed(Reading.of(id="id"), "fixed:alpha=0.5:beta=0.25", lateness=lateness, **options)


def lines_of(times):
    """Plots of two tracks, of which the first has these times and the other a steady one."""
    lines = ["t,id,x"]
    for k, time in enumerate(times):
        lines += [f"{time},a,{k * 3}", f"{k},b,{k * 2}"]
    return [line.encode() + b"\n" for line in lines]


WILD = [*range(10), 9000, *range(10, 20)]


def segments(text):
    """Time and segment of each answer about the first track."""
    rows = [line.split(",") for line in text.decode().splitlines()]
    return [(row[1], row[-2]) for row in rows if row[0] == "a"]


@pytest.mark.parametrize("lateness", [0.0, 5.0])
def test_a_track_begins_anew_after_one_time_far_ahead(lateness):
    told = []
    feed = a_feed(lateness, tell=told.append)
    text = feed.push(lines_of(WILD))
    before = [(str(k), "0") for k in range(10)]
    after = [(str(k), "2") for k in range(11, 20)]
    assert segments(text) == [*before, ("9000", "1"), *after]
    others = [line for line in text.decode().splitlines() if line.startswith("b")]
    alone = a_feed(lateness).push(lines_of(range(21)))
    assert others == [line for line in alone.decode().splitlines() if line.startswith("b")]
    assert feed.faults.counts == {"too_late": 1, "ahead": 1}
    assert told[-1] == (
        "line 26: time 11 (id 'a'): its track begins anew; the newest plot was 8989 s ahead"
    )


@pytest.mark.parametrize("lateness", [0.0, 5.0])
def test_any_cut_and_a_saved_state_give_the_same(lateness, tmp_path):
    lines = lines_of(WILD)
    whole = a_feed(lateness).push(lines)
    single = a_feed(lateness)
    assert b"".join(single.push([line]) for line in lines) == whole
    # Stopped between the two plots that are too late.
    first, second = a_feed(lateness), a_feed(lateness)
    begun = first.push(lines[:24])
    assert first.faults.counts == {"too_late": 1}
    LiveState.of(first, 0).save(tmp_path / "state")
    LiveState.load(tmp_path / "state").resume(second, tmp_path / "state")
    assert begun + second.push(lines[24:]) == whole
    assert second.faults.counts == {"too_late": 1, "ahead": 1}


def test_the_first_plot_of_a_track_may_be_the_wrong_one():
    assert segments(a_feed().push(lines_of([9000, *range(9)]))) == [
        ("9000", "0"),
        *((str(k), "1") for k in range(1, 9)),
    ]


@pytest.mark.parametrize(
    "times",
    [
        # Sent once more, within the minute, and after two plots that agree.
        [*range(10), *range(3, 8), 10],
        [*range(10), 60, *range(10, 15), 61],
        [*range(10), 9000, 9001, *range(10, 20)],
    ],
)
def test_a_track_does_not_begin_anew_where_it_is_not_one_plot_that_is_far_ahead(times):
    feed = a_feed()
    feed.push(lines_of(times))
    assert set(feed.faults.counts) == {"too_late"}


@pytest.mark.filterwarnings("ignore::fuzzytrack.errors.TrackWarning")
@pytest.mark.parametrize("wild", range(6, 13))
def test_a_time_far_ahead_does_not_make_all_tracks_silent(wild, monkeypatch):
    monkeypatch.setattr("fuzzytrack.recordings.live._SWEEP", 8)
    times = [*range(20)]
    times[wild] = 9000
    feed = a_feed(forget=50.0)
    feed.push(lines_of(times))
    assert feed.tracks.counts["forgotten"] == 0
    # Silent for longer, by both of the last lines.
    feed.push([f"{time},b,1\n".encode() for time in range(100, 200)])
    assert feed.tracks.counts["forgotten"] == 1


# -------------------------------------------------------------------- plots of scans


def harbor():
    """Rows (scan, time, x, y) of two boats in 20 scans."""
    rng = np.random.default_rng(3)
    rows = []
    for k in range(20):
        t = 1.5 * k
        for x, y in [(3 * t, 40.0), (-70.0, 4 * t)]:
            dx, dy = rng.normal(0, 0.7, 2).tolist()
            rows.append((k, t, x + dx, y + dy))
    return rows


def answers(rows, cut=None, **how):
    """Answers without the column of the rows, and the feed."""
    names = ["scan", "t", "x", "y"] if "scan" in how else ["n", "t", "x", "y"]
    lines = [",".join(map(str, row)).encode() + b"\n" for row in [names, *rows]]
    feed = ScanFeed(Reading(), ScanTracker(), how)
    text = b"".join(feed.push(some) for some in (lines[:cut], lines[cut:] if cut else []))
    text += feed.finish()
    return [line.rsplit(",", 1)[0] for line in text.decode().splitlines()], feed


@pytest.mark.parametrize("place", [0, 7, 8, 21])
def test_a_plot_far_ahead_is_left_out(place):
    rows = harbor()
    expected, _ = answers(rows, period=1.5)
    rows.insert(place, (0, 1e6, 5.0, 5.0))
    found, feed = answers(rows, period=1.5)
    assert found == expected
    assert feed.stream.plots.findings.sentences() == ("1 time far ahead of all others, left out",)
    for cut in (place + 1, place + 2):
        assert answers(rows, cut, period=1.5)[0] == expected


def test_a_scan_far_ahead_is_left_out():
    rows = harbor()
    expected, _ = answers([row for row in rows if row[0] != 7], scan="scan")
    far = [(n, t + 5000.0 * (n == 7), x, y) for n, t, x, y in rows]
    found, feed = answers(far, scan="scan")
    assert found == expected
    assert feed.stream.plots.findings.counts["ahead"] == 2


def test_a_recording_with_late_plots_is_not_cut_short(tmp_path):
    rows = harbor()
    rows.insert(9, (0, 1e6, 5.0, 5.0))
    n, t, x, y = map(np.array, zip(*rows, strict=True))
    found = track_scans({"n": n, "t": t, "x": x, "y": y}, period=1.5, lateness=2.0)
    assert (found.totals.summary["plots"], len(found)) == (40, 2)


def test_a_plot_that_waits_is_in_the_state(tmp_path):
    rows = harbor()
    rows[21:] = [(n, t + 4000.0, x, y) for n, t, x, y in rows[21:]]
    whole, _ = answers(rows, period=1.5)
    lines = [",".join(map(str, row)).encode() + b"\n" for row in [("n", "t", "x", "y"), *rows]]
    first, second = (ScanFeed(Reading(), ScanTracker(), {"period": 1.5}) for _ in range(2))
    text = first.push(lines[:23])
    ScanState.of(first, 0).save(tmp_path / "state")
    ScanState.load(tmp_path / "state").resume(second, tmp_path / "state")
    text += second.push(lines[23:]) + second.finish()
    assert [line.rsplit(",", 1)[0] for line in text.decode().splitlines()] == whole
