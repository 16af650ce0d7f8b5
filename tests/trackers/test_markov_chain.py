import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from fuzzytrack.gains.singer import fade
from fuzzytrack.trackers.markov_chain import MarkovChain

# Asymmetric, and one state cannot be left for each other.
THREE = ((0.0, 1 / 12, 1 / 18), (0.1, 0.0, 0.0), (0.0, 1 / 14, 0.0))
FOUR = ((0, 0.3, 0, 0.02), (0, 0, 0.5, 0), (0.7, 0, 0, 0.1), (0.01, 0, 0, 0))


def generator(rates):
    return np.array(rates) - np.diag(np.sum(rates, axis=1))


@pytest.mark.parametrize("rates", [THREE, FOUR, ((0.0, 0.2, 0.0), (0.0, 0.0, 0.3), (0.1, 0, 0))])
@pytest.mark.parametrize("time", [1e-6, 0.3, 4.0, 90.0, 1e5])
def test_it_is_the_square_of_an_inverse(rates, time):
    inverse = np.linalg.inv(np.eye(len(rates)) - 0.5 * time * generator(rates))
    found = MarkovChain.of(rates).transitions(time)
    assert found == pytest.approx(inverse @ inverse, rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("time", [0.0, 1e-6, 0.3, 4.0, 90.0, 1e5])
def test_two_states_fade(time):
    kept = fade(time * 0.35)
    stationary = np.array([[0.25, 0.1]] * 2) / 0.35
    found = MarkovChain.of(((0.0, 0.1), (0.25, 0.0))).transitions(time)
    assert found == pytest.approx(kept * np.eye(2) + (1 - kept) * stationary, abs=1e-14)


@pytest.mark.parametrize("rates", [((0.0, 0.1), (0.25, 0.0)), THREE, FOUR])
def test_over_a_short_time_it_is_the_exponential(rates):
    q, chain = generator(rates), MarkovChain.of(rates)
    largest = np.abs(q @ q).max()
    for time in (0.1, 0.01):
        assert np.abs(chain.transitions(time) - expm(q * time)).max() < 0.3 * largest * time**2
    # A step, or the same time in ten steps.
    many = np.linalg.matrix_power(chain.transitions(0.01), 10)
    assert np.abs(many - chain.transitions(0.1)).max() < 0.3 * largest * 0.1**2


@pytest.mark.parametrize("rates", [((0.0, 0.1), (0.25, 0.0)), THREE, FOUR])
def test_after_a_long_time_it_is_stationary(rates):
    q = generator(rates)
    found = MarkovChain.of(rates).transitions(1e9)
    assert found == pytest.approx(np.repeat(found[:1], len(rates), axis=0), abs=1e-7)
    assert np.abs(found[0] @ q).max() < 1e-9
    assert found.min() > 0.0


def test_one_state_and_states_that_are_kept():
    assert MarkovChain.of(((0.0,),)).transitions(7.0).tolist() == [[1.0]]
    for count in (2, 3):
        kept = MarkovChain.of(((0.0,) * count,) * count).transitions(7.0)
        assert kept.tolist() == np.eye(count).tolist()
    # The last state is never left, the first never entered.
    found = MarkovChain.of(((0, 1, 0), (0, 0, 2), (0, 0, 0))).transitions(1e6)
    assert found[2].tolist() == [0.0, 0.0, 1.0]
    assert found[:, 2] == pytest.approx(1.0, abs=1e-9)


@given(data=st.data(), count=st.integers(1, 5), time=st.floats(0.0, 1e6))
def test_rows_are_distributions(data, count, time):
    rate = st.one_of(st.just(0.0), st.floats(1e-3, 10.0))
    rows = data.draw(st.lists(st.lists(rate, min_size=count, max_size=count), min_size=count,
                              max_size=count))  # fmt: skip
    rates = tuple(tuple(0.0 if i == j else x for j, x in enumerate(r)) for i, r in enumerate(rows))
    found = MarkovChain.of(rates).transitions(time)
    assert found.min() >= 0.0
    # Up to a million stays in five states; see the notes of the class.
    assert found.sum(axis=1) == pytest.approx(1.0, abs=1e-5)
    assert not math.isnan(found.sum())


@pytest.mark.parametrize("time", [1e3, 1e6])
def test_chains_of_parts_that_never_meet(time):
    rates = np.array([[0, 3, 0, 0, 0], [2, 0, 0, 0, 0], [0, 0, 0, 9, 0], [0, 0, 7, 0, 0], [0] * 5])
    found = MarkovChain.of(tuple(map(tuple, rates.tolist()))).transitions(time)
    half = np.linalg.inv(np.eye(5) - (rates - np.diag(rates.sum(axis=1))) * time / 2)
    np.testing.assert_allclose(found, half @ half, atol=1e-7)
