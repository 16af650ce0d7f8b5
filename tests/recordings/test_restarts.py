"""Segments of tracks that start again."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.io import Piece
from fuzzytrack.recordings.restarts import Restarts

ROWS = st.lists(st.tuples(st.sampled_from("abc"), st.booleans(), st.integers(0, 1)), max_size=30)


def piece_of(rows):
    ids = [id for id, _, _ in rows]
    piece = Piece.of(ids, np.arange(len(rows)), np.zeros((len(rows), 1)))
    return replace(piece, segments=np.array([segment for _, _, segment in rows], dtype=np.int64))


def by_hand(rows):
    seen, found = dict.fromkeys("abc", 0), []
    for id, begins, segment in rows:
        seen[id] += begins
        found.append(segment + seen[id])
    return found


@given(ROWS, st.integers(0, 30))
def test_starts_are_counted_track_by_track_and_from_piece_to_piece(rows, cut):
    restarts, found = Restarts(), []
    for part in (rows[:cut], rows[cut:]):
        if part:
            begins = np.array([begins for _, begins, _ in part])
            found += restarts.advance(piece_of(part), begins).segments.tolist()
    assert found == by_hand(rows)


def test_without_a_start_nothing_changes():
    piece = Piece.of(["a"], [0], [[1.0]])
    assert Restarts().advance(piece, np.array([False])) is piece
