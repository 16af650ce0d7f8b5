import gpxpy
import numpy as np
import pyogrio
from geo_tracks import empty, nothing_if_unknown, part, sample, tracks
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_track_text import as_in_xml

from fuzzytrack.io import write_geo_tracks
from fuzzytrack.version import __version__


def written(tmp_path, tracks):
    path = tmp_path / "a&b.gpx"
    write_geo_tracks(path, tracks)
    return path


def read(path):
    return gpxpy.parse(path.read_text(encoding="utf-8"))


def test_a_track_to_the_letter(tmp_path):
    assert written(tmp_path, [part(sample(), slice(0, 2))]).read_text() == (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<gpx version="1.1" creator="fuzzytrack {__version__}" '
        'xmlns="http://www.topografix.com/GPX/1/1" '
        'xmlns:gpxtpx="http://www.garmin.com/xmlschemas/TrackPointExtension/v2">\n'
        "<metadata><name>a&amp;b</name></metadata>\n"
        "<trk>\n<name>a&amp;b &lt;1&gt;</name>\n<trkseg>\n"
        '<trkpt lat="-17.5" lon="179.0"><ele>0.0</ele><time>2024-05-01T12:00:00Z</time></trkpt>\n'
        '<trkpt lat="-17.25" lon="179.5"><ele>0.0000001</ele><time>2024-05-01T12:00:01Z</time>'
        "<extensions><gpxtpx:TrackPointExtension><gpxtpx:speed>1.0</gpxtpx:speed>"
        "<gpxtpx:course>350.0</gpxtpx:course></gpxtpx:TrackPointExtension></extensions></trkpt>\n"
        "</trkseg>\n</trk>\n</gpx>\n"
    )


def test_parts_of_a_track_are_segments(tmp_path):
    parts = [sample(id="a"), sample(id="a", segment=1), sample(id="b"), empty()]
    found = read(written(tmp_path, parts)).tracks
    assert [(track.name, len(track.segments)) for track in found] == [
        ("a", 2),
        ("b", 1),
        ("none", 1),
    ]
    assert found[2].segments[0].points == []
    (tmp_path / "a&b.gpx").unlink()
    assert read(written(tmp_path, [])).tracks == []


def test_times_without_a_date(tmp_path):
    (track,) = read(written(tmp_path, [sample(time=None)])).tracks
    assert {point.time for point in track.segments[0].points} == {None}


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(tracks(), max_size=3, unique_by=lambda track: track.id))
def test_every_value_reads_back(tmp_path, written_tracks):
    found = read(written(tmp_path, written_tracks))
    assert found.name == "a&b"
    for track, back in zip(written_tracks, found.tracks, strict=True):
        known = track.known()
        assert (back.name or "") == as_in_xml(track.id or "track")
        (segment,) = back.segments
        points = segment.points
        # gpxpy has microseconds.
        times = np.array([point.time.replace(tzinfo=None) for point in points], "datetime64[us]")
        assert (np.abs(times - known.time) < np.timedelta64(1, "us")).all()
        assert [point.latitude for point in points] == known.latitude.tolist()
        assert [point.longitude for point in points] == known.longitude.tolist()
        heights = nothing_if_unknown(known.altitude, len(known))
        assert [point.elevation for point in points] == heights
        for name in ("speed", "course"):
            values = nothing_if_unknown(getattr(known, name), len(known))
            assert [extension(point, name) for point in points] == values


def extension(point, name):
    for group in point.extensions:
        for child in group:
            if child.tag.endswith("}" + name):
                return float(child.text)
    return None


def test_gdal_reads_the_same_points(tmp_path):
    path = written(tmp_path, [sample(), sample(segment=1)])
    meta, _, _, columns = pyogrio.raw.read(path, layer="track_points")
    fields = dict(zip(meta["fields"].tolist(), columns, strict=True))
    assert fields["track_seg_id"].tolist() == [0] * 5 + [1] * 5
    assert fields["ele"].tolist() == [*sample().altitude.tolist()] * 2
    assert str(fields["time"][2]) == "2024-05-01T12:00:02.500"
    _, _, geometries, _ = pyogrio.raw.read(path, layer="track_points")
    found = [np.frombuffer(point[5:], count=2).tolist() for point in geometries[:5]]
    assert found == np.c_[sample().longitude, sample().latitude].tolist()
