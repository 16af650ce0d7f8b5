import json
import math

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, FixedGains
from fuzzytrack.simulation import turning_target
from fuzzytrack.testbed import compare, compare_tracks, comparison
from fuzzytrack.trackers.catalog import make_tracker

FIXED = {"fixed": AlphaBetaTracker(FixedGains(0.5, 0.2))}
THREE = {
    name: make_tracker(name)
    for name in ("fixed:alpha=0.5377:beta=0.2018", "chan-style", "stiffness-damping")
}


def straight(steps, start=0.0):
    t = np.arange(steps) + start
    return t, np.stack([10 * t, -3 * t], axis=1)


def test_target_turns_as_told():
    t, p = turning_target()
    assert t[-1] == 180
    np.testing.assert_allclose(p[60], [9000, 0], atol=1e-9)
    # 3°/s at 150 m/s: a half circle of radius v/ω to the left, then back
    np.testing.assert_allclose(p[120], [9000, 2 * 150 / math.radians(3)], atol=1e-9)
    steps = np.hypot(*np.diff(p, axis=0).T)
    assert steps.max() <= 150 + 1e-9
    assert steps.min() > 149.9
    _, right = turning_target(turn=-math.pi)
    np.testing.assert_allclose(right, p * [1, -1], atol=1e-9)
    _, up = turning_target(heading=math.pi / 2)
    np.testing.assert_allclose(up, np.stack([-p[:, 1], p[:, 0]], axis=1), atol=1e-9)


def test_target_is_sampled_at_the_period():
    t, p = turning_target(period=4.0, straight=10.0, turn=0.0)
    np.testing.assert_array_equal(t, [0, 4, 8, 12, 16, 20])
    np.testing.assert_allclose(p[-1], [3000, 0])


@pytest.mark.parametrize(
    "wrong",
    [{"speed": 0}, {"rate": -1}, {"period": math.nan}, {"straight": -1}, {"turn": math.inf}],
)
def test_impossible_targets(wrong):
    with pytest.raises(ValueError, match="must"):
        turning_target(**wrong)


def test_rmse_by_hand():
    # Two runs, three scans: only the third is predicted, from the first two plots.
    t, truth = straight(3)
    found = compare(FIXED, t, truth, 2.0, 2, 7)
    predicted, filtered, measured = [], [], []
    for stream in np.random.SeedSequence(7).spawn(2):
        # one row more than there are scans is drawn
        noise = 2.0 * np.random.default_rng(stream).standard_normal((4, 2))[:3]
        error = 2 * noise[1] - noise[0]
        predicted.append((error**2).sum())
        filtered.append(((error + 0.5 * (noise[2] - error)) ** 2).sum())
        measured.append((noise[2] ** 2).sum())
    np.testing.assert_allclose(found.predicted_mse[0], predicted)
    np.testing.assert_allclose(found.filtered_mse[0], filtered)
    np.testing.assert_allclose(found.measured_mse, measured)
    np.testing.assert_allclose(found.predicted_rmse, math.sqrt(np.mean(predicted)))
    np.testing.assert_allclose(found.filtered_rmse, math.sqrt(np.mean(filtered)))
    np.testing.assert_allclose(found.measured_rmse, math.sqrt(np.mean(measured)))
    # of the mean of two: half their distance, through the root
    error = abs(predicted[0] - predicted[1]) / 2 / (2 * found.predicted_rmse[0])
    np.testing.assert_allclose(found.predicted_error, error)
    assert found.scans.tolist() == [1, 1]
    assert found.runs == 2
    assert np.isnan(compare(FIXED, t, truth, 2.0, 1, 7).filtered_error).all()


def test_rmse_of_fixed_gains_is_that_of_theory():
    alpha, beta, sigma = 0.5, 0.2, 5.0
    # Covariance of the error in position and velocity, from the two-point start on.
    step, gain = np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([[alpha], [beta]])
    keep = np.eye(2) - gain @ [[1.0, 0.0]]
    covariance = np.array([[1.0, 1.0], [1.0, 2.0]])
    ratios = []
    for _ in range(58):
        covariance = step @ covariance @ step.T
        ratios.append(covariance[0, 0])
        covariance = keep @ covariance @ keep.T + gain @ gain.T
    settled = (2 * alpha**2 + alpha * beta + 2 * beta) / (alpha * (4 - 2 * alpha - beta))
    assert ratios[-1] == pytest.approx(settled, rel=1e-6)

    t, truth = straight(60)
    found = compare({"f": AlphaBetaTracker(FixedGains(alpha, beta))}, t, truth, sigma, 400, 1)
    expected = sigma * math.sqrt(2 * np.mean(ratios))
    assert found.predicted_error[0] < 0.02 * expected
    assert abs(found.predicted_rmse[0] - expected) < 4 * found.predicted_error[0]
    assert abs(found.measured_rmse - sigma * math.sqrt(2)) < 0.1


def test_settled_errors_have_the_variance_of_the_noise_ratio():
    alpha, beta = 0.4, 0.15
    z = np.random.default_rng(5).standard_normal((120, 400, 1))
    result = AlphaBetaTracker(FixedGains(alpha, beta)).run(np.arange(120.0), z)
    ratio = (2 * alpha**2 + alpha * beta + 2 * beta) / (alpha * (4 - 2 * alpha - beta))
    by_run = (result.predicted[60:, :, 0] ** 2).mean(axis=0)
    error = by_run.std(ddof=1) / math.sqrt(len(by_run))
    assert abs(by_run.mean() - ratio) < 4 * error


def test_seeded_paired_and_independent_of_batches(monkeypatch):
    t, truth = turning_target(straight=10, turn=1.0)
    one = compare(THREE, t, truth, 30.0, 7, 3)
    monkeypatch.setattr(comparison, "_BATCH", 1)
    shares = []
    two = compare(THREE, t, truth, 30.0, 7, 3, shares.append)
    for name in ("predicted_mse", "filtered_mse", "measured_mse", "scans"):
        np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
    assert shares[-1] == 1
    assert len(shares) == 21
    # A tracker alone sees the noise that it sees in company, and a run the noise of any longer job.
    name = "stiffness-damping"
    alone = compare({name: THREE[name]}, t, truth, 30.0, 4, 3)
    np.testing.assert_array_equal(alone.predicted_mse[0], one.predicted_mse[2, :4])
    other = compare(THREE, t, truth, 30.0, 7, 4)
    assert (other.predicted_mse != one.predicted_mse).all()


def test_tracks_are_pooled():
    tracks = [straight(5), straight(9, 100.0), straight(5, 50.0)]
    pooled = compare_tracks(FIXED, tracks, 2.0, 3, 1)
    assert pooled.scans.tolist() == [3 + 7 + 3] * 3
    noise = [
        2.0 * np.random.default_rng(s).standard_normal((20, 2))
        for s in np.random.SeedSequence(1).spawn(3)
    ]
    squares = np.zeros(3)
    for (t, truth), part in zip(tracks, (slice(0, 5), slice(5, 14), slice(14, 19)), strict=True):
        for run in range(3):
            result = FIXED["fixed"].run(t, truth + noise[run][part])
            squares[run] += np.nansum((result.predicted - truth) ** 2)
    np.testing.assert_allclose(pooled.predicted_mse[0], squares / 13)


def test_scans_without_truth_are_not_scored():
    t, truth = straight(8)
    truth[4] = np.nan
    assert compare(FIXED, t, truth, 1.0, 2, 0).scans.tolist() == [5, 5]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"trackers": {}}, "trackers"),
        ({"sigma": 0.0}, "sigma must be positive"),
        ({"sigma": math.nan}, "sigma must be positive"),
        ({"runs": 0}, "runs must be at least 1"),
        ({"seed": -1}, "seed must not be negative"),
        ({"truth": np.zeros(5)}, "truth: needs shape"),
        ({"t": [0, 1]}, "truth: needs shape"),
        ({"t": [0, 1], "truth": np.zeros((2, 1))}, "too short"),
    ],
)
def test_wrong_arguments(change, message):
    t, truth = straight(5)
    arguments = {"trackers": FIXED, "t": t, "truth": truth, "sigma": 1.0, "runs": 2, "seed": 0}
    with pytest.raises(ValueError, match=message):
        compare(**(arguments | change))


def test_tracks_must_agree():
    with pytest.raises(ValueError, match="the same axes"):
        compare_tracks(FIXED, [straight(5), (np.arange(5), np.zeros((5, 1)))], 1.0, 1, 0)
    with pytest.raises(ValueError, match="at least one"):
        compare_tracks(FIXED, [], 1.0, 1, 0)


def test_json_and_changes_are_those_of_the_errors():
    trackers = {**FIXED, "slow": AlphaBetaTracker(FixedGains(0.2, 0.02))}
    found = compare(trackers, *straight(12), 2.0, 5, 7)
    text = json.loads(json.dumps(found.to_json_dict()))
    assert {key: text[key] for key in ("noise", "runs", "seed", "scans")} == {
        "noise": 2.0, "runs": 5, "seed": 7, "scans": 10,
    }  # fmt: skip
    assert text["measured_rmse"] == found.measured_rmse
    assert [each["name"] for each in text["trackers"]] == ["fixed", "slow"]
    for name in ("predicted_rmse", "predicted_error", "filtered_rmse", "filtered_error"):
        assert [each[name] for each in text["trackers"]] == getattr(found, name).tolist()
    first, second = found.predicted_rmse
    assert found.predicted_change.tolist() == [0.0, pytest.approx((second - first) / first)]
