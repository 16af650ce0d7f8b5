import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fuzzytrack.simulation.noise import Noise, streams
from fuzzytrack.simulation.published import MANEUVERS, llinas_maneuver
from fuzzytrack.simulation.sensor_field import SensorField, canonical_field, sensor_grid

ONE = SensorField([[100.0, -50.0]], 1000.0, 10.0, 0.05)
# Three that overlap, each with noise of its own
SEVERAL = SensorField(
    [[0.0, 0.0], [900.0, 0.0], [5000.0, 5000.0], [400.0, 800.0]],
    1000.0,
    [10.0, 20.0, 1.0, 5.0],
    [0.02, 0.05, 0.01, 0.1],
)
PATH = np.stack([np.linspace(-1500, 1500, 13), np.full(13, 200.0)], axis=1)


def test_the_grid_is_centred_and_row_after_row():
    field = sensor_grid(3, 10.0, 4.0, 1.0, 0.1, centre=(1.0, 2.0))
    assert_array_equal(field.position[:4], [[-9, -8], [1, -8], [11, -8], [-9, 2]])
    assert_array_equal(field.position.mean(axis=0), [1.0, 2.0])


def test_the_canonical_field_touches_and_covers_a_quarter_of_pi():
    field = canonical_field()
    assert field.position.min() == -6000
    assert field.sees([1000.0, 0.0]).sum() == 2
    assert field.sees([1000.0, 1.0]).sum() == 0
    places = np.random.default_rng(1).uniform(-7000, 7000, (4000, 2))
    seen = field.sees(places).sum(axis=1)
    assert seen.max() == 1
    assert_allclose(seen.mean(), math.pi / 4, atol=0.025)
    assert_allclose(field.range_sigma**2, 200.0)
    assert_allclose(field.bearing_sigma**2, 0.05236, atol=1e-5)


def test_covariance_is_the_rotated_one():
    rng = np.random.default_rng(2)
    for place in rng.uniform(-500, 500, (5, 2)):
        for k, found in enumerate(SEVERAL.covariance(place)):
            off = place - SEVERAL.position[k]
            far = np.hypot(*off)
            ahead, left = off / far, np.array([-off[1], off[0]]) / far
            across = far * SEVERAL.bearing_sigma[k]
            by_hand = SEVERAL.range_sigma[k] ** 2 * np.outer(ahead, ahead)
            assert_allclose(found, by_hand + across**2 * np.outer(left, left), rtol=1e-9)


@pytest.mark.parametrize("linear", [True, False])
def test_plots_have_the_covariance(linear):
    place = np.array([[500.0, 350.0]])
    plots = ONE.measure(place, streams(6, 20000), linear=linear)
    expected = ONE.covariance(place[0])[0]
    errors = plots.z[0] - place
    assert_allclose(np.cov(errors.T), expected, rtol=0.05, atol=6)
    assert_allclose(plots.sigma[0, 0] ** 2, np.diag(expected))


def test_polar_noise_is_in_range_and_bearing():
    field = SensorField([[0.0, 0.0]], 1000.0, 3.0, 0.4)
    z = field.measure(np.array([[600.0, 0.0]]), streams(6, 5000)).z[0]
    assert_allclose(np.hypot(*z.T).std(), 3.0, rtol=0.05)
    assert_allclose(np.arctan2(z[:, 1], z[:, 0]).std(), 0.4, rtol=0.05)
    # noise so large bends the cloud: a bias that the linear draw lacks
    assert_allclose(z[:, 0].mean(), 600 * math.exp(-0.08), rtol=0.01)
    straight = field.measure(np.array([[600.0, 0.0]]), streams(6, 5000), linear=True).z[0]
    assert_allclose(straight[:, 0].mean(), 600.0, atol=0.3)


def test_unseen_is_nan_and_overlaps_are_fused():
    plots = SEVERAL.measure(PATH, streams(1, 3000), linear=True)
    seen = SEVERAL.sees(PATH)
    assert_array_equal(np.isnan(plots.z).any(axis=(1, 2)), ~seen.any(axis=1))
    assert_array_equal(np.isnan(plots.sigma), np.isnan(plots.z))
    assert seen.sum(axis=1).max() == 3
    variances = np.diagonal(SEVERAL.covariance(PATH), axis1=-2, axis2=-1)
    for k in np.flatnonzero(seen.any(axis=1)):
        best = 1 / (1 / variances[k, seen[k]]).sum(axis=0)
        assert_allclose(plots.sigma[k, 0] ** 2, best)
        assert_allclose(plots.z[k].var(axis=0), best, rtol=0.15)


def test_missed_detections():
    field = SensorField([[0.0, 0.0], [1.0, 0.0]], 1000.0, 1.0, 0.01, detection=0.7)
    plots = field.measure(np.full((200, 2), 30.0), streams(2, 100))
    assert_allclose(np.isnan(plots.z[..., 0]).mean(), 0.09, atol=0.01)
    # with the noise that it has when nothing is missed
    sure = SensorField([[0.0, 0.0]], 1000.0, 1.0, 0.01)
    some = SensorField([[0.0, 0.0]], 1000.0, 1.0, 0.01, detection=0.5)
    truth = np.full((20, 2), 30.0)
    z, whole = (f.measure(truth, streams(2, 5)).z for f in (some, sure))
    assert_array_equal(z[~np.isnan(z)], whole[~np.isnan(z)])


def test_runs_do_not_depend_on_their_batch():
    rng = np.random.default_rng(3)
    # every run a path of its own, seen by other sensors
    truth = PATH[:, None] + rng.uniform(-600, 600, (1, 7, 2))
    field = SensorField(
        SEVERAL.position, 1000.0, SEVERAL.range_sigma, SEVERAL.bearing_sigma, detection=0.8
    )
    runs, noise = streams(9, 7), Noise(correlation=0.5, freedom=5)
    whole = field.measure(truth, runs, noise=noise)
    for part in (slice(0, 1), slice(1, 4), slice(4, 7)):
        found = field.measure(truth[:, part], runs[part], noise=noise)
        assert_array_equal(found.z, whole.z[:, part])
        assert_array_equal(found.sigma, whole.sigma[:, part])


def test_sigma_from_the_plot():
    runs = streams(1, 50)
    true, told = (ONE.measure(PATH[4:6], runs, sigma_from=s) for s in ("truth", "plot"))
    assert_array_equal(true.z, told.z)
    for k in range(50):
        expected = np.diagonal(ONE.covariance(told.z[1, k])[0])
        assert_allclose(told.sigma[1, k] ** 2, expected, rtol=1e-9)
    assert (true.sigma[1] == true.sigma[1, 0]).all()


def test_colored_noise_reaches_the_plots():
    truth = np.full((300, 2), [600.0, -50.0])
    z = ONE.measure(truth, streams(1, 50), noise=Noise(correlation=0.8)).z[..., 0] - 600.0
    assert_allclose((z[1:] * z[:-1]).mean() / (z**2).mean(), 0.8, atol=0.04)


def test_a_target_that_nobody_sees():
    plots = ONE.measure(np.full((3, 2), 1e5), streams(1, 2))
    assert np.isnan(plots.z).all()
    assert plots.z.shape == (3, 2, 2)


def test_missing_scans_of_the_canonical_maneuvers():
    # counted from 1; the second of M1 is what the start interpolates
    missing = {
        "M1": [2, 3, 15, 16],
        "M2": [6, 7, 20],
        "M3": [5, 11, 13],
        "M4": [4, 5, *range(17, 21)],
    }
    field = canonical_field()
    for name in MANEUVERS:
        unseen = ~field.sees(llinas_maneuver(name)[1]).any(axis=1)
        assert (np.flatnonzero(unseen) + 1).tolist() == missing[name]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"position": np.zeros((0, 2))}, r"one sensor at least; got shape \(0, 2\)"),
        ({"position": [0.0, 1.0]}, "position must have shape"),
        ({"position": [[0.0, math.inf]]}, "position must be finite"),
        ({"reach": 0.0}, "reach must be finite and > 0, got 0"),
        (
            {"reach": [1.0, 2.0]},
            r"reach must be a number or 1, one for each sensor; got shape \(2,\)",
        ),
        ({"range_sigma": -1.0}, "range_sigma must be finite and > 0, got -1"),
        ({"bearing_sigma": math.nan}, "bearing_sigma must be finite and > 0, got nan"),
        ({"detection": 0.0}, "detection must be > 0 and <= 1, got 0.0"),
        ({"detection": math.nan}, "detection must be"),
    ],
)
def test_impossible_fields(change, message):
    good = {"position": [[0.0, 0.0]], "reach": 1.0, "range_sigma": 1.0, "bearing_sigma": 1.0}
    with pytest.raises(ValueError, match=message):
        SensorField(**(good | change))


def test_a_target_at_a_sensor_is_refused_where_its_variance_is_taken_there():
    path = [[50.0, -50.0], [100.0, -50.0]]
    with pytest.raises(ValueError, match=r"exactly at a sensor.*move its start"):
        ONE.measure(path, streams(0, 1))
    plots = ONE.measure(path, streams(0, 1), sigma_from="plot")
    assert np.all(plots.sigma > 0)


def test_impossible_grids_and_measurements():
    with pytest.raises(ValueError, match="n must be at least 1, got 0"):
        sensor_grid(0, 1.0, 1.0, 1.0, 1.0)
    with pytest.raises(ValueError, match="spacing must be finite and > 0, got 0"):
        sensor_grid(2, 0.0, 1.0, 1.0, 1.0)
    with pytest.raises(ValueError, match="centre must be two coordinates"):
        sensor_grid(2, 1.0, 1.0, 1.0, 1.0, centre=(0.0,))
    with pytest.raises(ValueError, match="unknown 'here'; one of truth, plot"):
        ONE.measure(PATH, streams(1, 1), sigma_from="here")
    with pytest.raises(ValueError, match=r"needs shape \(..., 2\), got shape \(13, 1, 3\)"):
        ONE.measure(np.zeros((13, 3)), streams(1, 1))
    with pytest.raises(ValueError, match="read-only"):
        ONE.reach[0] = 5.0
