import numpy as np
import pytest

from fuzzytrack.gains import kalata, noise_ratio
from fuzzytrack.gains.track_noise import largest_noise


def brute(elapsed, alpha, beta, gamma, dt):
    """Standard deviations of the position, as sums over what each plot's noise becomes."""
    errors = []  # of (x, v, a), one for each plot
    for span, a, b, c, step in zip(elapsed, alpha, beta, gamma, dt, strict=True):
        if np.isnan(a):
            continue
        move = np.array([[1, span, span * span / 2], [0, 1, span], [0, 0, 1]])
        gain = np.array([a, b / step, c / (2 * step * step)])
        errors = [move @ e for e in errors]
        errors = [*(e - gain * e[0] for e in errors), gain]
        yield np.sqrt(sum(e[0] ** 2 for e in errors))


def columns(*values):
    return [np.asarray(value, dtype=float)[:, None] for value in values]


@pytest.mark.parametrize("with_gamma", [False, True])
def test_it_is_the_sum_over_the_noise_of_every_plot(with_gamma):
    random = np.random.default_rng(3)
    n = 40
    elapsed = np.exp(random.uniform(0, 3, n))
    dt = elapsed * random.uniform(0.3, 1, n)
    alpha, beta = random.uniform(0.3, 0.9, n), random.uniform(0.05, 0.6, n)
    gamma = random.uniform(0, 0.1, n) if with_gamma else np.zeros(n)
    alpha[[0, 7, 8]] = np.nan
    expected = max(brute(elapsed, alpha, beta, gamma, dt))
    found = largest_noise(*columns(elapsed, alpha, beta, gamma, dt))
    np.testing.assert_allclose(found, [expected], rtol=1e-12)


def test_at_constant_time_it_is_the_noise_ratio():
    alpha, beta = 0.5, 0.7
    gains = np.full((80, 2), alpha), np.full((80, 2), beta)
    found = largest_noise(np.full((80, 2), 4.0), *gains)
    expected = np.sqrt(noise_ratio(alpha, beta, of="filtered"))
    # Before the steady state it is less than in it, with these gains.
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_a_long_track_is_looked_at_in_pieces():
    """A burst anywhere is found, whether plots stand before and after it or not."""
    n = 20_000
    elapsed = np.ones(n)
    elapsed[15_000:15_040] = np.tile([0.02, 0.98], 20)
    alpha, beta = np.full(n, 0.5), np.full(n, 0.2)
    found = largest_noise(*columns(elapsed, alpha, beta))
    burst = slice(15_000, 15_040)
    alone = largest_noise(*columns(elapsed[burst], alpha[burst], beta[burst]))
    assert found > 1e4
    assert found >= alone
    assert largest_noise(*columns(np.ones(n), alpha, beta)) < 1


def test_what_cannot_be_represented_is_infinite():
    n = 4000
    elapsed = np.tile([1e-6, 1e3], n // 2)
    found = largest_noise(*columns(elapsed, np.full(n, 0.5), np.full(n, 0.5)))
    assert np.isinf(found).all()


def test_nothing():
    assert largest_noise(np.ones((0, 3)), np.ones((0, 3)), np.ones((0, 3))).tolist() == [0, 0, 0]
    assert largest_noise(*(np.ones((5, 0)),) * 3).shape == (0,)
    unused = np.full((5, 2), np.nan)
    assert largest_noise(unused, unused, unused, unused).tolist() == [0, 0]


def test_gains_of_kalata_at_their_time():
    alpha, beta = map(float, kalata(0.5))
    found = largest_noise(*(np.full((60, 1), value) for value in (3.0, alpha, beta)))
    assert found < 1
