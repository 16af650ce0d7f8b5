import numpy as np
import pytest

from fuzzytrack.simulation.noise import Noise, noisy_plots, streams
from fuzzytrack.simulation.scenario import FieldSensors, PlotNoise, Scenario
from fuzzytrack.simulation.sensor_field import canonical_field

T = np.arange(6.0)
ONE = np.stack([T, -2 * T], axis=1)


def test_plots_have_the_noise_told():
    truth = np.zeros((4000, 2))
    noise = Noise(correlation=0.5)
    plots = PlotNoise((3.0, 7.0), noise).measure(truth, streams(2, 3))
    np.testing.assert_array_equal(plots.z, noisy_plots(truth, [3.0, 7.0], streams(2, 3), noise).z)
    np.testing.assert_array_equal(plots.sigma, np.broadcast_to([3.0, 7.0], (4000, 3, 2)))


def test_missed_plots():
    truth = np.zeros((2000, 2))
    runs = streams(2, 4)
    every = PlotNoise(3.0).measure(truth, runs)
    some = PlotNoise(3.0, detection=0.7, clean=5).measure(truth, runs)
    missed = np.isnan(some.z)
    # Both axes of a plot, never the clean ones, and the noise is that of full detection.
    np.testing.assert_array_equal(missed[..., 0], missed[..., 1])
    assert not missed[:5].any()
    np.testing.assert_array_equal(some.z[:5], 0)
    np.testing.assert_array_equal(some.z[5:][~missed[5:]], every.z[5:][~missed[5:]])
    np.testing.assert_array_equal(np.isnan(some.sigma), missed)
    scans = missed[5:, :, 0].size
    assert abs(missed[5:, :, 0].mean() - 0.3) < 4 * np.sqrt(0.3 * 0.7 / scans)
    # Runs miss different scans; the same ones when asked again, and in any company.
    assert (missed[:, 0] != missed[:, 1]).any()
    np.testing.assert_array_equal(
        PlotNoise(3.0, detection=0.7, clean=5).measure(truth, runs[2:]).z, some.z[:, 2:]
    )


TRUTH = np.zeros((3000, 2))


def test_the_share_of_plots_is_the_probability_of_detection():
    for detection in (0.9, 0.7, 0.5, 0.3):
        plots = PlotNoise(1.0, detection=detection).measure(TRUTH, streams(4, 5))
        seen = ~np.isnan(plots.z[..., 0])
        assert abs(seen.mean() - detection) < 4 * np.sqrt(detection * (1 - detection) / seen.size)


def test_a_standard_deviation_of_each_plot():
    every = PlotNoise((3.0, 7.0)).measure(TRUTH, streams(4, 3))
    plots = PlotNoise((3.0, 7.0), spread=2.0).measure(TRUTH, streams(4, 3))
    factor = plots.sigma[..., 0] / 3
    # One factor a plot, told to the tracker, and the noise is as large as that.
    np.testing.assert_allclose(plots.sigma[..., 1], 7 * factor, rtol=1e-14)
    np.testing.assert_allclose(plots.z, every.z * factor[..., None], rtol=1e-14)
    logs = np.log2(factor)
    assert (logs >= -1).all()
    assert (logs < 1).all()
    assert abs(logs.mean()) < 4 / np.sqrt(3 * logs.size)
    np.testing.assert_allclose(logs.std(), 1 / np.sqrt(3), rtol=0.03)
    # As told in any company
    alone = PlotNoise((3.0, 7.0), spread=2.0).measure(TRUTH, streams(4, 3)[1:])
    np.testing.assert_array_equal(alone.sigma, plots.sigma[:, 1:])


def test_given_factors_return():
    plots = PlotNoise(4.0, factors=[1, 0.5, 3]).measure(np.zeros((7, 1)), streams(4, 2))
    expected = 4 * np.array([1, 0.5, 3, 1, 0.5, 3, 1])
    np.testing.assert_array_equal(plots.sigma[:, 1, 0], expected)
    every = PlotNoise(1.0).measure(np.zeros((7, 1)), streams(4, 2))
    np.testing.assert_allclose(plots.z[:, 1, 0], expected * every.z[:, 1, 0], rtol=1e-14)


def test_outliers_are_not_told():
    every = PlotNoise(3.0).measure(TRUTH, streams(4, 3))
    plots = PlotNoise(3.0, outliers=(0.02, 10.0)).measure(TRUTH, streams(4, 3))
    np.testing.assert_array_equal(plots.sigma, every.sigma)
    out = plots.z[..., 0] != every.z[..., 0]
    assert abs(out.mean() - 0.02) < 4 * np.sqrt(0.02 / out.size)
    np.testing.assert_allclose(plots.z[out], 10 * every.z[out], rtol=1e-13)
    np.testing.assert_array_equal(plots.z[~out], every.z[~out])


@pytest.mark.parametrize("told", [0.5, 2.0])
def test_a_wrong_standard_deviation_is_told(told):
    every = PlotNoise((3.0, 7.0), detection=0.8).measure(TRUTH, streams(4, 3))
    plots = PlotNoise((3.0, 7.0), detection=0.8, told=told).measure(TRUTH, streams(4, 3))
    np.testing.assert_array_equal(plots.z, every.z)
    np.testing.assert_array_equal(plots.sigma, told * every.sigma)


def test_what_is_drawn_for_one_purpose_does_not_depend_on_another():
    runs = streams(4, 3)
    some = PlotNoise(1.0, detection=0.6).measure(TRUTH, runs)
    noise = PlotNoise(1.0, detection=0.6, spread=3.0, outliers=(0.1, 5.0), told=0.5)
    both = noise.measure(TRUTH, runs)
    np.testing.assert_array_equal(np.isnan(some.z), np.isnan(both.z))
    spread = PlotNoise(1.0, spread=3.0).measure(TRUTH, runs)
    seen = ~np.isnan(both.z)
    np.testing.assert_array_equal(both.sigma[seen], 0.5 * spread.sigma[seen])
    again = noise.measure(TRUTH, runs)
    np.testing.assert_array_equal(again.z, both.z)


def test_tracks_of_their_own():
    truth = np.stack([ONE, ONE + 100], axis=1)
    plots = PlotNoise(1.0, clean=2).measure(truth, streams(0, 2))
    np.testing.assert_array_equal(plots.z[:2], truth[:2])
    assert (abs(plots.z - truth) < 6).all()


def test_field_sensors_measure_as_the_field_does():
    field = canonical_field()
    truth = np.tile([100.0, 50.0], (5, 1))
    told = {"noise": Noise(correlation=0.4), "linear": True, "sigma_from": "plot"}
    plots = FieldSensors(field, **told).measure(truth, streams(1, 2))
    asked = field.measure(truth, streams(1, 2), **told)
    np.testing.assert_array_equal(plots.z, asked.z)
    np.testing.assert_array_equal(plots.sigma, asked.sigma)


def test_truth_of_runs():
    one = Scenario("one", T, ONE, PlotNoise(1.0), velocity=np.ones_like(ONE))
    position, velocity = one.truth(7, 3)
    np.testing.assert_array_equal(position, ONE)
    np.testing.assert_array_equal(velocity, np.ones_like(ONE))
    assert one.n_axes == 2
    tracks = np.stack([ONE, ONE + 10, ONE + 20], axis=1)
    three = Scenario("three", T, tracks, PlotNoise(1.0), velocity=2 * tracks)
    position, velocity = three.truth(4, 4)
    # Runs 4 to 7 fly tracks 1, 2, 0, 1.
    np.testing.assert_array_equal(position, tracks[:, [1, 2, 0, 1]])
    np.testing.assert_array_equal(velocity, 2 * position)
    assert Scenario("no velocity", T, tracks, PlotNoise(1.0)).truth(0, 2)[1] is None


def test_times_of_runs():
    tracks = np.stack([ONE, ONE + 10, ONE + 20], axis=1)
    times = T[:, None] * [1.0, 2.0, 4.0]
    three = Scenario("three", times, tracks, PlotNoise(1.0))
    np.testing.assert_array_equal(three.times(4, 4), times[:, [1, 2, 0, 1]])
    np.testing.assert_allclose(three.scan_time, T * 7 / 3)
    common = Scenario("common", T, tracks, PlotNoise(1.0))
    np.testing.assert_array_equal(common.times(4, 4), T)
    np.testing.assert_array_equal(common.scan_time, T)
    with pytest.raises(ValueError, match="prepare_start must be False where tracks have times of"):
        Scenario("three", times, tracks, PlotNoise(1.0), prepare_start=True)
    with pytest.raises(ValueError, match="time must be two increasing times"):
        Scenario("three", -times, tracks, PlotNoise(1.0))


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ({"sigma": 0.0}, "sigma must be"),
        ({"sigma": (1.0, -2.0)}, "sigma must be"),
        ({"detection": 0.0}, "detection must be > 0 and <= 1, got 0"),
        ({"detection": 1.1}, "detection must be > 0 and <= 1, got 1.1"),
        ({"clean": -1}, "clean must not be negative, got -1"),
        ({"factors": [1, 0]}, "factors must be finite and > 0, got 0 at index 1"),
        ({"spread": 0.5}, "spread must be finite and >= 1, got 0.5"),
        ({"spread": np.inf}, "spread must be finite and >= 1, got inf"),
        ({"outliers": (1.5, 5.0)}, "outliers must be a share from 0 to 1 and a factor > 0, got 1"),
        ({"outliers": (0.1, 0.0)}, "outliers must be a share .* > 0, got 0.1 and 0"),
        ({"told": 0.0}, "told must be finite and > 0, got 0"),
    ],
)
def test_impossible_noise(wrong, complaint):
    with pytest.raises(ValueError, match=complaint):
        PlotNoise(**{"sigma": 1.0, **wrong})


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ({"time": [0.0]}, "time must be two increasing times"),
        ({"time": T[::-1]}, "time must be two increasing times"),
        ({"time": T[:, None]}, r"time must be common .* shape \(6,\); got \(6, 1\)"),
        ({"position": T}, r"position must have shape \(6, n_axes\)"),
        ({"position": ONE[:5]}, r"position must have shape .* got \(5, 2\)"),
        ({"position": ONE[:, :0]}, "position must have shape"),
        ({"position": ONE * np.nan}, "position must be"),
        ({"velocity": ONE[:, :1]}, "velocity must be shaped as position"),
        ({"first_scored": 6}, "first_scored must be a scan from 0 to 5, got 6"),
        ({"first_scored": -1}, "first_scored must be a scan"),
        ({"process_sigma": -0.1}, "process_sigma must be"),
    ],
)
def test_impossible_scenarios(wrong, complaint):
    given = {"name": "n", "time": T, "position": ONE, "sensors": PlotNoise(1.0)}
    with pytest.raises(ValueError, match=complaint):
        Scenario(**{**given, **wrong})
