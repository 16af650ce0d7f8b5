import math
import os
import threading

import numpy as np
import pytest
from data_files import pieces_of, written

from fuzzytrack import DataError
from fuzzytrack.io import csv, read_tracks
from fuzzytrack.io.formats import open_table
from fuzzytrack.io.text_form import TextForm

BAD = {
    "text": ("t,x\n0,0\n1,abc\n", r"row 3, column x: 'abc'; expected a finite number, or"),
    "underscore": ("t,x\n0,1_0\n", r"row 2, column x: '1_0'"),
    "other digits": ("t,x\n0,١\n", r"row 2, column x"),
    "infinite": ("t,x\n0,0\n1,-inf\n", r"row 3, column x: '-inf'; expected a finite"),
    "overflow": ("t,x\n0,1e999\n", r"row 2, column x: '1e999'"),
    "time empty": ("t,x\n,0\n", r"row 2, column t: an empty cell; expected a time$"),
    "time nan": ("t,x\nnan,0\n", r"row 2, column t: 'nan'"),
    "time clock": ("t,x\n12:30,0\n", r"row 2, column t: '12:30'"),
    "long": (f"t,x\n0,{'q' * 99}\n", r"'q{40}…'"),
    "empty": ("", r"f.csv: is empty"),
    "blank": ("\n\n", r"f.csv: is empty"),
    "blank cells": (",,\n,,\n", r"f.csv: is empty"),
    "header only": ("t,x\n\n", r"f.csv: holds no rows"),
    "ragged": ("t,x\n0,0\n\n1\n", r"row 4: 1 cell; expected 2"),
    "doubled": ("t,x,x\n0,0,0\n", r"row 1: two columns are called 'x'"),
    "no header": ("0,0\n1,1\n", r"row 1: holds numbers"),
    "not utf-8": (b"t,x\n0,0\n1,\xff\n", r"row 3: byte 0xff is not UTF-8"),
    "quote": ('t,x\n0,"0\n', r"row 2: not CSV"),
}


@pytest.mark.parametrize(("text", "message"), BAD.values(), ids=BAD)
def test_bad_files(tmp_path, text, message):
    with pytest.raises(DataError, match=message):
        read_tracks(written(tmp_path, text))


def test_broken_csv(tmp_path):
    csv = tmp_path / "f.csv"
    for content, message in (
        (b"", "is empty"),
        (b"t,\xff\n", "0xff is not UTF-8"),
        (b't,"x"y\n', "not CSV"),
    ):
        csv.write_bytes(content)
        with pytest.raises(DataError, match=message):
            pieces_of(csv)
    for content, message in (
        (b"id,t,x,y\na,0,1,\xff\n", "row 2: byte 0xff is not UTF-8"),
        (b'id,t,x,y\na,0,1,"1"2\n', "row 2: not CSV"),
    ):
        csv.write_bytes(content)
        with pytest.raises(DataError, match=message):
            pieces_of(csv, id="id")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="named pipes")
def test_a_pipe_is_opened_once(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    writing = threading.Thread(target=pipe.write_text, args=("t,x\n0,1\n1,4\n",), daemon=True)
    writing.start()
    (track,) = read_tracks(pipe, progress=lambda share: None).tracks
    writing.join()
    np.testing.assert_array_equal(track.plots, [[1], [4]])


def test_columns_without_a_name_are_ignored(tmp_path):
    (track,) = read_tracks(written(tmp_path, "t,x,,\n3,4,5,\n4,5,,6\n")).tracks
    np.testing.assert_array_equal(track.plots, [[4], [5]])


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


def test_times_and_text_are_kept_as_they_were_read(tmp_path):
    path = written(tmp_path, "t,x,note\n 0:01 ,1,a b\n0:02,2,\n")
    with open_table(str(path)) as source:
        (table,) = source.tables({"t": "time", "note": "text"}, None)
    assert table.cells == {"t": ["0:01", "0:02"], "note": ["a b", ""]}
    path = written(tmp_path, "t,x\n0,1\n ,2\n")
    with (
        open_table(str(path)) as source,
        pytest.raises(DataError, match="row 3, column t: an empty cell; expected a time"),
    ):
        list(source.tables({"t": "time"}, None))


def test_numbers_that_stand_for_none_are_given(tmp_path):
    path = written(tmp_path, "t,x\n0,-99.0\n1,x\n2,null\n3,4\n")
    with open_table(str(path), TextForm(na=("-99", "X"))) as source:
        (table,) = source.tables({"t": "number", "x": "gaps"}, None)
    np.testing.assert_array_equal(table.numbers["x"], [math.nan, math.nan, math.nan, 4])
