import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack.gains.elapsed_times import ElapsedTimes
from fuzzytrack.gains.polygons import convex_hull


def test_missed_plots_add_steps():
    assert ElapsedTimes().intervals == [(1, 1)]
    assert ElapsedTimes(1, 1, 3).intervals == [(1, 1), (2, 2), (3, 3), (4, 4)]
    assert ElapsedTimes(2, 2.5, 2).intervals == [(2, 2.5), (4, 5), (6, 7.5)]
    assert ElapsedTimes(1, 2, 3).intervals == [(1, 8)]
    # From three steps on the intervals overlap.
    assert ElapsedTimes(2, 2.8, 3).intervals == [(2, 2.8), (4, 5.6), (6, 11.2)]


@given(st.floats(0.1, 10), st.floats(1, 5), st.integers(0, 4), st.integers(0, 99))
@settings(deadline=None)
def test_every_time_is_enclosed(low, ratio, missed, seed):
    times = ElapsedTimes(low, low * ratio, missed)
    rng = np.random.default_rng(seed)
    steps = rng.uniform(low, low * ratio, (missed + 1, 50))
    s = np.cumsum(steps, axis=0)[rng.integers(0, missed + 1, 50), np.arange(50)]
    hull = convex_hull(times.around())
    points = np.stack([s, 1 / s], axis=1)
    if len(hull) < 3:
        along = np.clip((s - hull[0, 0]) / (np.ptp(hull[:, 0]) or 1.0), 0, 1)[:, None]
        nearest = hull[0] + along * (hull[-1] - hull[0])
        np.testing.assert_allclose(points, nearest, rtol=1e-6)
        return
    following = np.roll(hull, -1, axis=0)
    edge, to_point = following - hull, points[:, None] - hull
    side = edge[:, 0] * to_point[..., 1] - edge[:, 1] * to_point[..., 0]
    assert (side > -1e-9 * np.abs(hull).max() ** 2).all()


def test_the_enclosure_is_tight():
    s, r = ElapsedTimes(1, 8).around().T
    assert (s * r > 0.999).all()
    assert (s * r <= 1 + 1e-12).all()


def test_times_tried_hold_the_ends():
    times = ElapsedTimes(1, 4, 3).tried()
    assert (times.dtype, times.tolist()) == (np.float64, [1, 16])
    assert ElapsedTimes(1, 1, 9).tried().tolist() == [1, 4, 7, 10]


@pytest.mark.parametrize(
    ("elapsed", "missed"), [(1, 0), (4, 0), (4.1, 1), (8, 1), (12, 2), (16, 3), (16 - 1e-9, 3)]
)
def test_fewest_missed_plots(elapsed, missed):
    assert ElapsedTimes(1, 4, 3).missed_within(elapsed) == missed


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0, 1), "steps: must be two times with 0 < shortest <= longest, got 0 and 1"),
        ((2, 1), "steps: .* got 2 and 1"),
        ((1, np.inf), "steps: .* got 1 and inf"),
        ((np.nan, 1), "steps: .* got nan and 1"),
        ((1, 2, -1), "missed: must be 0 to 1000, got -1"),
        ((1, 2, 1001), "missed: must be 0 to 1000, got 1001"),
        ((1, 2, 1.5), "missed: must be a whole number, got 1.5"),
        ((1, 2, True), "missed: must be a whole number, got True"),
    ],
)
def test_bad_limits(arguments, message):
    with pytest.raises(ValueError, match=message):
        ElapsedTimes(*arguments)
