import datetime
import gzip
import math

import pytest
from data_files import written
from hypothesis import given, settings
from hypothesis import strategies as st
from source_rows import read

from fuzzytrack import DataError

HEAD = '<?xml version="1.0"?>\n<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1">'


def point(lat, lon, time="2024-05-01T10:00:00Z", ele=None):
    inside = f"<ele>{ele}</ele>" if ele is not None else ""
    inside += f"<time>{time}</time>" if time else ""
    return f'<trkpt lat="{lat}" lon="{lon}">{inside}</trkpt>\n'


def track(*segments, name=None):
    title = f"<name>{name}</name>" if name else ""
    inside = "".join(f"<trkseg>{''.join(points)}</trkseg>" for points in segments)
    return f"<trk>{title}{inside}</trk>"


def gpx(*tracks, head=HEAD):
    return f"{head}{''.join(tracks)}</gpx>"


def test_tracks_segments_times_and_heights(tmp_path):
    text = gpx(
        track([point(45.5, 7.25, ele=1200.5), point(45.6, 7.3, "2024-05-01T10:00:01.25Z")],
              [point(-0.5, -180)], name="first"),
        track([point(1, 2)]),
    )  # fmt: skip
    columns, description, notes = read(written(tmp_path, text, "a.gpx"))
    assert columns["lat"] == [45.5, 45.6, -0.5, 1.0]
    assert columns["lon"] == [7.25, 7.3, -180.0, 2.0]
    assert columns["id"] == ["first"] * 3 + ["2"]
    assert columns["segment"] == [1.0, 1.0, 2.0, 1.0]
    assert columns["time"][:2] == ["2024-05-01T10:00:00Z", "2024-05-01T10:00:01.25Z"]
    assert columns["ele"][0] == 1200.5
    assert all(map(math.isnan, columns["ele"][1:]))
    assert (description.time, description.id) == ("time", "id")
    assert description.geodetic == ("lat", "lon")
    assert notes == []


def test_tracks_of_one_name_are_told_apart(tmp_path):
    tracks = [track([point(1, 2)], name=name) for name in ("a", "a", "a (2)", None, "4")]
    columns, _, _ = read(written(tmp_path, gpx(*tracks), "a.gpx"))
    assert columns["id"] == ["a", "a (2)", "a (2) (2)", "4", "4 (2)"]


def test_a_prefix_an_extension_and_entities_of_xml(tmp_path):
    text = (
        '<g:gpx xmlns:g="http://www.topografix.com/GPX/1/0"><g:trk><g:name>R&amp;D &#65;</g:name>'
        '<g:trkseg><g:trkpt lat="1" lon="2"><g:time>2024-05-01T10:00:00Z</g:time>'
        "<g:extensions><x><ele>7</ele><time>never</time></x></g:extensions></g:trkpt>"
        "</g:trkseg></g:trk></g:gpx>"
    )
    columns, _, _ = read(written(tmp_path, text, "a.gpx"))
    assert columns["id"] == ["R&D A"]
    assert columns["time"] == ["2024-05-01T10:00:00Z"]
    assert math.isnan(columns["ele"][0])


def test_utf_16(tmp_path):
    text = gpx(track([point(1, 2)], name="Zürich"), head=HEAD.replace("1.0", "1.0", 1))
    columns, _, _ = read(written(tmp_path, text.encode("utf-16"), "a.gpx"))
    assert columns["id"] == ["Zürich"]


def test_what_is_left_out_is_counted_with_its_line(tmp_path):
    text = gpx(
        '<wpt lat="1" lon="2"/>\n<rte><rtept lat="1" lon="2"/></rte>\n',
        track([point(1, 2), point(1, 2, time=""), point(91, 0), point("x", 0), point(1, "inf")]),
    )
    columns, _, notes = read(written(tmp_path, text, "a.gpx"))
    assert columns["lat"] == [1.0]
    assert notes == [
        "waypoints: 1 left out, first at line 2",
        "points of routes: 1 left out, first at line 3",
        "points of tracks without a time: 1 left out, first at line 5",
        "points of tracks whose latitude or longitude is none: 3 left out, first at line 6",
    ]


def test_a_file_that_breaks_off_is_read_as_far_as_it_goes(tmp_path):
    text = gpx(track([point(1, 2), point(3, 4)]))
    columns, _, notes = read(written(tmp_path, text[:-40], "a.gpx"))
    assert columns["lat"] == [1.0, 3.0][: len(columns["lat"])]
    assert columns["lat"]
    assert notes[0].startswith("left out: what is no XML, and all that follows: ")
    assert ": line " in notes[0]


@pytest.mark.parametrize("text", ["", "t,x\n0,1\n", "<gpx/>", "\xff\xfe\x00"])
def test_a_file_without_points_is_refused(tmp_path, text):
    with pytest.raises(DataError, match=r"a\.gpx: holds no plots"):
        read(written(tmp_path, text, "a.gpx"))


def test_a_document_type_is_refused_before_its_entities_grow(tmp_path):
    bomb = '<!DOCTYPE gpx [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
    text = gpx(track([point(1, 2)], name="&b;"), head=f'<?xml version="1.0"?>\n{bomb}<gpx>')
    with pytest.raises(DataError, match=r"a\.gpx: line 2: has a document type .*remove it"):
        read(written(tmp_path, text, "a.gpx"))


def test_long_texts_are_not_kept(tmp_path):
    text = gpx(track([point(1, 2)], name="x" * 1_000_000))
    columns, _, _ = read(written(tmp_path, text, "a.gpx"))
    assert len(columns["id"][0]) <= 2_000


def test_pieces_are_parts_of_the_whole(tmp_path):
    text = gpx(track([point(k / 100, 2, ele=k) for k in range(2_000)]))
    file = written(tmp_path, text, "a.gpx")
    assert read(file, rows=300)[0] == read(file)[0]


@settings(deadline=None, max_examples=25)
@given(
    st.lists(
        st.tuples(st.floats(-90, 90), st.floats(-180, 180), st.datetimes(), st.floats(-1e4, 1e5)),
        min_size=1,
        max_size=20,
    )
)
def test_gpxpy_writes_what_is_read(tmp_path_factory, points):
    gpxpy = pytest.importorskip("gpxpy.gpx", reason="gpxpy is not installed")
    document = gpxpy.GPX()
    segment = gpxpy.GPXTrackSegment()
    document.tracks.append(gpxpy.GPXTrack())
    document.tracks[0].segments.append(segment)
    utc = datetime.UTC
    for lat, lon, time, ele in points:
        time = time.replace(tzinfo=utc, year=max(time.year, 1000))
        segment.points.append(gpxpy.GPXTrackPoint(lat, lon, ele, time))
    file = written(tmp_path_factory.getbasetemp(), document.to_xml(), "property.gpx")
    columns, _, _ = read(file)
    assert columns["lat"] == pytest.approx([lat for lat, *_ in points], abs=1e-9)
    assert columns["lon"] == pytest.approx([lon for _, lon, *_ in points], abs=1e-9)
    assert columns["ele"] == pytest.approx([ele for *_, ele in points], abs=1e-9)
    times = [datetime.datetime.fromisoformat(time) for time in columns["time"]]
    assert times == [point.time for point in segment.points]


def test_compressed(tmp_path):
    text = gpx(track([point(1, 2)])).encode()
    columns, _, _ = read(written(tmp_path, gzip.compress(text), "a.GPX.gz"))
    assert columns["lat"] == [1.0]
