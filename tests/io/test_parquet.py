import math
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from data_files import parquet, pieces_of, plot_files, written

from fuzzytrack import DataError
from fuzzytrack.io import read_tracks
from fuzzytrack.io.formats import open_table
from fuzzytrack.io.text_form import TextForm


def test_parquet(tmp_path):
    path = parquet(tmp_path / "f.parquet", [7, 7, 7], [0, 1, 2], [0.5, None, math.nan])
    (track,) = read_tracks(path, id="id").tracks
    assert track.id == "7"
    np.testing.assert_array_equal(track.plots[:, 0], [0.5, math.nan, math.nan])


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"t": [0, 1], "x": ["1", "q"]}, "row 2, column x: 'q'"),
        ({"t": [0, None], "x": [1, 2]}, "row 2, column t: 'nan'; expected a time$"),
        ({"t": [0, 1], "x": [1.0, math.inf]}, "row 2, column x: 'inf'"),
    ],
)
def test_bad_parquet(tmp_path, columns, message):
    path = tmp_path / "f.pq"
    pq.write_table(pa.table(columns), path)
    with pytest.raises(DataError, match=message):
        read_tracks(path)


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
    (piece,) = pieces_of(path, id="id")
    assert piece.ids.names == ("a", "b")
    np.testing.assert_array_equal(piece.ids.codes, [0, 1, 0])


def test_numbers_as_text(tmp_path):
    path = parquet(tmp_path / "f.parquet", ["a", "a"], [0, 1], ["1.5", "na"], [1.0, 2.0])
    (piece,) = pieces_of(path, id="id")
    np.testing.assert_array_equal(piece.plots, [[1.5, 1], [math.nan, 2]])


def test_what_is_no_parquet(tmp_path):
    with pytest.raises(DataError, match="is not a Parquet file"):
        read_tracks(written(tmp_path, "t,x\n0,0\n", "f.parquet"))


def test_broken_files(tmp_path):
    bad = tmp_path / "f.parquet"
    bad.write_bytes(b"PAR1 no")
    with pytest.raises(DataError, match="is not a Parquet file"):
        pieces_of(bad, id="id")


def test_a_broken_page_names_its_file(tmp_path):
    path = Path(parquet(tmp_path / "f.parquet", ["a"] * 3, [0.0, 1.0, 2.0], [0.0] * 3, [0.0] * 3))
    content = bytearray(path.read_bytes())
    pages = len(content) - 8 - int.from_bytes(content[-8:-4], "little")
    content[4:pages] = b"\xff" * (pages - 4)
    path.write_bytes(content)
    with pytest.raises(DataError, match=r"f\.parquet: is not a Parquet file that can be read"):
        pieces_of(path, id="id")
    with pytest.raises(DataError, match=r"f\.parquet: is not a Parquet file that can be read"):
        read_tracks(path, time="t", axes=["x", "y"])


def test_parquet_without_pyarrow(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(DataError, match=r"pip install 'fuzzytrack\[parquet\]'"):
        read_tracks(tmp_path / "f.parquet")


def test_one_large_row_group_is_not_read_at_once(tmp_path):
    n = 2_000_000
    path = tmp_path / "f.parquet"
    numbers = np.random.default_rng(1).random(n)
    pq.write_table(
        pa.table({"t": np.arange(n), "x": numbers}), path, row_group_size=n, use_dictionary=False
    )
    assert pq.ParquetFile(path).num_row_groups == 1
    before, highest = pa.total_allocated_bytes(), 0
    for piece in plot_files(path).pieces(rows=50_000):
        assert len(piece.time) == 50_000
        highest = max(highest, pa.total_allocated_bytes() - before)
    assert highest < 2 * n * 8 / 3


def test_words_of_a_dictionary_that_are_not_used(tmp_path):
    codes = pa.array([2, 0, None, 2], pa.int32())
    ids = pa.DictionaryArray.from_arrays(codes, pa.array(["a", "", "b "]))
    path = parquet(
        tmp_path / "f.parquet", ids.take(pa.array([0, 1, 3])), [0, 0, 1], [1.0, 2.0, 3.0]
    )
    (piece,) = pieces_of(path, id="id")
    assert piece.ids.names == ("b", "a")
    assert list(piece.ids) == ["b", "a", "b"]
    assert [track.id for track in read_tracks(path, id="id").tracks] == ["b", "a"]
    path = parquet(tmp_path / "g.parquet", ids, [0, 0, 1, 1], [1.0, 2.0, 3.0, 4.0])
    # The third row has no identity.
    (piece,) = pieces_of(path, id="id")
    assert list(piece.ids) == ["b", "a", "b"]
    assert piece.rows.tolist() == [1, 2, 4]


def test_empty_and_missing_words_are_one(tmp_path):
    path = parquet(tmp_path / "f.parquet", [" ", "a", None, ""], range(4), [1.0, 2.0, 3.0, 4.0])
    (piece,) = pieces_of(path, id="id")
    assert piece.ids.names == ("a",)
    assert piece.rows.tolist() == [2]


def test_decimals_and_whole_numbers_with_gaps(tmp_path):
    from decimal import Decimal

    x = pa.array([Decimal("1.25"), None, Decimal("-3.00")])
    path = parquet(tmp_path / "f.parquet", ["a"] * 3, [0, 1, 2], x, pa.array([7, 8, None]))
    (track,) = read_tracks(path).tracks
    np.testing.assert_array_equal(track.plots, [[1.25, 7], [math.nan, 8], [-3, math.nan]])


@pytest.mark.parametrize("row_group_size", [1, 2, 100])
def test_a_whole_file_is_one_piece(tmp_path, row_group_size):
    ids = pa.array(["b", "a", "b", "c", "a"])
    path = parquet(tmp_path / "f.parquet", ids, range(5), np.arange(5.0), None, row_group_size)
    (piece,) = pieces_of(path, id="id")
    assert piece.ids.names == ("b", "a", "c")
    assert list(piece.ids) == ids.to_pylist()
    np.testing.assert_array_equal(piece.rows, [1, 2, 3, 4, 5])


def test_times_and_text_keep_the_types_of_the_file(tmp_path):
    stamps = np.array(["2024-01-01T00:00:00.000000001", "2024-01-01"], dtype="datetime64[ns]")
    columns = {
        "whole": pa.array([1, 2]),
        "fraction": pa.array([0.5, 1.5]),
        "stamp": pa.array(stamps),
        "zoned": pa.array(stamps).cast(pa.timestamp("ns", "Europe/Berlin")),
        "day": pa.array(stamps.astype("datetime64[D]")),
        "span": pa.array([1500, 2500], pa.duration("ms")),
        "text": pa.array([" 0:01", "0:02"]),
        "clock": pa.array([1_000, 2_500], pa.time32("ms")),
    }
    pq.write_table(pa.table({**columns, "note": ["a", None]}), tmp_path / "f.pq")
    with open_table(str(tmp_path / "f.pq")) as source:
        (table,) = source.tables({**dict.fromkeys(columns, "time"), "note": "text"}, None)
    cells = table.cells
    assert cells["whole"].dtype == np.int64
    np.testing.assert_array_equal(cells["fraction"], [0.5, 1.5])
    np.testing.assert_array_equal(cells["stamp"], stamps)
    np.testing.assert_array_equal(cells["zoned"], stamps)
    assert cells["day"].dtype.kind == "M"
    np.testing.assert_array_equal(cells["span"], [1.5, 2.5])
    assert cells["text"] == ["0:01", "0:02"]
    assert cells["clock"] == ["00:00:01", "00:00:02.500000"]
    assert cells["note"] == ["a", ""]


@pytest.mark.parametrize(
    "values", [[1, None], [0.5, None], [np.datetime64(1, "s"), None], ["a", ""]]
)
def test_no_time_is_missing(tmp_path, values):
    pq.write_table(pa.table({"t": pa.array(values)}), tmp_path / "f.pq")
    with (
        open_table(str(tmp_path / "f.pq")) as source,
        pytest.raises(DataError, match=r"row 2, column t: .*; expected a time"),
    ):
        list(source.tables({"t": "time"}, None))


def test_names_of_columns_are_those_of_the_file(tmp_path):
    pq.write_table(pa.table({"t": [1]}), tmp_path / "f.pq")
    with (
        pytest.raises(DataError, match="`columns`: a Parquet file has names"),
        open_table(str(tmp_path / "f.pq"), TextForm(columns=("a",))),
    ):
        pass
