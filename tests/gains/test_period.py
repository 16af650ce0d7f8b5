import math

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from fuzzytrack.gains import (
    alpha_beta_from_s,
    fading_memory,
    is_stable,
    resampled_gains,
    s_from_alpha_beta,
)
from fuzzytrack.gains.period import pair_after, pair_rates

ratios = st.floats(1e-4, 1e3)


@st.composite
def pairs(draw):
    """α and β inside the stability triangle without a negative real pole."""
    alpha = draw(st.floats(1e-5, 0.99999))
    share = draw(st.floats(1e-6, 0.999))
    return alpha, share * (1 + math.sqrt(1 - alpha)) ** 2


def error_matrix(alpha, beta, gamma):
    """Of (x, v, a), filtered to filtered, at T = 1."""
    move = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])
    gain = np.array([[alpha], [beta], [gamma / 2]])
    n = 3 if gamma else 2
    return (move - gain @ move[:1])[:n, :n]


def poles(alpha, beta, gamma=0.0):
    return np.sort_complex(np.linalg.eigvals(error_matrix(alpha, beta, gamma)))


@pytest.mark.parametrize(
    ("gains", "ratio"),
    [
        ((0.5, 0.7, 0.0), 2.5),  # complex poles
        ((0.5, 2.2, 0.0), 0.3),  # of negative real part
        ((0.5, 0.05, 0.0), 7.0),  # overdamped
        ((0.4, 0.1, 0.0), 0.01),
        ((0.5, 0.4, 0.1), 2.5),  # a pair and a third one
        ((0.75, 0.05, 0.002), 0.4),  # three real ones
    ],
)
def test_poles_are_raised_to_the_ratio_of_the_times(gains, ratio):
    new = resampled_gains(*gains, period=4.0, dt=4.0 * ratio)
    expected = np.sort_complex(poles(*gains).astype(complex) ** ratio)
    np.testing.assert_allclose(poles(*map(float, new)), expected, rtol=1e-9)


@pytest.mark.parametrize("order", [2, 3])
@given(st.floats(0.01, 0.99), st.floats(0.05, 20))
def test_fading_memory_stays_fading_memory(order, xi, ratio):
    """A pole of two or three times ξ becomes one of ξ^ratio, whose gains have a formula."""
    new = resampled_gains(*fading_memory(xi, order), period=2.0, dt=2.0 * ratio)
    expected = fading_memory(xi**ratio, order)
    np.testing.assert_allclose(new[:order], expected, rtol=1e-8, atol=1e-13)


@given(pairs(), st.floats(1e-3, 1), st.floats(1e-3, 100))
def test_there_and_on_is_the_same_as_at_once(gains, first, second):
    between = resampled_gains(*gains, period=1.0, dt=first)
    twice = resampled_gains(*between, period=first, dt=first * second)
    once = resampled_gains(*gains, period=1.0, dt=first * second)
    np.testing.assert_allclose(twice, once, rtol=1e-8, atol=1e-14)


@given(pairs(), ratios)
@example((0.5, 2.9), 1000.0)
def test_the_scalar_functions_agree_with_the_arrays(gains, ratio):
    """Square roots and squares against logarithms and exponentials."""
    expected = resampled_gains(*gains, period=3.0, dt=3.0 * ratio)[:2]
    # A turn by many radians is known as precisely as they are.
    np.testing.assert_allclose(pair_after(pair_rates(*gains), ratio), expected, rtol=1e-8)


@given(pairs(), st.floats(1e-8, 1e8))
def test_gains_stay_stable(gains, ratio):
    alpha, beta = pair_after(pair_rates(*gains), ratio)
    assert 0 < alpha <= 1
    assert beta > 0
    assert 2 * alpha + beta < 4


def test_a_pole_0_is_0_at_any_time_step():
    for ratio in (1e-7, 0.4, 30.0):
        assert pair_after(pair_rates(1.0, 1.0), ratio) == (1.0, 1.0)
        alpha, beta = pair_after(pair_rates(1.0, 0.3), ratio)
        assert alpha == 1.0
        assert beta == pytest.approx(1 - 0.7**ratio, rel=1e-12)
    found = resampled_gains(1.0, [0.3, 1.0], period=1.0, dt=0.4)
    np.testing.assert_allclose(found, [[1, 1], [1 - 0.7**0.4, 1], [0, 0]], rtol=1e-14)
    # Three poles 0: the filter that goes through the last three plots.
    assert resampled_gains(1.0, 1.5, 2.0, period=1.0, dt=3.0) == (1.0, 1.5, 2.0)


def test_no_gains_stay_none():
    assert pair_after(pair_rates(0.0, 0.0), 2.5) == (0.0, 0.0)
    alpha, beta = pair_after(pair_rates(0.3, 0.0), 2.0)
    assert (alpha, beta) == (pytest.approx(0.51, rel=1e-14), 0.0)


@given(st.floats(1e-3, 2), st.floats(1e-3, 5), st.floats(0.1, 100))
def test_a_continuous_system_is_found_again(angle, zeta, dt):
    """As long as it turns less than half a circle from plot to plot."""
    fast = angle * (zeta + math.sqrt(max(zeta**2 - 1, 0)))
    assume(fast < 20)
    gains = alpha_beta_from_s(angle / dt, zeta, dt)
    assume(gains[0] < 0.999)
    found = s_from_alpha_beta(*gains, dt)
    np.testing.assert_allclose(found, (angle / dt, zeta), rtol=1e-6)


@pytest.mark.parametrize(
    ("gains", "message"),
    [
        ((1.2, 0.3, 0.0), r"negative real pole .* alpha <= 1 .* got alpha=1.2, beta=0.3$"),
        ((0.5, 2.95, 0.0), r"got alpha=0.5, beta=2.95$"),
        ((1.0, 1.2, 0.0), "negative real pole"),
        ((1.3, 0.7, 0.3), "got alpha=1.3, beta=0.7, gamma=0.3"),
        ((0.5, 4.0, 0.0), "stability triangle"),
    ],
)
def test_gains_of_one_sampling_time_only_are_refused(gains, message):
    with pytest.raises(ValueError, match=message):
        resampled_gains(*gains, period=1.0, dt=2.0)


def test_times_must_be_positive():
    with pytest.raises(ValueError, match="period must be finite and > 0, got 0"):
        resampled_gains(0.5, 0.2, period=0.0, dt=2.0)
    with pytest.raises(ValueError, match="dt must be finite and > 0, got inf"):
        resampled_gains(0.5, 0.2, period=1.0, dt=np.inf)


def test_systems_without_a_continuous_form_are_refused():
    with pytest.raises(ValueError, match="alpha must be < 1, so that no pole is 0 or negative"):
        s_from_alpha_beta(1.0, 0.5, 1.0)
    with pytest.raises(ValueError, match=r"beta must be < \(1 \+ sqrt\(1 - alpha\)\)\^2"):
        s_from_alpha_beta(0.5, 2.95, 1.0)


def test_arrays_broadcast():
    alpha, beta, gamma = resampled_gains([[0.5], [0.3]], 0.2, period=4.0, dt=[1.0, 4.0, 9.0])
    assert alpha.shape == beta.shape == gamma.shape == (2, 3)
    np.testing.assert_allclose(alpha[:, 1], [0.5, 0.3], rtol=1e-14)
    np.testing.assert_allclose(alpha[0], 1 - 0.5 ** (np.array([1, 4, 9]) / 4), rtol=1e-14)
    assert is_stable(alpha, beta).all()
