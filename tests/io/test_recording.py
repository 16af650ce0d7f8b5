import math
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from fuzzytrack import DataError
from fuzzytrack.io.columns import Columns
from fuzzytrack.io.recording import Piece, find_columns, read_pieces, read_tracks, recording_files
from fuzzytrack.io.table import Words
from fuzzytrack.recordings.partition_files import partition_of, read_partition, write_partitions
from fuzzytrack.recordings.track_writer import track_writer

XY = Columns("t", "id", ("x", "y"))


def parquet(path, ids, t, x, y=None, row_group_size=None):
    y = x if y is None else y
    pq.write_table(pa.table({"id": ids, "t": t, "x": x, "y": y}), path, row_group_size)
    return str(path)


def table(pieces):
    """Rows of pieces: number, identity, time, plots."""
    return [
        (int(row), piece.ids.names[code], time, tuple(plot))
        for piece in pieces
        for row, code, time, plot in zip(
            piece.rows, piece.ids.codes, piece.time, piece.plots, strict=True
        )
    ]


@pytest.mark.parametrize("rows", [1, 2, 3, 100])
def test_csv_in_pieces_of_any_size(tmp_path, rows):
    path = tmp_path / "f.csv"
    path.write_text("id,t,x,y\n007,0,1,2\n\nb,0,3,\n007,1,nan,6\nb,1,7,8\n")
    assert find_columns([str(path)], id="id") == XY
    shares = []
    found = list(read_pieces([str(path)], XY, rows=rows, progress=shares.append))
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
    found = list(read_pieces([path], XY, rows=rows))
    assert all(len(piece.time) <= rows for piece in found)
    assert [row[:3] for row in table(found)] == [
        (k + 1, str(id), float(t)) for k, (id, t) in enumerate(zip(ids, times, strict=True))
    ]
    plots = np.concatenate([piece.plots[:, 0] for piece in found])
    np.testing.assert_array_equal(plots, [1, math.nan, math.nan, 4, 5])


@pytest.mark.parametrize(
    "ids",
    [
        pa.array([" a", "b", "a "]),
        pa.array(["a", "b", "a"]).dictionary_encode(),
        pa.array([" a", "b", "a"], type=pa.large_string()),
    ],
)
def test_words_of_any_type(tmp_path, ids):
    path = parquet(tmp_path / "f.parquet", ids, [0, 0, 1], [1.0, 2.0, 3.0])
    (piece,) = read_pieces([path], XY)
    assert piece.ids.names == ("a", "b")
    np.testing.assert_array_equal(piece.ids.codes, [0, 1, 0])


def test_numbers_as_text(tmp_path):
    path = parquet(tmp_path / "f.parquet", ["a", "a"], [0, 1], ["1.5", "na"], [1.0, 2.0])
    (piece,) = read_pieces([path], XY)
    np.testing.assert_array_equal(piece.plots, [[1.5, 1], [math.nan, 2]])


def test_one_track_and_no_rows(tmp_path):
    columns = Columns("t", "", ("x",))
    path = parquet(tmp_path / "f.parquet", ["a", "b"], [0, 1], [1.0, 2.0])
    (piece,) = read_pieces([path], columns)
    assert piece.ids.names == ("",)
    assert piece.plots.shape == (2, 1)
    none = parquet(tmp_path / "g.parquet", pa.array([], pa.string()), [], [])
    assert list(read_pieces([none], XY)) == []


def test_files_of_a_folder(tmp_path):
    for name in ("b.parquet", "a.PQ", "c.csv", ".d.part.parquet"):
        (tmp_path / name).write_text("")
    (tmp_path / "e.parquet").mkdir()
    assert recording_files(tmp_path) == (str(tmp_path / "a.PQ"), str(tmp_path / "b.parquet"))
    assert recording_files("x.csv") == ("x.csv",)
    with pytest.raises(DataError, match="holds no Parquet files"):
        recording_files(tmp_path / "e.parquet")


def test_files_that_do_not_agree(tmp_path):
    first = parquet(tmp_path / "a.parquet", ["a"], [0.0], [1.0])
    other = parquet(tmp_path / "b.parquet", [1], [0.0], [1.0])
    with pytest.raises(DataError, match=r"b.parquet: column id: is int64; expected string, as in"):
        find_columns([first, other], id="id")
    assert find_columns([first, other]) == Columns("t", "", ("x", "y"))
    pq.write_table(pa.table({"id": ["a"], "t": [0.0], "x": [1.0]}), tmp_path / "c.parquet")
    with pytest.raises(DataError, match=r"c.parquet: no column 'y', which .*a.parquet has"):
        find_columns([first, str(tmp_path / "c.parquet")])
    with pytest.raises(DataError, match="column 'x' cannot serve twice"):
        find_columns([first], id="x")


BAD = {
    "infinite": ([1.0, 2.0, math.inf], ["a", "b", "c"], r"row 3, column x: 'inf'"),
    "no id": ([1.0, 2.0, 3.0], ["a", None, "c"], r"row 2, column id: an empty cell"),
    "blank id": ([1.0, 2.0, 3.0], ["a", "b", " "], r"row 3, column id: an empty cell"),
    "word": (["1", "2", "c"], ["a", "b", "c"], r"row 3, column x: 'c'"),
}


@pytest.mark.parametrize(("x", "ids", "message"), BAD.values(), ids=BAD)
@pytest.mark.parametrize("rows", [2, 10])
def test_rows_are_counted_over_pieces(tmp_path, x, ids, message, rows):
    path = parquet(tmp_path / "f.parquet", ids, [0.0, 1.0, 2.0], x, [0.0, 0.0, 0.0])
    with pytest.raises(DataError, match=message):
        list(read_pieces([path], XY, rows=rows))


def test_broken_files(tmp_path):
    bad = tmp_path / "f.parquet"
    bad.write_bytes(b"PAR1 no")
    with pytest.raises(DataError, match="is not a Parquet file"):
        find_columns([str(bad)])
    with pytest.raises(DataError, match="is not a Parquet file"):
        list(read_pieces([str(bad)], XY))


def test_a_broken_page_names_its_file(tmp_path):
    path = Path(parquet(tmp_path / "f.parquet", ["a"] * 3, [0.0, 1.0, 2.0], [0.0] * 3, [0.0] * 3))
    content = bytearray(path.read_bytes())
    pages = len(content) - 8 - int.from_bytes(content[-8:-4], "little")
    content[4:pages] = b"\xff" * (pages - 4)
    path.write_bytes(content)
    with pytest.raises(DataError, match=r"f\.parquet: is not a Parquet file that can be read"):
        list(read_pieces([str(path)], XY))
    with pytest.raises(DataError, match=r"f\.parquet: is not a Parquet file that can be read"):
        read_tracks(path, time="t", axes=["x", "y"])
    csv = tmp_path / "f.csv"
    for content, message in (
        (b"", "is empty"),
        (b"t,\xff\n", "0xff is not UTF-8"),
        (b't,"x"y\n', "not CSV"),
    ):
        csv.write_bytes(content)
        with pytest.raises(DataError, match=message):
            find_columns([str(csv)])
    for content, message in (
        (b"id,t,x,y\na,0,1,\xff\n", "row 2: byte 0xff is not UTF-8"),
        (b'id,t,x,y\na,0,1,"1"2\n', "row 2: not CSV"),
    ):
        csv.write_bytes(content)
        with pytest.raises(DataError, match=message):
            list(read_pieces([str(csv)], XY))
    with pytest.raises(ValueError, match="rows must be at least 1, got 0"):
        list(read_pieces([str(csv)], XY, rows=0))


def test_one_large_row_group_is_not_read_at_once(tmp_path):
    n = 2_000_000
    path = tmp_path / "f.parquet"
    numbers = np.random.default_rng(1).random(n)
    pq.write_table(
        pa.table({"t": np.arange(n), "x": numbers}), path, row_group_size=n, use_dictionary=False
    )
    assert pq.ParquetFile(path).num_row_groups == 1
    before, highest = pa.total_allocated_bytes(), 0
    for piece in read_pieces([str(path)], Columns("t", "", ("x",)), rows=50_000):
        assert len(piece.time) == 50_000
        highest = max(highest, pa.total_allocated_bytes() - before)
    assert highest < 2 * n * 8 / 3


def test_pieces_of_arrays():
    piece = Piece.of([7, 5, 7], [0, 0, 1], [[1.0], [2.0], [3.0]])
    assert piece.ids.names == ("5", "7")
    np.testing.assert_array_equal(piece.ids.codes, [1, 0, 1])
    with pytest.raises(ValueError, match=r"plots: shape must be \(n_rows, n_axes\), got \(1,\)"):
        Piece.of([1], [0], [1.0])
    with pytest.raises(ValueError, match=r"ids: shape \(2,\) does not fit plots of shape \(1, 1\)"):
        Piece.of([1, 2], [0], [[1.0]])


# -------------------------------------------------------------------- writing


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


# -------------------------------------------------------------------- partitions


@pytest.mark.parametrize("rows", [1, 4, 100])
def test_partitions_hold_every_row_once(tmp_path, rows):
    rng = np.random.default_rng(3)
    whole = Piece.of(rng.integers(0, 20, 60), np.arange(60), rng.normal(size=(60, 2)))
    ids = whole.ids
    pieces = [
        Piece(Words(ids.names, ids.codes[cut]), whole.time[cut], whole.plots[cut], whole.rows[cut])
        for cut in (slice(0, 7), slice(7, 8), slice(8, 60))
    ]
    path = tmp_path / "p.parquet"
    write_partitions(path, pieces, 2, 3)
    seen = []
    for partition in range(3):
        found = list(read_partition(path, 2, partition, 3, file="f.parquet", rows=rows))
        assert all(piece.file == "f.parquet" and len(piece.time) for piece in found)
        rows_found = table(found)
        assert rows_found == sorted(rows_found)
        assert {partition_of(row[1], 3) for row in rows_found} <= {partition}
        seen += rows_found
    assert sorted(seen) == table([whole])


def test_partitions_are_the_same_everywhere():
    # The check value of CRC-32, as its specifications have it.
    assert partition_of("123456789", 2**32) == 0xCBF43926
    assert partition_of("é", 16) in range(16)
