"""Simulated scans of many targets, against what was asked for."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.simulation.scene import (
    OwnShip,
    Radar,
    Region,
    ScanTimes,
    Scene,
    TargetGroup,
    UniformClutter,
    load_scene,
    simulate_scans,
)
from fuzzytrack.simulation.scene.resolution import merged
from fuzzytrack.simulation.scene.shadows import hidden


def scene(radar=None, traffic=None, clutter=None, region=None, **scans):
    return Scene(
        "test",
        ScanTimes(**{"count": 20, "period": 2.0, **scans}),
        radar or Radar(reach=(0, 5000)),
        traffic or {"ships": TargetGroup(count=50, speed=(2, 8))},
        clutter or {},
        region,
    )


def plots_of(simulated):
    scans = simulated.scans
    numbers = np.repeat(np.arange(len(scans)), [len(each) for each in scans])
    return numbers, np.concatenate([each.positions for each in scans])


def test_without_noise_all_at_once_the_plots_are_the_truth():
    found = simulate_scans(scene(Radar(), region=Region(square=1000), antenna="at-once"))
    truth = found.truth
    assert len(truth) == 20 * 50
    assert (truth.plot >= 0).all()
    scan, position = plots_of(found)
    np.testing.assert_array_equal(scan[truth.plot], truth.scan)
    np.testing.assert_allclose(position[truth.plot], truth.position, atol=1e-9)
    np.testing.assert_array_equal(found.target_id[truth.plot], truth.target_id)
    np.testing.assert_array_equal(np.concatenate([s.rows for s in found.scans]), np.arange(1000))


def test_plots_of_a_turning_antenna_are_made_when_the_beam_points_at_them():
    found = simulate_scans(scene(traffic={"a": TargetGroup(count=80, speed=(20, 30))}))
    for each in found.scans:
        bearing = np.mod(np.arctan2(*each.positions.T), 2 * math.pi)
        expected = each.time - 2.0 * (1 - bearing / (2 * math.pi))
        # A target that crosses north during the scan is seen at its beginning or end.
        edge = np.isclose(each.times, each.time - 2.0) | np.isclose(each.times, each.time)
        assert edge.sum() <= 3
        np.testing.assert_allclose(each.times[~edge], expected[~edge], atol=1e-6)
        assert (np.diff(each.times) >= 0).all()
        assert (each.times <= each.time).all()


def test_noise_in_range_and_in_bearing_has_the_variance_asked_for():
    radar = Radar(sigma_range=15, sigma_bearing=math.radians(0.5))
    ships = {"ships": TargetGroup(count=2000, within=Region(disc=(5000, 9000)))}
    found = simulate_scans(scene(radar, ships, region=Region(square=1), antenna="at-once"), seed=3)
    truth, (_, position) = found.truth, plots_of(found)
    got, true = position[truth.plot], truth.position
    ranges = np.hypot(*got.T) - np.hypot(*true.T)
    bearings = np.angle(
        np.exp(1j * (np.arctan2(got[:, 0], got[:, 1]) - np.arctan2(true[:, 0], true[:, 1])))
    )
    n = len(truth)
    for errors, sigma in ((ranges, 15), (bearings, math.radians(0.5))):
        assert abs(errors.mean()) < 4 * sigma / math.sqrt(n)
        # The deviation of an estimate of sigma is sigma / sqrt(2 n).
        assert errors.std() == pytest.approx(sigma, rel=4 / math.sqrt(2 * n))
    assert abs(np.corrcoef(ranges, bearings)[0, 1]) < 4 / math.sqrt(n)


def test_a_target_that_is_added_leaves_the_plots_of_the_others():
    radar = Radar(reach=(0, 5000), sigma_range=5, sigma_bearing=0.01, detection=0.8)
    region = Region(square=3000)
    traffic = [{"ships": TargetGroup(count=n, speed=(2, 8), turn_rate=0.02)} for n in (5, 6)]
    traffic[1]["boats"] = TargetGroup(count=3)
    few, more = (simulate_scans(scene(radar, each, region=region), seed=7) for each in traffic)
    (_, fewer), (_, many) = plots_of(few), plots_of(more)
    for target in range(1, 6):
        np.testing.assert_array_equal(
            fewer[few.target_id == target], many[more.target_id == target]
        )


def test_clutter_is_uniform_and_poisson():
    sea = {"sea": UniformClutter(density=2e-5, within=Region(disc=(1000, 3000)))}
    none = {"ships": TargetGroup()}
    found = simulate_scans(scene(traffic=none, clutter=sea, count=200), seed=5)
    scan, position = plots_of(found)
    mean = 2e-5 * math.pi * (3000**2 - 1000**2)
    counts = np.bincount(scan, minlength=200)
    assert counts.mean() == pytest.approx(mean, abs=4 * math.sqrt(mean / 200))
    assert counts.var() == pytest.approx(mean, rel=0.4)
    # Uniform in a ring: the square of the range and the bearing are uniform.
    share = (np.hypot(*position.T) ** 2 - 1000**2) / (3000**2 - 1000**2)
    turn = np.mod(np.arctan2(*position.T) / (2 * math.pi), 1)
    for values in (share, turn):
        counted, _ = np.histogram(values, 20, (0, 1))
        expected = len(values) / 20
        chi2 = ((counted - expected) ** 2 / expected).sum()
        assert chi2 < 19 + 4 * math.sqrt(2 * 19)


# -------------------------------------------------------------------- detection


def test_the_share_detected_follows_the_curve_over_range():
    radar = Radar(reach=(500, 9000), detection=((1000, 0.95), (5000, 0.8), (9000, 0.3)))
    ships = {"ships": TargetGroup(count=5000, within=Region(disc=10_000), detection=0.9)}
    truth = simulate_scans(scene(radar, ships, antenna="at-once"), seed=2).truth
    distance, seen = np.hypot(*truth.position.T), truth.plot >= 0
    assert not seen[(distance < 500) | (distance > 9000)].any()
    np.testing.assert_array_equal(truth.visible, (distance >= 500) & (distance <= 9000))
    for low in range(1000, 9000, 1000):
        ring = (distance >= low) & (distance < low + 1000)
        # Written out: the curve has two straight parts.
        curve = np.where(
            distance < 5000,
            0.95 - 0.15 * (distance - 1000) / 4000,
            0.8 - 0.5 * (distance - 5000) / 4000,
        )
        expected = 0.9 * curve[ring].mean()
        deviation = math.sqrt(0.25 / ring.sum())
        assert seen[ring].mean() == pytest.approx(expected, abs=4 * deviation)


def test_new_targets_fade_in():
    ships = {"ships": TargetGroup(count=4000, within=Region(square=500), fade_in=30.0)}
    truth = simulate_scans(scene(Radar(), ships, region=Region(square=1), antenna="at-once")).truth
    seen = truth.plot >= 0
    for k in range(20):
        expected = min(truth.time[truth.scan == k][0] / 30, 1.0)
        assert seen[truth.scan == k].mean() == pytest.approx(expected, abs=4 * 0.5 / 63)


def test_what_is_behind_a_large_ship_is_hidden():
    groups = {
        "large": TargetGroup(path=((0, 0, 1000),), size=100),
        "behind": TargetGroup(path=((0, 60, 1500),)),
        "beside": TargetGroup(path=((0, 90, 1500),)),
        "before": TargetGroup(path=((0, 10, 960),)),
        # Across north from the ship's left end.
        "left": TargetGroup(path=((0, -140, 3000),)),
    }
    radar = Radar(reach=5000, shadowing=1)
    truth = simulate_scans(scene(radar, groups, count=3)).truth
    # Its half width is asin(50 / 1000) = 2.87 degrees; the four are at 2.3, 3.4, 0.6 and -2.7.
    np.testing.assert_array_equal(truth.plot[:5] >= 0, [True, False, True, True, False])
    np.testing.assert_array_equal(truth.visible, truth.plot >= 0)
    wider = Radar(reach=5000, shadowing=1, shadow_margin=math.radians(1))
    truth = simulate_scans(scene(wider, groups, count=3)).truth
    np.testing.assert_array_equal(truth.plot[:5] >= 0, [True, False, False, True, False])
    half = simulate_scans(scene(Radar(reach=5000, shadowing=0.5), groups, count=2000), seed=1).truth
    behind = half.plot[half.target_id == 2] >= 0
    assert behind.mean() == pytest.approx(0.5, abs=4 * 0.5 / math.sqrt(2000))


@given(seed=st.integers(0, 2**31), n=st.integers(0, 60), margin=st.floats(0, 0.3))
def test_shadows_are_those_of_all_pairs(seed, n, margin):
    rng = np.random.default_rng(seed)
    distance, bearing = rng.uniform(0, 300, n), rng.uniform(-4, 10, n)
    size = rng.choice([0.0, 10, 80], n)
    expected = np.zeros(n, bool)
    for a in range(n):
        for b in range(n):
            off = abs(math.remainder(bearing[a] - bearing[b], 2 * math.pi))
            half = math.asin(min(size[a] / 2 / distance[a], 1)) + margin
            if size[a] and distance[b] > distance[a] + size[a] / 2 and off <= half:
                expected[b] = True
    np.testing.assert_array_equal(hidden(distance, bearing, size, margin), expected)


# -------------------------------------------------------------------- resolution


def test_targets_closer_than_a_cell_in_range_and_in_bearing_share_a_plot():
    def plots(*places):
        groups = {f"{k}": TargetGroup(path=((0, *place),)) for k, place in enumerate(places)}
        radar = Radar(reach=5000, range_cell=20, beam=math.radians(2))
        return simulate_scans(scene(radar, groups, count=1, antenna="at-once"))

    # At 1,000 m the beam is 34.9 m wide.
    for apart, expected in ((34, 1), (36, 2)):
        found = plots((-apart / 2, 1000), (apart / 2, 1000))
        assert len(found.scans[0]) == expected
    for apart, expected in ((19.9, 1), (20.1, 2)):
        found = plots((0, 1000), (0, 1000 + apart))
        assert len(found.scans[0]) == expected
    # A chain: the ends alone would be resolved.
    found = plots((0, 1000), (0, 1015), (0, 1030))
    np.testing.assert_allclose(found.scans[0].positions, [[0, 1015]])
    assert found.n_echoes.tolist() == [3]
    assert found.target_id.tolist() == [1]
    assert found.truth.plot.tolist() == [0, 0, 0]


@given(seed=st.integers(0, 2**31), n=st.integers(0, 40))
def test_merged_echoes_are_the_connected_ones(seed, n):
    rng = np.random.default_rng(seed)
    scan = rng.integers(0, 3, n)
    distance, bearing = rng.uniform(0, 100, n), rng.uniform(-7, 7, n)
    label, count = merged(scan, distance, bearing, 12.0, 0.4)
    # Flood: the smallest number of all echoes that are linked.
    expected = np.arange(n)
    for _ in range(n):
        for a in range(n):
            for b in range(n):
                off = abs(math.remainder(bearing[a] - bearing[b], 2 * math.pi))
                if scan[a] == scan[b] and abs(distance[a] - distance[b]) < 12 and off < 0.4:
                    expected[a] = expected[b] = min(expected[a], expected[b])
    assert count == len(set(expected.tolist()))
    pairs = set(zip(label.tolist(), expected.tolist(), strict=True))
    assert len(pairs) == count


def test_a_merged_plot_of_two_is_seen_more_often_than_one():
    groups = {name: TargetGroup(path=((0, 0, 100),)) for name in "ab"}
    radar = Radar(reach=500, detection=0.6, range_cell=5, beam=0.1)
    found = simulate_scans(scene(radar, groups, count=4000), seed=1)
    share = len(found.target_id) / 4000
    assert share == pytest.approx(1 - 0.4**2, abs=4 * 0.37 / math.sqrt(4000))
    both = (found.n_echoes == 2).mean()
    assert both == pytest.approx(0.36 / 0.84, abs=4 * 0.5 / math.sqrt(3360))


# -------------------------------------------------------------------- births and deaths


def test_births_and_lives_have_the_rates_asked_for():
    ships = {"ships": TargetGroup(births=0.5, life=60.0, speed=(1, 2))}
    truth = simulate_scans(scene(traffic=ships, count=3000), seed=8).truth
    counts = np.bincount(truth.scan, minlength=3000)
    # In the long run births times life are there, Poisson; they are correlated over 60 s.
    late = counts[200:]
    independent = len(late) * 2 / (2 * 60)
    assert late.mean() == pytest.approx(30, abs=4 * math.sqrt(30 / independent))
    # Of those that were born 400 s before the end nearly all have died.
    first, last = (np.full(len(truth.groups), x) for x in (np.inf, -np.inf))
    np.minimum.at(first, truth.target_id - 1, truth.time)
    np.maximum.at(last, truth.target_id - 1, truth.time)
    done = first < 6000 - 400
    lives = (last - first)[done]
    # Whole scans: a life of L has (L / 2) scans on average, with the first time a second late.
    assert lives.mean() == pytest.approx(60 - 0.5, abs=4 * 60 / math.sqrt(done.sum()))
    assert done.sum() == pytest.approx(0.5 * 5600, abs=4 * math.sqrt(2800) + 60)


def test_no_plot_is_older_than_its_target():
    ships = {"ships": TargetGroup(births=5.0, life=20.0)}
    found = simulate_scans(scene(traffic=ships), seed=8)
    times = np.concatenate([each.times for each in found.scans])
    truth = found.truth
    born = np.full(len(truth.groups), np.inf)
    np.minimum.at(born, truth.target_id - 1, truth.time)
    seen = truth.plot >= 0
    # Of those that are born during a scan, half by half, the beam has passed one half before.
    first = truth.time == born[truth.target_id - 1]
    later = truth.time > 2.0
    assert (times[truth.plot[seen]] > truth.time[seen] - 2.0).all()
    assert seen[~first].all()
    assert seen[first & later].mean() == pytest.approx(0.5, abs=0.15)


def test_a_target_that_leaves_the_region_does_not_come_back():
    ships = {
        "ships": TargetGroup(count=300, speed=(5, 9), turn_rate=0.1, leg=20, leaves="yes"),
        "others": TargetGroup(count=300, speed=(5, 9), turn_rate=0.1, leg=20),
    }
    region = Region(square=400)
    truth = simulate_scans(scene(Radar(), ships, region=region, count=60)).truth
    leavers = truth.target_id <= 300
    inside = region.holds(truth.position)
    assert inside[leavers].all()
    assert not inside[~leavers].all()
    for each in range(1, 301):
        np.testing.assert_array_equal(np.diff(truth.scan[truth.target_id == each]), 1)


def test_targets_that_return_stay_near_their_region():
    ships = {
        name: TargetGroup(count=200, speed=(5, 9), turn_rate=0.2, leg=20, returns=name)
        for name in ("yes", "no")
    }
    truth = simulate_scans(scene(Radar(), ships, region=Region(disc=200), count=500)).truth
    late = truth.scan == 499
    distance = np.hypot(*truth.position.T)
    home = np.median(distance[late & (truth.target_id <= 200)])
    gone = np.median(distance[late & (truth.target_id > 200)])
    assert home < 250 < 600 < gone


def test_targets_appear_and_start_when_they_should():
    ships = {"ships": TargetGroup(count=500, begin=(10, 20), rest=(5, 8), speed=3)}
    truth = simulate_scans(scene(Radar(), ships, region=Region(square=100), period=1.0)).truth
    counts = np.bincount(truth.scan, minlength=20)
    assert not counts[:9].any()  # scan k ends at k + 1 s
    assert counts[19] == 500
    assert counts[14] == pytest.approx(250, abs=4 * math.sqrt(125))
    speed = np.hypot(*truth.velocity.T)
    age = truth.time - np.array([truth.time[truth.target_id == k].min() for k in truth.target_id])
    assert not speed[age < 4].any()
    np.testing.assert_allclose(speed[age > 8], 3)


def test_speeds_courses_and_turns_are_within_their_limits():
    group = TargetGroup(
        count=1000,
        speed=(4, 12),
        course=(math.radians(80), math.radians(100)),
        turn_rate=math.radians(1),
        leg=30.0,
    )
    truth = simulate_scans(
        scene(Radar(), {"a": group}, region=Region(square=10), period=1.0, count=100)
    ).truth
    speed = np.hypot(*truth.velocity.T).reshape(100, 1000)
    np.testing.assert_allclose(speed, np.broadcast_to(speed[0], speed.shape))
    assert 4 <= speed.min() < 4.1
    assert 11.9 < speed.max() <= 12
    course = np.unwrap(np.arctan2(*truth.velocity.T).reshape(100, 1000), axis=0)
    straight = np.abs(np.degrees(course[0]) - 90) <= 10.0 + 1
    assert straight.mean() > 0.95  # the others turned in the first second
    turned = np.abs(np.diff(course, axis=0))
    assert turned.max() <= math.radians(1) + 1e-9


# -------------------------------------------------------------------- scans


def test_lost_scans_are_empty_and_the_truth_goes_on():
    found = simulate_scans(scene(lost=0.3, count=1000), seed=1)
    empty = np.array([len(each) == 0 for each in found.scans])
    assert empty.mean() == pytest.approx(0.3, abs=4 * math.sqrt(0.21 / 1000))
    np.testing.assert_array_equal(np.bincount(found.truth.scan), 50)
    assert (found.truth.plot[empty[found.truth.scan]] == -1).all()


def test_the_radar_measures_from_where_it_is():
    own = OwnShip(speed=10, course=math.pi / 2)
    fixed = {"buoy": TargetGroup(path=((0, 0, 400),))}
    made = Scene(
        "moving",
        ScanTimes(count=40, period=2.0),
        Radar(reach=500, sigma_bearing=0.05),
        fixed,
        own=own,
    )
    found = simulate_scans(made, seed=2)
    for k, each in enumerate(found.scans):
        assert each.own == pytest.approx((20 * (k + 1), 0))
    # Bearing noise keeps the range from where the radar was at the time of the plot.
    _, places = plots_of(found)
    times = np.concatenate([each.times for each in found.scans])
    distance = np.hypot(places[:, 0] - 10 * times, places[:, 1])
    np.testing.assert_allclose(distance, np.hypot(10 * times, 400), rtol=1e-9)
    # Out of reach from x = 300 on, which is 30 s.
    assert len(found.target_id) == 15


def test_the_echo_of_a_large_ship_wanders_along_it():
    ships = {
        "ships": TargetGroup(count=400, speed=2, course=0.0, wander=8, wander_time=6.0, size=60)
    }
    found = simulate_scans(
        scene(Radar(), ships, region=Region(square=5000), antenna="at-once", count=100)
    )
    truth, (_, places) = found.truth, plots_of(found)
    shift = (places[truth.plot] - truth.position).reshape(100, 400, 2)
    assert np.abs(shift[..., 0]).max() < 1e-6
    along = shift[..., 1]
    # Correlated over 6 s, three scans: about 100 / 6 independent values of each ship.
    assert along.std() == pytest.approx(8, rel=4 / math.sqrt(2 * 400 * 100 / 6))
    again = (along[:-1] * along[1:]).mean() / along.var()
    assert again == pytest.approx(math.exp(-2 / 6), abs=0.02)


def test_numbers_depend_on_the_seed_alone():
    one, again, other = (simulate_scans(load_scene("harbor"), seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(plots_of(one)[1], plots_of(again)[1])
    np.testing.assert_array_equal(one.truth.position, again.truth.position)
    assert len(one.target_id) != len(other.target_id)


def test_a_clutter_that_is_added_leaves_everything_else():
    sea = {"sea": UniformClutter(count=5)}
    more = {"rain": UniformClutter(count=7), **sea}
    radar = Radar(reach=5000, sigma_range=3, detection=0.8)
    one, two = (simulate_scans(scene(radar, clutter=each), seed=5) for each in (sea, more))
    kept = two.clutter != 0
    np.testing.assert_array_equal(plots_of(one)[1], plots_of(two)[1][kept])
    np.testing.assert_array_equal(one.target_id, two.target_id[kept])


def test_a_scene_without_targets_and_clutter_has_empty_scans():
    found = simulate_scans(scene(traffic={"none": TargetGroup()}))
    assert [len(each) for each in found.scans] == [0] * 20
    assert all(each.positions.shape == (0, 2) for each in found.scans)
    assert len(found.truth) == found.truth.n_targets == 0
    assert repr(found) == "<SimulatedScans: scans=20, plots=0, targets=0>"


def test_a_seed_must_not_be_negative_and_a_scene_must_fit_in_memory():
    with pytest.raises(ValueError, match="seed must not be negative, got -1"):
        simulate_scans(scene(), seed=-1)
    large = scene(traffic={"a": TargetGroup(count=100_000)}, count=1000)
    with pytest.raises(ValueError, match="1000 scans of some 100000 targets, more than 20000000"):
        simulate_scans(large)
