import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fuzzytrack.simulation.noise import WHITE, Noise, noisy_plots, streams


def sample(noise, steps=400, width=500, seed=4):
    return noise.draw(np.random.default_rng(seed), (steps, width))


def correlation(values, lag):
    return (values[lag:] * values[:-lag]).mean() / (values**2).mean()


def kurtosis(values):
    return (values**4).mean() / (values**2).mean() ** 2


def test_white_noise():
    values = sample(WHITE)
    assert_allclose(values.mean(), 0.0, atol=0.01)
    assert_allclose(values.var(), 1.0, atol=0.02)
    assert_allclose(correlation(values, 1), 0.0, atol=0.01)
    assert_allclose(kurtosis(values), 3.0, atol=0.1)


@pytest.mark.parametrize("rho", [0.7, -0.5])
def test_colored_noise_is_stationary(rho):
    values = sample(Noise(correlation=rho))
    for lag in (1, 2, 3):
        assert_allclose(correlation(values, lag), rho**lag, atol=0.02)
    assert_allclose(values.var(), 1.0, atol=0.03)
    # also from the first scan on
    assert_allclose(sample(Noise(correlation=rho), 3, 100_000).var(axis=1), 1.0, atol=0.03)


def test_heavy_tails():
    values = sample(Noise(freedom=10))
    assert_allclose(values.var(), 1.0, atol=0.02)
    # of Student's t: 3 + 6/(ν - 4)
    assert_allclose(kurtosis(values), 4.0, atol=0.2)
    colored = sample(Noise(correlation=0.7, freedom=5))
    assert_allclose(colored.var(), 1.0, atol=0.03)
    assert kurtosis(colored) > 3.3


def test_plots_with_the_same_noise_everywhere():
    truth = np.stack([np.arange(30.0), -np.arange(30.0)], axis=1)
    truth[7] = np.nan
    plots = noisy_plots(truth, [15.0, 23.0], streams(3, 2000))
    assert plots.z.shape == plots.sigma.shape == (30, 2000, 2)
    assert np.isnan(plots.z[7]).all()
    assert np.isnan(plots.sigma[7]).all()
    assert_array_equal(plots.sigma[0, 0], [15.0, 23.0])
    assert_allclose(np.nanstd(plots.z - truth[:, None], axis=(0, 1)), [15.0, 23.0], rtol=0.02)


def test_a_run_is_the_same_in_any_batch():
    truth, runs = np.zeros((5, 1)), streams(3, 6)
    noise = Noise(correlation=0.3, freedom=4)
    whole = noisy_plots(truth, 2.0, runs, noise).z
    assert_array_equal(noisy_plots(truth, 2.0, runs[2:4], noise).z, whole[:, 2:4])
    own = noisy_plots(np.repeat(truth[:, None], 6, axis=1), 2.0, runs, noise).z
    assert_array_equal(own, whole)
    assert (noisy_plots(truth, 2.0, streams(4, 6), noise).z != whole).all()
    assert_array_equal(noisy_plots(truth, 2.0, streams(3, 2), noise).z, whole[:, :2])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"correlation": 1.0}, "correlation must be between -1 and 1, got 1.0"),
        ({"correlation": math.nan}, "correlation must be"),
        ({"freedom": 2.0}, "freedom must be > 2, got 2.0"),
        ({"freedom": math.nan}, "freedom must be > 2, got nan"),
    ],
)
def test_impossible_noise(arguments, message):
    with pytest.raises(ValueError, match=message):
        Noise(**arguments)


def test_wrong_arguments():
    with pytest.raises(ValueError, match="runs must be at least 1, got 0"):
        streams(1, 0)
    with pytest.raises(ValueError, match="seed must not be negative, got -1"):
        streams(-1, 1)
    with pytest.raises(ValueError, match="runs: at least one is needed"):
        noisy_plots(np.zeros((3, 2)), 1.0, [])
    with pytest.raises(ValueError, match="sigma must be finite and > 0, got 0"):
        noisy_plots(np.zeros((3, 2)), 0.0, streams(1, 1))
    for shape in ((3,), (3, 4, 2)):
        with pytest.raises(ValueError, match="truth: needs shape"):
            noisy_plots(np.zeros(shape), 1.0, streams(1, 2))
