import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fuzzytrack import AlphaBetaTracker, FixedGains
from fuzzytrack.simulation.published import (
    ALL_SETS,
    MANEUVERS,
    kim_lee,
    llinas_maneuver,
    s3,
    track_set,
    warship,
)
from fuzzytrack.simulation.sampling import Sampling


def test_llinas_maneuvers():
    speeds, angles = {}, {}
    for name in MANEUVERS:
        t, position = llinas_maneuver(name)
        assert len(t) == 20
        assert t[-1] == 1140
        steps = np.diff(position, axis=0)
        speeds[name] = np.hypot(*steps.T) / 60
        angles[name] = np.degrees(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
        np.testing.assert_array_equal(np.diff(t), 60.0)
    assert_allclose(speeds["M1"], 6.0)
    assert_allclose(speeds["M2"], 6.0 + 0.004 * (60.0 * np.arange(19) + 30.0))
    assert_allclose(speeds["M3"], 6.0, rtol=1e-3)
    assert_allclose(speeds["M4"], speeds["M2"], rtol=1e-3)
    assert_allclose(angles["M1"], -30.0)
    assert_allclose(angles["M2"], -120.0)
    # 18 steps of 360 m on a radius of 4500 m; and 18 that grow
    assert_allclose(angles["M3"][-1] - angles["M3"][0], math.degrees(18 * 360 / 4500))
    middle = (6.0 * 1140 + 0.002 * 1140**2 + 6.0 * 1080 + 0.002 * 1080**2) / 2
    first = (6.0 * 60 + 0.002 * 60**2) / 2
    assert_allclose(angles["M4"][-1] - angles["M4"][0], math.degrees((middle - first) / 4500))
    with pytest.raises(ValueError, match="unknown maneuver 'M5'; one of M1, M2, M3, M4"):
        llinas_maneuver("M5")


def test_kim_lee():
    t, position = kim_lee()
    assert position.shape == (100, 1)
    x = np.concatenate([[0.0], position[:, 0]])
    speed = np.diff(x)
    assert_allclose(speed[:25], 120.0)
    assert_allclose(speed[35:65], 610.5)
    assert_allclose(speed[75:], 120.0)
    second = np.diff(x, n=2)
    # constant acceleration from t = 25 to 35: inner second differences show all of it
    assert_allclose(second[25:34], 49.05)
    assert_allclose(second[[24, 34]], 49.05 / 2)
    assert_allclose(second[65:74], -49.05)
    assert t[0] == 1


def test_s3_gives_the_errors_of_two_independent_implementations():
    # M1 of Al-Wagih & Abdulla without noise, over 100 scans: rms error in x and y.
    t, truth = s3()
    for alpha, expected in ((0.05, (43.56, 279.64)), (0.01, (60.58, 1102.6))):
        tracker = AlphaBetaTracker(FixedGains(alpha, alpha**2 / (2 - alpha)))
        errors = tracker.run(t, truth).predicted - truth
        rmse = np.sqrt(np.nansum(errors**2, axis=0) / 100)
        assert_allclose(rmse, expected, rtol=1e-4, atol=0.01)


def test_warship():
    t, position = warship()
    assert t[-1] == 2997
    assert_allclose(position[0], [573.0, 1038.4])
    # over the first 3 s as published; at the first instant, by the derivative at 0
    assert_allclose(np.hypot(*(position[1] - position[0])) / 3, 50.4, atol=0.02)
    a, b, w = 573 / 18, 51.92, 1e-6
    _, slow = warship(w)
    velocity = (slow[1] - slow[0]) / 3
    by_hand = [a * w * (12 + 5.6 + 27) + 10, b * w * 44]
    assert_allclose(velocity, by_hand, rtol=1e-4)
    speeds = np.hypot(*np.diff(warship()[1], axis=0).T) / 3
    assert_allclose(speeds.mean(), 30.6, atol=0.1)
    assert_allclose(speeds.max(), 54.1, atol=0.3)
    with pytest.raises(ValueError, match="rate must be finite and > 0, got 0"):
        warship(0)


def expected_rmse(tracks, alpha, beta):
    """Of the prediction in two axes: lag on the truth, and noise by the covariance."""
    truth, first = tracks.position, tracks.first_scored
    x, v = truth[1], truth[1] - truth[0]
    covariance = np.array([[1.0, 1.0], [1.0, 2.0]])
    step, gain = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[alpha], [beta]])
    keep = np.eye(2) - gain @ [[1.0, 0.0]]
    lags, noise = [], []
    for k in range(2, len(truth)):
        x = x + v
        error = truth[k] - x
        covariance = step @ covariance @ step.T
        if k >= first:
            lags.append((error**2).sum(axis=-1))
            noise.append(2 * covariance[0, 0])
        x, v = x + alpha * error, v + beta * error
        covariance = keep @ covariance @ keep.T + gain @ gain.T
    return np.sqrt(np.mean(lags, axis=0) + np.mean(noise))


def pooled(values):
    return math.sqrt(np.mean(values**2))


def test_report_set_has_the_errors_of_the_prototype():
    tracks = track_set("report", 2000, seed=11)
    values = expected_rmse(tracks, 0.5377, 0.2018)
    prototype = {"M1": 1.683, "M2": 1.737, "M3": 2.213, "M4": 3.241}
    for name, rmse in prototype.items():
        assert_allclose(pooled(values[tracks.kind == name]), rmse, rtol=0.03)
    assert_allclose(pooled(values), 2.305, rtol=0.02)


@pytest.mark.parametrize(
    ("name", "published", "tuned", "best"),
    [("mixed", 1.920, (0.49, 0.356), 1.733), ("strong", 6.151, (0.549, 0.829), 2.800)],
)
def test_sets_with_legs_have_the_errors_of_the_prototype(name, published, tuned, best):
    tracks = track_set(name, 1500, seed=11)
    assert_allclose(pooled(expected_rmse(tracks, 0.5377, 0.2018)), published, rtol=0.04)
    assert_allclose(pooled(expected_rmse(tracks, *tuned)), best, rtol=0.02)


@pytest.mark.parametrize(("name", "low", "high"), [("mixed", 0.1, 1.0), ("strong", 1.0, 3.0)])
def test_legs_keep_to_their_accelerations(name, low, high):
    tracks = track_set(name, 300, seed=5)
    assert tracks.position.shape == (60, 300, 2)
    assert (tracks.kind == name).all()
    second = np.hypot(*np.moveaxis(np.diff(tracks.position, n=2, axis=0), -1, 0))
    # straight at first, for 8 scans at least
    assert_allclose(second[:7], 0.0, atol=1e-9)
    largest = second.max(axis=0)
    assert (largest < high * 1.0001).all()
    # of a turn the chords show a little less than all
    assert (largest > low * 0.9).all()
    logs = np.log(largest)
    assert_allclose(logs.mean(), (math.log(low) + math.log(high)) / 2, atol=0.12)


def test_weaving_targets_keep_to_their_accelerations_and_periods():
    tracks = track_set("weaving", 200, 5, Sampling(period=1 / 16))
    assert tracks.first_scored == 8 * 16
    second = np.diff(tracks.position, n=2, axis=0) * 16**2
    size = np.hypot(second[..., 0], second[..., 1])
    largest = size.max(axis=0)
    assert 0.1 * 0.99 < largest.min() < 0.15
    assert 2.5 < largest.max() < 3.0
    # Always across the same course, with a sign that changes twice in a period.
    assert_allclose(np.linalg.matrix_rank(second.swapaxes(0, 1), tol=1e-7), 1)
    side = np.sign((second * second[40]).sum(axis=2))
    changes = (np.diff(side, axis=0) != 0).sum(axis=0)
    assert 2 * 59 / 40 - 1 <= changes.min() < changes.max() <= 2 * 59 / 12 + 1


@pytest.mark.parametrize("name", ALL_SETS)
def test_sets_come_from_their_seed_track_by_track(name):
    few, many = track_set(name, 3, 8), track_set(name, 9, 8)
    np.testing.assert_array_equal(few.position, many.position[:, :3])
    assert (track_set(name, 3, 9).position[-1] != few.position[-1]).all()
    np.testing.assert_array_equal(few.time, np.arange(len(few.position)))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("weak", 1, 0), "unknown set 'weak'; one of report, mixed, strong, weaving"),
        (("mixed", 0, 0), "tracks must be at least 1, got 0"),
        (("mixed", 1, -1), "seed must not be negative, got -1"),
    ],
)
def test_impossible_sets(arguments, message):
    with pytest.raises(ValueError, match=message):
        track_set(*arguments)
