"""Each kind of clutter, by its statistics."""

import math

import numpy as np
import pytest

from fuzzytrack.simulation.scene import (
    Arcs,
    CreepingGlints,
    EchoGroups,
    OwnShip,
    Radar,
    Region,
    ScanTimes,
    Scene,
    Shoreline,
    SteadyPoints,
    TargetGroup,
    UniformClutter,
    simulate_scans,
)
from fuzzytrack.simulation.scene.clutter import View
from fuzzytrack.simulation.scene.streams import Streams


def view(count=400, period=1.0, region=None, speed=0.0):
    times = period * np.arange(1, count + 1)
    own = np.stack([speed * times, np.zeros(count)], axis=1)
    return View(times, 0.0, own, region or Region(square=1000))


def drawn(part, seen=None, seed=3):
    return part.plots(seen or view(), Streams(seed, "clutter", "test"))


def test_uniform_clutter_may_have_the_same_number_in_each_scan():
    scan, place = drawn(UniformClutter(count=7, exact="yes", within=Region(disc=50)))
    np.testing.assert_array_equal(np.bincount(scan), np.full(400, 7))
    assert np.hypot(*place.T).max() <= 50


def test_densities_of_regions_add_where_these_overlap():
    near, far = Region(disc=1000), Region(disc=(500, 2000))
    clutter = {
        "near": UniformClutter(density=2e-5, within=near),
        "far": UniformClutter(density=1e-5, within=far),
    }
    made = Scene(
        "rings",
        ScanTimes(count=200, period=1.0),
        Radar(reach=1800),
        {"none": TargetGroup()},
        clutter,
    )
    found = simulate_scans(made, seed=1)
    distance = np.hypot(*np.concatenate([each.positions for each in found.scans]).T)
    rings = ((0, 500, 2e-5), (500, 1000, 3e-5), (1000, 1800, 1e-5), (1800, 2000, 0))
    for low, high, density in rings:
        counted = ((distance >= low) & (distance < high)).sum()
        expected = 200 * density * math.pi * (high**2 - low**2)
        assert counted == pytest.approx(expected, abs=4 * math.sqrt(expected) + 1e-9)
    assert (found.target_id == 0).all()
    np.testing.assert_array_equal(np.unique(found.clutter), [0, 1])


def test_steady_points_are_seen_again_at_their_places():
    places = ((10.0, 20.0), (-300.0, 40.0))
    scan, place = drawn(SteadyPoints(at=places, detection=0.7, spread=3), view(2000))
    nearest = np.where(place[:, 0] < -100, 1, 0)
    for k, at in enumerate(places):
        own = nearest == k
        n = own.sum()
        assert n == pytest.approx(1400, abs=4 * math.sqrt(2000 * 0.21))
        assert len(np.unique(scan[own])) == n
        error = place[own] - at
        np.testing.assert_allclose(error.mean(axis=0), 0, atol=4 * 3 / math.sqrt(n))
        np.testing.assert_allclose(error.std(axis=0), 3, rtol=4 / math.sqrt(2 * n))
    scan, place = drawn(SteadyPoints(count=5, detection=1, spread=0))
    assert len(np.unique(place, axis=0)) == 5
    assert len(scan) == 5 * 400


def test_a_shoreline_has_its_density_along_the_line():
    line = ((-300.0, 100.0), (0.0, 100.0), (0.0, 400.0))
    scan, place = drawn(Shoreline(line=line, spacing=30, spread=0))
    mean = 600 / 30
    assert len(scan) == pytest.approx(400 * mean, abs=4 * math.sqrt(400 * mean))
    level = place[:, 1] == 100
    assert level.mean() == pytest.approx(0.5, abs=4 * 0.5 / math.sqrt(len(scan)))
    assert (place[~level, 0] == 0).all()
    counted, _ = np.histogram(place[level, 0], 10, (-300, 0))
    expected = level.sum() / 10
    assert ((counted - expected) ** 2 / expected).sum() < 9 + 4 * math.sqrt(18)
    _, place = drawn(Shoreline(line=line, spacing=30, spread=5))
    upper = place[place[:, 1] > 150]
    assert upper[:, 0].std() == pytest.approx(5, rel=4 / math.sqrt(2 * len(upper)))


def test_a_window_that_turns_shows_a_stretch_that_creeps_along_the_shore():
    circle = np.radians(np.arange(0, 361, 2))
    line = tuple(map(tuple, 200 * np.stack([np.sin(circle), np.cos(circle)], axis=1)))
    part = Shoreline(
        line=line,
        spacing=2,
        spread=0,
        window=math.radians(40),
        window_at=math.radians(350),
        window_rate=math.radians(0.5),
    )
    scan, place = drawn(part, view(200))
    bearing = np.degrees(np.arctan2(*place.T))
    off = (bearing - (350 + 0.5 * (scan + 1)) + 180) % 360 - 180
    assert -20 <= off.min() < -18
    assert 18 < off.max() <= 20
    expected = 200 * (2 * math.pi * 200 / 2) * 40 / 360
    assert len(scan) == pytest.approx(expected, abs=4 * math.sqrt(expected) + 0.01 * expected)


def test_glints_appear_live_and_creep_as_asked():
    glints = CreepingGlints(births=0.5, life=20.0, speed=(1, 1), detection=1, spread=0)
    scan, place = drawn(glints, view(4000))
    counts = np.bincount(scan, minlength=4000)
    independent = 4000 / (2 * 20)
    # As many from the first scan on.
    for part in (counts, counts[:1000]):
        assert part.mean() == pytest.approx(10, abs=4 * math.sqrt(10 / independent) * 2)
    # Glints are followed from scan to scan by their speed of 1 m/s.
    steps = []
    for k in range(1000):
        before, after = place[scan == k], place[scan == k + 1]
        apart = np.hypot(*(before[:, None] - after[None]).T)
        steps.append((np.abs(apart - 1) < 1e-9).any(axis=0).sum() / max(len(before), 1))
    assert np.mean(steps) == pytest.approx(math.exp(-1 / 20), abs=0.02)


def test_arcs_keep_their_range_from_a_radar_that_moves():
    arcs = Arcs(
        births=0.3, life=30.0, within=Region(disc=(200, 300)), spread=0, detection=1, wander=0
    )
    seen = view(1000, speed=3.0)
    # They begin around the radar's first place, so only those of the first scans are within.
    scan, place = drawn(arcs, seen)
    distance = np.hypot(*(place - seen.own[scan]).T)
    first = distance[scan == 0]
    assert ((first >= 197) & (first <= 303)).all()
    second = distance[scan == 1]
    kept = np.isclose(first[:, None], second[None]).any(axis=1)
    assert kept.mean() > 0.7


@pytest.mark.untraced
@pytest.mark.parametrize(("sweep", "wander"), [((0.02, 0.02), 0.0), ((0.0, 0.0), 6.0)])
def test_arcs_sweep_or_wander_along_their_range(sweep, wander):
    arcs = Arcs(
        births=0.02,
        life=1e5,
        within=Region(disc=(200, 300)),
        spread=0,
        detection=1,
        wander=wander,
        sweep=sweep,
    )
    _scan, place = drawn(arcs, view(100))
    distance = np.round(np.hypot(*place.T), 6)
    ways = []
    for each in np.unique(distance):
        own = distance == each
        if own.sum() == 100:
            bearing = np.unwrap(np.arctan2(*place[own].T))
            ways.append(np.diff(bearing) * (each if wander else 1))
    ways = np.array(ways)
    assert len(ways) > 1000
    if wander:
        assert ways.std() == pytest.approx(6, rel=4 / math.sqrt(2 * ways.size))
        assert abs(ways.mean()) < 4 * 6 / math.sqrt(ways.size)
    else:
        np.testing.assert_allclose(np.abs(ways), 0.02)
        assert (ways[:, 0] > 0).mean() == pytest.approx(0.5, abs=4 * 0.5 / math.sqrt(len(ways)))


def test_groups_have_members_around_a_middle_that_wanders():
    # One that is there from the start on: births times life is 1, so look for a seed.
    groups = EchoGroups(births=1e-6, life=1e6, members=40, radius=15, wander=3)
    for seed in range(50):
        scan, place = drawn(groups, view(300), seed)
        if 0 < len(scan) < 300 * 60:
            break
    counts = np.bincount(scan, minlength=300)
    assert counts.mean() == pytest.approx(40, abs=4 * math.sqrt(40 / 300))
    middle = np.stack([np.bincount(scan, axis) / counts for axis in place.T], axis=1)
    spread = place - middle[scan]
    assert spread.std() == pytest.approx(15 * math.sqrt(39 / 40), rel=0.03)
    steps = np.diff(middle, axis=0)
    expected = math.sqrt(9 + 2 * 15**2 / 40)
    assert steps.std() == pytest.approx(expected, rel=4 / math.sqrt(2 * 600))
    # The noise of the mean does not add up, the walk does: after 100 s it is 30 m from there.
    far = (middle[100:] - middle[:-100]).std()
    assert 10 < far < 90


def test_clutter_out_of_reach_is_not_seen_and_has_times_of_the_beam():
    made = Scene(
        "reach",
        ScanTimes(count=50, period=2.0),
        Radar(reach=(20, 100)),
        {"none": TargetGroup()},
        {"sea": UniformClutter(count=60)},
        Region(square=400),
        OwnShip(at=(50, 0)),
    )
    found = simulate_scans(made)
    for each in found.scans:
        east, north = (each.positions - each.own).T
        distance = np.hypot(east, north)
        assert ((distance >= 20) & (distance <= 100)).all()
        turn = np.mod(np.arctan2(east, north), 2 * math.pi) / (2 * math.pi)
        np.testing.assert_allclose(each.times, each.time - 2 * (1 - turn), atol=1e-9)


@pytest.mark.parametrize(
    "part",
    [
        UniformClutter(count=1e6),
        UniformClutter(density=1e30),
        SteadyPoints(count=100_000),
        Shoreline(line=((0, 0), (1e9, 0)), spacing=1),
        CreepingGlints(births=1e4, life=1e6),
        EchoGroups(births=1.0, life=100.0, members=1e4),
    ],
    ids=lambda part: type(part).__name__,
)
def test_clutter_that_no_memory_would_hold_is_refused(part):
    with pytest.raises(ValueError, match=r"the scene has clutter of some .* plots, more than 5000"):
        drawn(part, view(1000))
