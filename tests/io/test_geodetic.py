"""Places on earth against textbook formulas, and there and back."""

import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.errors import DataError
from fuzzytrack.io.geodetic import LocalFrame, axes_on_earth, on_the_earth

MAJOR, FLATTENING = 6378137.0, 1 / 298.257223563
ECCENTRICITY = FLATTENING * (2 - FLATTENING)


def earth_centered(lat, lon, alt):
    """Textbook: a place of WGS 84 from the center of the earth."""
    lat, lon = np.radians(lat), np.radians(lon)
    normal = MAJOR / np.sqrt(1 - ECCENTRICITY * np.sin(lat) ** 2)
    level = (normal + alt) * np.cos(lat)
    height = (normal * (1 - ECCENTRICITY) + alt) * np.sin(lat)
    return np.array([level * np.cos(lon), level * np.sin(lon), height])


def turned(lat, lon, vector):
    """A vector from the center's axes to east, north and up, by two turns about axes."""
    quarter = np.pi / 2
    about_z, about_x = quarter + np.radians(lon), quarter - np.radians(lat)
    c, s = np.cos(about_z), np.sin(about_z)
    vector = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ vector
    c, s = np.cos(about_x), np.sin(about_x)
    return np.array([[1, 0, 0], [0, c, s], [0, -s, c]]) @ vector


def oracle(frame, lat, lon, alt):
    difference = earth_centered(lat, lon, alt) - earth_centered(frame.lat, frame.lon, frame.alt)
    return turned(frame.lat, frame.lon, difference)


heights = st.floats(-400, 12e3)
frames = st.builds(LocalFrame, st.floats(-90, 90), st.floats(-180, 360), heights)
everywhere = (st.floats(-90, 90), st.floats(-360, 360), heights)


@given(frames, *everywhere)
def test_as_the_textbook_says_with_altitude(frame, lat, lon, alt):
    found = frame.to_local([lat], [lon], [alt])
    assert found.position[0] == pytest.approx(oracle(frame, lat, lon, alt), abs=1e-7)
    assert not found.impossible.any()
    assert not found.too_far.any()


near = st.floats(-300e3, 300e3)


@given(frames, near, near, heights)
def test_there_and_back_with_altitude(frame, east, north, up):
    places = frame.to_geodetic([[east, north, up]])
    assert -90 <= places.lat[0] <= 90
    assert -180 <= places.lon[0] <= 180
    back = frame.to_local(places.lat, places.lon, places.alt)
    assert back.position[0] == pytest.approx([east, north, up], abs=1e-6)


@given(frames, near, near)
def test_there_and_back_in_the_plane(frame, east, north):
    places = frame.to_geodetic([[east, north]])
    assert places.alt == pytest.approx(frame.alt, abs=1e-6)
    back = frame.to_local(places.lat, places.lon)
    assert back.position[0] == pytest.approx([east, north], abs=1e-6)
    # The other turn of the longitude is the same place.
    other = frame.to_local(places.lat, places.lon + 360 * (places.lon < 0))
    assert other.position == pytest.approx(back.position, abs=1e-6)


@given(frames, st.floats(0, 44), st.floats(0, 360))
def test_far_places_come_back_from_the_plane(frame, arc, bearing):
    """Up to 44° away, where the plane is 1800 km above the ground."""
    size = np.sin(np.radians(arc)) * 6.35e6
    east, north = size * np.sin(np.radians(bearing)), size * np.cos(np.radians(bearing))
    places = frame.to_geodetic([[east, north]])
    assert places.alt == pytest.approx(frame.alt, abs=1e-6)
    back = frame.to_local(places.lat, places.lon)
    assert not back.too_far.any()
    assert back.position[0] == pytest.approx([east, north], abs=1e-5)


@given(frames)
def test_the_origin_is_zero(frame):
    assert frame.to_local([frame.lat], [frame.lon]).position == pytest.approx(0, abs=1e-8)
    place = frame.to_geodetic([[0.0, 0.0, 0.0]])
    assert place.lat == pytest.approx(frame.lat, abs=1e-9)
    assert place.alt == pytest.approx(frame.alt, abs=1e-6)


def test_across_the_date_line():
    """A degree of longitude on the equator is 111.3 km, on either side of 180°."""
    degree = MAJOR * np.radians(1)
    for lon in (179.5, -180.5):
        found = LocalFrame(0.0, lon).to_local([0.0] * 3, [180.0, -179.5, 180.5]).position
        assert found[:, 0] == pytest.approx(np.array([0.5, 1, 1]) * degree, rel=1e-4)
        assert found[:, 1] == pytest.approx(0, abs=1e-8)


def test_across_the_pole():
    """From 0.01° south of the pole to 0.01° beyond it, straight to the north."""
    frame = LocalFrame(89.99, 20.0)
    found = frame.to_local([90.0, 89.99, 89.99], [-70.0, -160.0, 200.0]).position
    degree = np.radians(0.01) * 6399593.6  # the radius of curvature at the pole
    assert found[:, 0] == pytest.approx(0, abs=1e-6)
    assert found[:, 1] == pytest.approx(np.array([1, 2, 2]) * degree, rel=1e-6)
    back = frame.to_geodetic(found)
    assert back.lat == pytest.approx([90.0, 89.99, 89.99], abs=1e-9)
    assert np.cos(np.radians(back.lon[1:] - 200)) == pytest.approx(1)
    # At the pole itself, the longitude of the origin says where its north is.
    pole = LocalFrame(90.0, 0.0).to_local([89.99] * 2, [0.0, 90.0]).position
    assert pole == pytest.approx(np.array([[0, -degree], [degree, 0]]), rel=1e-6, abs=1e-6)


def test_impossible_places_are_marked_and_missed():
    lat = [91.0, -90.1, 10.0, 10.0, np.nan, 90.0, np.inf, 9.97e36, 10.0]
    lon = [181.0, 0.0, 360.1, -np.inf, 0.0, 360.0, 0.0, 0.0, np.nan]
    expected = [True, True, True, True, False, False, True, True, False]
    for alt in (None, np.zeros(9)):
        found = LocalFrame(60.0, 5.0).to_local(lat, lon, alt)
        assert found.impossible.tolist() == expected
        assert np.isnan(found.position).all(axis=1).tolist() == [i != 5 for i in range(9)]
        assert not found.too_far.any()
    wrong = LocalFrame(0.0, 0.0).to_local([0.0, 0.0], [0.0, 0.0], [np.inf, -9.97e36])
    assert wrong.impossible.all()


anything = st.floats(allow_nan=True, allow_infinity=True)


@given(frames, anything, anything, anything)
def test_any_numbers_are_a_finite_position_or_a_missed_plot(frame, lat, lon, alt):
    for found, known in (
        (frame.to_local([lat], [lon]), [lat, lon]),
        (frame.to_local([lat], [lon], [alt]), [lat, lon]),
    ):
        dropped = found.impossible[0] or found.too_far[0]
        level = found.position[0, :2]
        assert np.isfinite(level).all() == (not dropped and np.isfinite(known).all())
        assert not np.isinf(found.position).any()
    places = frame.to_geodetic([[lat, lon, alt]])
    assert np.isnan(places.lat[0]) or -90 <= places.lat[0] <= 90
    flat = frame.to_geodetic([[lat, lon]])
    assert np.isnan(flat.lat[0]) or -90 <= flat.lat[0] <= 90


def test_a_longitude_of_181_is_one():
    """AIS codes both coordinates; hurricane tracks count longitudes to 360."""
    found = LocalFrame(10.0, -179.0).to_local([10.0], [181.0])
    assert found.position == pytest.approx(0, abs=1e-8)


def test_places_that_the_plane_does_not_reach():
    frame = LocalFrame(0.0, 0.0)
    lat, lon = np.array([0.0, 0.0, 44.9, 45.1, -80.0, np.nan]), np.array([0, 180.0, 0, 0, 0, 0])
    plane = frame.to_local(lat, lon)
    assert plane.too_far.tolist() == [False, True, False, True, True, False]
    assert np.isnan(plane.position).all(axis=1).tolist() == [False, True, False, True, True, True]
    space = frame.to_local(lat, lon, np.zeros(6))
    assert not space.too_far.any()
    assert space.position[1] == pytest.approx([0, 0, -2 * MAJOR], abs=1e-6)


def test_a_missing_altitude_leaves_east_and_north():
    frame = LocalFrame(60.0, 5.0, 300.0)
    found = frame.to_local([60.1, 60.1], [5.1, 5.1], [np.nan, 300.0]).position
    assert np.isnan(found[0, 2])
    assert found[0, :2].tolist() == found[1, :2].tolist()
    back = frame.to_geodetic(found)
    assert back.lat == pytest.approx(60.1)
    assert back.lon == pytest.approx(5.1)
    assert np.isnan(back.alt[0])
    assert back.alt[1] == pytest.approx(300)


def test_none_and_nothing():
    frame = LocalFrame(60.0, 5.0)
    assert frame.to_local([], []).position.shape == (0, 2)
    assert frame.to_local([], [], []).position.shape == (0, 3)
    assert frame.to_geodetic(np.zeros((0, 2))).lat.shape == (0,)
    lost = frame.to_geodetic([[np.nan, 1.0], [7e6, 0.0]])
    assert np.isnan([lost.lat, lost.lon, lost.alt]).all()
    assert np.isnan(frame.to_geodetic([[np.nan, 1.0, 1.0]]).lat).all()
    assert frame.remark(0.0, 2) is None


def test_short_distances_are_said():
    frame = LocalFrame(50.0, 5.0)
    assert frame.remark(499e3, 2) is None
    told = frame.remark(600e3, 2)
    assert "up to 600 km from the origin" in told
    assert "0.1% shorter" in told
    assert "0.4% lower" in told
    assert "28 km above the ground" in frame.remark(600e3, 3)
    # Where the plane has no ground below it.
    assert "100.0% lower" in frame.remark(7e6, 2)


def test_the_figures_of_the_class():
    for distance, short, slow in ((100e3, 0.00004, 0.00012), (500e3, 0.001, 0.003)):
        arc = distance / 6371e3
        assert 1 - np.sin(arc) / arc == pytest.approx(short, rel=0.05)
        assert 1 - np.cos(arc) == pytest.approx(slow, rel=0.05)


@given(frames)
def test_axes_are_those_of_the_textbook(frame):
    axes = axes_on_earth(frame.lat, frame.lon)
    turn = np.stack([turned(frame.lat, frame.lon, unit) for unit in np.eye(3)], axis=-1)
    assert axes == pytest.approx(turn, abs=1e-14)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-14)


def test_places_about_many_origins():
    """Each with an origin of its own, as frames one by one."""
    lat, lon, alt = np.array([10.0, -89.9, 60.0]), np.array([179.99, 0.0, 5.0]), 20.0
    found = on_the_earth([5e3, 2e4, 0.0], [1e3, 3e4, 0.0], lat, lon, alt)
    for k, position in enumerate([[5e3, 1e3], [2e4, 3e4], [0.0, 0.0]]):
        one = LocalFrame(lat[k], lon[k], alt).to_geodetic([position])
        assert [found.lat[k], found.lon[k], found.alt[k]] == pytest.approx(
            [one.lat[0], one.lon[0], one.alt[0]], abs=1e-9
        )


# -------------------------------------------------------------------- wrong arguments


@pytest.mark.parametrize(
    ("origin", "message"),
    [
        ((91.0, 0.0), "lat 91; expected -90 to 90"),
        ((0.0, 361.0), "lon 361; expected -360 to 360"),
        ((np.nan, 0.0), "lat nan"),
        ((0.0, 0.0, np.inf), "alt inf"),
    ],
)
def test_origins_that_do_not_exist(origin, message):
    with pytest.raises(DataError, match=message):
        LocalFrame(*origin)


def test_wrong_shapes():
    frame = LocalFrame(0.0, 0.0)
    with pytest.raises(ValueError, match=r"`lon`: shape \(2,\); .* \(1,\), as `lat` has"):
        frame.to_local([1.0], [1.0, 2.0])
    with pytest.raises(ValueError, match=r"`alt`: shape \(\); .* \(1,\), as `lat` has"):
        frame.to_local([1.0], [1.0], 5.0)
    with pytest.raises(ValueError, match=r"`lat`: shape \(\); expected one value for each plot$"):
        frame.to_local(1.0, 1.0)
    with pytest.raises(ValueError, match=r"`position`: shape \(2,\); expected \(n, 2\)"):
        frame.to_geodetic([1.0, 2.0])


def test_without_pymap3d_the_command_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "pymap3d", None)
    for call in (
        lambda: LocalFrame(0.0, 0.0).to_local([0.0], [0.0]),
        lambda: LocalFrame(0.0, 0.0).to_geodetic([[0.0, 0.0]]),
    ):
        with pytest.raises(DataError, match=r"pip install 'fuzzytrack\[geo\]'") as caught:
            call()
        assert "\n" not in str(caught.value)
