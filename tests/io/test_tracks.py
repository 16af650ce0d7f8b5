import math
import sys

import numpy as np
import pytest

from fuzzytrack import AlphaBetaTracker, DataError, FixedGains
from fuzzytrack.io import check_output, csv, read_table, read_tracks, write_table
from fuzzytrack.recordings import write_tracks


def written(tmp_path, text, name="f.csv"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_guessed_columns_gaps_and_one_track(tmp_path):
    path = written(tmp_path, "\ufeffid,time, y_m ,x_m,note\na,0,2,1,é\nb,1,,nan,\n\nc,2,NA,3,x\n")
    recording = read_tracks(path)
    assert (recording.time, recording.id, recording.axes) == ("time", "", ("x_m", "y_m"))
    (track,) = recording.tracks
    assert track.id == ""
    np.testing.assert_array_equal(track.time, [0, 1, 2])
    np.testing.assert_array_equal(track.plots, [[1, 2], [math.nan, math.nan], [3, math.nan]])


def test_ids_are_text_in_order_of_first_appearance(tmp_path):
    path = written(tmp_path, "t,id,x\n5,007,1\n0,7,2\n6,007,3\n1,7,4\n")
    recording = read_tracks(path, id="id", axes=["x"])
    assert [t.id for t in recording.tracks] == ["007", "7"]
    np.testing.assert_array_equal(recording.tracks[1].plots, [[2], [4]])


def test_columns_without_a_name_are_ignored(tmp_path):
    (track,) = read_tracks(written(tmp_path, "t,x,,\n3,4,5,\n4,5,,6\n")).tracks
    np.testing.assert_array_equal(track.plots, [[4], [5]])


def test_one_row_is_a_track(tmp_path):
    (track,) = read_tracks(written(tmp_path, "t,x\n3,4")).tracks
    assert track.plots.shape == (1, 1)


def test_sorting(tmp_path):
    path = written(tmp_path, "t,id,x\n2,b,2\n1,a,1\n1,b,1\n0,a,0\n")
    tracks = read_tracks(path, id="id", sort=True).tracks
    assert [t.id for t in tracks] == ["b", "a"]
    np.testing.assert_array_equal(tracks[0].time, [1, 2])
    np.testing.assert_array_equal(tracks[1].plots[:, 0], [0, 1])


BAD = {
    "text": ("t,x\n0,0\n1,abc\n", r"row 3, column x: 'abc'; expected a finite number, or"),
    "underscore": ("t,x\n0,1_0\n", r"row 2, column x: '1_0'"),
    "other digits": ("t,x\n0,١\n", r"row 2, column x"),
    "infinite": ("t,x\n0,0\n1,-inf\n", r"row 3, column x: '-inf'; expected a finite"),
    "overflow": ("t,x\n0,1e999\n", r"row 2, column x: '1e999'"),
    "time empty": ("t,x\n,0\n", r"row 2, column t: an empty cell; expected a finite number$"),
    "time nan": ("t,x\nnan,0\n", r"row 2, column t: 'nan'"),
    "time clock": ("t,x\n12:30,0\n", r"row 2, column t: '12:30'"),
    "long": (f"t,x\n0,{'q' * 99}\n", r"'q{40}…'"),
    "earlier": (
        "t,x\n0,0\n2,0\n1,0\n",
        r"row 4, column t: time 1 is earlier than 2 in row 3.*sort",
    ),
    "repeated": ("t,x\n0,0\n0,1\n", r"row 3, column t: time 0 repeats that of row 2.*`id`"),
    "empty": ("", r"f.csv: is empty"),
    "blank": ("\n\n", r"f.csv: is empty"),
    "header only": ("t,x\n\n", r"f.csv: holds no rows"),
    "ragged": ("t,x\n0,0\n\n1\n", r"row 4: 1 cell; expected 2"),
    "doubled": ("t,x,x\n0,0,0\n", r"row 1: two columns are called 'x'"),
    "no header": ("0,0\n1,1\n", r"row 1: holds numbers"),
    "semicolons": ("t;x\n0;0\n", r"separated by semicolons; expected commas"),
    "tabs": ("t\tx\n0\t0\n", r"separated by tabs"),
    "not utf-8": (b"t,x\n0,0\n1,\xff\n", r"row 3: byte 0xff is not UTF-8"),
    "quote": ('t,x\n0,"0\n', r"row 2: not CSV"),
    "no time": ("a,x\n0,0\n", r"no column t, t_s, time or time_s.*`time`; there are a, x"),
    "no axes": ("t,a\n0,0\n", r"no columns x, y.*`axes`; there are t, a"),
}


@pytest.mark.parametrize(("text", "message"), BAD.values(), ids=BAD)
def test_bad_files(tmp_path, text, message):
    with pytest.raises(DataError, match=message):
        read_tracks(written(tmp_path, text))


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"time": "tt"}, "`time`: no column 'tt'; did you mean 't'"),
        ({"axes": ["x", "q"]}, "`axes`: no column 'q'; allowed: t, id, x"),
        ({"axes": []}, "`axes`: needs at least one"),
        ({"id": "ID"}, "`id`: no column 'ID'; did you mean 'id'"),
        ({"axes": ["x", "x"]}, "column 'x' cannot serve twice"),
        ({"id": "id"}, "row 3, column id: an empty cell; expected some text"),
    ],
)
def test_bad_columns(tmp_path, columns, message):
    with pytest.raises(DataError, match=message):
        read_tracks(written(tmp_path, "t,id,x\n0,a,0\n1,,0\n"), **columns)


def test_times_are_judged_within_an_id_and_the_first_wrong_row_is_named(tmp_path):
    path = written(tmp_path, "t,id,x\n0,a,0\n0,b,0\n1,b,0\n0,b,0\n0,a,1\n")
    with pytest.raises(DataError, match=r"row 5, column t: time 0 \(id 'b'\) is earlier.*row 4"):
        read_tracks(path, id="id")
    with pytest.raises(DataError, match=r"row 6, column t: time 0 \(id 'a'\) repeats.*row 2;"):
        read_tracks(written(tmp_path, "t,id,x\n0,a,0\n0,b,0\n1,b,0\n2,b,0\n0,a,1\n"), id="id")
    with pytest.raises(DataError, match="repeats that of row"):
        read_tracks(path, id="id", sort=True)


def test_rows_are_lines_also_after_cells_with_line_breaks(tmp_path):
    with pytest.raises(DataError, match="row 6, column x: 'q'"):
        read_tracks(written(tmp_path, 't,x,note\n0,0,"a\nb"\n\n1,1,c\n2,q,d\n'))


def test_long_files_come_in_pieces(tmp_path, monkeypatch):
    monkeypatch.setattr(csv, "CHUNK", 2)
    shares = []
    path = written(tmp_path, "t,x\n0,0\n1,1\n\n\n2,\n3,3\n")
    (track,) = read_tracks(path, progress=shares.append).tracks
    np.testing.assert_array_equal(track.plots[:, 0], [0, 1, math.nan, 3])
    assert shares
    assert 0 < shares[0] <= shares[-1] <= 1


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


def test_failure_leaves_nothing_behind(tmp_path, monkeypatch):
    path = written(tmp_path, "old", "out.csv")
    monkeypatch.setattr(csv, "CHUNK", 1)

    class Broken(list):
        def __getitem__(self, key):
            if key.start > 0:
                raise OSError(28, "No space left on device")
            return list(self)[key]

    with pytest.raises(OSError, match="No space"):
        write_table(path, {"a": Broken(["x", "y"])})
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["out.csv"]


def test_replacing_keeps_the_mode_and_follows_links(tmp_path):
    path = written(tmp_path, "old", "out.csv")
    path.chmod(0o640)
    (tmp_path / "link.csv").symlink_to(path)
    write_table(tmp_path / "link.csv", {"a": np.array([1.0])})
    assert path.read_text() == "a\n1.0\n"
    assert path.stat().st_mode & 0o777 == 0o640
    assert (tmp_path / "link.csv").is_symlink()


def test_what_cannot_be_written(tmp_path):
    column = {"a": np.array([1.0])}
    with pytest.raises(DataError, match=r"cannot write \.xls"):
        write_table(tmp_path / "a.xls", column)
    with pytest.raises(DataError, match="without suffix"):
        write_table(tmp_path / "a", column)
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        write_table(tmp_path / "no" / "a.csv", column)
    (tmp_path / "d.csv").mkdir()
    with pytest.raises(IsADirectoryError):
        write_table(tmp_path / "d.csv", column)
    with pytest.raises(OSError, match="ordinary file"):
        check_output("/dev/null")


def test_a_folder_that_cannot_be_written_to(tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda path, mode: False)
    with pytest.raises(PermissionError, match="cannot be written to"):
        write_table(tmp_path / "a.csv", {"a": np.array([1.0])})


def test_what_cannot_be_opened(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_tracks(tmp_path / "no.csv")
    with pytest.raises(IsADirectoryError):
        read_tracks(tmp_path)


def parquet(path, **columns):
    pa = pytest.importorskip("pyarrow")
    from pyarrow import parquet as pq

    pq.write_table(pa.table(columns), path)
    return path


def test_parquet(tmp_path):
    path = parquet(tmp_path / "f.parquet", t=[0, 1, 2], id=[7, 7, 7], x=[0.5, None, math.nan])
    (track,) = read_tracks(path, id="id").tracks
    assert track.id == "7"
    np.testing.assert_array_equal(track.plots[:, 0], [0.5, math.nan, math.nan])


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"t": [0, 1], "x": ["1", "q"]}, "row 2, column x: 'q'"),
        ({"t": [0, None], "x": [1, 2]}, "row 2, column t: 'nan'; expected a finite number$"),
        ({"t": [0, 1], "x": [1.0, math.inf]}, "row 2, column x: 'inf'"),
    ],
)
def test_bad_parquet(tmp_path, columns, message):
    with pytest.raises(DataError, match=message):
        read_tracks(parquet(tmp_path / "f.pq", **columns))


def test_what_is_no_parquet(tmp_path):
    pytest.importorskip("pyarrow")
    with pytest.raises(DataError, match="is not a Parquet file"):
        read_tracks(written(tmp_path, "t,x\n0,0\n", "f.parquet"))


def test_parquet_without_pyarrow(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(DataError, match=r"pip install 'fuzzytrack\[parquet\]'"):
        read_tracks(tmp_path / "f.parquet")


def test_words_only_table(tmp_path):
    found = read_table(written(tmp_path, "a,b\nx,1\ny,2\nx,3\n"), lambda names: {"a": "word"})
    assert found.words["a"].names == ("x", "y")
    np.testing.assert_array_equal(found.words["a"].codes, [0, 1, 0])
    np.testing.assert_array_equal(found.rows, [2, 3, 4])
