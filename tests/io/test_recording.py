import math

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from data_files import XY, parquet, pieces_of, plot_files, written
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack import DataError
from fuzzytrack.io import Columns, Piece, read_tracks, recording_files
from fuzzytrack.io.findings import Findings


def table(pieces):
    """Rows of pieces: number, identity, time, plots."""
    return [
        (int(row), piece.ids.names[code], time, tuple(plot))
        for piece in pieces
        for row, code, time, plot in zip(
            piece.rows, piece.ids.codes, piece.time, piece.plots, strict=True
        )
    ]


# -------------------------------------------------------------------- tracks


def test_places_far_from_the_origin_are_remarked(tmp_path):
    """Once, however many pieces there are."""
    far = "t,lat,lon\n0,50,5\n1,50,5.1\n2,50,13\n3,,\n4,50,14\n"
    findings = Findings()
    files = plot_files(written(tmp_path, far), geodetic=("lat", "lon"))
    pieces = list(files.pieces(rows=1, findings=findings))
    assert len(pieces) == 5
    (told,) = (note for note in findings.notes if "km from the origin" in note)
    assert "up to 644 km" in told
    near = Findings()
    files = plot_files(written(tmp_path, far[:25]), geodetic=("lat", "lon"))
    list(files.pieces(findings=near))
    assert not any("km from the origin" in note for note in near.notes)


MARKS = ["", " ", "a", "b", "007"]


@given(st.lists(st.sampled_from(MARKS), min_size=1, max_size=12), st.integers(1, 5))
def test_rows_without_an_identity_are_left_out_and_counted(tmp_path_factory, ids, rows):
    """The same from CSV and Parquet, and in pieces of any size."""
    folder = tmp_path_factory.mktemp("f")
    x = np.arange(len(ids), dtype=float)
    text = "t,id,x\n" + "".join(f"{k},{mark},{k}\n" for k, mark in enumerate(ids))
    cells = [mark if k % 2 else mark.strip() or None for k, mark in enumerate(ids)]
    csv = written(folder, text)
    binary = parquet(folder / "f.parquet", pa.array(cells, pa.string()), x, x)
    kept = [k for k, mark in enumerate(ids) if mark.strip()]
    for path, first in ((csv, 2), (binary, 1)):
        if not kept:
            with pytest.raises(DataError, match="column id: no row has an identity"):
                plot_files(path, id="id")
            continue
        findings = Findings()
        pieces = list(plot_files(path, id="id").pieces(rows=rows, findings=findings))
        assert findings.unnamed == len(ids) - len(kept)
        assert [mark for piece in pieces for mark in piece.ids] == [ids[k] for k in kept]
        assert all("" not in piece.ids.names for piece in pieces)
        assert np.concatenate([piece.plots[:, 0] for piece in pieces]).tolist() == kept
        assert np.concatenate([piece.rows for piece in pieces]).tolist() == [
            k + first for k in kept
        ]
        left = len(ids) - len(kept)
        rows_left = f"{left} row{'s' * (left != 1)} without an identity left out"
        assert (rows_left in findings.sentences()) == (left > 0)
        assert findings.to_json_dict()["faults"]["unnamed"] == left


def test_guessed_columns_gaps_and_one_track(tmp_path):
    path = written(tmp_path, "\ufeffid,time, y_m ,x_m,note\na,0,2,1,é\nb,1,,nan,\n\nc,2,NA,3,x\n")
    recording = read_tracks(path)
    assert recording.columns == Columns("time", "", ("x_m", "y_m"))
    (track,) = recording.tracks
    assert track.id == ""
    np.testing.assert_array_equal(track.time, [0, 1, 2])
    np.testing.assert_array_equal(track.plots, [[1, 2], [math.nan, math.nan], [3, math.nan]])


def test_ids_are_text_in_order_of_first_appearance(tmp_path):
    path = written(tmp_path, "t,id,x\n5,007,1\n0,7,2\n6,007,3\n1,7,4\n")
    recording = read_tracks(path, id="id", axes=["x"])
    assert [t.id for t in recording.tracks] == ["007", "7"]
    np.testing.assert_array_equal(recording.tracks[1].plots, [[2], [4]])


def test_one_row_is_a_track(tmp_path):
    (track,) = read_tracks(written(tmp_path, "t,x\n3,4")).tracks
    assert track.plots.shape == (1, 1)


def test_sorting(tmp_path):
    path = written(tmp_path, "t,id,x\n2,b,2\n1,a,1\n1,b,1\n0,a,0\n")
    tracks = read_tracks(path, id="id", sort=True).tracks
    assert [t.id for t in tracks] == ["b", "a"]
    np.testing.assert_array_equal(tracks[0].time, [1, 2])
    np.testing.assert_array_equal(tracks[1].plots[:, 0], [0, 1])


BAD_TIMES = {
    "earlier": (
        "t,x\n0,0\n2,0\n1,0\n",
        r"row 4, column t: time 1 is earlier than 2 in row 3.*sort",
    ),
    "repeated": ("t,x\n0,0\n0,1\n", r"row 3, column t: time 0 repeats that of row 2.*`id`"),
    "no time": ("a,x\n0,0\n", r"no column t, time or timestamp.*`time`; there are a, x"),
    "no axes": ("t,a\n0,0\n", r"no columns x, y.*`axes`; there are t, a"),
}


@pytest.mark.parametrize(("text", "message"), BAD_TIMES.values(), ids=BAD_TIMES)
def test_bad_times_and_columns(tmp_path, text, message):
    with pytest.raises(DataError, match=message):
        read_tracks(written(tmp_path, text))


def test_times_are_judged_within_an_id_and_the_first_wrong_row_is_named(tmp_path):
    path = written(tmp_path, "t,id,x\n0,a,0\n0,b,0\n1,b,0\n0,b,0\n0,a,1\n")
    with pytest.raises(DataError, match=r"row 5, column t: time 0 \(id 'b'\) is earlier.*row 4"):
        read_tracks(path, id="id")
    with pytest.raises(DataError, match=r"row 6, column t: time 0 \(id 'a'\) repeats.*row 2;"):
        read_tracks(written(tmp_path, "t,id,x\n0,a,0\n0,b,0\n1,b,0\n2,b,0\n0,a,1\n"), id="id")
    with pytest.raises(DataError, match="repeats that of row"):
        read_tracks(path, id="id", sort=True)


def test_what_cannot_be_opened(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_tracks(tmp_path / "no.csv")
    with pytest.raises(DataError, match="holds no"):
        read_tracks(tmp_path)


# -------------------------------------------------------------------- pieces


@pytest.mark.parametrize("rows", [1, 2, 3, 100])
def test_csv_in_pieces_of_any_size(tmp_path, rows):
    path = tmp_path / "f.csv"
    path.write_text("id,t,x,y\n007,0,1,2\n\nb,0,3,\n007,1,nan,6\nb,1,7,8\n")
    assert plot_files(path, id="id").columns == XY
    shares = []
    found = pieces_of(path, id="id", rows=rows, progress=shares.append)
    assert max(len(piece.time) for piece in found) == min(rows, 4)
    assert [row[:3] for row in table(found)] == [
        (2, "007", 0.0), (4, "b", 0.0), (5, "007", 1.0), (6, "b", 1.0),
    ]  # fmt: skip
    plots = np.concatenate([piece.plots for piece in found])
    np.testing.assert_array_equal(plots, [[1, 2], [3, math.nan], [math.nan, 6], [7, 8]])
    assert shares[-1] == 1.0


@pytest.mark.parametrize("rows", [1, 3, 100])
@pytest.mark.parametrize("row_group_size", [1, 2, 100])
def test_parquet_in_pieces_of_any_size(tmp_path, rows, row_group_size):
    ids, x = [7, 8, 7, 8, 9], [1.0, None, math.nan, 4.0, 5.0]
    times = [0, 0, 1, 1, 2]
    path = parquet(tmp_path / "f.parquet", ids, times, x, row_group_size=row_group_size)
    found = pieces_of(path, id="id", rows=rows)
    assert all(len(piece.time) <= rows for piece in found)
    assert [row[:3] for row in table(found)] == [
        (k + 1, str(id), float(t)) for k, (id, t) in enumerate(zip(ids, times, strict=True))
    ]
    plots = np.concatenate([piece.plots[:, 0] for piece in found])
    np.testing.assert_array_equal(plots, [1, math.nan, math.nan, 4, 5])


def test_one_track_and_no_rows(tmp_path):
    path = parquet(tmp_path / "f.parquet", ["a", "b"], [0, 1], [1.0, 2.0])
    (piece,) = pieces_of(path, axes=["x"])
    assert piece.ids.names == ("",)
    assert piece.plots.shape == (2, 1)
    none = parquet(tmp_path / "g.parquet", pa.array([], pa.string()), [], [])
    assert len(pieces_of(path)) == 1
    with pytest.raises(DataError, match=r"g\.parquet: holds no rows, only column names"):
        read_tracks(none)


def test_a_piece_has_a_row_at_least(tmp_path):
    path = parquet(tmp_path / "f.parquet", ["a"], [0.0], [1.0])
    with pytest.raises(ValueError, match="rows must be at least 1, got 0"):
        pieces_of(path, rows=0)


BAD = {
    "infinite": ([1.0, 2.0, math.inf], ["a", "b", "c"], r"row 3, column x: 'inf'"),
    "word": (["1", "2", "c"], ["a", "b", "c"], r"row 3, column x: 'c'"),
}


@pytest.mark.parametrize(("x", "ids", "message"), BAD.values(), ids=BAD)
@pytest.mark.parametrize("rows", [2, 10])
def test_rows_are_counted_over_pieces(tmp_path, x, ids, message, rows):
    path = parquet(tmp_path / "f.parquet", ids, [0.0, 1.0, 2.0], x, [0.0, 0.0, 0.0])
    with pytest.raises(DataError, match=message):
        pieces_of(path, id="id", rows=rows)


def test_pieces_of_arrays():
    piece = Piece.of([7, 5, 7], [0, 0, 1], [[1.0], [2.0], [3.0]])
    assert piece.ids.names == ("5", "7")
    np.testing.assert_array_equal(piece.ids.codes, [1, 0, 1])
    with pytest.raises(ValueError, match=r"plots: shape must be \(n_rows, n_axes\), got \(1,\)"):
        Piece.of([1], [0], [1.0])
    with pytest.raises(ValueError, match=r"ids: shape \(2,\) does not fit plots of shape \(1, 1\)"):
        Piece.of([1, 2], [0], [[1.0]])


# -------------------------------------------------------------------- several files


def test_files_of_a_folder(tmp_path):
    for name in ("b.parquet", "a.PQ", "c.md", ".d.part.parquet"):
        (tmp_path / name).write_text("")
    (tmp_path / "e.parquet").mkdir()
    assert recording_files(tmp_path) == (str(tmp_path / "a.PQ"), str(tmp_path / "b.parquet"))
    assert recording_files("x.csv") == ("x.csv",)
    with pytest.raises(DataError, match="holds no Parquet and no CSV files"):
        recording_files(tmp_path / "e.parquet")
    names = ["d.CSV", "f.csv.gz", "g.tsv"]
    for name in names:
        (tmp_path / "e.parquet" / name).write_text("")
    folder = tmp_path / "e.parquet"
    assert recording_files(folder) == tuple(str(folder / name) for name in names)
    (tmp_path / "h.csv").write_text("")
    with pytest.raises(DataError, match=r"holds a.PQ and h.csv; .* all be Parquet, or all CSV"):
        recording_files(tmp_path)


def test_files_that_do_not_agree(tmp_path):
    first = parquet(tmp_path / "a.parquet", ["a"], [0.0], [1.0])
    other = parquet(tmp_path / "b.parquet", [1], [0.0], [1.0])
    with pytest.raises(DataError, match=r"b.parquet: column id: is int64; expected string, as in"):
        plot_files(first, other, id="id")
    assert plot_files(first, other).columns == Columns("t", "", ("x", "y"))
    pq.write_table(pa.table({"id": ["a"], "t": [0.0], "x": [1.0]}), tmp_path / "c.parquet")
    with pytest.raises(DataError, match=r"c.parquet: no column 'y', which .*a.parquet has"):
        plot_files(first, tmp_path / "c.parquet")
    with pytest.raises(DataError, match="column 'x' cannot serve twice"):
        plot_files(first, id="x")


def test_a_unit_that_is_no_time_is_named(tmp_path):
    path = written(tmp_path, "t,x\n[m],[m]\n0,1\n1,2\n")
    with pytest.raises(
        DataError, match=r"column t: its unit is 'm'; expected one of s, ms, us, ns"
    ):
        read_tracks(path)
    assert len(read_tracks(path, time_unit="s").tracks) == 1
