import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack import FixedGains


def poles(alpha, beta, gamma):
    """Poles of the literal recursion on (x, v, a) with T = 1, filtered to filtered."""
    move = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1]])
    gain = np.array([[alpha], [beta], [gamma / 2]])
    return np.linalg.eigvals(move - gain @ move[:1])


@given(st.floats(-0.5, 2.5), st.floats(-0.5, 4.5), st.floats(-0.2, 3))
def test_exactly_the_stable_gains_are_accepted(alpha, beta, gamma):
    largest = np.abs(poles(alpha, beta, gamma)).max()
    if abs(largest - 1) < 1e-6:
        return
    if largest < 1 and gamma >= 0:
        FixedGains(alpha, beta, gamma)
    elif gamma != 0:
        # With γ = 0 the literal third pole stays at 1, so that case is tested below.
        with pytest.raises(ValueError, match=r"alpha, beta|gamma"):
            FixedGains(alpha, beta, gamma)


@given(st.floats(-0.5, 2.5), st.floats(-0.5, 4.5))
def test_exactly_the_stable_pairs_are_accepted(alpha, beta):
    matrix = np.array([[1 - alpha, 1 - alpha], [-beta, 1 - beta]])
    largest = np.abs(np.linalg.eigvals(matrix)).max()
    if abs(largest - 1) < 1e-6:
        return
    if largest < 1:
        assert FixedGains(alpha, beta).gamma == 0.0
    else:
        with pytest.raises(ValueError, match="alpha, beta must keep to the stability triangle"):
            FixedGains(alpha, beta)


@pytest.mark.parametrize("name", ["alpha", "beta", "gamma"])
def test_gains_must_be_numbers(name):
    gains = {"alpha": 0.5, "beta": 0.2, "gamma": 0.0, name: float("nan")}
    with pytest.raises(ValueError, match=f"{name} must be finite, got nan"):
        FixedGains(**gains)


def test_it_is_a_value():
    assert FixedGains(0.5, 0.2) == FixedGains(0.5, 0.2, 0)
    assert pickle.loads(pickle.dumps(FixedGains(0.5, 0.2, 0.1))) == FixedGains(0.5, 0.2, 0.1)
