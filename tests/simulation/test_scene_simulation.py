"""Simulated scans of many targets, against what was asked for."""

import math

import numpy as np
import pytest

from fuzzytrack.simulation.scene import (
    Radar,
    Region,
    ScanTimes,
    Scene,
    TargetGroup,
    UniformClutter,
    simulate_scans,
)


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
