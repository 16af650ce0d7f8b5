"""Speed and course of velocities."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.io.motion import course, speed

parts = st.floats(-1e6, 1e6)


@pytest.mark.parametrize(
    ("velocity", "expected"),
    [((0, 1), 0), ((1, 0), 90), ((0, -2), 180), ((-3, 0), 270), ((1, 1), 45), ((-1, 1), 315)],
)
def test_courses_of_the_rose(velocity, expected):
    assert course(velocity) == pytest.approx(expected, abs=1e-12)


@given(parts, parts, parts)
def test_speed_and_course_give_the_velocity_back(east, north, up):
    size, angle = speed([east, north]), course([east, north])
    assert size == pytest.approx(math.hypot(east, north), rel=1e-14)
    if np.isnan(angle):
        assert east == north == 0
    else:
        assert 0 <= angle < 360
        back = size * math.sin(math.radians(angle)), size * math.cos(math.radians(angle))
        assert back == pytest.approx((east, north), rel=1e-12, abs=1e-12 * size)
    assert np.array_equal(course([east, north, up]), angle, equal_nan=True)
    assert speed([east, north, up]) == pytest.approx(math.hypot(east, north, up), rel=1e-14)


def test_batches_gaps_and_extremes():
    velocity = np.array([[[3.0, 4.0], [np.nan, 1.0]], [[0.0, 0.0], [-0.0, -0.0]]])
    assert speed(velocity) == pytest.approx(np.array([[5, np.nan], [0, 0]]), nan_ok=True)
    assert np.isnan(course(velocity)).tolist() == [[False, True], [True, True]]
    assert speed([1e300, 1e300]) == pytest.approx(math.sqrt(2) * 1e300)
    assert speed([3e-300, 4e-300]) == pytest.approx(5e-300)
    assert speed([np.inf, 1.0]) == np.inf
    assert speed([-7.0]) == 7.0
    assert speed(np.zeros((0, 2))).shape == course(np.zeros((0, 2))).shape == (0,)
    # Just west of north is not 360.
    assert course([-1e-300, 1.0]) == 0.0


def test_too_few_axes():
    with pytest.raises(ValueError, match="at least two axes, east and north"):
        course([[1.0]])
    with pytest.raises(ValueError, match="at least one axis"):
        speed(np.zeros((3, 0)))
    for function in (speed, course):
        with pytest.raises(ValueError, match="single number"):
            function(1.0)
