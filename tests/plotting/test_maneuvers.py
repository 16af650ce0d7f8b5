import numpy as np
import pytest

from fuzzytrack.plotting._maneuvers import maneuvers_of
from fuzzytrack.plotting._ragged_lines import is_ragged, running_quartiles, running_rms


def flown(t, turns):
    """A target at 100 m/s that turns by 0.05 rad/s in some intervals."""
    fine = np.arange(t[0], t[-1] + 1e-9, 0.01)
    rate = sum(0.05 * ((fine >= a) & (fine < b)) for a, b in turns) + 0 * fine
    heading = np.cumsum(rate) * 0.01
    path = np.cumsum(np.stack([np.cos(heading), np.sin(heading)], axis=1), axis=0)
    return np.stack([np.interp(t, fine, column) for column in path.T], axis=1)


@pytest.mark.parametrize("turns", [[(20, 40)], [(20, 40), (60, 70)], [(0, 30)]])
def test_turns_are_found(turns):
    t = np.arange(101.0)
    found = maneuvers_of(t, flown(t, turns))
    np.testing.assert_allclose(found, turns, atol=1.0)


def test_times_may_be_irregular_and_rows_missing():
    t = np.cumsum(np.random.default_rng(1).uniform(0.5, 2, 80))
    truth = flown(t, [(30, 60)])
    truth[[5, 40, 41]] = np.nan
    np.testing.assert_allclose(maneuvers_of(t, truth), [(30, 60)], atol=4.0)


def test_where_a_target_always_turns_there_are_none():
    t = np.arange(50.0)
    assert maneuvers_of(t, flown(t, [(0, 50)])) == []


def test_straight_and_short_paths_have_none():
    t = np.arange(50.0)
    assert maneuvers_of(t, np.stack([7 * t + 1e6, 0.1 - t / 3], axis=1)) == []
    assert maneuvers_of(t, np.zeros((50, 1))) == []
    assert maneuvers_of(t[:3], t[:3, None] ** 2) == []
    assert maneuvers_of(t, np.full((50, 2), np.nan)) == []


def test_a_truth_with_noise_of_its_own_has_none():
    t = np.arange(300.0)
    noise = np.random.default_rng(2).normal(size=(300, 2))
    assert maneuvers_of(t, 5 * t[:, None] + noise) == []


def test_the_root_mean_square_of_a_window():
    values = np.array([3.0, np.nan, 4.0, 0.0, 12.0])
    got = running_rms(values, 3)
    expected = [3, np.nan, 8**0.5, (160 / 3) ** 0.5, 72**0.5]
    np.testing.assert_allclose(got, expected)
    # A window that is longer than the values.
    np.testing.assert_allclose(running_rms(values, 11)[[0, 4]], (169 / 4) ** 0.5)
    assert running_rms(values, 1) is values


def test_quartiles_of_blocks_of_time():
    time = np.array([0.0, 1, 2, 3, 9, 10, np.nan, 10])
    values = np.array([1.0, 2, 3, 4, 7, 9, 5, np.nan])
    middle, quartiles = running_quartiles(time[::-1], values[::-1], 5)
    np.testing.assert_allclose(middle, [1, 3, 9])
    np.testing.assert_allclose(quartiles, [[1.25, 3.25, 7.5], [1.5, 3.5, 8], [1.75, 3.75, 8.5]])
    middle, quartiles = running_quartiles(np.full(2, np.nan), np.ones(2), 5)
    assert (middle.shape, quartiles.shape) == ((0,), (3, 0))


def test_what_is_ragged():
    noise = np.random.default_rng(3).normal(size=200)
    assert is_ragged(noise)
    assert not is_ragged(noise[:50])
    assert not is_ragged(np.sin(np.arange(200) / 30))
    assert not is_ragged(np.zeros(200))
    assert not is_ragged(np.full(200, np.nan))
