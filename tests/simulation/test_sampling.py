import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from fuzzytrack.simulation.noise import streams
from fuzzytrack.simulation.published import TRACK_SETS, track_set
from fuzzytrack.simulation.sampling import PATTERNS, REGULAR, Sampling

OWN = np.arange(3.0, 64.0)
IRREGULAR = [
    Sampling("jitter", 0.4),
    Sampling("alternate", (1, 10)),
    Sampling("burst", (5, 20)),
    Sampling("log-uniform", (1, 10)),
]


def test_regular_times():
    assert REGULAR.times(OWN, streams(1, 2)) is OWN
    assert_array_equal(Sampling(period=2).times(OWN, streams(1, 2)), 3 + 2 * np.arange(31.0))
    # The last scan is not later than the target's own.
    assert_array_equal(Sampling(period=7).times(OWN, streams(1, 2)), 3 + 7 * np.arange(9.0))


@pytest.mark.parametrize("sampling", IRREGULAR, ids=lambda each: each.pattern)
@pytest.mark.parametrize("period", [None, 0.5, 2.0])
def test_irregular_times(sampling, period):
    sampling = Sampling(sampling.pattern, sampling.numbers, period)
    times = sampling.times(OWN, streams(7, 5))
    drawn = sampling.pattern in ("jitter", "log-uniform")
    steps = 1 + round(60 / (period or 1))
    assert times.shape == ((steps, 5) if drawn else (steps,))
    assert sampling.common == (not drawn)
    assert (np.diff(times, axis=0) > 0).all()
    # All begin and end with the target, so that the mean interval is the period.
    assert_array_equal(times[0], 3.0)
    assert_allclose(times[-1], 63.0, rtol=1e-15)
    if drawn:
        # The same from the same seed, in any company; different from track to track.
        assert_array_equal(sampling.times(OWN, streams(7, 9))[:, :5], times)
        assert (
            len(np.unique(sampling.times(OWN, streams(8, 5))[1].tolist() + times[1].tolist())) == 10
        )


def intervals(pattern, *numbers, tracks=60):
    return np.diff(Sampling(pattern, numbers).times(OWN, streams(2, tracks)), axis=0)


def test_jitter_moves_each_scan_by_a_share_of_the_period():
    gaps = intervals("jitter", 0.4)
    assert gaps.min() > 0.2 * 0.98
    assert gaps.max() < 1.8 * 1.02
    # The difference of two uniform numbers from -0.4 to 0.4
    assert_allclose(gaps.std(), 0.4 * math.sqrt(2 / 3), rtol=0.05)


def test_alternating_intervals():
    gaps = intervals("alternate", 1, 10)
    assert_allclose(gaps[::2], 2 / 11, rtol=1e-9)
    assert_allclose(gaps[1::2], 20 / 11, rtol=1e-9)


def test_bursts():
    gaps = intervals("burst", 3, 7)
    # Three plots and a gap: 20 gaps of 7 and 40 intervals of 1 in 60 s
    assert_allclose(gaps.reshape(20, 3), np.full((20, 3), [1.0, 1.0, 7.0]) * 60 / 180, rtol=1e-9)


def test_log_uniform_intervals():
    gaps = intervals("log-uniform", 1, 10)
    assert (gaps.max(axis=0) / gaps.min(axis=0) < 10 * (1 + 1e-9)).all()
    logs = np.log(gaps / gaps.mean(axis=0))
    assert_allclose(logs.std(), math.log(10) / math.sqrt(12), rtol=0.05)


@given(st.sampled_from(IRREGULAR), st.floats(0.05, 30), st.integers(2, 50), st.floats(-1e4, 1e4))
def test_times_keep_to_those_of_the_target(sampling, period, scans, begin):
    own = begin + 3.0 * np.arange(scans)
    sampling = Sampling(sampling.pattern, sampling.numbers, period)
    if own[-1] - own[0] < period:
        with pytest.raises(ValueError, match=r"period must leave two scans"):
            sampling.times(own, streams(0, 1))
        return
    times = sampling.times(own, streams(0, 2))
    assert len(times) == 1 + int((own[-1] - own[0]) / period * (1 + 1e-12))
    assert (np.diff(times, axis=0) > 0).all()
    assert_array_equal(times[0], own[0])
    assert (times[-1] <= own[-1] + 1e-9 * (1 + abs(own[-1]))).all()
    assert (times[-1] > own[-1] - period - 1e-6).all()


def test_the_scan_that_is_as_late():
    assert [Sampling(period=p).scan(8, OWN) for p in (0.5, 1, 2, 3, 8)] == [16, 8, 4, 3, 2]
    assert REGULAR.scan(8, OWN) == 8
    assert REGULAR.scan(2, OWN) == 2
    assert Sampling("jitter", 0.1).scan(8, 60 * OWN) == 8


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("bursts",), "pattern: unknown 'bursts'; one of regular, jitter, alternate, burst, log-u"),
        (("regular", 1), "regular must be without numbers, got 1"),
        (("jitter",), "jitter must be a number > 0 and < 0.5, got none"),
        (("jitter", 0.5), "jitter must be a number > 0 and < 0.5, got 0.5"),
        (("jitter", 0), "jitter must be a number > 0 and < 0.5, got 0"),
        (
            ("alternate", 3),
            "alternate must be two intervals > 0, one at most 1e9 times the other, got 3",
        ),
        (
            ("alternate", (1, 0)),
            "alternate must be two intervals > 0, one at most 1e9 times the other, got 1, 0",
        ),
        (
            ("alternate", (1, math.inf)),
            "alternate must be two intervals > 0, one at most 1e9 times the other, got 1, inf",
        ),
        (
            ("burst", (1, 9)),
            "burst must be a whole number of plots >= 2 and a gap > 1, at most 1e9, got 1, 9",
        ),
        (
            ("burst", (2.5, 9)),
            "burst must be a whole number of plots >= 2 and a gap > 1, at most 1e9, got 2.5",
        ),
        (
            ("burst", (3, 1)),
            "burst must be a whole number of plots >= 2 and a gap > 1, at most 1e9, got 3, 1",
        ),
        (
            ("log-uniform", (4, 4)),
            "two rising intervals > 0, one at most 1e9 times the other, got 4, 4",
        ),
        (("alternate", (1, math.nan)), "one at most 1e9 times the other, got 1, nan"),
        (("alternate", (2e9, 1)), "one at most 1e9 times the other, got 2e"),
        (("burst", (3, 2e9)), "a gap > 1, at most 1e9, got 3, 2e"),
        (("log-uniform", (1, 2e9)), "one at most 1e9 times the other, got 1, 2e"),
        (("jitter", 0.1, 0), "period must be finite and > 0, got 0"),
        (("jitter", 0.1, math.nan), "period must be finite and > 0, got nan"),
    ],
)
def test_impossible_samplings(arguments, complaint):
    with pytest.raises(ValueError, match=complaint.replace("(", r"\(")):
        Sampling(*arguments)


def test_too_many_scans():
    with pytest.raises(ValueError, match=r"not give more than 10000000 scans in all, got 1e-06"):
        Sampling(period=1e-6).times(OWN, streams(0, 1))
    with pytest.raises(ValueError, match=r"got 0.0005, which gives 120001 in each of 100"):
        Sampling("jitter", 0.1, 5e-4).times(OWN, streams(0, 100))


def test_samplings_are_values():
    one = Sampling("burst", [5, 20], 2)
    assert one == Sampling("burst", (5.0, 20.0), 2.0) != Sampling("burst", (5, 21), 2)
    assert len({one, Sampling("burst", (5, 20), 2)}) == 1
    assert eval(repr(one)) == one
    assert set(PATTERNS) == {"regular", *(each.pattern for each in IRREGULAR)}


# ---------------------------------------------------------------- sets of tracks

FINE = Sampling(period=1 / 64)


@pytest.mark.parametrize("name", TRACK_SETS)
def test_the_motion_does_not_depend_on_the_sampling(name):
    own, fine = track_set(name, 12, 4), track_set(name, 12, 4, FINE)
    assert_allclose(fine.position[::64], own.position, rtol=1e-12, atol=1e-12)
    assert fine.first_scored == 64 * own.first_scored
    for sampling in IRREGULAR:
        tracks = track_set(name, 12, 4, sampling)
        assert tracks.position.shape == own.position.shape
        assert tracks.first_scored == own.first_scored
        times = np.broadcast_to(tracks.time.reshape(len(own.time), -1), own.position.shape[:2])
        # Between two points of the fine grid the acceleration is nearly constant: a cubic through
        # four of them is the truth, but where a maneuver begins.
        place = np.clip(np.floor(times * 64).astype(int), 1, len(fine.time) - 3)
        part = times * 64 - place
        expected = sum(
            lagrange(part, k)[..., None] * fine.position[place + k, np.arange(12)]
            for k in (-1, 0, 1, 2)
        )
        assert_allclose(tracks.position, expected, atol=2e-3)
        assert np.median(abs(tracks.position - expected)) < 1e-9


def lagrange(x, k):
    return np.prod([(x - j) / (k - j) for j in (-1, 0, 1, 2) if j != k], axis=0)


def test_maneuvers_between_scans_are_circles_and_constant_accelerations():
    tracks = track_set("strong", 80, 4, FINE)
    ways = np.diff(tracks.position, axis=0)
    speeds = np.linalg.norm(ways, axis=2) * 64
    # Without tracks that brake and go back, whose heading jumps.
    ahead = speeds.min(axis=0) > 0.5
    assert ahead.sum() > 40
    angles = np.unwrap(np.arctan2(ways[..., 1], ways[..., 0]), axis=0)
    for values, largest in (speeds, 3.0), (angles, 1.0):
        each = 64 * np.diff(values.reshape(59, 64, 80)[..., ahead], axis=1)
        # The same from step to step within a scan, and there are scans in which it is not 0.
        assert_allclose(each, np.repeat(each[:, :1], 63, axis=1), atol=1e-8)
        assert 0.3 * largest < abs(each).max() < largest


@pytest.mark.parametrize("name", TRACK_SETS)
def test_sampled_sets_come_from_their_seed_track_by_track(name):
    few, many = (track_set(name, n, 8, Sampling("jitter", 0.3)) for n in (3, 9))
    assert_array_equal(few.time, many.time[:, :3])
    assert_array_equal(few.position, many.position[:, :3])
    assert not np.array_equal(track_set(name, 3, 9, Sampling("jitter", 0.3)).time, few.time)
