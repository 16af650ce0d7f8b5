"""Angles on the circle, against complex numbers and against NumPy's own unwrapping."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from fuzzytrack.io.angles import TURN, signed_difference, unwrapped, wrapped

periods = st.sampled_from([TURN, 360.0, 86400.0, 1.0])
turns = st.floats(-5, 5)


@given(turns, periods)
def test_wrapped_is_the_same_direction_within_one_turn(share, period):
    angle = share * period
    found = wrapped(angle, period)
    assert 0 <= found < period
    same = np.exp(1j * TURN * (found - angle) / period)
    assert same == pytest.approx(1, abs=1e-13)


@given(st.floats(min_value=-1e300, max_value=1e300), periods)
def test_wrapped_never_reaches_the_period(angle, period):
    assert 0 <= wrapped(angle, period) < period


def test_a_tiny_angle_below_zero_is_zero():
    assert wrapped(-1e-300, 360.0) == 0.0
    assert wrapped([359.0, 360.0, 361.0, -1.0, np.nan, np.inf], 360.0).tolist()[:4] == [
        359.0,
        0.0,
        1.0,
        359.0,
    ]
    assert np.isnan(wrapped([np.nan, np.inf], 360.0)).all()


@given(turns, turns, periods)
def test_the_difference_is_the_shorter_way(share, other, period):
    angle, reference = share * period, other * period
    way = signed_difference(angle, reference, period)
    assert -period / 2 <= way < period / 2
    rotated = np.exp(1j * TURN * reference / period) * np.exp(1j * TURN * way / period)
    assert rotated == pytest.approx(np.exp(1j * TURN * angle / period), abs=1e-13)


def test_a_difference_over_north():
    assert signed_difference(0.1, 358.9, 360.0) == pytest.approx(1.2, abs=1e-12)
    assert signed_difference(358.9, 0.1, 360.0) == pytest.approx(-1.2, abs=1e-12)
    assert signed_difference(270.0, 90.0, 360.0) == -180.0
    assert signed_difference(90.0, 270.0, 360.0) == -180.0
    # All digits of a small difference are kept.
    assert signed_difference(1e-30, 0.0, 360.0) == 1e-30
    assert np.isnan(signed_difference([np.nan, 1.0], [1.0, np.inf], 360.0)).all()


series = hnp.arrays(np.float64, st.integers(0, 30), elements=st.floats(-0.499, 0.499))


@given(series, periods, st.floats(-3, 3))
def test_what_was_wrapped_is_unwrapped(steps, period, start):
    smooth = (start + np.cumsum(steps)) * period
    found = unwrapped(wrapped(smooth, period), period=period)
    if smooth.size:
        assert found[0] == wrapped(smooth[0], period)
        assert np.allclose(found - found[0], smooth - smooth[0], rtol=0, atol=1e-10 * period)


@given(hnp.arrays(np.float64, st.integers(1, 30), elements=st.floats(0, 359.9)))
def test_as_numpy_unwraps(angles):
    # NumPy takes the other of the two ways where both are half a turn.
    if (np.abs(np.abs(np.diff(angles)) - 180) > 1e-9).all():
        expected = np.unwrap(angles, period=360.0)
        assert np.allclose(unwrapped(angles, period=360.0), expected, rtol=0, atol=1e-9)


@given(
    hnp.arrays(np.float64, 24, elements=st.one_of(st.floats(0, 6.28), st.just(np.nan))),
    hnp.arrays(np.int64, 24, elements=st.integers(0, 3)),
)
def test_tracks_and_gaps_one_by_one(angles, tracks):
    found = unwrapped(angles, tracks)
    assert np.array_equal(np.isnan(found), np.isnan(angles))
    words = np.array(["a", "b", "c", "d"])[tracks]
    assert np.array_equal(unwrapped(angles, words), found, equal_nan=True)
    for track in range(4):
        rows = np.flatnonzero((tracks == track) & ~np.isnan(angles))
        assert np.array_equal(found[rows], unwrapped(angles[rows]))
        assert np.array_equal(found[rows[:1]], angles[rows[:1]])
        assert (np.abs(np.diff(found[rows])) <= np.pi + 1e-9).all()


def test_a_bearing_that_passes_north():
    found = unwrapped([358.9, np.nan, 0.1, 1.0, 359.5], period=360.0)
    assert found == pytest.approx([358.9, np.nan, 360.1, 361.0, 359.5], nan_ok=True)
    assert unwrapped([]).shape == (0,)
    assert unwrapped([np.nan, 7.0], period=360.0)[1] == 7.0


@pytest.mark.parametrize("period", [0.0, -1.0, np.inf, np.nan])
@pytest.mark.parametrize(
    "call", [lambda p: wrapped(1.0, p), lambda p: signed_difference(1.0, 0.0, p),
             lambda p: unwrapped([1.0], period=p)]
)  # fmt: skip
def test_a_period_is_positive(call, period):
    with pytest.raises(ValueError, match="period"):
        call(period)


def test_wrong_shapes():
    with pytest.raises(ValueError, match=r"`angle`: shape \(1, 2\)"):
        unwrapped([[1.0, 2.0]])
    with pytest.raises(ValueError, match=r"`tracks`: shape \(1,\); expected \(2,\)"):
        unwrapped([1.0, 2.0], ["a"])
