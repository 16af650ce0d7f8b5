import builtins
import json
import math

import numpy as np
import pytest
from scipy import stats

from fuzzytrack import AlphaBetaTracker, FixedGains
from fuzzytrack.gains.performance import noise_ratio
from fuzzytrack.schedulers import KalmanCV
from fuzzytrack.simulation.scenario import PlotNoise, Scenario
from fuzzytrack.testbed import metrics
from fuzzytrack.testbed.montecarlo import monte_carlo
from fuzzytrack.testbed.results import Results

T, R, N, D = 3, 5, 7, 2  # trackers, runs, scans, axes
FIRST = 2


def made(**changes):
    """Asymmetric errors: trackers start at different scans, runs too, and the last run never."""
    rng = np.random.default_rng(11)
    predicted = rng.standard_normal((T, R, N, D)) * [[[[3.0, 5.0]]], [[[2.0, 1.0]]], [[[4.0, 9.0]]]]
    filtered = predicted * 0.7 + 0.1
    velocity = rng.standard_normal((T, R, N, D))
    measured = rng.standard_normal((R, N, D)) * 6
    nis, nees = rng.chisquare(2, (2, T, R, N))
    for k in range(T):
        for run in range(R):
            start = 1 + (k * run) % 3 + (run == 3)
            for array in (predicted, filtered, velocity, nis, nees):
                array[k, run, :start] = np.nan
    predicted[1, 4] = filtered[1, 4] = velocity[1, 4] = nis[1, 4] = nees[1, 4] = np.nan
    measured[1, 3] = measured[2, 5, 1] = np.nan
    nis[:, 1, 3] = np.nan
    given = {
        "scenario": "made",
        "names": ("a", "b", "c"),
        "seed": 1,
        "first_scored": FIRST,
        "time": np.arange(N) * 0.5,
        "predicted": predicted,
        "filtered": filtered,
        "velocity": velocity,
        "measured": measured,
        "nis": nis,
        "nees": nees,
        "sample": None,
    }
    return Results(**{**given, **changes})


def counting(results, first=FIRST):
    """Run and scan of all that count."""
    return [
        (run, scan)
        for run in range(results.runs)
        for scan in range(first, len(results.time))
        if not any(math.isnan(e) for e in results.predicted[:, run, scan].ravel())
    ]


def lengths(results, quantity, k, which):
    return [math.hypot(*getattr(results, quantity)[k, run, scan]) for run, scan in which]


def ratio_se(by_run):
    """Standard error of a ratio of sums, written out; by_run: lists of the values of each run."""
    runs = [values for values in by_run if values]
    total = sum(map(len, runs))
    ratio = sum(map(sum, runs)) / total
    squares = sum((sum(values) - ratio * len(values)) ** 2 for values in runs)
    return math.sqrt(squares * len(runs) / (len(runs) - 1)) / total


@pytest.mark.parametrize("quantity", ["predicted", "filtered", "velocity"])
def test_pooled_by_loops(quantity):
    results = made()
    which = counting(results)
    assert 10 < len(which) < R * (N - FIRST)
    assert results.scored_scans.tolist() == [sum(r == run for r, _ in which) for run in range(R)]
    assert results.empty_runs == 1
    assert results.unstarted_runs.tolist() == [0, 1, 0]
    for k in range(T):
        away = lengths(results, quantity, k, which)
        mean = sum(away) / len(away)
        variance = sum((d - mean) ** 2 for d in away) / len(away)
        rms = math.sqrt(sum(d * d for d in away) / len(away))
        runs = [[d for d, (r, _) in zip(away, which, strict=True) if r == run] for run in range(R)]
        rms_se = ratio_se([[d * d for d in run] for run in runs]) / (2 * rms)
        sums = [sum(run) for run in runs if run]
        checks = {
            "mean_error": mean,
            "mean_error_se": ratio_se(runs),
            "error_variance": variance,
            "error_variance_se": ratio_se([[(d - mean) ** 2 for d in r] for r in runs]),
            "rmse": rms,
            "rmse_se": rms_se,
            "cumulative": sum(sums) / len(sums),
            "cumulative_se": np.std(sums, ddof=1) / math.sqrt(len(sums)),
        }
        for name, expected in checks.items():
            assert getattr(results, name)(quantity)[k] == pytest.approx(expected, rel=1e-12), name
        for axis in range(D):
            squares = [getattr(results, quantity)[k, r, s, axis] ** 2 for r, s in which]
            assert results.rmse_per_axis(quantity)[k, axis] == pytest.approx(
                math.sqrt(sum(squares) / len(squares))
            )


@pytest.mark.parametrize("quantity", ["predicted", "filtered", "velocity"])
def test_curves_by_loops(quantity):
    results = made()
    which = counting(results, first=0)
    curve, error = results.rmse_per_scan(quantity), results.rmse_per_scan_se(quantity)
    levels = [0.0, 0.1, 0.5, 1.0]
    found = results.quantiles(levels, quantity)
    assert found.shape == (4, T, N)
    np.testing.assert_array_equal(results.quantiles(0.5, quantity), found[2])
    unknown = 0
    for k in range(T):
        for scan in range(N):
            away = lengths(results, quantity, k, [at for at in which if at[1] == scan])
            if not away:
                unknown += 1
                assert np.isnan(curve[k, scan])
                assert np.isnan(found[:, k, scan]).all()
                continue
            squares = np.square(away)
            assert curve[k, scan] == pytest.approx(math.sqrt(squares.mean()))
            if len(away) > 1:
                expected = squares.std(ddof=1) / math.sqrt(len(away)) / (2 * curve[k, scan])
                assert error[k, scan] == pytest.approx(expected)
            else:
                assert np.isnan(error[k, scan])
            np.testing.assert_allclose(found[:, k, scan], np.quantile(away, levels))
    assert unknown
    peak = results.peak(quantity)
    for k in range(T):
        best = max(range(FIRST, N), key=lambda scan: curve[k, scan])
        assert peak.scan[k] == best
        assert peak.value[k] == curve[k, best]
    assert np.nanmax(results.rmse_per_scan(quantity)[:, :FIRST]) > 0  # known before it counts


def test_plots_themselves():
    results = made()
    squares = [
        (results.measured[run, scan] ** 2).sum()
        for run, scan in counting(results)
        if not np.isnan(results.measured[run, scan]).any()
    ]
    assert results.measured_rmse == pytest.approx(math.sqrt(np.mean(squares)))
    assert len(squares) == len(counting(results)) - 2


def test_normalized_position_error():
    results = made()
    np.testing.assert_allclose(results.npe(4.0), results.rmse_per_scan() / 4)
    np.testing.assert_allclose(results.npe(4.0, "filtered"), results.rmse_per_scan("filtered") / 4)
    with pytest.raises(ValueError, match="sigma must be"):
        results.npe(0.0)
    with pytest.raises(ValueError, match="'velocity' is no position"):
        results.npe(1.0, "velocity")


@pytest.mark.parametrize("of", ["rmse", "mean"])
def test_paired_difference_is_that_of_scipy(of):
    results = made()
    which = counting(results)
    each = []
    for k in (0, 2):
        runs = [lengths(results, "filtered", k, [w for w in which if w[0] == r]) for r in range(R)]
        take = (lambda d: math.sqrt(np.mean(np.square(d)))) if of == "rmse" else np.mean
        each.append([take(run) for run in runs if run])
    found = results.paired_difference("a", "c", 0.9, "filtered", of)
    test = stats.ttest_rel(each[1], each[0])
    low, high = test.confidence_interval(0.9)
    assert found.runs == 4
    assert found.difference == pytest.approx(np.mean(each[1]) - np.mean(each[0]))
    assert found.standard_error == pytest.approx(found.difference / test.statistic)
    assert (found.low, found.high) == pytest.approx((low, high))
    assert found.significant == (test.pvalue < 0.1)
    back = results.paired_difference("c", "a", 0.9, "filtered", of)
    assert (back.difference, back.low, back.high) == pytest.approx(
        (-found.difference, -found.high, -found.low)
    )
    assert results.paired_difference("a", "a").difference == 0
    assert not results.paired_difference("a", "a").significant


def test_paired_difference_says_what_is_wrong():
    results = made()
    with pytest.raises(ValueError, match="second: no such tracker 'd'; one of a, b, c"):
        results.paired_difference("a", "d")
    with pytest.raises(ValueError, match="level must be > 0 and < 1, got 95"):
        results.paired_difference("a", "b", 95)
    with pytest.raises(ValueError, match="of: unknown 'median'"):
        results.paired_difference("a", "b", of="median")
    with pytest.raises(ValueError, match="quantity: unknown 'speed'"):
        results.rmse("speed")
    with pytest.raises(ValueError, match="the scenario has no velocity"):
        made(velocity=None).rmse("velocity")
    with pytest.raises(ValueError, match="levels must be from 0 to 1"):
        results.quantiles([0.5, 1.5])


def part_of(results, runs):
    arrays = {
        name: getattr(results, name)[:, runs]
        for name in ("predicted", "filtered", "velocity", "nis", "nees")
    }
    return made(**arrays, measured=results.measured[runs])


def test_one_run_and_none():
    one = part_of(made(), slice(0, 1))
    assert np.isfinite(one.rmse()).all()
    assert np.isnan(one.rmse_se()).all()
    found = one.paired_difference("a", "b")
    assert found.runs == 1
    assert math.isfinite(found.difference)
    assert math.isnan(found.low)
    assert not found.significant
    # Only the run without a prediction of "b": nothing counts for anyone.
    none = part_of(made(), slice(4, 5))
    assert none.empty_runs == 1
    for name in ("mean_error", "error_variance", "rmse", "rmse_se", "cumulative", "cumulative_se"):
        assert np.isnan(getattr(none, name)()).all()
    assert np.isnan(none.measured_rmse)
    assert none.peak().scan.tolist() == [-1] * T
    assert np.isnan(none.peak().value).all()
    assert none.paired_difference("a", "b").runs == 0
    assert math.isnan(none.paired_difference("a", "b").difference)
    assert not none.nis_consistency().consistent.any()
    for row in none.table():
        assert row["peak_scan"] is None
    json.dumps(none.to_json_dict(), allow_nan=False)


def test_no_error_is_no_doubt():
    squares = np.zeros((1, 4, 3))
    found = metrics.root(squares, np.ones((4, 3), bool))
    assert found.value == found.error == 0


# -------------------------------------------------------------------- consistency


def test_consistency_by_loops():
    results = made()
    for name in ("nis", "nees"):
        values = getattr(results, name)
        found = getattr(results, f"{name}_consistency")(0.9)
        for k in range(T):
            which = [at for at in counting(results) if not math.isnan(values[k][at])]

            def freedom(run, scan, name=name, k=k):
                if name == "nees":
                    return D
                both = results.measured[run, scan] + results.predicted[k, run, scan]
                return sum(not math.isnan(x) for x in both)

            number = len(which)
            degrees = sum(freedom(*at) for at in which)
            assert found.mean[k] == pytest.approx(sum(values[k][at] for at in which) / number)
            assert found.expected[k] == pytest.approx(degrees / number)
            if name == "nees":
                number = len({run for run, _ in which})
                degrees = D * number
            else:
                assert degrees == 2 * number - 1  # one axis was missed
            assert found.low[k] == pytest.approx(stats.chi2.ppf(0.05, degrees) / number)
            assert found.high[k] == pytest.approx(stats.chi2.ppf(0.95, degrees) / number)
            for scan in range(N):
                runs = [r for r in range(R) if not math.isnan(values[k, r, scan])]
                if not runs:
                    assert np.isnan(found.scan_mean[k, scan])
                    assert np.isnan(found.scan_low[k, scan])
                    continue
                degrees = sum(freedom(r, scan) for r in runs)
                expected = (
                    np.mean(values[k, runs, scan]),
                    stats.chi2.ppf(0.05, degrees) / len(runs),
                    stats.chi2.ppf(0.95, degrees) / len(runs),
                )
                assert (
                    found.scan_mean[k, scan],
                    found.scan_low[k, scan],
                    found.scan_high[k, scan],
                ) == pytest.approx(expected)
    assert made(nis=None).nis_consistency() is None
    assert made(nees=None).nees_consistency() is None


@pytest.fixture(scope="module")
def disturbed():
    """Targets with the white acceleration that a right Kalman filter presumes."""
    rng = np.random.default_rng(5)
    steps, tracks, sigma_v = 40, 150, 2.0
    a = sigma_v * rng.standard_normal((steps, tracks, 2))
    v = np.cumsum(a, axis=0) - a
    x = np.cumsum(v + a / 2, axis=0) - (v + a / 2)
    scenario = Scenario(
        "disturbed",
        np.arange(float(steps)),
        x,
        PlotNoise(10.0, detection=0.9),
        velocity=v,
        process_sigma=sigma_v,
    )
    trackers = {
        "right": AlphaBetaTracker(KalmanCV(sigma_v)),
        "fixed": AlphaBetaTracker(FixedGains(0.6, 0.3)),
    }
    return scenario, trackers


def test_what_is_right_is_consistent_and_what_is_wrong_is_not(disturbed):
    scenario, trackers = disturbed
    found = monte_carlo(scenario, trackers, 150, 3)
    # The covariance is exact for any gains, so fixed gains are consistent as well: 99.9 %, as the
    # seed was not chosen.
    for check in (found.nis_consistency(0.999), found.nees_consistency(0.999)):
        assert check.consistent.all()
        inside = (check.scan_low <= check.scan_mean) & (check.scan_mean <= check.scan_high)
        assert inside[~np.isnan(check.scan_mean)].mean() > 0.95
    quiet = Scenario("q", scenario.time, scenario.position, scenario.sensors, process_sigma=0.2)
    wrong = monte_carlo(quiet, {"wrong": AlphaBetaTracker(KalmanCV(0.2))}, 150, 3)
    for check in (wrong.nis_consistency(0.999), wrong.nees_consistency(0.999)):
        assert not check.consistent.any()
        assert check.mean > check.high


# -------------------------------------------------------------------- against theory


def test_fixed_gains_have_the_error_of_theory():
    alpha, beta, sigma = 0.6, 0.25, 20.0
    t = np.arange(60.0)
    position = t[:, None] * [100.0, -40.0]
    scenario = Scenario("straight", t, position, PlotNoise(sigma), first_scored=40)
    found = monte_carlo(scenario, {"f": AlphaBetaTracker(FixedGains(alpha, beta))}, 400, 2)
    for quantity in ("predicted", "filtered"):
        each = noise_ratio(alpha, beta, of=quantity) * sigma**2
        expected = math.sqrt(2 * each)
        error = found.rmse_se(quantity)[0]
        assert error < 0.02 * expected
        assert abs(found.rmse(quantity)[0] - expected) < 4 * error
        assert abs(found.rmse_per_axis(quantity) - math.sqrt(each)).max() < 6 * error
        # Two equal normal axes: the distance is Rayleigh.
        mean = math.sqrt(math.pi / 2 * each)
        assert abs(found.mean_error(quantity)[0] - mean) < 4 * found.mean_error_se(quantity)[0]
        variance, error = found.error_variance(quantity)[0], found.error_variance_se(quantity)[0]
        assert abs(variance - (2 - math.pi / 2) * each) < 4 * error
    curve, error = found.rmse_per_scan()[0, 40:], found.rmse_per_scan_se()[0, 40:]
    expected = math.sqrt(2 * noise_ratio(alpha, beta)) * sigma
    assert (abs(curve - expected) < 4 * error).all()
    quartiles = found.quantiles([0.25, 0.75])[:, 0, 40:].mean(axis=1)
    rayleigh = stats.rayleigh(scale=expected / math.sqrt(2)).ppf([0.25, 0.75])
    np.testing.assert_allclose(quartiles, rayleigh, rtol=0.05)


def test_standard_errors_are_what_repeated_experiments_scatter():
    t = np.arange(15.0)
    # Runs miss plots, so each counts other scans.
    scenario = Scenario("s", t, 9 * t[:, None], PlotNoise(5.0, detection=0.5))
    tracker = {"f": AlphaBetaTracker(FixedGains(0.5, 0.2))}
    all_of_it = [monte_carlo(scenario, tracker, 60, seed) for seed in range(80)]
    for name in ("mean_error", "rmse", "cumulative"):
        values = np.array([getattr(found, name)()[0] for found in all_of_it])
        errors = np.array([getattr(found, f"{name}_se")()[0] for found in all_of_it])
        # A deviation out of 80 is known to 8 %.
        told = math.sqrt(np.mean(errors**2))
        assert values.std(ddof=1) == pytest.approx(told, rel=4 * 0.08), name


# -------------------------------------------------------------------- other forms


def test_table():
    results = made()
    rows = results.table()
    assert [row["name"] for row in rows] == ["a", "b", "c"]
    assert rows[0]["change"] is None
    difference = results.paired_difference("a", "c")
    last = rows[2]
    assert last["change"] == difference.difference
    assert (last["change_low"], last["change_high"]) == (difference.low, difference.high)
    assert last["filtered_rmse"] == results.rmse("filtered")[2]
    assert last["predicted_variance"] == results.error_variance()[2]
    assert last["velocity_mean_se"] == results.mean_error_se("velocity")[2]
    assert last["peak_time"] == results.time[results.peak().scan[2]]
    assert last["nees_high"] == results.nees_consistency().high[2]
    assert {type(value) for row in rows for value in row.values()} <= {str, int, float, type(None)}
    short = made(velocity=None, nis=None, nees=None).table()[0]
    assert not [key for key in short if key.startswith(("velocity", "nis", "nees"))]


def test_json():
    results = made()
    text = json.dumps(results.to_json_dict(), allow_nan=False)
    read = json.loads(text)
    assert read["runs"] == 5
    assert read["trackers"][1]["predicted_rmse"] == results.rmse()[1]
    curve = read["curves"]["b"]["filtered_rmse"]
    expected = results.rmse_per_scan("filtered")[1]
    assert curve == [None if math.isnan(x) else x for x in expected]
    assert None in curve
    assert read["time"] == results.time.tolist()


def test_pandas():
    pytest.importorskip("pandas")
    results = made()
    frame = results.to_pandas()
    assert len(frame) == T * N
    one = frame[(frame.tracker == "b") & (frame.scan == 4)].iloc[0]
    assert one.time == 2.0
    assert one.predicted_rmse == results.rmse_per_scan()[1, 4]
    assert one.velocity_median == results.quantiles(0.5, "velocity")[1, 4]
    assert one.nis == results.nis_consistency().scan_mean[1, 4]


def test_without_pandas(monkeypatch):
    real = builtins.__import__

    def missing(name, *rest):
        if name == "pandas":
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(ImportError, match="pip install pandas"):
        made().to_pandas()
