"""Positions by object."""

import numpy as np
import pytest

from fuzzytrack.scoring.object_paths import ObjectPaths


def test_rows_are_put_in_order_object_by_object():
    truth = (
        [2.0, 0.0, 1.0, 1.0, 3.0],
        ["b", "a", "b", "a", "b"],
        [[2, 0], [0, 9], [1, 0], [1, 9], [np.nan, 0]],
    )
    paths = ObjectPaths.of(truth)
    assert paths.names == ("a", "b")
    assert paths.edges.tolist() == [0, 2, 4]
    assert paths.time.tolist() == [0, 1, 1, 2]
    assert paths.position.tolist() == [[0, 9], [1, 9], [1, 0], [2, 0]]
    assert repr(paths) == "<ObjectPaths: rows=4, objects=2>"


def test_numbers_are_names_and_none_is_no_object():
    assert ObjectPaths.of(([0.0], [7], [[1.0, 2.0]])).names == ("7",)
    assert len(ObjectPaths.of(None)) == 0
    assert ObjectPaths.of(None).position.shape == (0, 2)


def test_a_map_needs_two_axes():
    with pytest.raises(ValueError, match="truth: positions have 3 axes; a map needs two"):
        ObjectPaths.of(([0.0], ["a"], [[1.0, 2.0, 3.0]]))
