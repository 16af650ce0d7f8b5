"""Columns in memory as a source of tables."""

from datetime import datetime

import numpy as np
import pytest

from fuzzytrack import DataError
from fuzzytrack.io.data_frame import FrameSource

KINDS = {"t": "time", "id": "word", "x": "gaps"}


def only_table(data, kinds=KINDS, rows=None):
    (table,) = FrameSource.of(data).tables(kinds, rows)
    return table


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_data_frames(library):
    frames = pytest.importorskip(library)
    frame = frames.DataFrame({"t": [0.0, 1.0], "id": ["a", None], "x": [1, 2]})
    table = only_table(frame)
    assert list(table.words["id"]) == ["a", ""]
    assert table.numbers["x"].tolist() == [1.0, 2.0]


def test_a_table_of_arrow():
    arrow = pytest.importorskip("pyarrow")
    table = only_table(arrow.table({"t": [0.0], "id": ["a"], "x": [None]}, schema=arrow.schema(
        [("t", arrow.float64()), ("id", arrow.string()), ("x", arrow.float64())]
    )))  # fmt: skip
    assert np.isnan(table.numbers["x"]).all()


def test_texts_are_read_as_cells_of_a_file():
    table = only_table({"t": ["0", "1"], "id": [7, 8], "x": ["1.5", ""]})
    assert list(table.words["id"]) == ["7", "8"]
    np.testing.assert_equal(table.numbers["x"], [1.5, np.nan])
    with pytest.raises(DataError, match="plots: row 2, column x"):
        only_table({"t": [0, 1], "id": [0, 0], "x": [0.0, "much"]})


def test_datetimes_are_times():
    whole = [datetime(2024, 5, 1, 12), datetime(2024, 5, 1, 13)]
    table = only_table({"t": np.array(whole, dtype="datetime64[us]")}, {"t": "time"})
    assert np.diff(table.cells["t"]).astype("timedelta64[s]").astype(int).tolist() == [3600]


@pytest.mark.parametrize("rows", [1, 2, 3, None])
def test_rows_come_in_pieces(rows):
    shares = []
    source = FrameSource.of((np.arange(5.0), np.arange(5.0)))
    tables = list(source.tables({"t": "time", "x": "gaps"}, rows, shares.append))
    assert np.concatenate([table.rows for table in tables]).tolist() == [1, 2, 3, 4, 5]
    assert np.concatenate([table.numbers["x"] for table in tables]).tolist() == [0, 1, 2, 3, 4]
    assert shares[-1] == 1.0


def test_masked_numbers_are_gaps():
    plots = np.ma.masked_array([1.0, 2.0], mask=[False, True])
    table = only_table(([0.0, 1.0], plots), {"t": "time", "x": "gaps"})
    np.testing.assert_equal(table.numbers["x"], [1.0, np.nan])


def test_no_rows_give_no_tables():
    assert list(FrameSource.of({"t": [], "x": []}).tables({"x": "gaps"}, None)) == []


@pytest.mark.parametrize(
    ("data", "error", "message"),
    [
        ({"t": [0], "x": [1, 2]}, DataError, "column 'x' has 2 rows, column 't' has 1"),
        (([0.0], np.zeros((1, 4))), DataError, "with 1 to 3 axes, got \\(1, 4\\)"),
        (3, TypeError, "plots must be a file.*got int"),
        ((1, 2, 3), TypeError, "got tuple"),
    ],
)
def test_what_is_no_recording(data, error, message):
    with pytest.raises(error, match=message):
        FrameSource.of(data)
