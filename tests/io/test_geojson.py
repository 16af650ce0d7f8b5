import json
import struct

import numpy as np
import pyogrio
import pytest
from geo_tracks import empty, nothing_if_unknown, part, sample, times, tracks
from geojson_pydantic import FeatureCollection
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzytrack.io import write_geo_tracks
from fuzzytrack.io.track_text import unicode_text


def written(tmp_path, tracks):
    path = tmp_path / "tracks.geojson"
    write_geo_tracks(path, tracks)
    return path


def features(path):
    """Features of a file that the referee of RFC 7946 takes."""
    text = path.read_text(encoding="utf-8")
    assert FeatureCollection.model_validate_json(text).type == "FeatureCollection"
    return json.loads(text)["features"]


def test_a_track_to_the_letter(tmp_path):
    track = sample(id="a", course=None)
    assert written(tmp_path, [part(track, slice(0, 2))]).read_text() == (
        '{"type": "FeatureCollection", "name": "tracks", "features": [\n'
        '{"type": "Feature", "properties": {"id": "a", "segment": 0, "stroke": "#0072b2", '
        '"times": ["2024-05-01T12:00:00Z", "2024-05-01T12:00:01Z"], "speeds": [null, 1.0]}, '
        '"geometry": {"type": "LineString", '
        '"coordinates": [[179.0, -17.5, 0.0], [179.5, -17.25, 1e-07]]}}\n'
        "]}\n"
    )


def test_cut_at_the_date_line(tmp_path):
    (feature,) = features(written(tmp_path, [sample()]))
    geometry, properties = feature["geometry"], feature["properties"]
    assert geometry["type"] == "MultiLineString"
    west, east = geometry["coordinates"]
    # Two thirds of the way from 179.5 to 180.25, along a straight line in degrees.
    np.testing.assert_allclose(west[-1], [180, -17 - 1 / 12, 25 / 3])
    np.testing.assert_allclose(east[0], [-180, -17 - 1 / 12, 25 / 3])
    assert [row[0] for row in west + east] == [
        179.0, 179.5, 180.0, -180.0, -179.75, -179.5, -179.123456789012,
    ]  # fmt: skip
    assert properties["times"] == [
        ["2024-05-01T12:00:00Z", "2024-05-01T12:00:01Z", "2024-05-01T12:00:02Z"],
        ["2024-05-01T12:00:02Z", "2024-05-01T12:00:02.5Z", "2024-05-01T12:00:03.25Z",
         "2024-05-01T12:16:40.000000001Z"],
    ]  # fmt: skip
    assert properties["speeds"] == [[None, 1.0, None], [None, 2.5, 0.0, 1e-9]]
    assert properties["courses"] == [[None, 350.0, None], [None, 359.5, 0.5, 10.0]]


def test_one_point_no_point_and_no_track(tmp_path):
    one = sample(longitude=np.array([np.nan, np.nan, 180.0, np.nan, np.nan]))
    point, nothing = features(written(tmp_path, [one, empty()]))
    assert point["geometry"] == {"type": "Point", "coordinates": [-180.0, -17.0, 12.5]}
    assert point["properties"]["times"] == "2024-05-01T12:00:02.5Z"
    assert point["properties"]["speeds"] == 2.5
    assert nothing["geometry"] is None
    assert nothing["properties"] == {
        "id": "none", "segment": 0, "stroke": "#d55e00", "times": [],
    }  # fmt: skip
    (tmp_path / "tracks.geojson").unlink()
    assert features(written(tmp_path, [])) == []


def test_times_without_a_date(tmp_path):
    (feature,) = features(written(tmp_path, [sample(time=None)]))
    assert "times" not in feature["properties"]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(tracks(), max_size=3))
def test_every_value_reads_back(tmp_path, written_tracks):
    path = written(tmp_path, written_tracks)
    for track, feature in zip(written_tracks, features(path), strict=True):
        known, properties = track.known(), feature["properties"]
        assert properties["id"] == unicode_text(track.id)
        assert properties["segment"] == track.segment
        rows = {
            time: (position, speed, course)
            for time, position, speed, course in zip(
                *(flat(feature, key) for key in ("times", "coordinates", "speeds", "courses")),
                strict=True,
            )
        }
        speeds = nothing_if_unknown(known.speed, len(known))
        courses = nothing_if_unknown(known.course, len(known))
        for k in range(len(known)):
            position, *motion = rows[str(known.time[k]).rstrip("0").rstrip(".") + "Z"]
            height = [] if known.altitude is None else [known.altitude[k]]
            assert position[1:] == [known.latitude[k], *height]
            assert (position[0] - known.longitude[k]) % 360 == 0
            assert motion == [speeds[k], courses[k]]


def flat(feature, key):
    """Values of all vertices of a feature."""
    geometry = feature["geometry"] or {"type": "LineString", "coordinates": []}
    shape, count = geometry["type"], geometry["coordinates"]
    values = geometry if key == "coordinates" else feature["properties"]
    if key not in values:
        return [None] * len(flat(feature, "times"))
    values = values[key]
    assert shape in ("Point", "LineString", "MultiLineString")
    if shape == "Point":
        return [values]
    if shape == "LineString":
        assert len(values) == len(count)
        return values
    assert [len(part) for part in values] == [len(part) for part in count]
    return [value for part in values for value in part]


# -------------------------------------------------------------------- GDAL


def test_gdal_reads_the_same_positions(tmp_path):
    line = sample(longitude=np.array([5.0, 5.5, 6, 6.25, 6.123456789012]))
    path = written(tmp_path, [line, sample(), empty(), part(line, [0])])
    meta, _, geometries, columns = pyogrio.raw.read(path)
    fields = dict(zip(meta["fields"].tolist(), columns, strict=True))
    assert meta["crs"] == "EPSG:4326"
    assert fields["id"].tolist() == [line.id, line.id, "none", line.id]
    whole, cut, nothing, point = geometries
    (found,) = lines(whole)
    np.testing.assert_array_equal(found, np.c_[line.longitude, line.latitude, line.altitude])
    assert [len(part) for part in lines(cut)] == [3, 4]
    assert nothing is None
    np.testing.assert_array_equal(lines(point)[0], found[:1])
    assert json.loads(fields["times"][0])[1] == "2024-05-01T12:00:01Z"


def lines(wkb):
    """Positions of the lines, or of the point, in a geometry with heights as WKB."""
    kind, rest = struct.unpack("<H", wkb[1:3])[0] % 1000, wkb[5:]
    if kind == 1:
        return [np.frombuffer(rest).reshape(1, 3)]
    count = struct.unpack("<I", rest[:4])[0]
    if kind == 2:
        return [np.frombuffer(rest[4:], count=3 * count).reshape(-1, 3)]
    found, rest = [], rest[4:]
    for _ in range(count):
        found += lines(rest)
        rest = rest[9 + found[-1].size * 8 :]
    return found


@pytest.mark.parametrize("start", ["1800-01-01", "2200-01-01"])
def test_any_century(tmp_path, start):
    track = sample(time=times([0, 1, 2, 3, 4], np.datetime64(start, "ns")))
    (feature,) = features(written(tmp_path, [track]))
    assert feature["properties"]["times"][0][0] == f"{start}T00:00:00Z"
