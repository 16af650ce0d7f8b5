import math

import numpy as np
import pyarrow.parquet as pq
import pytest

from fuzzytrack import AlphaBetaTracker, DataError, FixedGains
from fuzzytrack.io import Columns, Piece, read_tracks
from fuzzytrack.recordings import write_tracks
from fuzzytrack.recordings.track_writer import track_writer

XY = Columns("t", "id", ("x", "y"))


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
        "id,t,x,x_predicted,x_filtered,x_velocity,x_innovation,alpha_x,beta_x\n"
        "b,0.0,0.0,,0.0,0.0,,,\n"
        "b,1.0,8.0,,8.0,8.0,,,\n"
        "b,2.0,20.0,16.0,20.0,10.0,4.0,1.0,0.5\n"
        "b,3.0,,30.0,30.0,10.0,,,\n"
        "a,0.0,5.0,,5.0,0.0,,,\n"
    )


def test_gamma_only_where_it_is_used(tmp_path):
    recording = read_tracks(written(tmp_path, "t,x\n0,0\n1,1\n2,3\n"))
    track_and_write(recording, tmp_path / "a.csv")
    track_and_write(recording, tmp_path / "b.csv", AlphaBetaTracker(FixedGains(0.5, 0.2, 0.1)))
    assert "gamma" not in (tmp_path / "a.csv").read_text()
    assert "beta_x,gamma_x\n" in (tmp_path / "b.csv").read_text()


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
    columns = Columns("x_filtered", "", ("x",))
    with (
        pytest.raises(DataError, match="two columns of the output would be 'x_filtered'"),
        track_writer(tmp_path / "o.csv", columns),
    ):
        pass
