"""OSPA, GOSPA and OSPA(2): by brute force from their definitions, and what makes them metrics."""

from itertools import combinations, permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scored_scenes import one_instant, pairs, points, random_scene, scene, swapped

from fuzzytrack.scoring.gospa import gospa
from fuzzytrack.scoring.ospa import SetAssignment, ospa
from fuzzytrack.scoring.ospa2 import ospa2

orders = st.sampled_from([1.0, 2.0, 3.0])


def assigned(of, c=20.0, p=2.0):
    return SetAssignment.of(of, pairs(of, c), c, p)


def ospa_by_brute_force(x, y, c, p, distance=lambda a, b: np.hypot(*np.subtract(a, b))):
    """The definition: the best of all ways to map the smaller set into the larger one."""
    if len(x) > len(y):
        x, y = y, x
    if not y:
        return 0.0
    costs = [
        sum(min(distance(a, b), c) ** p for a, b in zip(x, chosen, strict=True))
        for chosen in permutations(y, len(x))
    ]
    return ((min(costs) + c**p * (len(y) - len(x))) / len(y)) ** (1 / p)


def gospa_by_brute_force(x, y, c, p):
    """The definition: the best of all partial assignments."""
    best = np.inf
    for size in range(min(len(x), len(y)) + 1):
        for mine in combinations(x, size):
            for yours in permutations(y, size):
                near = sum(
                    np.hypot(*np.subtract(a, b)) ** p for a, b in zip(mine, yours, strict=True)
                )
                best = min(best, near + (len(x) + len(y) - 2 * size) * c**p / 2)
    return best ** (1 / p)


@given(points, points, orders)
def test_as_defined(x, y, p):
    of = assigned(one_instant(x, y), 17.0, p)
    assert ospa(of).distance[0] == pytest.approx(ospa_by_brute_force(x, y, 17.0, p), abs=1e-9)
    assert gospa(of).distance[0] == pytest.approx(gospa_by_brute_force(x, y, 17.0, p), abs=1e-9)


@given(points, points, orders)
def test_parts_add_up(x, y, p):
    of = assigned(one_instant(x, y), 17.0, p)
    found, general = ospa(of), gospa(of)
    whole = found.localization**p + found.cardinality**p
    assert whole == pytest.approx(found.distance**p)
    assert found.cardinality[0] ** p == pytest.approx(
        17.0**p * abs(len(x) - len(y)) / max(1, len(x), len(y))
    )
    parts = general.localization**p + (general.missed + general.false) * 17.0**p / 2
    assert parts == pytest.approx(general.distance**p)
    assert general.false[0] - general.missed[0] == len(y) - len(x)


@given(points, points, points, orders)
def test_they_are_metrics(x, y, z, p):
    for measure in (ospa, gospa):
        xy, yz, xz = (
            measure(assigned(one_instant(a, b), 15.0, p)).distance[0]
            for a, b in ((x, y), (y, z), (x, z))
        )
        back = measure(assigned(one_instant(y, x), 15.0, p)).distance[0]
        assert xy == pytest.approx(back)
        assert measure(assigned(one_instant(x, x), 15.0, p)).distance[0] == pytest.approx(0)
        assert xz <= xy + yz + 1e-9
        assert (xy == pytest.approx(0, abs=1e-9)) == (sorted(x) == sorted(y))


@given(points, points, orders)
def test_bounds(x, y, p):
    found = ospa(assigned(one_instant(x, y), 12.0, p))
    assert 0 <= found.distance[0] <= 12.0 + 1e-9
    most = (12.0**p / 2 * (len(x) + len(y))) ** (1 / p)
    assert gospa(assigned(one_instant(x, y), 12.0, p)).distance[0] <= most + 1e-9


def test_nothing_one_and_many():
    empty = one_instant([], [])
    assert ospa(assigned(empty)).distance.tolist() == [0.0]
    alone = one_instant([], [(1.0, 2.0)])
    assert ospa(assigned(alone)).distance.tolist() == [20.0]
    assert gospa(assigned(alone)).false.tolist() == [1.0]
    assert gospa(assigned(alone)).distance.tolist() == [pytest.approx(20 / np.sqrt(2))]
    # A hundred objects a kilometer apart, each with a track 3 m from it, and one more.
    far = [(1000.0 * k, 0.0) for k in range(100)]
    near = [(x + 3.0, y) for x, y in far]
    many = ospa(assigned(one_instant(far, [*near, (0.0, 900.0)])))
    assert many.distance[0] == pytest.approx(np.sqrt((100 * 9 + 400) / 101))


def test_a_large_set_is_as_a_small_one():
    """Above some size a tree finds the near pairs."""
    rng = np.random.default_rng(8)
    truth = rng.uniform(0, 3000, (300, 2))
    tracks = np.concatenate([truth + rng.normal(0, 5, truth.shape), rng.uniform(0, 3000, (50, 2))])
    large = pairs(one_instant(truth, tracks), 40.0)
    distance = np.hypot(*(truth[:, None] - tracks).T).T
    rows, columns = np.nonzero(distance <= 40.0)
    assert sorted(zip(large.true_row.tolist(), large.track_row.tolist(), strict=True)) == sorted(
        zip(rows.tolist(), columns.tolist(), strict=True)
    )
    assert large.distance == pytest.approx(distance[large.true_row, large.track_row])


# -------------------------------------------------------------------- OSPA(2)


def ospa2_by_brute_force(of, c, p, window):
    """The definition, for small scenes."""
    values = []
    for end in range(len(of.time)):
        sets = []
        for side in (of.truth, of.tracks):
            lives = {}
            for k, id, place in zip(
                side.instant.tolist(), side.id.tolist(), side.position.tolist(), strict=True
            ):
                if end - window < k <= end:
                    lives.setdefault(id, {})[k] = place
            sets.append(list(lives.values()))

        def apart(f, g):
            union = f.keys() | g.keys()
            each = [
                min(np.hypot(*np.subtract(f[t], g[t])), c) if t in f and t in g else c
                for t in union
            ]
            return np.mean(np.power(each, p)) ** (1 / p)

        values.append(ospa_by_brute_force(*sets, c, p, apart))
    return values


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("p", "window"), [(1.0, 4), (2.0, 3), (2.0, 1), (2.0, 50)])
def test_of_tracks_as_defined(seed, p, window):
    of = random_scene(seed, objects=3, tracks=4, instants=9)
    found = ospa2(of, pairs(of, 20.0), 20.0, p, window)
    expected = ospa2_by_brute_force(of, 20.0, p, window)
    assert found.distance == pytest.approx(expected, abs=1e-9)
    assert found.distance**p == pytest.approx(found.localization**p + found.cardinality**p)
    back = ospa2(swapped(of), pairs(swapped(of), 20.0), 20.0, p, window)
    assert back.distance == pytest.approx(found.distance)


def test_of_tracks_over_one_instant_is_that_of_sets():
    of = random_scene(4, objects=6, tracks=6, instants=12)
    whole = ospa2(of, pairs(of, 20.0), 20.0, 2.0, 1)
    assert whole.distance == pytest.approx(ospa(assigned(of)).distance, abs=1e-9)


def test_a_switch_costs_while_it_is_in_the_window():
    truth = [(k, 0, 10.0 * k, 0.0) for k in range(12)]
    tracks = [(k, int(k >= 4), 10.0 * k, 0.0) for k in range(12)]
    of = scene(truth, tracks)
    found = ospa2(of, pairs(of, 20.0), 20.0, 2.0, 3).distance
    assert found[:4] == pytest.approx(0)
    assert (found[4:6] > 1).all()
    assert found[6:] == pytest.approx(0)


def test_of_tracks_without_any():
    for truth, tracks, value in (([], [], 0.0), ([(0, 0, 1.0, 1.0)], [], 20.0)):
        of = scene(truth, tracks, instants=2)
        found = ospa2(of, pairs(of, 20.0), 20.0, 2.0, 2)
        assert found.distance.tolist() == [value, value]
