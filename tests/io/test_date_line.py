from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fuzzytrack.io.date_line import cut_at_date_line

NEAR = (-180.0, -179.99999999999997, 179.99999999999997, -90.0, 0.0, 90.0, 179.0, -179.0)


def cut(longitude):
    return [
        (rows.tolist(), found.tolist()) for rows, found in cut_at_date_line(np.array(longitude))
    ]


@pytest.mark.parametrize(
    ("longitude", "parts"),
    [
        ([], []),
        ([5.0], [([0], [5])]),
        ([-180.0], [([0], [-180])]),
        (
            [170.0, 175, -170],
            [([0, 1, 1 + 1 / 3], [170, 175, 180]), ([1 + 1 / 3, 2], [-180, -170])],
        ),
        ([-179.0, 178], [([0, 1 / 3], [-179, -180]), ([1 / 3, 1], [180, 178])]),
        # A vertex on the line ends one part and begins the next one.
        ([179.0, -180, -179], [([0, 1], [179, 180]), ([1, 2], [-180, -179])]),
        ([-179.0, -180, 179], [([0, 1], [-179, -180]), ([1, 2], [180, 179])]),
        # A track that touches the line is not cut, nor one that begins or ends there.
        ([179.0, -180, 179], [([0, 1, 2], [179, 180, 179])]),
        ([-179.0, -180, -179], [([0, 1, 2], [-179, -180, -179])]),
        ([-180.0, 179], [([0, 1], [180, 179])]),
        ([179.0, -180], [([0, 1], [179, 180])]),
        # Half of the way round: either way is right, and none crosses.
        ([-90.0, 90], [([0, 1], [-90, 90])]),
        ([0.0, -180], [([0, 1], [0, -180])]),
    ],
)
def test_parts(longitude, parts):
    found = cut(longitude)
    assert len(found) == len(parts)
    for (rows, where), (wanted_rows, wanted) in zip(found, parts, strict=True):
        np.testing.assert_allclose(rows, wanted_rows, rtol=1e-12)
        assert where == wanted


def test_twice_round_the_earth():
    longitude = (np.arange(0, 721, 40) + 180) % 360 - 180
    assert len(cut(longitude)) == 3
    assert len(cut(longitude[::-1])) == 3


@given(
    st.lists(
        st.sampled_from(NEAR) | st.floats(-180, 180, exclude_max=True), min_size=2, max_size=12
    )
)
@example([-179.99999999999997, 179.99999999999997, -179.99999999999997])
def test_parts_join_at_the_line(longitude):
    longitude = np.array(longitude)
    parts = cut_at_date_line(longitude)
    for rows, where in parts:
        assert len(rows) >= 2
        assert (np.abs(where) <= 180).all()
        assert (np.abs(np.diff(where)) <= 180).all()
        assert (np.diff(rows) > 0).all()
        # The same places on the earth, along the shorter way.
        whole = rows == np.floor(rows)
        turn = (where[whole] - longitude[rows[whole].astype(int)] + 180) % 360 - 180
        assert (np.abs(turn) < 1e-9).all()
        assert (np.abs(where[~whole]) == 180).all()
    for (rows, where), (next_rows, next_where) in pairwise(parts):
        assert rows[-1] == next_rows[0]
        np.testing.assert_allclose(sorted([where[-1], next_where[0]]), [-180, 180], atol=1e-12)
    every = np.concatenate([rows for rows, _ in parts])
    assert sorted(set(every[every == np.floor(every)])) == list(range(len(longitude)))
    if (np.abs(longitude) < 179.9).all():
        # By a line that goes on beyond 180.
        worlds = np.floor((np.unwrap(longitude, period=360) + 180) / 360)
        assert len(parts) - 1 == np.abs(np.diff(worlds)).sum()
