import math

import numpy as np
import pytest
from geo_tracks import empty, part, sample, times

from fuzzytrack.io import GeoTrack
from fuzzytrack.io.geo_track import numbered


def track(**changes):
    return GeoTrack(**{"id": "a", "latitude": np.zeros(2), "longitude": np.zeros(2), **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"longitude": np.zeros(3)}, r"longitude: shape \(3,\); expected \(2,\)"),
        ({"latitude": np.zeros((2, 1))}, "latitude: shape"),
        ({"speed": [1, 2, 3]}, "speed: shape"),
        ({"altitude": [1, math.inf]}, "altitude: holds infinite values"),
        ({"latitude": [0, 90.5]}, "latitude: 90.5; expected degrees from -90 to 90"),
        ({"time": times([0])}, r"time: shape \(1,\); expected \(2,\)"),
        ({"time": times([1, 1])}, "time: does not increase"),
    ],
)
def test_what_is_no_track(changes, message):
    with pytest.raises(ValueError, match=message):
        track(**changes)


def test_rows_without_a_position_are_left_out():
    whole = sample()
    latitude, longitude = whole.latitude.copy(), whole.longitude.copy()
    altitude, time = whole.altitude.copy(), whole.time.copy()
    latitude[0] = longitude[1] = altitude[2] = np.nan
    time[4] = np.datetime64("NaT")
    holes = sample(latitude=latitude, longitude=longitude, altitude=altitude, time=time)
    known = holes.known()
    expected = part(whole, [3])
    for name in ("time", "latitude", "longitude", "altitude", "speed", "course"):
        np.testing.assert_array_equal(getattr(known, name), getattr(expected, name))
    assert len(holes) == 5
    assert len(empty().known()) == 0


def test_longitudes_are_below_180():
    longitude = [0.1, 180.0, 190.0, -180.0, -190.0, 540.0, 359.75]
    found = GeoTrack(id="a", latitude=np.zeros(7), longitude=longitude).known().longitude
    assert found.tolist() == [0.1, -180.0, -170.0, -180.0, 170.0, -180.0, -0.25]


def test_titles():
    assert track().title == "a"
    assert track(segment=2).title == "a (3)"
    assert track(id="").title == "track"


def test_parts_of_a_track_share_a_number():
    parts = [track(), track(segment=1), track(id="b"), track()]
    assert [number for number, _ in numbered(parts)] == [0, 0, 1, 2]


def test_repr():
    assert repr(track()) == '<GeoTrack: id="a", segment=0, latitude.shape=(2,)>'
