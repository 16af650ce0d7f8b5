"""Positions from what a user has, with the messages about what is wrong with them."""

import numpy as np
import pytest
from scored_scenes import positions

from fuzzytrack import scan
from fuzzytrack.scoring.positions import KINDS, Positions

THREE = {"time": [0.0, 0.0, 1.0], "id": ["a", "b", "a"], "position": [[0, 0], [5, 5], [1, 0]]}


def test_the_kinds_are_those_of_a_scan_tracker():
    assert KINDS == scan.KINDS


def test_of_a_mapping_a_tuple_and_positions():
    found = Positions.of(THREE, "tracks")
    assert (len(found), found.n_axes, found.kind, found.group) == (3, 2, None, None)
    for other in (found, tuple(THREE.values())):
        again = Positions.of(other, "tracks")
        assert again.time.tolist() == found.time.tolist()
        assert again.id.tolist() == found.id.tolist()
        assert again.position.tolist() == found.position.tolist()


def test_of_one_axis():
    found = Positions.of(([0, 1], [1, 1], [3.0, 4.0]), "truth")
    assert found.position.tolist() == [[3.0], [4.0]]


def test_rows_without_a_position_are_left_out():
    rows = {**THREE, "position": [[0, 0], [np.nan, 5], [1, 0]], "kind": ["moving"] * 3}
    found = Positions.of(rows, "tracks")
    assert found.id.tolist() == ["a", "a"]
    assert found.kind.tolist() == [KINDS.index("moving")] * 2


def test_of_nothing():
    found = positions([])
    assert len(found) == 0
    assert len(Positions.make("truth", [], [], np.empty((0, 2)), kind=[], group=[])) == 0


def test_of_the_reports_of_a_scan_tracker_without_tentative_tracks():
    reports = scan.TrackReports(
        *(np.arange(3), np.arange(3.0), np.array([1, 1, 2])),
        *(np.ones((3, 2)), np.full((3, 2), 7.0), np.ones((3, 4))),
        *(np.array([0, 1, 2], np.uint8), np.array([0, 1, 2], np.uint8)),
        *(np.ones(3), np.zeros(3), np.array([0, 1, -1])),
    )
    found = Positions.of(reports, "tracks")
    assert found.coasting.tolist() == [False, True]
    assert found.id.tolist() == [1, 2]
    assert found.kind.tolist() == [1, 2]
    assert found.velocity.tolist() == [[7.0, 7.0]] * 2


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"time": [[0.0]]}, r"tracks: time has shape \(1, 1\); expected \(n,\)"),
        ({"time": [0, np.nan, 1]}, "tracks: time of row 1 is nan; expected a finite number"),
        ({"id": [1]}, r"tracks: id has shape \(1,\), time \(3,\); expected as many"),
        ({"position": [[0, 0]]}, r"position has shape \(1, 2\); expected \(3, n_axes\)"),
        ({"position": [[0, np.inf]] * 3}, "position of row 0 is infinite; expected m, or NaN"),
        ({"velocity": [1.0, 1.0, 1.0]}, "velocity and position have different numbers of axes"),
        ({"kind": ["moving", "still", "static"]}, "kind .*still.*; expected one of undecided, mov"),
        ({"kind": [0, 3, 1]}, "kind .*3.*; expected one of undecided, moving, static"),
        ({"id": ["a", "a", "b"]}, "a has two positions at time 0; expected one for each object"),
        ({"color": [1, 2, 3]}, "tracks: has 'color', which is not known; expected time, id, pos"),
    ],
)
def test_what_is_wrong_is_named(change, message):
    with pytest.raises(ValueError, match=message):
        Positions.of({**THREE, **change}, "tracks")


def test_a_coasting_row_beside_a_plot_is_left_out():
    rows = {
        "time": [4.0, 4.0, 8.0, 8.0, 8.0],
        "id": [1, 1, 1, 2, 1],
        "position": [[0, 0], [1, 0], [2, 0], [9, 9], [3, 0]],
        "group": ["a", "a", "a", "a", "b"],
    }
    found = Positions.of({**rows, "coasting": [True, False, True, True, True]}, "tracks")
    assert found.position[:, 0].tolist() == [1, 2, 9, 3]
    assert found.doubles == 1
    assert Positions.of(found, "tracks").doubles == 1
    for coasting in ([True, True, False, False, False], [False] * 5):
        with pytest.raises(ValueError, match=r"1 has two positions at time 4; .* and time$"):
            Positions.of({**rows, "coasting": coasting}, "tracks")
    with pytest.raises(ValueError, match="or a column status that says which row is coasting"):
        Positions.of(rows, "tracks")


def test_something_else():
    with pytest.raises(ValueError, match="truth: has no 'position'; expected time, id, position"):
        Positions.of({"time": [], "id": []}, "truth")
    with pytest.raises(TypeError, match="truth: int; expected a path, a mapping"):
        Positions.of(3, "truth")
