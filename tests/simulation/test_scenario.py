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


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ({"sigma": 0.0}, "sigma must be"),
        ({"sigma": (1.0, -2.0)}, "sigma must be"),
        ({"detection": 0.0}, "detection must be > 0 and <= 1, got 0"),
        ({"detection": 1.1}, "detection must be > 0 and <= 1, got 1.1"),
        ({"clean": -1}, "clean must not be negative, got -1"),
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
        ({"time": T[:, None]}, "time must be two increasing times"),
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
