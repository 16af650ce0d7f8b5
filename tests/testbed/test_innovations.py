"""What the innovations of a tracker say of it."""

import math

import numpy as np
import pytest

from fuzzytrack.io.recording import Track
from fuzzytrack.testbed.innovations import Innovations, expected_outside, positions_of
from fuzzytrack.trackers.catalog import make_tracker

RNG = np.random.default_rng(7)
T = np.cumsum(RNG.uniform(0.5, 1.5, 30))


def track(name, length, sigma=2.0, missed=()):
    z = np.stack([8 * T[:length], 0.3 * T[:length] ** 2], axis=1)
    z = z + sigma * RNG.standard_normal(z.shape)
    z[list(missed)] = np.nan
    noise = np.full(z.shape, sigma)
    noise[list(missed)] = np.nan
    return Track(name, T[:length], z, noise)


TRACKS = [track("a", 30, missed=(3, 11)), track("b", 29), track("c", 9)]


@pytest.mark.parametrize("name", ["maneuver", "kalman-cv:sigma_v=1", "imm-two"])
def test_positions_and_variances_are_those_of_single_steps(name):
    tracker = make_tracker(name)
    found = positions_of(tracker, TRACKS)
    row = 0
    for one in TRACKS:
        state = None
        for t, z, sigma in zip(one.time, one.plots, one.sigma, strict=True):
            sigma = np.where(np.isnan(sigma), 1.0, sigma)
            if state is None:
                state = tracker.start(z, t, sigma)
            else:
                expected = tracker.predict(state, t, sigma)
                if not np.isnan(expected.innovation_variance).any():
                    np.testing.assert_allclose(found.predicted[row], expected.position)
                np.testing.assert_allclose(found.variance[row], expected.innovation_variance)
                state = tracker.step(state, z, t, sigma)
            row += 1
    assert row == len(found.predicted)


def test_fixed_gains_predict_no_variance():
    assert positions_of(make_tracker("fixed:alpha=.5:beta=.2"), TRACKS).variance is None
    bare = [Track(one.id, one.time, one.plots) for one in TRACKS]
    assert positions_of(make_tracker("fixed:alpha=.5:beta=.2"), bare).variance is None


# -------------------------------------------------------------------- statistics


def test_statistics_by_hand():
    values = np.array([[3.0, 4.0], [0.0, -5.0], [1.0, 1.0], [2.0, 2.0]])
    variance = np.array([[1.0, 4.0], [1.0, 1.0], [1.0, 1.0], [4.0, 4.0]])
    found = Innovations(values, variance, np.array([0, 0, 1, 1]))
    assert found.rms == pytest.approx(math.sqrt((25 + 25 + 2 + 8) / 4))
    # Exactly three deviations are not outside; the second plot is.
    assert found.outside == 1 / 4
    terms = 9 + 4 + 0 + 25 + 1 + 1 + 1 + 1 + np.log(2 * math.pi * variance).sum()
    assert found.log_likelihood == pytest.approx(-0.5 * terms / 4)
    # Of the first track 3·0 - 4·5, of the second 1·2 + 1·2; none from one track to the other.
    assert found.whiteness.correlation == pytest.approx((-20 + 4) / 60)
    assert found.whiteness.reach == pytest.approx(1.96 * math.sqrt(400 + 16) / 60)


def test_the_likelihood_is_that_of_scipy():
    from scipy.stats import norm

    values, variance = RNG.standard_normal((40, 2)), RNG.uniform(0.5, 3, (40, 2))
    found = Innovations(values, variance, np.zeros(40, dtype=np.int64))
    expected = norm.logpdf(values, scale=np.sqrt(variance)).sum(axis=1).mean()
    assert found.log_likelihood == pytest.approx(expected)


def test_without_variance_nothing_is_known():
    found = Innovations(np.ones((3, 1)), None, np.zeros(3, dtype=np.int64))
    assert math.isnan(found.log_likelihood)
    assert math.isnan(found.outside)
    lost = Innovations(np.full((3, 1), np.inf), None, np.zeros(3, dtype=np.int64))
    assert lost.rms == math.inf
    for one in (lost, Innovations(np.ones((1, 1)), None, np.zeros(1, dtype=np.int64))):
        assert math.isnan(one.whiteness.correlation)


@pytest.mark.parametrize("n_axes", [1, 2, 3])
def test_independent_innovations_are_as_expected(n_axes):
    """Shares over many recordings; noise that changes its size and has long tails is white too."""
    rng = np.random.default_rng(n_axes)
    inside, outside = [], []
    for _ in range(400):
        sizes = np.exp(0.5 * rng.standard_normal((100, 1)))
        values = sizes * rng.standard_normal((100, n_axes))
        found = Innovations(values, sizes**2 * np.ones(n_axes), np.repeat([0, 1], 50))
        white = found.whiteness
        inside.append(abs(white.correlation) <= white.reach)
        outside.append(found.outside)
    assert 0.92 <= np.mean(inside) <= 0.98
    expected = expected_outside(n_axes)
    assert np.mean(outside) == pytest.approx(expected, abs=4 * math.sqrt(expected / 40_000))
