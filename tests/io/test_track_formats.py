import pytest
from geo_tracks import sample

from fuzzytrack import DataError
from fuzzytrack.io.track_formats import TRACK_SUFFIXES, check_geo_tracks, is_geo, write_geo_tracks


def test_formats_are_known_by_their_suffixes():
    assert TRACK_SUFFIXES == (".geojson", ".kml", ".czml", ".gpx")
    assert is_geo("a.GeoJSON")
    assert not any(map(is_geo, ("a.csv", "a.json", "geojson", "")))


@pytest.mark.parametrize(
    ("name", "known", "message"),
    [
        ("a.csv", {}, r"a.csv: cannot write .csv; .geojson, .kml, .czml or .gpx$"),
        ("a", {}, "a: cannot write without suffix; "),
        ("a.gpx", {"on_earth": False}, r"a.gpx: .gpx needs positions on the earth; .*`geodetic`"),
        ("a.kml", {"dated": False}, r"a.kml: KML needs the date of every plot, .*, .gpx or .csv"),
        ("a.czml", {"dated": False}, "a.czml: CZML needs the date of every plot, "),
    ],
)
def test_what_cannot_be_written(tmp_path, name, known, message):
    with pytest.raises(DataError, match=message):
        check_geo_tracks(tmp_path / name, **known)


def test_what_can_be_written(tmp_path):
    for suffix in TRACK_SUFFIXES:
        check_geo_tracks(tmp_path / f"a{suffix}")
    check_geo_tracks(tmp_path / "a.gpx", dated=False)
    check_geo_tracks(tmp_path / "a.GeoJSON", dated=False)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", TRACK_SUFFIXES)
def test_the_name_is_that_of_the_file_unless_given(tmp_path, suffix):
    write_geo_tracks(tmp_path / f"harbor{suffix}", [sample()])
    assert "harbor" in (tmp_path / f"harbor{suffix}").read_text()
    write_geo_tracks(tmp_path / f"b{suffix}", [], name="ferries")
    assert "ferries" in (tmp_path / f"b{suffix}").read_text()


@pytest.mark.parametrize("suffix", TRACK_SUFFIXES)
def test_whole_or_not_at_all(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    path.write_text("before")

    def tracks():
        yield sample()
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        write_geo_tracks(path, tracks())
    with pytest.raises(DataError, match="is the input"):
        write_geo_tracks(path, [sample()], (path,))
    assert path.read_text() == "before"
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
    write_geo_tracks(path, [sample()])
    assert path.read_text() != "before"


@pytest.mark.parametrize("suffix", TRACK_SUFFIXES)
def test_tracks_are_written_one_by_one(tmp_path, suffix):
    alive = []

    def tracks():
        for k in range(50):
            drafts = list(tmp_path.iterdir())
            alive.append(drafts[0].stat().st_size)
            yield sample(id=str(k))

    write_geo_tracks(tmp_path / f"a{suffix}", tracks())
    # The file grows while tracks are still to come.
    assert alive[-1] > 8192
