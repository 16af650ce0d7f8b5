"""Parts of a scene: settings, regions, paths, the radar's own way, times of scans."""

import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.simulation.scene import (
    CLUTTER,
    OwnShip,
    Radar,
    Region,
    ScanTimes,
    Scene,
    TargetGroup,
    UniformClutter,
)
from fuzzytrack.simulation.scene.legs import Legs
from fuzzytrack.simulation.scene.paths import Paths
from fuzzytrack.simulation.scene.settings import settings_of
from fuzzytrack.simulation.scene.streams import Streams

REGIONS = (
    Region(disc=300, at=(50, -20)),
    Region(disc=(100, 300)),
    Region(disc=(100, 300), sector=(math.radians(300), math.radians(400))),
    Region(square=400, at=(10, 20)),
    # Not convex.
    Region(polygon=((0, 0), (300, 0), (300, 300), (150, 60), (0, 300))),
)


# -------------------------------------------------------------------- regions


@pytest.mark.parametrize("region", REGIONS, ids=str)
def test_places_in_a_region_are_uniform(region):
    rng = np.random.default_rng(4)
    places = region.draw(rng, 40_000)
    assert region.holds(places).mean() > 0.9999  # but for rounding at its border
    # Monte Carlo: as many of uniform places in a square around it as its area says.
    around = rng.uniform(-700, 700, (400_000, 2))
    inside = region.holds(around)
    share = region.area / 1400**2
    deviation = math.sqrt(share * (1 - share) / len(around))
    assert inside.mean() == pytest.approx(share, abs=4 * deviation)
    # The same in each cell of a grid, of those drawn and of those found inside.
    edges = np.linspace(-700, 700, 15)
    drawn, _, _ = np.histogram2d(*places.T, bins=(edges, edges))
    found, _, _ = np.histogram2d(*around[inside].T, bins=(edges, edges))
    share = (drawn + found) / (len(places) + inside.sum())
    variance = share * (1 / len(places) + 1 / inside.sum())
    with np.errstate(invalid="ignore"):
        z = (drawn / len(places) - found / inside.sum()) / np.sqrt(variance)
    z = z[share > 1e-4]
    assert (z**2).sum() < len(z) + 5 * math.sqrt(2 * len(z))


@pytest.mark.parametrize("region", REGIONS, ids=str)
def test_more_places_begin_with_the_same_ones(region):
    few, more = (region.draw(np.random.default_rng(1), n) for n in (7, 40))
    np.testing.assert_array_equal(few, more[:7])
    assert region.draw(np.random.default_rng(1), 0).shape == (0, 2)


def test_a_region_with_an_area_for_each_target_grows_with_their_number():
    assert Region(area_each=5000).for_targets(80).area == pytest.approx(400_000)
    assert Region(disc=5).for_targets(80) == Region(disc=5)
    with pytest.raises(ValueError, match="area_each must be resolved"):
        _ = Region(area_each=5000).area


@pytest.mark.parametrize(
    ("given_", "message"),
    [
        ({}, "exactly one of disc, square, polygon, area_each, got none"),
        ({"disc": 3, "square": 3}, "got disc and square"),
        ({"disc": -3}, "disc must be a number >= 0, got -3"),
        ({"disc": 0}, "disc must have a radius > 0"),
        ({"disc": (5, 3)}, "disc must be the least number and the largest, got 5 and 3"),
        ({"disc": (5, 3, 1)}, "disc must be a number or two, the least and the largest, got 3"),
        ({"square": 0}, "square must be a number > 0, got 0"),
        ({"square": math.nan}, "square must be a number > 0, got nan"),
        ({"square": "a"}, "square must be a number > 0, got 'a'"),
        ({"polygon": ((0, 0), (1, 1), (2, 2))}, "polygon must be three corners or more"),
        ({"polygon": ((0, 0), (1, 1, 3))}, "polygon must have 2 numbers in a row, got 3"),
        ({"polygon": 3}, "polygon must be a list, got 3"),
        ({"square": 3, "sector": (0, 1)}, "sector must be a part of a disc"),
        ({"disc": 3, "sector": (1, 1)}, "sector must be a part of a disc"),
    ],
)
def test_a_wrong_region_is_refused(given_, message):
    with pytest.raises(ValueError, match=message):
        Region(**given_)


# -------------------------------------------------------------------- paths


@given(
    seed=st.integers(0, 2**31),
    n=st.integers(1, 5),
    legs=st.integers(1, 6),
)
def test_paths_are_what_small_steps_of_their_velocity_give(seed, n, legs):
    rng = np.random.default_rng(seed)
    start, heading = rng.normal(0, 1000, (n, 2)), rng.uniform(-4, 4, n)
    begin = rng.uniform(-20, 20, n)
    durations, speed = rng.uniform(0, 20, (n, legs)), rng.uniform(0, 30, (n, legs))
    rate = rng.choice([0.0, 0.05, -0.2], (n, legs))
    paths = Paths.of_legs(start, heading, begin, durations, speed, rate)
    target = int(rng.integers(n))
    end = begin[target] + durations[target].sum() + 3
    step = 0.002
    times = np.arange(begin[target], end, step)
    one = np.full(len(times), target)
    position, velocity = paths.at(one, times)
    # Midpoint rule: the error of a step is of the third order in it, but at the ends of legs.
    middle = paths.at(one[1:], times[1:] - step / 2)[1]
    walked = start[target] + np.concatenate([[[0, 0]], np.cumsum(middle * step, axis=0)])
    np.testing.assert_allclose(position, walked, atol=legs * 60 * step)
    speeds = np.hypot(*velocity.T)
    assert speeds.max() <= speed[target].max() + 1e-9
    np.testing.assert_allclose(paths.at(one[:1], times[:1])[0], start[target][None])


def test_a_path_through_points_is_there_at_its_times_and_rests_at_its_end():
    points = np.array([[0.0, 0, 0], [10, 30, 40], [30, 30, -20]])
    paths = Paths.through(points)
    zero = np.zeros(5, int)
    position, velocity = paths.at(zero, np.array([0.0, 5, 10, 30, 99]))
    np.testing.assert_allclose(position, [[0, 0], [15, 20], [30, 40], [30, -20], [30, -20]])
    np.testing.assert_allclose(velocity, [[3, 4], [3, 4], [0, -3], [0, 0], [0, 0]], atol=1e-12)


def test_joined_paths_keep_their_targets():
    one = Paths.through(np.array([[0.0, 0, 0], [10, 10, 0]]))
    two = Paths.through(np.array([[0.0, 5, 5]]))
    joined = Paths.joined([one, two, one])
    assert len(joined) == 3
    position, _ = joined.at(np.array([2, 1, 0]), np.array([3.0, 3, 4]))
    np.testing.assert_allclose(position, [[3, 0], [5, 5], [4, 0]])
    assert joined.at(np.empty(0, int), np.empty(0))[0].shape == (0, 2)


def test_legs_have_the_durations_and_turns_asked_for():
    n = 4000
    legs = Legs(30.0, 0.02, (0.3, 1.0), (0.5, 1.5))
    zero = np.zeros(n)
    durations, rates = legs.draw(Streams(3, "test"), np.zeros((n, 2)), zero, zero, zero + 1e-9)
    # One straight leg, a turn, and the last leg, which goes on.
    assert durations.shape == rates.shape == (n, 3)
    assert not rates[:, [0, 2]].any()
    assert durations[:, 0].mean() == pytest.approx(30, abs=4 * 30 / math.sqrt(n))
    assert durations[:, 0].std() == pytest.approx(30, rel=0.1)
    share, change = abs(rates[:, 1]) / 0.02, abs(rates[:, 1]) * durations[:, 1]
    for values, low, high in ((share, 0.3, 1.0), (change, 0.5, 1.5)):
        counted, _ = np.histogram(values, 10, (low, high))
        assert counted.sum() == n
        assert ((counted - n / 10) ** 2 / (n / 10)).sum() < 9 + 4 * math.sqrt(18)
    assert (rates[:, 1] > 0).mean() == pytest.approx(0.5, abs=4 * 0.5 / math.sqrt(n))


# -------------------------------------------------------------------- radar and scans


def test_the_own_ship_turns_to_the_right():
    ship = OwnShip(at=(100, 50), speed=5, course=0.0, turn_rate=math.pi / 2 / 10)
    places = ship.places(20.0, np.array([20.0, 30.0, 40.0]))
    radius = 5 * 10 / (math.pi / 2)
    np.testing.assert_allclose(
        places, [[100, 50], [100 + radius, 50 + radius], [100 + 2 * radius, 50]], atol=1e-9
    )


def test_the_own_ship_on_a_path_waits_for_its_first_point():
    ship = OwnShip(path=((10, 1, 2), (20, 11, 2)))
    np.testing.assert_allclose(ship.places(0.0, np.array([0.0, 15, 30])), [[1, 2], [6, 2], [11, 2]])


def test_detection_is_a_line_between_ranges_and_nothing_out_of_reach():
    radar = Radar(reach=(100, 2000), detection=((500, 1.0), (1500, 0.5)))
    found = radar.probability(np.array([99, 100, 500, 1000, 1500, 2000, 2001]))
    np.testing.assert_allclose(found, [0, 1, 1, 0.75, 0.5, 0.5, 0])
    assert Radar(reach=2000).reach == (0, 2000)


@given(
    count=st.integers(1, 200),
    period=st.floats(0.01, 100),
    jitter=st.floats(0, 0.499),
    start=st.floats(-1e4, 1e4),
)
def test_scans_follow_each_other_and_fill_the_time(count, period, jitter, start):
    scans = ScanTimes(count=count, period=period, jitter=jitter, start=start)
    ends, durations = scans.times(np.random.default_rng(0))
    assert len(ends) == count
    assert (durations > 0).all()
    np.testing.assert_allclose(ends, start + np.cumsum(durations), rtol=1e-9, atol=1e-6)
    regular = start + np.arange(1, count + 1) * period
    assert np.abs(ends - regular).max() <= jitter * period + 1e-9 * (abs(start) + count * period)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ScanTimes(count=0, period=1), "count must be a whole number >= 1"),
        (lambda: ScanTimes(count=2.5, period=1), "count must be a whole number"),
        (lambda: ScanTimes(count=2, period=0), "period must be a number > 0, got 0"),
        (lambda: ScanTimes(count=2, period=1, antenna="on"), "antenna must be one of turning, at-"),
        (lambda: Radar(detection=1.2), "detection must be a number >= 0 and <= 1, got 1.2"),
        (lambda: Radar(detection=((5, 1), (5, 0.5))), "pairs whose first numbers increase"),
        (lambda: Radar(detection=((5, 1, 2),)), "detection must be pairs of numbers, got 3"),
        (lambda: Radar(beam=4), r"beam must be a number >= 0 and <= 180 \(degrees\), got 229.183"),
        (lambda: OwnShip(path=((0, 1, 2),), speed=3), "path must be alone"),
        (lambda: OwnShip(path=((0, 1, 2), (0, 1, 2))), "path must have increasing times"),
        (lambda: OwnShip(path=((0, 1),)), "path must have 3 numbers in a row, got 2"),
        (lambda: TargetGroup(at=(0, 0), within=Region(disc=2)), "at and within both"),
        (lambda: TargetGroup(path=((0, 0, 0),), count=2), "count has no meaning beside path"),
        (lambda: TargetGroup(path=((0, 0, 0), (0, 1, 1))), "path must have increasing times"),
        (lambda: TargetGroup(life=0), "life must be a number > 0, got 0"),
        (lambda: UniformClutter(), "count or density must be given, and not both"),
        (lambda: UniformClutter(count=1, density=1), "count or density must be given"),
        (lambda: CLUTTER["points"](), "count must be given, or at without within"),
        (lambda: CLUTTER["shoreline"](line=((0, 0), (0, 0))), "line must have two different"),
        (lambda: CLUTTER["shoreline"](line=None), "line must be given"),
        (lambda: Scene("a", ScanTimes(count=1, period=1), Radar(), {}), "region must be given"),
    ],
)
def test_wrong_settings_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_parts_show_their_code_and_pickle():
    region = Region(disc=(100, 300), at=(1, 2))
    for part in (
        region,
        Radar(reach=500, sigma_range=3),
        TargetGroup(count=3, within=region, speed=(1, 4)),
        UniformClutter(count=4),
        ScanTimes(count=3, period=2.5),
    ):
        again = eval(repr(part))
        assert again == part == pickle.loads(pickle.dumps(part))
        assert hash(again) == hash(part)
    scene = Scene("a", ScanTimes(count=3, period=1), Radar(reach=9), {"x": TargetGroup(count=2)})
    assert repr(scene) == "<Scene: name=\"a\", scans=3, traffic=['x']>"
    again = pickle.loads(pickle.dumps(scene))
    assert again.traffic == scene.traffic
    assert again.radar == scene.radar


def test_every_setting_says_what_it_means():
    for part in (Region, Radar, OwnShip, ScanTimes, TargetGroup, *CLUTTER.values()):
        for name, declared in settings_of(part).items():
            assert declared.meaning, name
            assert not declared.meaning.endswith(".")
