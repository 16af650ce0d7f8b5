from csv import reader

import numpy as np
import pyarrow.parquet as pq
import pytest
from data_files import written

from fuzzytrack import DataError
from fuzzytrack.io import check_table, csv, read_table, table_writer, write_table


def test_words_only_table(tmp_path):
    found = read_table(written(tmp_path, "a,b\nx,1\ny,2\nx,3\n"), lambda names: {"a": "word"})
    assert found.words["a"].names == ("x", "y")
    np.testing.assert_array_equal(found.words["a"].codes, [0, 1, 0])
    np.testing.assert_array_equal(found.rows, [2, 3, 4])


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


def test_a_table_without_rows(tmp_path):
    with pytest.raises(DataError, match=r"f\.csv: holds no rows, only column names"):
        read_table(written(tmp_path, "only\n"), lambda names: {"only": "word"})


@pytest.mark.parametrize("name", ["a.csv", "a.txt", "a.parquet", "a.pq"])
def test_tables_of_any_format(tmp_path, name):
    shares = []
    columns = {"who": ["x", "y", "x"], "n": np.array([1.5, np.nan, -2.0])}
    write_table(tmp_path / name, columns, progress=shares.append)
    assert shares == [1.0]
    found = read_table(
        tmp_path / name, lambda names: dict(zip(names, ("word", "gaps"), strict=True))
    )
    assert list(found.words["who"]) == columns["who"]
    np.testing.assert_array_equal(found.numbers["n"], columns["n"])


def test_a_table_can_be_checked_before_the_work(tmp_path):
    path = written(tmp_path, "t,x\n", "in.csv")
    check_table(tmp_path / "out.pq", (path,))
    with pytest.raises(DataError, match=r"in\.csv: is the input"):
        check_table(path, (path,))
    with pytest.raises(DataError, match=r"cannot write \.json; \.csv or \.parquet"):
        check_table(tmp_path / "a.json")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["in.csv"]


def test_types_of_numbers_are_kept(tmp_path):
    write_table(tmp_path / "a.pq", {"n": np.array([3, 1]), "x": np.array([0.5, 2.0])})
    assert list(map(str, pq.read_schema(tmp_path / "a.pq").types)) == ["int64", "double"]


def test_numbers_that_repeat_are_stored_once_if_the_file_is_to_be_compact(tmp_path):
    columns = {"who": ["x", "y"], "n": np.array([2.0, 2.0])}
    for compact in (False, True):
        types = {"who": "string", "n": "float64"}
        with table_writer(tmp_path / "a.pq", types, compact=compact) as write:
            write(columns)
        found = pq.read_metadata(tmp_path / "a.pq").row_group(0)
        assert [found.column(k).has_dictionary_page for k in (0, 1)] == [True, compact]


def test_formulas_are_quoted_on_request(tmp_path):
    ids = ["=1+1", "+a", "-1", "-cmd", "@x", "\tx", " =x", "a=1", "1e5", ""]
    columns = {"=id": ids, "x": np.arange(10) - 5.0}
    types = {"=id": "string", "x": "float64"}
    for quote_formulas, expected in (
        (False, ids),
        (True, ["'=1+1", "'+a", "-1", "'-cmd", "'@x", "'\tx", "' =x", "a=1", "1e5", ""]),
    ):
        path = tmp_path / f"{quote_formulas}.csv"
        with table_writer(path, types, quote_formulas=quote_formulas) as write:
            write(columns)
        with open(path, newline="") as stream:
            header, *rows = reader(stream)
        assert [row[0] for row in rows] == expected
        assert [float(row[1]) for row in rows] == list(range(-5, 5))
        assert header[0] == ("'=id" if quote_formulas else "=id")
    path = tmp_path / "a.parquet"
    with table_writer(path, types, quote_formulas=True) as write:
        write(columns)
    assert pq.read_table(path)["=id"].to_pylist() == ids
