import json
import math
from dataclasses import replace
from datetime import datetime

import numpy as np
import pyarrow.parquet as pq
import pytest

from fuzzytrack import AlphaBetaTracker, DataError, FixedGains
from fuzzytrack.io import Piece, read_tracks
from fuzzytrack.io.geodetic import LocalFrame
from fuzzytrack.recordings import write_tracks
from fuzzytrack.recordings.track_table import TrackTable
from fuzzytrack.recordings.track_writer import check_tracks, table_of_tracks, track_writer

XY = TrackTable("t", "id", ("x", "y"))


def written(tmp_path, text):
    path = tmp_path / "f.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


# -------------------------------------------------------------------- whole tracks


def track_and_write(recording, path, tracker=None):
    tracker = tracker or AlphaBetaTracker(FixedGains(0.5, 0.2))
    results = [tracker.run(t.time, t.plots) for t in recording.tracks]
    write_tracks(path, recording, results)
    return results


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_written_tracks_read_back_exactly(tmp_path, suffix):
    source = written(tmp_path, "t,id,x,y\n0,007,0,0.1\n1,007,1,\n2,007,2,2\n3,007,4,5\n0,b,0,1\n")
    recording = read_tracks(source, id="id")
    out = tmp_path / f"out{suffix}"
    results = track_and_write(recording, out)
    for column in ("measured", "predicted", "filtered", "velocity", "innovation"):
        axes = ["x", "y"] if column == "measured" else [f"x_{column}", f"y_{column}"]
        back = read_tracks(out, time="t", id="id", axes=axes)
        assert [t.id for t in back.tracks] == ["007", "b"]
        for track, result in zip(back.tracks, results, strict=True):
            np.testing.assert_array_equal(track.plots, getattr(result, column))
    back = read_tracks(out, time="t", id="id", axes=["alpha_x", "beta_x"])
    np.testing.assert_array_equal(back.tracks[0].plots[2], [0.5, 0.2])


def test_the_table_to_the_letter(tmp_path):
    """By hand, with gains of 1 and 0.5; a cell is empty where there is no number."""
    source = written(tmp_path, "t,id,x\n0,b,0\n1,b,8\n0,a,5\n2,b,20\n3,b,\n")
    tracker = AlphaBetaTracker(FixedGains(1.0, 0.5))
    track_and_write(read_tracks(source, id="id"), tmp_path / "out.csv", tracker)
    assert (tmp_path / "out.csv").read_text() == (
        "id,t,x,x_predicted,x_filtered,x_velocity,x_innovation,alpha_x,beta_x,coasted,since_last\n"
        "b,0,0.0,,0.0,0.0,,,,false,0.0\n"
        "b,1,8.0,,8.0,8.0,,,,false,0.0\n"
        "b,2,20.0,16.0,20.0,10.0,4.0,1.0,0.5,false,0.0\n"
        "b,3,,30.0,30.0,10.0,,,,true,1.0\n"
        "a,0,5.0,,5.0,0.0,,,,false,0.0\n"
    )


def test_gamma_only_where_it_is_used(tmp_path):
    recording = read_tracks(written(tmp_path, "t,x\n0,0\n1,1\n2,3\n"))
    track_and_write(recording, tmp_path / "a.csv")
    track_and_write(recording, tmp_path / "b.csv", AlphaBetaTracker(FixedGains(0.5, 0.2, 0.1)))
    assert "gamma" not in (tmp_path / "a.csv").read_text()
    assert "beta_x,gamma_x," in (tmp_path / "b.csv").read_text()


def test_names_of_the_output_must_differ(tmp_path):
    recording = read_tracks(written(tmp_path, "x_filtered,x\n0,0\n"), time="x_filtered")
    with pytest.raises(DataError, match="two columns of the output would be 'x_filtered'"):
        track_and_write(recording, tmp_path / "a.csv")


def test_the_input_is_never_overwritten(tmp_path):
    path = written(tmp_path, "t,x\n0,0\n")
    recording = read_tracks(path)
    (tmp_path / "link.csv").symlink_to(path)
    for target in (path, tmp_path / "link.csv"):
        with pytest.raises(DataError, match="is the input"):
            track_and_write(recording, target)
    assert path.read_text() == "t,x\n0,0\n"


# -------------------------------------------------------------------- pieces


def outputs(piece):
    names = ("predicted", "filtered", "velocity", "innovation", "alpha", "beta", "gamma")
    return {name: piece.plots + k for k, name in enumerate(names)}


def test_a_piece_is_a_row_group(tmp_path):
    path = tmp_path / "o.parquet"
    first = Piece.of(["a", "b"], [0, 0], [[1.0, 2.0], [3.0, math.nan]])
    second = Piece.of(["b"], [1], [[5.0, 6.0]])
    with track_writer(path, XY) as write:
        for piece in (first, second):
            write(piece, outputs(piece))
    source = pq.ParquetFile(path)
    assert source.num_row_groups == 2
    found = source.read().to_pydict()
    assert list(found)[:9] == [
        "id", "t", "x", "x_predicted", "x_filtered", "x_velocity", "x_innovation", "alpha_x",
        "beta_x",
    ]  # fmt: skip
    assert found["id"] == ["a", "b", "b"]
    assert found["y"] == [2, None, 6]
    assert found["gamma_x"] == [7, 9, 11]


def test_a_table_that_fails_is_not_there(tmp_path):
    def fail(path):
        with track_writer(path, XY) as write:
            piece = Piece.of(["a"], [0], [[1.0, 2.0]])
            write(piece, outputs(piece))
            raise DataError("bad row")

    for name in ("o.parquet", "o.csv"):
        with pytest.raises(DataError, match="bad row"):
            fail(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_columns_of_one_name(tmp_path):
    table = TrackTable("x_filtered", "", ("x",))
    with (
        pytest.raises(DataError, match=r"o.csv: two columns of the output would be 'x_filtered'"),
        track_writer(tmp_path / "o.csv", table),
    ):
        pass


def test_no_piece_at_all(tmp_path):
    with track_writer(tmp_path / "o.csv", TrackTable("t", "", ("x",), gamma=False)):
        pass
    assert (tmp_path / "o.csv").read_text() == (
        "t,x,x_predicted,x_filtered,x_velocity,x_innovation,alpha_x,beta_x,coasted,since_last\n"
    )


# -------------------------------------------------------------------- cells and types


def one_row(**changes):
    piece = replace(Piece.of(["=1+2"], [0], [[1.0, 2.0]]), **changes)
    return piece, outputs(piece) | {"position_variance": np.array([[4.0, 9.0]])}


@pytest.mark.parametrize(
    ("cells", "text", "value"),
    [
        (["2024-05-01 12:00"], "2024-05-01 12:00", "2024-05-01 12:00"),
        (["00.5"], "00.5", 0.5),
        (np.array([7]), "7", 7),
        (
            np.array(["2024-05-01T12:00:00.5"], "datetime64[ns]"),
            "2024-05-01T12:00:00.5Z",
            datetime(2024, 5, 1, 12, 0, 0, 500_000),
        ),
        (None, "0.0", 0.0),
    ],
)
def test_times_are_those_that_were_read(tmp_path, cells, text, value):
    table = replace(XY, deviation=True, segment=True)
    for name in ("o.csv", "o.parquet"):
        with track_writer(tmp_path / name, table) as write:
            write(*one_row(time_cells=cells))
    head, row = (tmp_path / "o.csv").read_text().splitlines()
    found = dict(zip(head.split(","), row.split(","), strict=True))
    assert (found["t"], found["coasted"], found["segment"]) == (text, "false", "0")
    assert (found["x_sd"], found["y_sd"]) == ("2.0", "3.0")
    (row,) = pq.read_table(tmp_path / "o.parquet").to_pylist()
    assert (row["t"], row["coasted"], row["segment"]) == (value, False, 0)


def test_formulas_are_quoted_on_request(tmp_path):
    for quote, id in ((False, "=1+2"), (True, "'=1+2")):
        with track_writer(tmp_path / "o.csv", XY, quote_formulas=quote) as write:
            write(*one_row())
        assert (tmp_path / "o.csv").read_text().splitlines()[1].startswith(f"{id},0.0,")


def test_the_table_as_columns(tmp_path):
    recording = read_tracks(written(tmp_path, "t,x,y\n0,0,0\n1,3,4\n2,6,8\n"))
    tracker = AlphaBetaTracker(FixedGains(0.5, 0.2))
    results = [tracker.run(t.time, t.plots) for t in recording.tracks]
    found = table_of_tracks(recording, results)
    assert list(found)[-4:] == ["speed", "course", "coasted", "since_last"]
    np.testing.assert_allclose(found["speed"], [math.nan, 5, 5])
    assert found["t"].tolist() == [0, 1, 2]


# -------------------------------------------------------------------- on the earth


EARTH = replace(XY, frame=LocalFrame(60.0, 5.0), epoch=1_700_000_000 * 10**9, gamma=False)


@pytest.mark.parametrize("suffix", [".geojson", ".gpx", ".kml", ".czml"])
def test_tracks_on_the_earth_in_pieces(tmp_path, suffix):
    """Two tracks by turns, of which one begins again, in two pieces."""
    path = tmp_path / f"o{suffix}"
    ids = ["a", "b", "a", "b", "a", "a"]
    whole = Piece.of(ids, [0, 0, 1, 1, 9, 10], np.arange(12.0).reshape(6, 2))
    whole = replace(whole, segments=np.array([0, 0, 0, 0, 1, 1]))
    with track_writer(path, EARTH) as write:
        for rows in (np.arange(3), np.arange(3, 6)):
            piece = whole.take(rows)
            write(piece, {**outputs(piece), "filtered": piece.plots})
    text = path.read_text()
    assert text.count("2023-11-14T22:13:") >= 4
    if suffix == ".geojson":
        features = json.loads(text)["features"]
        found = [(f["properties"]["id"], f["properties"]["segment"]) for f in features]
        assert found == [("a", 0), ("a", 1), ("b", 0)]
        assert features[1]["properties"]["times"] == [
            "2023-11-14T22:13:29Z", "2023-11-14T22:13:30Z",
        ]  # fmt: skip
        place = EARTH.frame.to_geodetic(whole.plots[[1, 3]])
        assert features[2]["geometry"]["coordinates"] == np.c_[place.lon, place.lat].tolist()
    with track_writer(path, EARTH):
        pass
    assert "2023-11" not in path.read_text()


def test_tracks_that_are_not_on_the_earth(tmp_path):
    for table, message in (
        (XY, "o.kml: .kml needs positions on the earth"),
        (replace(EARTH, epoch=None), "o.kml: KML needs the date of every plot"),
    ):
        with pytest.raises(DataError, match=message):
            check_tracks(tmp_path / "o.kml", table)
    check_tracks(tmp_path / "o.gpx", replace(EARTH, epoch=None))
    check_tracks(tmp_path / "o.kml", EARTH)
    with pytest.raises(DataError, match=r"cannot write .xls; .csv, .parquet, .geojson"):
        check_tracks(tmp_path / "o.xls", XY)
    assert list(tmp_path.iterdir()) == []
