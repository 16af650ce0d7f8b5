"""CLEAR MOT, IDF1 and HOTA on small scenes: by hand, and by brute force over identities."""

import math
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scored_scenes import pairs, random_scene, scene

from fuzzytrack.scoring.clear_mot import clear_mot
from fuzzytrack.scoring.correspondences import Correspondences
from fuzzytrack.scoring.hota import THRESHOLDS, hota
from fuzzytrack.scoring.idf1 import idf1


def clear(of, reach=10.0):
    return clear_mot(of, Correspondences.of(of, pairs(of), reach))


def straight(ids, offset=1.0):
    """One object over instants, with a track of these ids, None where there is none."""
    truth = [(k, 0, 10.0 * k, 0.0) for k in range(len(ids))]
    tracks = [(k, id, 10.0 * k, offset) for k, id in enumerate(ids) if id is not None]
    return scene(truth, tracks, instants=len(ids))


def test_a_switch_and_a_break():
    found = clear(straight([0, 0, None, 0, 1, 1, None, None]))
    assert (found.switches, found.fragmentations, found.misses, found.matches) == (1, 1, 3, 5)
    assert found.mota == pytest.approx(1 - (3 + 0 + 1) / 8)
    assert found.motp == pytest.approx(1.0)


def test_an_id_that_comes_back_is_another_switch():
    assert clear(straight([0, 1, 0])).switches == 2
    assert clear(straight([0, None, 0])).switches == 0


def test_a_track_is_kept_though_another_is_nearer():
    of = scene(
        [(k, 0, 0.0, 0.0) for k in range(3)],
        [(k, 0, 0.0, 5.0) for k in range(3)] + [(k, 1, 0.0, 1.0) for k in (1, 2)],
    )
    found = Correspondences.of(of, pairs(of), 10.0)
    assert of.tracks.id[found.pairs.track_row].tolist() == [0, 0, 0]
    assert clear(of).false_positives == 2


def test_as_many_pairs_as_possible():
    """The nearest pair is not taken if it leaves an object without a track."""
    of = scene(
        [(0, 0, 0.0, 0.0), (0, 1, 8.0, 0.0)], [(0, 0, 7.0, 0.0), (0, 1, 17.0, 0.0)], instants=1
    )
    found = clear(of)
    assert (found.matches, found.motp) == (2, pytest.approx(8.0))


def test_a_distance_equal_to_the_reach_is_a_match():
    of = scene([(0, 0, 0.0, 0.0)], [(0, 0, 3.0, 4.0)])
    assert clear(of, 5.0).matches == 1
    assert clear(of, np.nextafter(5.0, 0)).matches == 0


def test_two_objects_that_had_the_same_track():
    of = scene(
        [(0, 0, 0.0, 0.0), (1, 1, 0.0, 0.0), (2, 0, 0.0, 0.0), (2, 1, 1.0, 0.0)],
        [(k, 0, 0.0, 0.0) for k in range(3)],
    )
    found = clear(of)
    assert (found.matches, found.misses, found.switches) == (3, 1, 0)


def test_nothing_to_count():
    empty = clear(scene([], [], instants=2))
    assert math.isnan(empty.mota)
    assert math.isnan(empty.motp)
    tracks_only = clear(scene([], [(0, 0, 0.0, 0.0)]))
    assert tracks_only.false_positives == 1


def identified_by_brute_force(of, reach):
    """The best of all ways to give each object a track for all time."""
    n_objects, n_tracks = len(of.truth.names), len(of.tracks.names)
    near = pairs(of, reach)
    together = np.zeros((n_objects, n_tracks + n_objects))
    np.add.at(together, (of.truth.id[near.true_row], of.tracks.id[near.track_row]), 1)
    ways = permutations(range(n_tracks + n_objects), n_objects)
    return max(sum(together[i, j] for i, j in enumerate(way)) for way in ways)


@pytest.mark.parametrize("seed", range(8))
def test_identification_as_defined(seed):
    of = random_scene(seed, objects=3, tracks=4, instants=15)
    best = identified_by_brute_force(of, 8.0)
    found = idf1(of, pairs(of), 8.0)
    assert found.idp == pytest.approx(best / len(of.tracks))
    assert found.idr == pytest.approx(best / len(of.truth))
    assert found.idf1 == pytest.approx(2 * best / (len(of.tracks) + len(of.truth)))


def test_identification_of_nothing():
    found = idf1(scene([], [], instants=1), pairs(scene([], [], instants=1)), 5.0)
    assert all(map(math.isnan, vars(found).values()))
    missed = scene([(0, 0, 0.0, 0.0)], [])
    found = idf1(missed, pairs(missed), 5.0)
    assert (found.idf1, found.idr) == (0.0, 0.0)
    assert math.isnan(found.idp)


def test_hota_of_a_track_that_is_half_of_two():
    """Two tracks of one object, half of its life each, with no error: DetA 1, AssA 1/2."""
    of = straight([0, 0, 0, 1, 1, 1], offset=0.0)
    found = hota(of, pairs(of), 20.0)
    assert (found.det_a, found.loc_a) == (pytest.approx(1), pytest.approx(1))
    assert found.ass_a == pytest.approx(0.5)
    assert found.hota == pytest.approx(math.sqrt(0.5))


def test_hota_counts_a_pair_up_to_its_similarity():
    of = straight([0] * 4, offset=8.0)
    found = hota(of, pairs(of), 20.0)
    matched = THRESHOLDS <= 0.6 + 1e-12
    assert found.curves[1].tolist() == matched.astype(float).tolist()
    assert found.hota == pytest.approx(matched.mean())
    assert found.curves[3][matched] == pytest.approx(0.6)


def test_hota_of_nothing():
    empty = scene([], [], instants=1)
    assert math.isnan(hota(empty, pairs(empty), 20.0).hota)
    missed = scene([(0, 0, 0.0, 0.0)], [])
    assert hota(missed, pairs(missed), 20.0).hota == 0.0


@given(st.integers(0, 10_000))
def test_bounds(seed):
    of = random_scene(seed, objects=3, tracks=4, instants=8)
    every = pairs(of)
    whole = hota(of, every, 20.0)
    for value in (*vars(idf1(of, every, 10.0)).values(), *whole.curves.ravel()):
        assert 0 <= value <= 1
    assert clear(of).mota <= 1
    perfect = scene(
        [(k, i, x, y) for k, i, (x, y) in _entries(of)],
        [(k, i + 1, x, y) for k, i, (x, y) in _entries(of)],
        instants=len(of.time),
    )
    # The right identities make all of these 1.
    assert hota(perfect, pairs(perfect), 20.0).hota == pytest.approx(1)
    assert idf1(perfect, pairs(perfect), 5.0).idf1 == pytest.approx(1)


def _entries(of):
    return zip(
        of.truth.instant.tolist(), of.truth.id.tolist(), of.truth.position.tolist(), strict=True
    )
