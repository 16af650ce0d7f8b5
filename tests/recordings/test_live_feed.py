"""Lines of a feed: what is wrong with them, what they begin with, and states of a run."""

from __future__ import annotations

import json
import zipfile

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.errors import DataError
from fuzzytrack.io.reading import Reading
from fuzzytrack.recordings.live_feed import LiveFeed
from fuzzytrack.recordings.live_state import LiveState
from fuzzytrack.recordings.state_file import StateFile

FIXED = "fixed:alpha=0.5:beta=0.25"


def a_feed(tracker=FIXED, told=None, lateness=0.0, forget=None, **options):
    said = [] if told is None else told
    return LiveFeed(
        Reading.of(**options), tracker, lateness=lateness, forget=forget, tell=said.append
    )


def pushed(feed, text):
    """Answers to a text, as rows of cells without the numbers of the track."""
    lines = [line.encode() + b"\n" for line in text.splitlines()]
    return [line.split(",") for line in feed.push(lines).decode().splitlines()]


def test_faulty_lines_before_the_first_good_one_are_left_out():
    told = []
    feed = a_feed(told=told, id="id")
    assert pushed(feed, "t,id,x\nwhen,a,1\n0,,1\n\n# nothing\n1,a,what\n") == []
    assert [row[:3] for row in pushed(feed, "2,a,5\n3,a,6\n")] == [
        ["a", "2", "5.0"],
        ["a", "3", "6.0"],
    ]
    assert feed.sentences() == (
        "2 faulty lines, left out",
        "1 row without an identity left out",
    )
    # The second one of a kind is not told of at once.
    assert len(told) == 1
    assert "row 2" in told[0]


def test_bytes_that_are_no_text_are_a_faulty_line():
    told = []
    feed = a_feed(told=told)
    assert len(pushed(feed, "t,x\n0,1")) == 1
    answers = feed.push([b"1,\xff\n", b"2,3\n"])
    assert answers.startswith(b"2,3.0,")
    assert told == ["the feed: row 3: byte 0xff is not UTF-8; left out"]


def test_numbers_that_no_tracker_can_square_do_not_end_a_run():
    told = []
    feed = a_feed("kalman-cv:sigma_v=1", told=told, sigma="s")
    text = "t,x,s\n1e200,1,1\n0,1,1\n1e-300,2,1\n1,2,1e200\n2,3,1e-200\n3,1e300,1\n4,5,1\n"
    assert [row[0] for row in pushed(feed, text)] == ["0", "3", "4"]
    assert feed.faults.counts == {"faulty": 4}
    assert told == ["the feed: row 2: a time beyond 1e+12 s; left out"]


def test_a_byte_order_mark_is_no_part_of_a_name():
    feed = a_feed()
    assert feed.push([b"\xef\xbb\xbft,x\n", b"0,1\n"]).startswith(b"0,1.0")


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ('{"t": 1, "x": [2]}', "column x: [2]; expected a number, a text or null"),
        ('{"t": 1, "x": true}', "column x: true"),
        ('{"t": 1, "x": "a"}', "column x: 'a'"),
        ('{"x": 1}', "column t: an empty cell; expected a time"),
        ('{"t": 1, "x": "\\ud800"}', 'column x: "\\ud800" has half a pair of surrogates'),
        ("[1, 2]", "expected an object of JSON"),
        ('{"t": 1', "not JSON"),
        ('{"t": 1, "x": 1}, {"t": 2, "x": 1}', "not JSON"),
    ],
)
def test_a_line_that_is_no_such_object_is_left_out(line, why):
    told = []
    feed = a_feed(told=told)
    lines = '{"t": 0, "x": 0}', line, '{"t": 5, "x": 1e1}'
    answers = feed.push([each.encode() + b"\n" for each in lines])
    rows = [json.loads(row) for row in answers.splitlines()]
    assert [(row["t"], row["x"]) for row in rows] == [(0, 0.0), (5, 10.0)]
    assert why in told[0]


def test_a_name_that_cannot_be_written_is_refused():
    with pytest.raises(DataError, match="half a pair"):
        a_feed().push([b'{"t": 0, "x": 1, "\\udfff": 2}\n'])


def test_a_cell_does_not_go_on_in_the_next_line():
    feed = a_feed(id="id")
    rows = pushed(feed, 't,id,x\n0,"a, b",1\n1,"a\n2,b",3\n3,"a, b",4\n')
    assert [row[2] for row in rows] == ["0", "3"]
    assert feed.faults.counts["faulty"] == 2


def test_rows_wait_for_the_first_place_on_earth_as_those_of_a_file_do(tmp_path):
    text = "t,mmsi,lat,lon\n0,7,,\n1,7,91,10\n2,7,60,10\n3,7,60.001,10.001\n4,7,60.002,10.001\n"
    options = {"id": "mmsi", "geodetic": ("lat", "lon"), "sigma": 20.0}
    feed = a_feed("kalman-cv:sigma_v=1", **options)
    assert pushed(feed, "\n".join(text.splitlines()[:3])) == []
    rows = pushed(feed, "\n".join(text.splitlines()[3:]))
    file = tmp_path / "plots.csv"
    file.write_text(text)
    ft.track(file, "kalman-cv:sigma_v=1", **options).write(tmp_path / "tracks.csv")
    whole = [line.split(",") for line in (tmp_path / "tracks.csv").read_text().splitlines()[1:]]
    assert [row[:-1] for row in rows] == whole


POLAR = {
    "id": "id",
    "polar": ("r", "az"),
    "sigma_range": 10.0,
    "sigma_azimuth": 0.5,
}


def polar_lines():
    """Plots of two targets, one of which passes north; every fifth is late."""
    rows = [
        f"{10 + k - 3 * (k % 5 == 4)},{'ab'[k % 2]},{9000 - 20 * k},{(355 + k / 3) % 360:.3f}"
        for k in range(60)
    ]
    return ["t,id,r,az", *rows]


@pytest.mark.parametrize("cut", [2, 17, 60])
def test_a_feed_that_goes_on_from_a_state_gives_the_same_answers(cut, tmp_path):
    lines = polar_lines()
    whole = a_feed("maneuver", lateness=6.0, **POLAR)
    first = pushed(whole, "\n".join(lines[:cut]))
    state = LiveState.of(whole, 7)
    state.save(tmp_path / "state")
    rest = pushed(whole, "\n".join(lines[cut:]))
    later = a_feed("maneuver", lateness=6.0, **POLAR)
    loaded = LiveState.load(tmp_path / "state")
    loaded.resume(later, "state")
    assert (loaded.written, loaded.lines) == (7, cut)
    assert pushed(later, "\n".join(lines[cut:])) == rest
    assert later.sentences() == whole.sentences()
    assert later.tracks.counts == whole.tracks.counts
    assert (later.lines, later.checksum, later.header) == (61, whole.checksum, whole.header)
    assert len(first) >= cut - 1


def test_late_polar_plots_with_noise_of_their_own_end_as_sorted_ones():
    lines = polar_lines()
    feed, in_order = (a_feed("maneuver", lateness=6.0, **POLAR) for _ in range(2))
    rows = pushed(feed, "\n".join(lines))
    last = {(row[0], row[1]): row[2:-1] for row in rows}
    sorted_lines = [lines[0], *sorted(lines[1:], key=lambda line: int(line.split(",")[0]))]
    assert last == {
        (row[0], row[1]): row[2:-1] for row in pushed(in_order, "\n".join(sorted_lines))
    }
    assert feed.tracks.counts["late"] == 12
    assert in_order.tracks.counts["revisions"] == 0


def test_plots_around_midnight_are_put_in_their_place():
    times = ["23:59:50", "23:59:52", "23:59:54", "00:00:00", "23:59:58", "00:00:02", "23:59:56"]
    text = "\n".join(f"{time},{k * k}" for k, time in enumerate(times))
    feed = a_feed(lateness=10.0)
    rows = pushed(feed, f"time,x\n{text}\n")
    last = {row[0]: row[1:-1] for row in rows}
    order = [*times[:3], times[6], times[4], times[3], times[5]]
    sorted_feed = a_feed()
    plots = "\n".join(f"{time},{times.index(time) ** 2}" for time in order)
    assert last == {row[0]: row[1:-1] for row in pushed(sorted_feed, f"time,x\n{plots}\n")}
    assert feed.tracks.counts["late"] == 2
    assert "the clock starts again after 86400 s, 1 time" in feed.sentences()


def test_silent_tracks_are_forgotten_and_memory_stays_flat():
    feed = a_feed(id="id", lateness=2.0, forget=50.0)
    pushed(feed, "t,id,x\n0,old,1\n1,old,2\n")
    for begin in range(0, 40_000, 500):
        rows = range(begin, begin + 500)
        pushed(feed, "\n".join(f"{2 + k / 100},t{k // 100},1" for k in rows))
    assert len(feed.tracks) < 150
    assert len(feed.tracks.recent) == len(feed.tracks)
    assert feed.tracks.counts["forgotten"] > 250
    (row,) = pushed(feed, "402,old,7\n")
    assert row[:4] == ["old", "402", "7.0", ""]
    # Nothing depends on how the lines come.
    again = a_feed(id="id", lateness=2.0, forget=50.0)
    every = [f"{2 + k / 100},t{k // 100},1" for k in range(40_000)]
    pushed(again, "\n".join(["t,id,x", "0,old,1", "1,old,2", *every, "402,old,7"]))
    assert sorted(again.tracks.ids) == sorted(feed.tracks.ids)


@pytest.mark.parametrize("size", [1, 100, 5000])
def test_a_row_that_is_out_of_order_does_not_decide_what_is_forgotten(size):
    feed = a_feed(id="id", forget=50.0)
    lines = ["t,id,x", "0,old,1", *(f"{k / 50},a,1" for k in range(1, 4000)), "10,a,2"]
    lines += [f"{80 + k / 100},b,1" for k in range(300)]
    rows = [f"{line}\n".encode() for line in lines]
    feed.push(rows[:4000])
    for start in range(4000, len(rows), size):
        feed.push(rows[start : start + size])
    assert feed.tracks.counts["forgotten"] == 1
    assert feed.tracks.ids == ("a", "b")


def test_other_plots_of_the_same_time_and_copies_of_late_ones_are_counted():
    feed = a_feed(lateness=5.0)
    rows = pushed(feed, "t,x\n0,0\n1,1\n2,2\n1,1\n1,9\n2,9\n2,2\n")
    assert [row[0] for row in rows] == ["0", "1", "2"]
    assert feed.faults.counts == {"repeated": 2}
    assert "2 exact copies of rows dropped" in feed.sentences()


def test_findings_of_a_feed_are_those_of_its_file(tmp_path):
    plots = [f"{k},{k * 10 if k % 9 != 7 else 5000},{k % 4}" for k in range(40)]
    text = "\n".join(["t,x,y", *plots, "5000,1,1", "5001,2,2", "5002,1e30,2"])
    (tmp_path / "plots.csv").write_text(text)
    options = {"sigma": 2.0, "valid": {"y": (0, 2)}, "least_step": 0.1}
    feed = a_feed("kalman-cv:sigma_v=1", **options)
    pushed(feed, text)
    tracked = ft.track(tmp_path / "plots.csv", "kalman-cv:sigma_v=1", **options)
    assert feed.sentences() == tracked.findings.sentences()
    assert len(feed.sentences()) == 4


# -------------------------------------------------------------------- states in files


def saved(tmp_path, change=lambda facts, arrays: None):
    """A state in a file, after a change."""
    feed = a_feed(id="id", lateness=3.0)
    pushed(feed, "t,id,x\n0,a,1\n1,a,2\n0.5,a,3\n")
    state = LiveState.of(feed, 0)
    change(state.facts, state.arrays)
    state.save(tmp_path / "state")
    return tmp_path / "state"


def test_a_state_of_another_version_is_refused(tmp_path):
    path = saved(tmp_path, lambda facts, arrays: facts.update(version=7))
    with pytest.raises(DataError, match="is of version 7, and this release reads 2"):
        LiveState.load(path)


def test_an_archive_that_is_no_state_is_refused(tmp_path):
    np.savez(tmp_path / "other.npz", x=1)
    for content in (b"", b"abc", (tmp_path / "other.npz").read_bytes()):
        (tmp_path / "state").write_bytes(content)
        with pytest.raises(DataError, match="is no state of a live run"):
            LiveState.load(tmp_path / "state")


def test_no_code_in_a_state_is_run(tmp_path):
    path = tmp_path / "state"
    with path.open("wb") as file:
        np.savez(file, facts=np.array([print], dtype=object))
    with pytest.raises(DataError, match="is no state of a live run"):
        LiveState.load(path)


@pytest.mark.parametrize(
    "change",
    [
        lambda facts, arrays: arrays.update(numbers=arrays["numbers"][:, 1:]),
        lambda facts, arrays: arrays.pop("clock"),
        lambda facts, arrays: arrays.update(row_time=arrays["row_time"][1:]),
        lambda facts, arrays: facts.update(ids=["a", "b"]),
        lambda facts, arrays: facts.pop("counts"),
    ],
)
def test_a_damaged_state_is_refused(tmp_path, change):
    path = saved(tmp_path, change)
    with pytest.raises(DataError, match="is damaged"):
        LiveState.load(path).resume(a_feed(id="id", lateness=3.0), path)


def test_a_state_that_cannot_be_saved_is_told_of_once(tmp_path):
    folder = tmp_path / "folder"
    folder.mkdir()
    file = StateFile(str(folder / "state"))
    feed = a_feed()
    pushed(feed, "t,x\n0,1\n")
    folder.rmdir()
    file.save(lambda: LiveState.of(feed, 0))
    with pytest.raises(OSError, match="there is no folder"):
        file.wait()
    folder.mkdir()
    file.save(lambda: LiveState.of(feed, 0))
    file.wait()
    assert zipfile.is_zipfile(folder / "state")


# -------------------------------------------------------------------- compiled


@pytest.mark.parametrize("options", [{}, {"sigma": 3.0}])
def test_after_a_warm_up_the_answers_are_the_same(options):
    lines = "\n".join(["t,x", *(f"{k - 3 * (k % 5 == 4)},{k * k}" for k in range(40))])
    feed, warm = a_feed(lateness=5.0, **options), a_feed(lateness=5.0, **options)
    warm.push([b"t,x\n", b"0,0\n"])
    warm.tracks.warm_up()
    answers = pushed(feed, lines)
    assert pushed(warm, "\n".join(lines.splitlines()[2:])) == answers[1:]


def test_an_empty_piece_has_no_answers():
    feed = a_feed()
    pushed(feed, "t,x\n0,1\n")
    assert pushed(feed, "\n\n") == []
    assert len(feed.tracks) == 1
