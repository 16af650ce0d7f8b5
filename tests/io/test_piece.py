"""Rows of a piece that are taken, with all that belongs to them."""

from dataclasses import replace

import numpy as np
import pytest

from fuzzytrack.io.piece import Piece

PIECE = replace(
    Piece.of(["a", "b", "a"], [0, 0, 1], [[0.0, 1.0], [5.0, np.nan], [10.0, 2.0]]),
    sigma=np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]),
    segments=np.array([0, 0, 1]),
)


@pytest.mark.parametrize("cells", [["0", "0.0", "1"], np.array([0, 0, 1])])
@pytest.mark.parametrize("places", [np.array([2, 0]), np.array([True, False, True])])
def test_rows_are_taken_with_all_that_belongs_to_them(cells, places):
    taken = replace(PIECE, time_cells=cells).take(places)
    rows = np.arange(3)[places]
    assert len(taken) == len(rows)
    assert taken.ids[:] == [PIECE.ids[k] for k in rows]
    assert list(taken.time_cells) == [cells[k] for k in rows]
    for name in ("time", "plots", "rows", "sigma", "segments"):
        np.testing.assert_array_equal(getattr(taken, name), getattr(PIECE, name)[rows])


def test_what_a_piece_does_not_have_stays_out():
    taken = Piece.of(["a", "b"], [0, 1], [[0.0], [1.0]]).take(np.array([1]))
    assert taken.sigma is None
    assert taken.time_cells is None
    assert taken.segments is None
