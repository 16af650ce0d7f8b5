"""SIAP and the life of tracks, on scenes whose figures are counted by hand."""

import math

import numpy as np
import pytest
from scored_scenes import pairs, random_scene, scene

from fuzzytrack.scoring.correspondences import Correspondences
from fuzzytrack.scoring.siap import nearest_objects, siap
from fuzzytrack.scoring.track_life import track_life


def life(of, reach=10.0):
    every = pairs(of)
    near = np.zeros(len(of.tracks), dtype=bool)
    near[every.within(2 * reach).track_row] = True
    return track_life(of, Correspondences.of(of, every, reach), near)


def picture(of, reach=10.0):
    return siap(of, nearest_objects(pairs(of), reach))


# Object 0 for ten instants, 1 for the last five; track 0 follows 0 from 2 to 5, track 1 from 7 on;
# track 2 is beside track 1 at 8 and 9, track 3 is far away from 4 to 6, object 1 has none.
TRUTH = [(k, 0, 10.0 * k, 0.0) for k in range(10)] + [(k, 1, 0.0, 500.0) for k in range(5, 10)]
TRACKS = (
    [(k, 0, 10.0 * k, 3.0) for k in range(2, 6)]
    + [(k, 1, 10.0 * k, 4.0) for k in range(7, 10)]
    + [(k, 2, 10.0 * k, 6.0) for k in (8, 9)]
    + [(k, 3, -900.0, 0.0) for k in (4, 5, 6)]
)


def test_counted_by_hand():
    found = life(scene(TRUTH, TRACKS, step=2.0))
    assert found.share_tracked == pytest.approx(7 / 15)
    # After 2 steps of 2 s; never, in the 4 steps that the other one lives.
    assert found.first_match == pytest.approx((4 + 8) / 2)
    assert found.never_matched == 1
    assert (found.breaks, found.switches) == (0.5, 0.5)
    assert found.rmse == pytest.approx(math.sqrt((4 * 9 + 3 * 16) / 7))
    assert found.false_time == pytest.approx(2 * 3)
    assert found.false_per_minute == pytest.approx(60 * 6 / 20)
    assert found.redundant_per_minute == pytest.approx(60 * 4 / 20)
    # Tracks of which no kind is known move.
    assert found.moving_false_per_minute == found.false_per_minute
    assert found.static_false_per_minute == 0


def test_false_tracks_by_kind():
    kind = {0: "moving", 1: "moving", 2: "moving", 3: "static"}
    found = life(scene(TRUTH, TRACKS, kind=kind, step=2.0))
    assert found.moving_false_per_minute == 0
    assert found.static_false_per_minute == pytest.approx(60 * 6 / 20)
    kind[3] = "undecided"
    assert life(scene(TRUTH, TRACKS, kind=kind)).static_false_per_minute > 0
    kind[3] = "moving"
    assert life(scene(TRUTH, TRACKS, kind=kind, step=2.0)).moving_false_per_minute > 0


def test_a_track_a_little_too_far_off_is_redundant_and_not_false():
    found = life(scene([(0, 0, 0.0, 0.0)], [(0, 0, 12.0, 0.0)]))
    assert (found.share_tracked, found.false_per_minute) == (0.0, 0.0)
    of = scene([(k, 0, 0.0, 0.0) for k in (0, 1)], [(k, 0, 12.0, 0.0) for k in (0, 1)])
    found = life(of)
    assert (found.share_tracked, found.false_per_minute) == (0.0, 0.0)
    assert found.redundant_per_minute == pytest.approx(60)


def test_times_that_are_not_regular():
    of = scene([(k, 0, 0.0, 0.0) for k in range(3)], [(2, 0, 0.0, 0.0)])
    of.time[:] = [0.0, 1.0, 5.0]
    found = life(of)
    # The first lasts 1 s, the second 4 s, the last as long as is usual.
    assert found.share_tracked == pytest.approx(2.5 / 7.5)
    assert found.first_match == pytest.approx(5.0)


def test_nothing_to_count():
    found = life(scene([], [(0, 0, 0.0, 0.0), (1, 0, 0.0, 0.0)]))
    assert found.false_time == pytest.approx(2.0)
    for name in ("share_tracked", "first_match", "breaks", "switches", "rmse"):
        assert math.isnan(getattr(found, name)), name
    assert math.isnan(life(scene([], [], instants=0)).false_per_minute)


def test_air_picture_counted_by_hand():
    found = picture(scene(TRUTH, TRACKS, step=2.0))
    assert found.completeness == pytest.approx(7 / 15)
    assert found.ambiguity == pytest.approx(9 / 7)
    assert found.spuriousness == pytest.approx(3 / 12)
    assert found.position_accuracy == pytest.approx((4 * 3 + 3 * 4 + 2 * 6) / 9)
    # Two segments are needed, from 2 to 5 and from 7 to 9, 6 s and 4 s long.
    assert found.rate_of_number_changes == pytest.approx(1 / 10)
    assert found.longest_segment == pytest.approx(6 / (18 + 8))


def test_segments_that_overlap_are_covered_by_the_fewest():
    of = scene(
        [(k, 0, 0.0, 0.0) for k in range(10)],
        [
            (k, id, 1.0, 0.0)
            for id, lives in enumerate([(0, 4), (2, 6), (3, 5), (5, 9)])
            for k in range(lives[0], lives[1] + 1)
        ],
    )
    # 0 to 4 and 5 to 9 cover all that is covered; between 4 and 5 the others have it.
    found = picture(of)
    assert found.rate_of_number_changes == pytest.approx(1 / 9)
    assert found.longest_segment == pytest.approx(4 / 9)


def test_velocity_is_compared_where_it_is_known():
    of = scene([(k, 0, 0.0, 0.0) for k in range(4)], [(k, 0, 0.0, 0.0) for k in range(4)])
    of.truth.velocity[:] = [1.0, 0.0]
    of.tracks.velocity[:] = [[1.0, 2.0], [4.0, 4.0], [math.nan, 0.0], [1.0, 0.0]]
    assert picture(of).velocity_accuracy == pytest.approx((2 + 5 + 0) / 3)


def test_an_air_picture_of_nothing():
    assert all(map(math.isnan, vars(picture(scene([], [], instants=3))).values()))


def test_ratios_are_ratios():
    for seed in range(10):
        found = picture(random_scene(seed))
        for name in ("completeness", "spuriousness", "longest_segment"):
            assert 0 <= getattr(found, name) <= 1
        assert found.ambiguity >= 1
