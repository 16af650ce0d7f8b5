import json

import numpy as np
import pytest
from czml3 import Document
from geo_tracks import empty, part, sample, tracks
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fuzzytrack import DataError
from fuzzytrack.io import write_geo_tracks
from fuzzytrack.io.track_text import unicode_text


def written(tmp_path, tracks):
    path = tmp_path / "tracks.czml"
    write_geo_tracks(path, tracks)
    return path


def packets(path):
    """Packets of tracks, after the document, which an independent reader takes."""
    found = json.loads(path.read_text(encoding="utf-8"))
    document, *rest = Document.model_validate({"packets": found}).packets
    assert (document.id, document.version) == ("document", "1.0")
    assert len({packet.id for packet in rest} | {"document"}) == len(found)
    return rest


def test_a_track_to_the_letter(tmp_path):
    text = written(tmp_path, [part(sample(id="a", course=None), slice(0, 2))]).read_text()
    assert text == (
        '[\n{"id": "document", "name": "tracks", "version": "1.0"},\n'
        '{"id": "track/a/0", "name": "a", '
        '"availability": "2024-05-01T12:00:00Z/2024-05-01T12:00:01Z", '
        '"position": {"epoch": "2024-05-01T12:00:00Z", '
        '"cartographicDegrees": [0.0, 179.0, -17.5, 0.0, 1.0, 179.5, -17.25, 1e-07]}, '
        '"point": {"pixelSize": 8, "color": {"rgba": [0, 114, 178, 255]}}, '
        '"path": {"width": 2, "material": {"solidColor": {"color": {"rgba": [0, 114, 178, 255]}}}}'
        ', "properties": {"speed": {"epoch": "2024-05-01T12:00:00Z", "number": [1.0, 1.0]}}}\n'
        "]\n"
    )


def test_a_course_that_passes_north_goes_on(tmp_path):
    (packet,) = packets(written(tmp_path, [sample()]))
    times_and_courses = np.reshape(packet.properties["course"]["number"], (-1, 2))
    np.testing.assert_allclose(times_and_courses[:, 0], [1, 2.5, 3.25, 1000.000000001])
    np.testing.assert_allclose(times_and_courses[:, 1], [350, 359.5, 360.5, 370])


def test_without_heights_the_point_is_on_the_ground(tmp_path):
    packet, other = packets(written(tmp_path, [sample(altitude=None), sample(segment=1)]))
    assert packet.point.heightReference.heightReference == "CLAMP_TO_GROUND"
    assert packet.position.cartographicDegrees.values[3::4] == [0.0] * 5
    assert other.point.heightReference is None


def test_no_track_and_no_point(tmp_path):
    assert packets(written(tmp_path, [])) == []
    (tmp_path / "tracks.czml").unlink()
    (packet,) = packets(written(tmp_path, [empty(id="document")]))
    assert (packet.id, packet.name, packet.position) == ("track/document/0", "document", None)


def test_times_need_a_date(tmp_path):
    with pytest.raises(DataError, match=r"^CZML needs the date of every plot"):
        written(tmp_path, [sample(time=None)])
    assert list(tmp_path.iterdir()) == []


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(tracks(), max_size=3, unique_by=lambda track: (track.id, track.segment)))
def test_every_value_reads_back(tmp_path, written_tracks):
    for track, packet in zip(
        written_tracks, packets(written(tmp_path, written_tracks)), strict=True
    ):
        known = track.known()
        assert packet.name == unicode_text(track.title)
        if not len(known):
            assert packet.position is None
            continue
        assert np.datetime64(packet.availability.start.rstrip("Z"), "ns") == known.time[0]
        assert np.datetime64(packet.availability.end.rstrip("Z"), "ns") == known.time[-1]
        rows = np.reshape(packet.position.cartographicDegrees.values, (-1, 4))
        np.testing.assert_array_equal(time_of(packet.position.epoch, rows[:, 0]), known.time)
        height = np.zeros(len(known)) if known.altitude is None else known.altitude
        np.testing.assert_array_equal(rows[:, 1:], np.c_[known.longitude, known.latitude, height])
        for name in ("speed", "course"):
            values = getattr(known, name)
            if values is None or np.isnan(values).all():
                assert name not in (packet.properties or {})
                continue
            found = packet.properties[name]
            rows = np.reshape(found["number"], (-1, 2))
            good = ~np.isnan(values)
            np.testing.assert_array_equal(time_of(found["epoch"], rows[:, 0]), known.time[good])
            turn = (rows[:, 1] - values[good] + 180) % 360 - 180
            assert (np.abs(turn if name == "course" else rows[:, 1] - values[good]) < 1e-9).all()


def time_of(epoch, seconds):
    shift = np.round(seconds * 1e9).astype(np.int64).astype("timedelta64[ns]")
    return np.datetime64(epoch.rstrip("Z"), "ns") + shift
