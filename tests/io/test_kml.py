from xml.etree import ElementTree

import numpy as np
import pyogrio
import pytest
from geo_tracks import empty, part, sample, tracks
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_geojson import lines
from test_track_text import as_in_xml

from fuzzytrack import DataError
from fuzzytrack.io import write_geo_tracks

KML = "{http://www.opengis.net/kml/2.2}"
GX = "{http://www.google.com/kml/ext/2.2}"


def written(tmp_path, tracks):
    path = tmp_path / "a&b.kml"
    write_geo_tracks(path, tracks)
    return path


def test_a_track_to_the_letter(tmp_path):
    text = written(tmp_path, [part(sample(course=None), slice(0, 2))]).read_text()
    assert text.startswith(
        '<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2"'
        ' xmlns:gx="http://www.google.com/kml/ext/2.2">\n<Document>\n<name>a&amp;b</name>\n'
    )
    assert text.endswith(
        "<Placemark>\n<name>a&amp;b &lt;1&gt;</name>\n<styleUrl>#color0</styleUrl>\n<gx:Track>\n"
        "<altitudeMode>absolute</altitudeMode>\n"
        "<when>2024-05-01T12:00:00Z</when>\n<when>2024-05-01T12:00:01Z</when>\n"
        "<gx:coord>179.0 -17.5 0.0</gx:coord>\n<gx:coord>179.5 -17.25 0.0000001</gx:coord>\n"
        '<ExtendedData>\n<SchemaData schemaUrl="#motion">\n<gx:SimpleArrayData name="speed">\n'
        "<gx:value></gx:value>\n<gx:value>1.0</gx:value>\n</gx:SimpleArrayData>\n"
        "</SchemaData>\n</ExtendedData>\n</gx:Track>\n</Placemark>\n</Document>\n</kml>\n"
    )


def test_without_heights_a_track_is_on_the_ground(tmp_path):
    (track,) = placemarks(written(tmp_path, [sample(altitude=None, speed=None, course=None)]))
    assert track.find(f"{KML}altitudeMode").text == "clampToGround"
    assert {coord.text.split()[2] for coord in track.iter(f"{GX}coord")} == {"0"}
    assert track.find(f"{KML}ExtendedData") is None


def test_each_track_has_a_color(tmp_path):
    first, second = sample(id="a"), sample(id="a", segment=1)
    many = [first, second, *(sample(id=str(k)) for k in range(6))]
    root = ElementTree.parse(written(tmp_path, many))
    used = [element.text for element in root.iter(f"{KML}styleUrl")]
    assert used == ["#color0", "#color0", *(f"#color{k}" for k in (1, 2, 3, 4, 5, 0))]
    assert {f"#{style.get('id')}" for style in root.iter(f"{KML}Style")} == set(used)


def test_times_need_a_date(tmp_path):
    with pytest.raises(DataError, match=r"^KML needs the date of every plot.*\.geojson or \.gpx$"):
        written(tmp_path, [sample(time=None)])
    assert list(tmp_path.iterdir()) == []


def placemarks(path):
    """Tracks of a file, in its order."""
    return list(ElementTree.parse(path).iter(f"{GX}Track"))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(tracks(), max_size=3))
def test_every_value_reads_back(tmp_path, written_tracks):
    path = written(tmp_path, written_tracks)
    names = [
        mark.find(f"{KML}name").text for mark in ElementTree.parse(path).iter(f"{KML}Placemark")
    ]
    assert names == [as_in_xml(track.title) for track in written_tracks]
    for track, element in zip(written_tracks, placemarks(path), strict=True):
        known = track.known()
        times = [when.text.rstrip("Z") for when in element.iter(f"{KML}when")]
        np.testing.assert_array_equal(np.array(times, "datetime64[ns]"), known.time)
        found = [[float(x) for x in coord.text.split()] for coord in element.iter(f"{GX}coord")]
        height = np.zeros(len(known)) if known.altitude is None else known.altitude
        wanted = np.c_[known.longitude, known.latitude, height]
        np.testing.assert_array_equal(np.reshape(found, (-1, 3)), wanted)
        arrays = {array.get("name"): array for array in element.iter(f"{GX}SimpleArrayData")}
        for name in ("speed", "course"):
            values = getattr(known, name)
            assert (name in arrays) == (values is not None)
            if values is not None:
                found = [float(cell.text or "nan") for cell in arrays[name].iter(f"{GX}value")]
                np.testing.assert_array_equal(found, values)


# -------------------------------------------------------------------- independent readers


def test_gdal_reads_the_same_tracks(tmp_path):
    path = written(tmp_path, [sample(), part(sample(segment=1), [1]), empty()])
    meta, _, geometries, columns = pyogrio.raw.read(path)
    fields = dict(zip(meta["fields"].tolist(), columns, strict=True))
    assert fields["Name"].tolist() == ["a&b <1>", "a&b <1> (2)", "none"]
    assert [str(time) for time in fields["begin"][:2]] == [
        "2024-05-01T12:00:00.000",
        "2024-05-01T12:00:01.000",
    ]
    assert str(fields["end"][0]) == "2024-05-01T12:16:40.000"
    track = sample()
    wanted = np.c_[track.longitude, track.latitude, track.altitude]
    np.testing.assert_array_equal(lines(geometries[0])[0], wanted)
    np.testing.assert_array_equal(lines(geometries[1])[0], wanted[1:2])


def test_the_schemas_of_ogc_and_google(tmp_path):
    """With the copy of the schemas that fastkml brings, where it is installed."""
    fastkml = pytest.importorskip("fastkml", reason="fastkml has the schemas of KML")
    etree = pytest.importorskip("lxml.etree", reason="lxml reads schemas")
    from pathlib import Path

    folder = Path(fastkml.__file__).parent / "schema"
    schema = etree.XMLSchema(etree.parse(folder / "ogckml22.xsd"))
    many = [sample(), sample(altitude=None), sample(speed=None, course=None), empty()]
    path = written(tmp_path, many)
    schema.assertValid(etree.parse(path))
    # The schema is looked at, also inside of tracks.
    wrong = path.read_text().replace("gx:coord>", "gx:place>")
    assert not schema.validate(etree.fromstring(wrong.encode()))
