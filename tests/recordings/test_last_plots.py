import math
from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.io import Piece
from fuzzytrack.recordings.last_plots import LastPlots


def one_by_one(ids, times, segments, used):
    """What is known at each row, by a loop over the rows."""
    last, found = {}, []
    for id, time, segment, seen in zip(ids, times, segments, used, strict=True):
        before, count = last.get((id, segment), (math.nan, 0))
        if seen:
            before, count = time, count + 1
        last[id, segment] = before, count
        found.append((time - before, count >= 2))
    return found


def run(ids, times, segments, used, cuts):
    last, found = LastPlots(), []
    whole = Piece.of(ids, times, np.zeros((len(ids), 1)))
    whole = replace(whole, segments=np.array(segments, dtype=np.int64))
    for begin, end in zip([0, *cuts], [*cuts, len(ids)], strict=True):
        rows = np.arange(begin, end)
        since = last.advance(whole.take(rows), np.array(used, dtype=bool)[rows])
        found += zip(since.seconds.tolist(), since.moving.tolist(), strict=True)
    return found


@given(st.data())
def test_any_tracks_in_any_pieces(data):
    count = data.draw(st.integers(1, 20))
    ids = data.draw(st.lists(st.sampled_from("abc"), min_size=count, max_size=count))
    used = data.draw(st.lists(st.booleans(), min_size=count, max_size=count))
    grows = data.draw(st.lists(st.integers(0, 1), min_size=count, max_size=count))
    segment, segments = dict.fromkeys("abc", 0), []
    for id, grow in zip(ids, grows, strict=True):
        segment[id] += grow
        segments.append(segment[id])
    cuts = sorted(data.draw(st.lists(st.integers(0, count), max_size=3)))
    times = np.arange(count) * 0.5
    found = run(ids, times, segments, used, cuts)
    wanted = one_by_one(ids, times.tolist(), segments, used)
    np.testing.assert_array_equal(np.array(found), np.array(wanted))


def test_without_segments():
    last = LastPlots()
    piece = Piece.of(["a", "b", "a", "a"], [0, 0, 1, 3], np.zeros((4, 1)))
    since = last.advance(piece, np.array([True, False, True, False]))
    assert since.seconds.tolist()[0::2] == [0.0, 0.0]
    assert since.seconds[3] == 2.0
    assert math.isnan(since.seconds[1])
    assert since.moving.tolist() == [False, False, True, True]
