import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.gains.singer import add_onset, correct_optimally, fade, onset, predict_singer

TIMES = st.floats(1e-3, 100.0)
UPPER = np.triu_indices(3)


@st.composite
def covariances(draw):
    """L·Lᵀ of a lower triangular matrix."""
    off, on = st.floats(-5.0, 5.0), st.floats(0.05, 5.0)
    lower = np.zeros((3, 3))
    for k in range(3):
        lower[k, :k] = [draw(off) for _ in range(k)]
        lower[k, k] = draw(on)
    return lower @ lower.T


def assert_is_product(numbers, f, p):
    """Six numbers are those of F·P·Fᵀ, to the rounding of its terms."""
    off = np.abs(np.array(numbers) - (f @ p @ f.T)[UPPER])
    assert (off <= 1e-14 * (np.abs(f) @ np.abs(p) @ np.abs(f).T)[UPPER]).all()


def test_fade_keeps_all_at_first_and_nothing_in_the_end():
    assert fade(0.0) == 1.0
    assert fade(2.0) == pytest.approx(0.2, rel=1e-15)
    assert fade(1e200) == 0.0
    x = np.linspace(0.0, 0.3, 20)
    assert np.abs(fade(x) - np.exp(-x)).max() < 0.3**3 / 6


@given(covariances(), TIMES, st.floats(0.0, 1.0))
def test_prediction_is_the_product_of_matrices(p, dt, phi):
    f = np.array([[1.0, dt, phi * dt * dt / 2], [0.0, 1.0, phi * dt], [0.0, 0.0, phi]])
    assert_is_product(predict_singer(*p[UPPER], dt, phi), f, p)


def test_an_acceleration_of_which_nothing_is_left_moves_nothing():
    p = np.diag([1.0, 2.0, 3.0])
    assert predict_singer(*p[UPPER], 2.0, 0.0) == (9.0, 4.0, 0.0, 2.0, 0.0, 0.0)


@given(covariances(), TIMES, TIMES, st.floats(0.0, 1.0), st.floats(0.0, 10.0), TIMES)
def test_noise_of_an_acceleration_that_began_before_the_plot(p, dt, delay, phi, q, gap):
    b, g1, g2 = onset(dt, phi, delay, dt / gap)
    assert b == pytest.approx((1 - phi**2) / (1 + dt / gap), rel=1e-12)
    g = np.array([(dt + delay) ** 2 / 2, dt + delay, 1.0])
    noise = np.array(add_onset(*p[UPPER], b * q, g1, g2)) - p[UPPER]
    assert noise == pytest.approx(b * q * np.outer(g, g)[UPPER], rel=1e-9, abs=1e-12)


@given(covariances(), st.floats(0.01, 100.0))
def test_correction_is_that_of_information(p, r):
    after = np.linalg.inv(np.linalg.inv(p) + np.diag([1.0 / r, 0.0, 0.0]))
    k1, k2, k3, numbers = correct_optimally(*p[UPPER], r)
    assert np.array([k1, k2, k3]) * r == pytest.approx(after[0], rel=1e-6, abs=1e-9)
    assert numbers == pytest.approx(after[UPPER], rel=1e-6, abs=1e-9 * np.abs(p).max())


@given(covariances())
def test_a_missing_plot_corrects_nothing(p):
    assert correct_optimally(*p[UPPER], math.inf) == (0.0, 0.0, 0.0, tuple(p[UPPER]))


def test_correction_after_a_long_gap_keeps_a_positive_covariance():
    p = 1.0, 0.1, 0.01, 0.2, 0.05, 0.1
    for dt, r in ((1e4, 1.0), (1e-3, 1e2), (1e4, 1e-2), (1e-3, 1e-2), (3.0, 1.0)):
        phi = fade(dt)
        p = predict_singer(*p, dt, phi)
        b, g1, g2 = onset(dt, phi, 1.0, dt / 0.6)
        p = correct_optimally(*add_onset(*p, 4.0 * b, g1, g2), r)[3]
        full = np.zeros((3, 3))
        full[UPPER] = p
        assert np.linalg.eigvalsh(full + np.triu(full, 1).T).min() > 0
        assert math.isfinite(sum(p))
