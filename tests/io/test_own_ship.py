"""Plots relative to a moving sensor, against bearings added by hand and frames one by one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.io.geodetic import LocalFrame
from fuzzytrack.io.own_ship import relative_to_own_ship
from fuzzytrack.io.polar import ConvertedPlots, polar_to_cartesian

NOISE = {"sigma_range": 5.0, "sigma_azimuth": 0.02}
bearings = st.floats(-360, 720)
meters = st.floats(-5e4, 5e4)


@given(st.floats(1, 1e5), bearings, st.floats(-360, 360), meters, meters)
def test_heading_is_added_to_bearings_and_position_to_plots(distance, bearing, heading, x, y):
    relative = polar_to_cartesian([distance], [np.radians(bearing)], **NOISE)
    found = relative_to_own_ship(relative, [[x, y]], [heading])
    total = np.radians((bearing + heading) % 360)
    expected = polar_to_cartesian([distance], [total], **NOISE)
    assert found.position == pytest.approx(expected.position + np.array([x, y]), abs=1e-8)
    assert found.covariance == pytest.approx(expected.covariance, abs=1e-12 * distance**2 + 1e-12)
    assert not found.impossible.any()


@given(st.floats(1, 1e5), bearings, st.floats(-1.5, 1.5), st.floats(0, 360))
def test_height_stays_when_the_bow_turns(distance, bearing, elevation, heading):
    relative = polar_to_cartesian(
        [distance], [np.radians(bearing)], [elevation], **NOISE, sigma_elevation=0.01
    )
    found = relative_to_own_ship(relative, heading=heading)
    assert found.position[0, 2] == relative.position[0, 2]
    total = [np.radians((bearing + heading) % 360)]
    expected = polar_to_cartesian([distance], total, [elevation], **NOISE, sigma_elevation=0.01)
    assert found.position == pytest.approx(expected.position, abs=1e-8)
    assert found.covariance == pytest.approx(expected.covariance, abs=1e-12 * distance**2 + 1e-12)
    above = relative_to_own_ship(relative, [[1.0, 2.0, 3.0]])
    assert above.position == pytest.approx(relative.position + np.array([1, 2, 3]))
    level = relative_to_own_ship(relative, [[1.0, 2.0]])
    assert level.position == pytest.approx(relative.position + np.array([1, 2, 0]))


origins = st.builds(LocalFrame, st.floats(-85, 85), st.floats(-180, 180), st.floats(0, 500))


@given(origins, meters, meters, meters, meters)
def test_a_target_is_where_own_ship_sees_it_on_earth(frame, x, y, east, north):
    """Own ship anywhere about the origin; the target as its own frame sees it."""
    ship = frame.to_geodetic([[x, y]])
    mine = LocalFrame(ship.lat[0], ship.lon[0], frame.alt)
    target = mine.to_geodetic([[east, north]])
    distance, bearing = np.hypot(east, north), np.arctan2(east, north)
    relative = polar_to_cartesian([distance], [bearing])
    own = np.stack([ship.lat, ship.lon], axis=-1)
    found = relative_to_own_ship(relative, own, frame=frame)
    expected = frame.to_local(target.lat, target.lon).position
    assert found.position == pytest.approx(expected, abs=1e-5)


@given(origins, meters, meters, meters, meters, st.floats(-1e3, 1e4), st.floats(0, 360))
def test_the_same_in_space(frame, x, y, east, north, up, heading):
    ship = frame.to_geodetic([[x, y, 100.0]])
    mine = LocalFrame(ship.lat[0], ship.lon[0], ship.alt[0])
    target = mine.to_geodetic([[east, north, up]])
    level = np.hypot(east, north)
    bearing = (np.arctan2(east, north) - np.radians(heading)) % (2 * np.pi)
    plot = [np.hypot(level, up)], [bearing], [np.arctan2(up, level)]
    own = np.stack([ship.lat, ship.lon, ship.alt], axis=-1)
    found = relative_to_own_ship(polar_to_cartesian(*plot), own, heading, frame)
    expected = frame.to_local(target.lat, target.lon, target.alt).position
    assert found.position == pytest.approx(expected, abs=1e-5)
    relative = polar_to_cartesian(*plot, **NOISE, sigma_elevation=0.03)
    found = relative_to_own_ship(relative, own, heading, frame)
    spread = np.linalg.eigvalsh(found.covariance[0])
    before = np.linalg.eigvalsh(relative.covariance[0])
    assert spread == pytest.approx(before, rel=1e-9, abs=1e-9 * before.max())
    assert np.array_equal(found.covariance[0], found.covariance[0].T)


def test_north_of_own_ship_is_not_that_of_the_origin():
    """60° north, 100 km east: the meridians meet at 1.6°."""
    frame = LocalFrame(60.0, 0.0)
    ship = frame.to_geodetic([[100e3, 0.0]])
    own = np.stack([ship.lat, ship.lon], axis=-1)
    found = relative_to_own_ship(polar_to_cartesian([10e3], [0.0]), own, frame=frame).position
    turn = np.degrees(np.arctan2(*(found[0] - [100e3, 0.0])))
    assert turn == pytest.approx(-1.55, abs=0.02)


def test_what_is_missing_or_impossible_is_missed():
    four = polar_to_cartesian([1.0] * 4, [0.0, 0.0, 0.0, 99.0], **NOISE)
    own = [[1.0, 1.0], [np.nan, 1.0], [np.inf, 1.0], [1.0, 1.0]]
    found = relative_to_own_ship(four, own)
    assert np.isnan(found.position).all(axis=1).tolist() == [False, True, True, True]
    assert np.isnan(found.covariance).all(axis=(1, 2)).tolist() == [False, True, True, True]
    assert found.impossible.tolist() == [False, False, True, True]
    headed = relative_to_own_ship(four, heading=[0.0, np.nan, 721.0, 0.0])
    assert np.isnan(headed.position).all(axis=1).tolist() == [False, True, True, True]
    assert headed.impossible.tolist() == [False, False, True, True]
    places = [[60.0, 5.0], [91.0, 181.0], [-60.0, 5.0], [60.0, np.nan]]
    fine = polar_to_cartesian([1.0] * 4, [0.0] * 4)
    on_earth = relative_to_own_ship(fine, places, frame=LocalFrame(60.0, 5.0))
    assert on_earth.covariance is None
    assert np.isnan(on_earth.position).all(axis=1).tolist() == [False, True, True, True]
    assert on_earth.impossible.tolist() == [False, True, True, False]


def test_one_axis_of_a_plot_may_be_missing():
    position = np.array([[1.0, np.nan], [1.0, 2.0]])
    plots = ConvertedPlots(position, None, np.zeros(2, dtype=bool))
    found = relative_to_own_ship(plots, [[10.0, 10.0], [10.0, 10.0]])
    assert np.array_equal(found.position, [[11.0, np.nan], [11.0, 12.0]], equal_nan=True)
    turned = relative_to_own_ship(plots, heading=90.0).position
    assert np.isnan(turned[0]).all()
    assert turned[1] == pytest.approx([2.0, -1.0])


def test_plots_along_a_line():
    plots = ConvertedPlots(np.array([[1.0], [2.0]]), None, np.zeros(2, dtype=bool))
    assert relative_to_own_ship(plots, [[10.0], [np.nan]]).position[0] == 11.0
    assert relative_to_own_ship(plots, [[10.0, 7.0]] * 2).position.ravel().tolist() == [11, 12]


def test_own_ship_without_a_height_is_at_that_of_the_origin():
    frame = LocalFrame(60.0, 5.0, 250.0)
    plots = polar_to_cartesian([1e3] * 2, [1.0] * 2, [0.1] * 2)
    low = relative_to_own_ship(plots, [[60.1, 5.1]] * 2, frame=frame).position
    same = [[60.1, 5.1, 250.0], [60.1, 5.1, np.nan]]
    high = relative_to_own_ship(plots, same, frame=frame).position
    assert np.array_equal(low, high)


def test_none_and_nothing():
    none = polar_to_cartesian([], [])
    found = relative_to_own_ship(none, np.zeros((0, 2)), np.zeros(0), LocalFrame(0.0, 0.0))
    assert found.position.shape == (0, 2)
    assert relative_to_own_ship(none) is none


def test_wrong_shapes():
    one = polar_to_cartesian([1.0], [1.0])
    with pytest.raises(ValueError, match=r"`own`: shape \(2,\); expected \(1, 2\) or \(1, 3\)"):
        relative_to_own_ship(one, [1.0, 2.0])
    with pytest.raises(ValueError, match=r"`heading`: shape \(2,\); expected a number, or \(1,\)"):
        relative_to_own_ship(one, heading=[1.0, 2.0])
