"""Intervals of the change of an RMS error, by blocks."""

import math

import numpy as np
import pytest

from fuzzytrack.testbed.block_bootstrap import rms_change


def series(rng, tracks, length, memory):
    """Squared errors of two trackers with a common part that lasts, and their tracks."""
    lasting = np.zeros((length, tracks))
    for k in range(1, length):
        lasting[k] = memory * lasting[k - 1] + rng.standard_normal(tracks)
    lasting *= math.sqrt(1 - memory**2)
    one, two = (np.abs(rng.standard_normal((2, length, tracks)))) ** 2
    two = two * np.exp(0.8 * lasting) * 1.5
    return one.T.ravel(), two.T.ravel(), np.repeat(np.arange(tracks), length)


def test_change_is_that_of_the_roots():
    rng = np.random.default_rng(1)
    one, two, tracks = series(rng, 3, 100, 0.5)
    found = rms_change(one, two, tracks)
    assert found.change == pytest.approx(math.sqrt(two.mean() / one.mean()) - 1)
    assert found.low < found.change < found.high
    assert found == rms_change(one, two, tracks)
    assert found != rms_change(one, two, tracks, seed=1)


def test_the_interval_is_that_of_independent_errors_where_they_are():
    """Against the delta method, which is exact for many independent plots."""
    rng = np.random.default_rng(2)
    one, two, tracks = series(rng, 200, 20, 0.0)
    found = rms_change(one, two, tracks, resamples=4000)
    shares = 0.5 * (two / two.sum() - one / one.sum())
    reach = 1.96 * math.sqrt((shares**2).sum())
    assert math.log1p(found.high) - math.log1p(found.change) == pytest.approx(reach, rel=0.15)


@pytest.mark.parametrize(("tracks", "length"), [(1, 900), (4, 250), (30, 40)])
def test_intervals_cover(tracks, length):
    """Coverage over recordings; errors that last make the plain bootstrap cover too little."""
    rng = np.random.default_rng(3)
    long = series(rng, 1, 400_000, 0.9)
    true = math.sqrt(long[1].mean() / long[0].mean()) - 1
    found = [rms_change(*series(rng, tracks, length, 0.9), resamples=199) for _ in range(200)]
    covered = np.mean([one.low <= true <= one.high for one in found])
    # 95 % within three standard errors of 200 recordings.
    assert 0.90 <= covered <= 0.995


def test_blocks_are_tracks_where_there_are_enough():
    rng = np.random.default_rng(4)
    assert rms_change(*series(rng, 30, 20, 0.5)).blocks == 30
    assert rms_change(*series(rng, 500, 4, 0.5)).blocks == 200
    assert rms_change(*series(rng, 2, 300, 0.5)).blocks == 15


def test_long_and_short_tracks_count_by_their_plots():
    rng = np.random.default_rng(5)
    one, two = rng.random((2, 700))
    tracks = np.repeat([0, 1, 2, 3], [600, 50, 30, 20])
    found = rms_change(one, two, tracks)
    # Three short tracks and the parts of the long one.
    assert found.blocks == 3 + round(600 / 47)
    assert found.low < found.change < found.high


def test_equal_errors_do_not_differ():
    same = np.ones(60)
    found = rms_change(same, same, np.zeros(60, dtype=int))
    assert (found.change, found.low, found.high) == (0, 0, 0)


@pytest.mark.parametrize(
    ("one", "two", "change"),
    [
        ([1.0, 1.0], [math.inf, 1.0], math.inf),
        ([0.0, 0.0], [1.0, 1.0], math.inf),
        ([0.0, 0.0], [0.0, 0.0], math.nan),
        ([math.inf, 1.0], [1.0, 1.0], -1.0),
    ],
)
def test_what_has_no_interval(one, two, change):
    found = rms_change(one, two, [0, 0])
    assert found.change == pytest.approx(change, nan_ok=True)
    assert found.blocks == 0


def test_the_end_of_an_interval_that_no_number_reaches_is_infinite():
    """Errors of two trackers that diverge, and do so at different times."""
    grows = np.exp(np.minimum(0.5 * np.arange(700), 600))
    found = rms_change(grows, grows[::-1], np.zeros(700, dtype=int))
    assert found.change == pytest.approx(0, abs=1e-12)
    assert (found.low, found.high) == (-1, math.inf)


def test_one_plot_has_no_interval():
    found = rms_change([1.0], [4.0], [0])
    assert found.change == 1
    assert math.isnan(found.low)
    assert math.isnan(found.high)


def test_no_plot_has_no_change():
    assert math.isnan(rms_change([], [], []).change)
