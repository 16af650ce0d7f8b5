"""Plots without identities tracked as they come."""

import gc
import itertools
import json
import re
import tracemalloc

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from turning_radar import turning_radar

from fuzzytrack import DataError, track_scans
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.scan_feed import ScanFeed
from fuzzytrack.scan.scan_tracker import ScanTracker


def lines_of(columns):
    names = list(columns)
    rows = zip(*(np.asarray(values).tolist() for values in columns.values()), strict=True)
    return [",".join(names) + "\n", *(",".join(map(repr, row)) + "\n" for row in rows)]


def harbor(scans=20, seed=3):
    rng = np.random.default_rng(seed)
    rows = []
    for k in range(scans):
        t = 1.5 * k
        for x, y in [(3 * t, 40), (-70, 4 * t), *rng.uniform(-300, 300, (2, 2)).tolist()]:
            dx, dy = rng.normal(0, 0.7, 2).tolist()
            rows.append((k, t, x + dx, y + dy))
    scan, t, x, y = map(np.array, zip(*rows, strict=True))
    return {"scan": scan, "t": t, "x": x, "y": y}


def answers(lines, cuts=(), how=None, reading=None, **options):
    feed = ScanFeed(Reading.of(**(reading or {})), ScanTracker(), how, **options)
    found = b""
    edges = [0, *sorted(cuts), len(lines)]
    for first, last in itertools.pairwise(edges):
        found += feed.push([line.encode() for line in lines[first:last]])
    found += feed.finish()
    return (feed.header + found).decode(), feed


@settings(max_examples=12, deadline=None, phases=[Phase.explicit, Phase.generate])
@given(st.lists(st.integers(0, 81), max_size=6), st.sampled_from(["scan", "period", "times"]))
def test_any_cut_gives_what_the_file_gives(tmp_path_factory, cuts, how):
    columns = harbor()
    if how != "scan":
        del columns["scan"]
    given_ = {"period": 1.5} if how == "period" else {}
    out = tmp_path_factory.mktemp("tracks") / "tracks.csv"
    # Rows of a file count from 1, the names of the columns being the first.
    path = out.with_name("plots.csv")
    path.write_text("".join(lines_of(columns)))
    track_scans(path, **given_).write(out)
    found, feed = answers(lines_of(columns), cuts, given_)
    assert found == out.read_text()
    assert feed.totals.summary["scans"] == 20
    assert feed.sentences() == ()


def test_each_scan_is_answered_when_the_next_begins_or_after_a_pause():
    lines = lines_of(harbor())
    feed = ScanFeed(Reading(), ScanTracker(), {"scan": "scan"})
    counts = []
    for line in lines:
        feed.push([line.encode()])
        counts.append(feed.totals.scans)
    assert counts[-1] == 19
    assert counts[5] == counts[4] + 1
    feed.pause()
    assert feed.totals.scans == 20
    # More of a scan that was taken for whole.
    feed.push([b"19,28.5,0,0\n"])
    feed.push([b"20,30.0,0,0\n"])
    feed.finish()
    assert feed.sentences() == ("1 plot came too late, left out",)
    assert feed.totals.scans == 21


def test_a_pause_is_due_when_the_period_is_known():
    lines = [line.encode() for line in lines_of(harbor(80))]
    by_times = ScanFeed(Reading(), ScanTracker(), {"period": 1.5})
    assert by_times.pause_after is None
    by_times.push(lines)
    assert by_times.pause_after == pytest.approx(0.05 * 1.5)


def test_lines_of_json():
    columns = harbor()
    lines = [
        json.dumps(dict(zip(columns, map(float, row), strict=True))) + "\n"
        for row in zip(*columns.values(), strict=True)
    ]
    found, feed = answers(lines, [7], json=True)
    assert feed.header == b""
    rows = [json.loads(line) for line in found.splitlines()]
    assert {row["kind"] for row in rows} == {"moving"}
    assert rows[0]["t"] == pytest.approx(1.5 * round(rows[0]["t"] / 1.5))


def test_sectors_of_a_feed_are_those_of_a_file(tmp_path):
    columns, _, _ = turning_radar(5, targets=8, turns=20, clutter=8)
    path, out = tmp_path / "plots.csv", tmp_path / "tracks.csv"
    path.write_text("".join(lines_of(columns)))
    track_scans(path, sectors=8, period=2.5).write(out)
    found, feed = answers(lines_of(columns), [3, 70, 71, 200], {"sectors": 8, "period": 2.5})
    one = [line.split(",") for line in out.read_text().splitlines()]
    other = [line.split(",") for line in found.splitlines()]
    assert len(one) == len(other) > 50
    for name in ("track_id", "plot", "status"):
        at = one[0].index(name)
        assert [row[at] for row in one] == [row[at] for row in other]
    assert feed.pause_after is None


def test_faulty_lines_are_left_out_and_told():
    lines, told = lines_of(harbor()), []
    lines[30:30] = ["what?\n", "7,10.5,abc,1\n"]
    feed = ScanFeed(Reading(), ScanTracker(), {"scan": "scan"}, tell=told.append)
    feed.push([line.encode() for line in lines[:3]])
    feed.push([b"\xff\xfe\n", *(line.encode() for line in lines[3:])])
    feed.finish()
    assert feed.sentences() == ("3 faulty lines, left out",)
    assert "is not UTF-8" in told[0]
    assert feed.totals.scans == 20


def test_faulty_lines_before_the_scans_are_known_are_left_out_and_told():
    columns, told = harbor(), []
    del columns["scan"]
    clean = lines_of(columns)
    lines = [*clean[:10], "1.5,7\n", *clean[10:20], "3.0,abc,1\n", *clean[20:]]
    found, feed = answers(lines, (40,), tell=told.append)
    # The last column is the row of the plot, which the faulty lines move.
    one, other = (
        [line.rpartition(",")[0] for line in text.splitlines()]
        for text in (found, answers(clean, (40,))[0])
    )
    assert one == other
    assert feed.sentences() == ("2 faulty lines, left out",)
    assert re.search(r"row 11: .*; left out", told[0])


def test_a_feed_of_faulty_lines_is_an_error():
    lines = ["t,x,y\n", *(f"{k},a,b\n" for k in range(30))]
    with pytest.raises(DataError, match="the feed: row"):
        answers(lines, how={"period": 1.0})


def test_a_lateness():
    columns = harbor()
    del columns["scan"]
    order = np.arange(80)
    order[[10, 14]] = order[[14, 10]]
    lines = lines_of({name: values[order] for name, values in columns.items()})
    _, feed = answers(lines, how={"period": 1.5})
    assert feed.sentences() == ("2 plots came too late, left out",)
    _, feed = answers(lines, how={"period": 1.5, "lateness": 2.0})
    assert feed.sentences() == ()
    assert feed.totals.plots == 80


@pytest.mark.parametrize(
    ("how", "reading", "said"),
    [
        ({"group": "g"}, {}, "group: needs the whole recording"),
        ({"scans": "f.csv"}, {}, "scans: needs the whole recording"),
        ({}, {"sort": True}, "sort: needs the whole recording"),
        ({}, {"format": "csv"}, "format: csv: a feed is CSV"),
    ],
)
def test_options_of_whole_recordings(how, reading, said):
    with pytest.raises(ValueError, match=said):
        ScanFeed(Reading.of(**reading), ScanTracker(), how)


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([], "holds no rows"),
        (["t,x,y\n"], "no rows"),
        (["t,x\n", "1,2\n"], "two coordinates"),
        (["t,x,y\n", "1,2,abc\n"], "row 2, column y: 'abc'"),
    ],
)
def test_feeds_without_plots(lines, said):
    with pytest.raises(DataError, match=said):
        answers(lines, how={"period": 1.0})


def traced_memory():
    """Bytes in use, without objects that Python keeps to use them again, up to 2000 of a kind."""
    gc.collect()
    return tracemalloc.get_traced_memory()[0]


def test_memory_does_not_grow_with_the_feed():
    feed = ScanFeed(Reading(), ScanTracker(), {"scan": "scan"})
    lines = [line.encode() for line in lines_of(harbor(600))]
    feed.push(lines[:1201])
    tracemalloc.start()
    try:
        feed.push(lines[1201:1601])
        before = traced_memory()
        for first in range(1601, len(lines), 100):
            feed.push(lines[first : first + 100])
        after = traced_memory()
    finally:
        tracemalloc.stop()
    assert after - before < 10_000
