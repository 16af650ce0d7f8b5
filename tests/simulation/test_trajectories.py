import math

import numpy as np
import pytest

from fuzzytrack.simulation.trajectories import (
    constant_acceleration,
    constant_velocity,
    turn,
    turn_with_angular_acceleration,
    waypoints,
)

FINE = {"steps": 2001, "period": 0.05}
PLACED = {"heading": 0.7, "start": (-300.0, 40.0)}


def derivatives(t, position):
    """Velocity and acceleration by central differences, at the inner samples."""
    h = t[1] - t[0]
    velocity = (position[2:] - position[:-2]) / (2 * h)
    return velocity, (position[2:] - 2 * position[1:-1] + position[:-2]) / h**2


def cross(u, v):
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]


def test_constant_velocity():
    t, position = constant_velocity(speed=6.0, **PLACED)
    np.testing.assert_array_equal(t, 60.0 * np.arange(20))
    np.testing.assert_array_equal(position[0], PLACED["start"])
    velocity, acceleration = derivatives(t, position)
    np.testing.assert_allclose(np.hypot(*velocity.T), 6.0)
    np.testing.assert_allclose(np.arctan2(velocity[:, 1], velocity[:, 0]), 0.7)
    np.testing.assert_allclose(acceleration, 0.0, atol=1e-12)


def test_constant_acceleration_along_the_track():
    t, position = constant_acceleration(speed=6.0, acceleration=-0.4, **PLACED, **FINE)
    velocity, acceleration = derivatives(t, position)
    ahead = np.array([math.cos(0.7), math.sin(0.7)])
    # braked to a standstill at 15 s, and back
    np.testing.assert_allclose(velocity @ ahead, 6.0 - 0.4 * t[1:-1], atol=1e-9)
    np.testing.assert_allclose(acceleration @ ahead, -0.4, atol=1e-6)
    np.testing.assert_allclose(cross(velocity, np.tile(ahead, (len(velocity), 1))), 0, atol=1e-9)


@pytest.mark.parametrize("radius", [250.0, -250.0])
@pytest.mark.parametrize("along", [0.0, 0.1])
def test_turns(radius, along):
    if along:
        t, position = turn_with_angular_acceleration(
            speed=6.0, acceleration=along, radius=radius, **PLACED, **FINE
        )
    else:
        t, position = turn(speed=6.0, radius=radius, **PLACED, **FINE)
    velocity, acceleration = derivatives(t, position)
    speed = np.hypot(*velocity.T)
    np.testing.assert_allclose(speed, 6.0 + along * t[1:-1], rtol=1e-5)
    tangential = (velocity * acceleration).sum(axis=1) / speed
    np.testing.assert_allclose(tangential, along, atol=1e-5)
    np.testing.assert_allclose(cross(velocity, acceleration) / speed**3, 1 / radius, rtol=1e-5)
    # the angle turned through is the way over the radius
    headings = np.unwrap(np.arctan2(velocity[:, 1], velocity[:, 0]))
    way = 6.0 * t[1:-1] + along * t[1:-1] ** 2 / 2
    np.testing.assert_allclose(headings - 0.7, way / radius, atol=1e-5)
    center = np.array(PLACED["start"]) + radius * np.array([-math.sin(0.7), math.cos(0.7)])
    np.testing.assert_allclose(np.hypot(*(position - center).T), abs(radius))


def test_a_very_wide_turn_is_a_parabola():
    t, position = turn(speed=1.0, radius=1e9, steps=5, period=1.0)
    np.testing.assert_allclose(position[:, 1], t**2 / 2e9, rtol=1e-12)


def test_spline_through_waypoints():
    points = np.array([[0.0, 0.0], [50.0, 10.0], [80.0, 70.0], [20.0, 90.0], [0.0, 30.0]])
    t, position = waypoints(points, leg=10.0, period=0.01)
    assert t[-1] == 40.0
    np.testing.assert_allclose(position[::1000], points, atol=1e-9)
    velocity, acceleration = derivatives(t, position)
    # no jump at the way-points: neither in velocity nor in acceleration
    assert np.abs(np.diff(velocity, axis=0)).max() < 0.1
    assert np.abs(np.diff(acceleration, axis=0)).max() < 0.01


def test_spline_is_exact_for_a_cubic():
    times = np.array([1.0, 2.0, 4.0, 5.0, 9.0])
    points = np.stack([times**3 - 2 * times, times**2, -times], axis=1)
    t, position = waypoints(points, times=times, period=0.7)
    assert t[0] == 1.0
    assert 8.3 < t[-1] <= 9.0
    np.testing.assert_allclose(position, np.stack([t**3 - 2 * t, t**2, -t], axis=1), atol=1e-9)


def test_two_waypoints_make_a_line_that_ends_on_the_last():
    t, position = waypoints([[0.0, 0.0], [3.0, 6.0]], leg=0.3, period=0.1)
    assert len(t) == 4
    np.testing.assert_allclose(position, [[0, 0], [1, 2], [2, 4], [3, 6]], atol=1e-12)


@pytest.mark.parametrize(
    ("make", "change", "message"),
    [
        (constant_velocity, {"speed": math.nan}, "speed must be finite, got nan"),
        (constant_velocity, {"heading": math.inf}, "heading must be finite, got inf"),
        (constant_velocity, {"start": (1.0, math.nan)}, "start must be finite, got nan at index 1"),
        (constant_velocity, {"start": (1.0, 2.0, 3.0)}, r"start must be two coord.*shape \(3,\)"),
        (constant_velocity, {"steps": 0}, "steps must be at least 1, got 0"),
        (constant_velocity, {"period": 0.0}, "period must be finite and > 0, got 0"),
        (turn, {"radius": 0.0}, "radius must be finite and not 0, got 0"),
        (turn, {"radius": math.nan}, "radius must be finite, got nan"),
    ],
)
def test_impossible_paths(make, change, message):
    good = {"speed": 6.0} | ({"radius": 100.0} if make is turn else {})
    with pytest.raises(ValueError, match=message):
        make(**(good | change))


def test_acceleration_must_be_finite():
    with pytest.raises(ValueError, match="acceleration must be finite, got inf"):
        constant_acceleration(speed=1.0, acceleration=math.inf)
    with pytest.raises(TypeError):
        constant_velocity(speed=1.0, steps=2.5)


@pytest.mark.parametrize(
    ("points", "more", "message"),
    [
        ([[0, 0]], {}, r"two way-points at least; got shape \(1, 2\)"),
        ([0, 1], {}, "points must have shape"),
        ([[5, 1]] * 3, {}, r"must not all lie on one spot; all 3 lie on \[5.0, 1.0\]"),
        ([[0, 0], [1, math.nan]], {}, "points must be finite"),
        ([[0, 0], [1, 1]], {"leg": 0.0}, "leg must be finite and > 0, got 0"),
        ([[0, 0], [1, 1]], {"period": -1.0}, "period must be finite and > 0, got -1"),
        ([[0, 0], [1, 1]], {"times": [1, 1]}, r"times must be 2 increasing.*\[1.0, 1.0\]"),
        ([[0, 0], [1, 1]], {"times": [1, 2, 3]}, "times must be 2 increasing"),
    ],
)
def test_impossible_waypoints(points, more, message):
    with pytest.raises(ValueError, match=message):
        waypoints(points, **more)
