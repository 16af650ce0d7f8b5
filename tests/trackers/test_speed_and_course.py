import math

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, FixedGains

TRACKER = AlphaBetaTracker(FixedGains(0.5, 0.2))


@pytest.mark.parametrize(
    ("east", "north", "course"),
    [(0, 2, 0), (3, 3, 45), (2, 0, 90), (0, -1, 180), (-1, 0, 270), (-1, 1, 315)],
)
def test_over_ground(east, north, course):
    t = np.arange(4.0)
    for up in ((), (5.0,)):
        result = TRACKER.run(t, t[:, None] * np.array([east, north, *up]))
        np.testing.assert_allclose(result.speed, [math.nan, *[math.hypot(east, north)] * 3])
        np.testing.assert_allclose(result.course, [math.nan, *[course] * 3], atol=1e-12)


def test_batches():
    t = np.arange(3.0)
    z = np.stack([np.c_[t, 0 * t], np.c_[0 * t, 0 * t]], axis=1)
    result = TRACKER.run(t, z)
    np.testing.assert_array_equal(result.speed[2:], [[1, 0]])
    np.testing.assert_array_equal(result.course[2:], [[90, math.nan]])


def test_an_axis_that_starts_later():
    t = np.arange(5.0)
    z = np.c_[2 * t, 3 * t]
    z[:2, 1] = math.nan
    found = TRACKER.run(t, z).speed
    np.testing.assert_allclose(found, [*[math.nan] * 3, *[math.hypot(2, 3)] * 2])


def test_a_track_that_goes_on():
    t = np.arange(4.0)
    z = t[:, None] * np.array([3.0, 4.0])
    first = TRACKER.run(t[:2], z[:2])
    rest = TRACKER.run(t[2:], z[2:], state=first.state)
    assert rest.speed.tolist() == [5.0, 5.0]


@pytest.mark.parametrize("shape", [(3,), (3, 1)])
def test_two_axes_are_needed(shape):
    result = TRACKER.run(np.arange(3.0), np.zeros(shape))
    for name in ("speed", "course"):
        with pytest.raises(ValueError, match="speed and course need two axes, east and north"):
            getattr(result, name)


def test_what_was_not_kept():
    result = TRACKER.run(np.arange(3.0), np.zeros((3, 2)), keep=("filtered",))
    with pytest.raises(
        AttributeError, match="speed and course need predicted, filtered and velocity"
    ):
        _ = result.speed
