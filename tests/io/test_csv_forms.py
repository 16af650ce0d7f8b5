"""CSV as programs and people write it: any form gives the same table."""

import gzip
import io
import math
import sys

import numpy as np
import pytest
from data_files import written
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack import DataError
from fuzzytrack.io import csv_blocks, read_tracks
from fuzzytrack.io.formats import open_table
from fuzzytrack.io.text_form import MISSING, TextForm

KINDS = {"time": "time", "x": "gaps", "y": "gaps"}
PLAIN = "time,x,y\n0,10.0,5.0\n1,12.5,\n2,15.25,7.0\n"
X, Y, ROWS = [10, 12.5, 15.25], [5, math.nan, 7], [2, 3, 4]


def read(path, form=None, kinds=KINDS, rows=None):
    """Tables of a file, and what its source says at the end."""
    with open_table(str(path), form) as source:
        return list(source.tables(kinds, rows)), source


def checked(path, form=None, rows=ROWS):
    (table,), source = read(path, form)
    np.testing.assert_array_equal(table.numbers["x"], X)
    np.testing.assert_array_equal(table.numbers["y"], Y)
    assert list(map(float, table.cells["time"])) == [0, 1, 2]
    assert table.rows.tolist() == rows
    return source


FORMS = {
    "semicolons": ("time;x;y\n0,0;10,0;5,0\n1,0;12,5;\n2,0;15,25;7,0\n", ROWS),
    "semicolons and points": (PLAIN.replace(",", ";"), ROWS),
    "tabs": (PLAIN.replace(",", "\t"), ROWS),
    "bars": (PLAIN.replace(",", "|"), ROWS),
    "blanks": (" time  x y\n0   10.0 5.0\n 1 12.5 nan \n2 15.25  7.0\n", ROWS),
    "quoted decimal commas": ('time,x,y\n"0,0","10,0","5,0"\n1,"12,5",\n2,"15,25",7\n', ROWS),
    "quotes, return": (PLAIN.replace("time", '"time"').replace("\n", "\r\n"), ROWS),
    "only returns": (PLAIN.replace("\n", "\r"), ROWS),
    "blank after a comma": ('time, x, "y"\n0, 10.0, "5.0"\n1, 12.5, ""\n2, "15.25", 7\n', ROWS),
    "byte order mark": ("\ufeff" + PLAIN, ROWS),
    "utf-16": (PLAIN.encode("utf-16"), ROWS),
    "utf-16 with its end first": (b"\xfe\xff" + PLAIN.encode("utf-16-be"), ROWS),
    "utf-32": (PLAIN.encode("utf-32"), ROWS),
    "gzip": (gzip.compress(PLAIN.encode()), ROWS),
    "comments": ("# logger\n" + PLAIN.replace("\n1", "\n  # \"a, b\n1") + "#end", [3, 5, 6]),
    "units": (PLAIN.replace("\n0", "\n[s],[m],[m]\n0"), [3, 4, 5]),
    "bare units": (PLAIN.replace("\n0", "\nsec,m,-\n0"), [3, 4, 5]),
    "blank rows": ("\n" + PLAIN.replace("\n2", "\n  \n,,\n\n2") + " , ,\n", [3, 4, 8]),
    "a comma at the end": (PLAIN.replace("\n", ",\n"), ROWS),
    "a comma at the end of rows": (PLAIN.replace("\n", ",,\n").replace("y,,", "y"), ROWS),
    "names again": (PLAIN.replace("\n2", "\ntime,x,y\n2"), [2, 3, 5]),
    "files put together": (
        PLAIN.replace("\n2", "\n\ufefftime,x,y\ns,m,m\n2").replace("\n0", "\ns,m,m\n0"),
        [3, 4, 7],
    ),
    "separator named": ("sep=;\n" + PLAIN.replace(",", ";"), [3, 4, 5]),
}  # fmt: skip


@pytest.mark.parametrize(("text", "rows"), FORMS.values(), ids=FORMS)
def test_any_form_gives_the_same_table(tmp_path, text, rows):
    checked(written(tmp_path, text), rows=rows)


def test_zstandard(tmp_path, monkeypatch):
    zstandard = pytest.importorskip("zstandard")
    data = zstandard.ZstdCompressor().compress(PLAIN.encode())
    checked(written(tmp_path, data))
    monkeypatch.setitem(sys.modules, "zstandard", None)
    checked(written(tmp_path, data))
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(DataError, match=r"f.csv: Zstandard needs a package .*fuzzytrack\[zst\]"):
        read(tmp_path / "f.csv")


@pytest.mark.parametrize("cut", [12, 40])
def test_compressed_files_that_are_broken(tmp_path, cut):
    data = gzip.compress(PLAIN.encode())
    for broken in (data[:cut], data[:cut] + b"\xff\xff\xff" + data[cut + 3 :]):
        with pytest.raises(DataError, match=r"f.csv: cannot be decompressed: "):
            read(written(tmp_path, broken))


def test_what_is_left_out_is_counted(tmp_path):
    text = "#a\n#b\n" + PLAIN + "time,x,y\n,,\n#c\n"
    _, source = read(written(tmp_path, text))
    file = source.file
    assert source.notes == [
        f"{file}: 3 comment lines left out",
        f"{file}: 1 repeated row of names left out",
        f"{file}: 1 blank row left out",
    ]
    assert read(written(tmp_path, PLAIN))[1].notes == []


def test_units_that_are_repeated_below_the_names_are_counted(tmp_path):
    head, *rows = PLAIN.splitlines()
    (table,), source = read(written(tmp_path, "\n".join([head, "s,m,m", *rows] * 3) + "\n"))
    assert table.numbers["x"].tolist() == 3 * X
    assert source.notes == [
        f"{source.file}: 2 repeated rows of names left out",
        f"{source.file}: 2 repeated rows of units left out",
    ]


def test_a_row_of_units_may_name_the_zone_of_dates(tmp_path):
    path = written(tmp_path, "Time;Target;Rng;Brg\nUTC;;NM;rad\n2024-05-01 09:00:00;T1;2,5;1,5\n")
    recording = read_tracks(str(path), polar=("Rng", "Brg"), id="Target")
    assert recording.columns.units == (("Rng", "nmi"), ("Brg", "rad"))
    place = 2.5 * 1852 * np.array([np.sin(1.5), np.cos(1.5)])
    np.testing.assert_allclose(recording.tracks[0].plots, [place])


def test_units_are_given_as_they_are_usually_written(tmp_path):
    _, source = read(written(tmp_path, "time,x,y\n[msec],(Meters),-\n0,1,2\n"))
    assert source.units == {"time": "ms", "x": "m", "y": "-"}


def test_a_file_without_names(tmp_path):
    path = written(tmp_path, "0,1,2\n1,3,4\n")
    with pytest.raises(DataError, match=r"row 1: holds numbers; .*\(`columns` gives them names\)"):
        read(path)
    (table,), _ = read(path, TextForm(columns=("time", "x", "y")))
    assert table.numbers["x"].tolist() == [1, 3]
    assert table.rows.tolist() == [1, 2]
    with pytest.raises(DataError, match="row 1: 3 cells between commas, but `columns` names 2"):
        read(path, TextForm(columns=("time", "x")))
    for text in ("0;1.5\n", "2024-01-01T00:00:00,1,2\n", "12:00:01;NaN;2\n"):
        with pytest.raises(DataError, match="row 1: holds numbers"):
            read(written(tmp_path, text))


UNSURE = {
    "decimal commas, no quotes": (
        "time,x,y\n0,0,10,0,5,0\n",
        r"row 2: 6 cells; expected 3, as in the header; if numbers have decimal commas, quotes",
    ),
    "thousands": ('time,x,y\n0,"1,000.5",1\n', r"row 2, column x: '1,000.5'; .*thousands must"),
    "thousands or decimals": (
        "time;x;y\n0;1,000;1\n",
        r"row 2, column x: '1,000'; .*`decimal` says that numbers have decimal commas",
    ),
    "both marks": ("time;x;y\n0;1,5;1\n1;1.5;1\n", r"column x: '1,5'; .*`decimal`"),
    "points among commas": (
        "time;x;y\n" + "0;1,5;1\n" * 99 + "1;1.5;1\n",
        r"row 101, column x: '1.5'; .*numbers of this file have decimal commas",
    ),
    "two delimiters": ("time,x;y\n1,2;3\n", r"row 1: commas and semicolons are there; `delimiter`"),
    "bytes of another encoding": (
        "time,x,y\n0,1,2\n".encode("utf-16-le"),
        r"row 1: is not UTF-8, and UTF-16 only with a byte order mark",
    ),
    "half a character": (PLAIN.encode("utf-16")[:-1], r"is not UTF-16"),
    "a row as long as the beginning": ("a" * 300_000 + ",b\n1,2\n", "row 1: is longer than"),
    "too few cells": ("time,x,y\n0,1\n", r"row 2: 2 cells; expected 3, as in the header$"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "message"), UNSURE.values(), ids=UNSURE)
def test_what_can_be_read_in_two_ways_is_an_error(tmp_path, text, message):
    with pytest.raises(DataError, match=message):
        read(written(tmp_path, text))


def test_a_form_that_is_given_is_used(tmp_path):
    text = "time,x;y\n1,2;3\n"
    with open_table(str(written(tmp_path, text)), TextForm(delimiter=";")) as source:
        assert tuple(source.types) == ("time,x", "y")
    path = written(tmp_path, "time;x;y\n0;1,000;1\n")
    (table,), _ = read(path, TextForm(decimal=","))
    assert table.numbers["x"].tolist() == [1]
    path = written(tmp_path, "time,x,y\n%no\n#1,2,3\n")
    (table,), source = read(path, TextForm(comment="%"))
    assert table.cells["time"] == ["#1"]
    path = written(tmp_path, "time,x,y\n#N/A,1,2\n")
    (table,), source = read(path)
    assert table.cells["time"] == ["#N/A"]
    assert source.notes == []


@pytest.mark.parametrize("token", sorted(MISSING))
def test_tokens_for_no_number(tmp_path, token):
    path = written(tmp_path, f"time,y,x\n0,1,{token.upper()}\n1,2,{token}\n2,3,4\n")
    (table,), _ = read(path)
    np.testing.assert_array_equal(table.numbers["x"], [math.nan, math.nan, 4])


def test_the_first_row_with_an_error_is_named(tmp_path):
    with pytest.raises(DataError, match="row 3, column y: 'q'"):
        read(written(tmp_path, "time,x,y\n0,1,2\n1,2,q\n2,q,1\n3,1\n"))
    with pytest.raises(DataError, match="row 2, column x: 'q'"):
        read(written(tmp_path, 'time,x,y\n0,q,2\n1,2,"3"4\n'))


def test_standard_input_is_read_once_and_can_be_opened_again(monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(PLAIN.encode())))
    for _ in range(3):
        source = checked("-")
        assert source.file == "standard input"
    monkeypatch.setattr(sys, "stdin", None)
    with pytest.raises(DataError, match="-: there is no standard input"):
        read("-")


# -------------------------------------------------------------------- any table in any form

numbers = st.floats(allow_nan=False, allow_infinity=False, width=64)
cells = st.one_of(st.none(), numbers)
tables = st.lists(st.tuples(st.integers(0, 10**9), cells, cells), min_size=1, max_size=20)


@st.composite
def forms(draw):
    delimiter = draw(st.sampled_from([",", ";", "\t", "|"]))
    return {
        "delimiter": delimiter,
        "decimal": "." if delimiter == "," else draw(st.sampled_from([".", ","])),
        "missing": draw(st.sampled_from(["", "nan", "NULL", "-", "\\N", "n/a", "?"])),
        "quotes": draw(st.booleans()),
        "end": draw(st.sampled_from(["\n", "\r\n", "\r"])),
        "encoding": draw(st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "utf-32"])),
        "gzip": draw(st.booleans()),
        "units": draw(st.booleans()),
        "extra": draw(st.lists(st.sampled_from(["", "# a, b; c", "  ", "names"]), max_size=3)),
    }


def text_of(table, form):
    def cell(value):
        text = form["missing"] if value is None else repr(value).replace(".", form["decimal"])
        return f'"{text}"' if form["quotes"] else text

    def line(values):
        return form["delimiter"].join(values)

    names = line(["time", "x", "y"])
    rows = [line(map(cell, row)) for row in table]
    for k, extra in enumerate(form["extra"]):
        rows.insert((7 * k) % (len(rows) + 1), names if extra == "names" else extra)
    head = [names, line(["[s]", "[m]", "m"])] if form["units"] else [names]
    data = form["end"].join([*head, *rows, ""]).encode(form["encoding"])
    return gzip.compress(data) if form["gzip"] else data


@given(tables, forms())
def test_a_table_in_any_form_is_read_as_it_was(tmp_path_factory, table, form):
    path = tmp_path_factory.getbasetemp() / "any.csv"
    path.write_bytes(text_of(table, form))
    known = TextForm(delimiter=form["delimiter"], decimal=form["decimal"])
    found, _ = read(path, known)
    expected = [[math.nan if cell is None else cell for cell in row[1:]] for row in table]
    (read_back,) = found
    np.testing.assert_array_equal(
        np.stack([read_back.numbers["x"], read_back.numbers["y"]], axis=1), expected
    )
    assert list(map(int, read_back.cells["time"])) == [row[0] for row in table]
    # What is recognized is right, or refused.
    try:
        found, source = read(path)
    except DataError:
        return
    assert source.form.delimiter == form["delimiter"]
    np.testing.assert_array_equal(found[0].numbers["x"], read_back.numbers["x"])
    np.testing.assert_array_equal(found[0].numbers["y"], read_back.numbers["y"])


@given(tables, st.sampled_from([",", ";", "\t", "|"]))
def test_a_table_without_names_is_read_with_those_given(tmp_path_factory, table, delimiter):
    path = tmp_path_factory.getbasetemp() / "nameless.csv"
    rows = (delimiter.join("nan" if c is None else repr(c) for c in row) for row in table)
    path.write_text("\n".join(rows) + "\n")
    (found,), _ = read(path, TextForm(columns=("time", "x", "y"), delimiter=delimiter))
    expected = [[math.nan if cell is None else cell for cell in row[1:]] for row in table]
    np.testing.assert_array_equal(
        np.stack([found.numbers["x"], found.numbers["y"]], axis=1), expected
    )
    assert found.rows.tolist() == list(range(1, len(table) + 1))
    with pytest.raises(DataError, match="row 1: holds numbers"):
        read(path)


# -------------------------------------------------------------------- large files

ODD = (
    *("1", "2.5", "-3e5", "", "nan", "NULL", " 4 ", "+5", "1e400", "inf", "nan(1)", "1_0", "q"),
    *('"6"', '"7', 'a"b', '""', '" "', '"1""2"', '"a\nb"', "١", "#", "#N/A", "\ufeff", "1,2", "é"),
    *("\0", "\r", "0x1", "1e-400", "infinity", "-", ".", "1.", ".5", "1d5", "-0", "0" * 30 + "1"),
)
odd = st.sampled_from(ODD)
plain = st.sampled_from(["1", "2.5", "-3e5", "nan", "", "0.1"])
lines_ = st.one_of(
    st.tuples(st.sampled_from(["1", "2"]), st.sampled_from(["a", "b"]), plain),
    st.tuples(st.sampled_from(["1", "2"]), st.sampled_from(["a", "b"]), plain),
    st.tuples(odd, odd, odd),
    st.sampled_from([(), ("#c",), ("",), ("t", "id", "x"), ("1", "a"), ("1", "a", "2", "")]),
)


def outcome(path, rows, kinds):
    tables, message = [], ""
    try:
        with open_table(str(path)) as source:
            for table in source.tables(kinds, rows):
                tables.append(
                    (
                        table.rows.tolist(),
                        {name: values.tobytes() for name, values in table.numbers.items()},
                        {name: list(words) for name, words in table.words.items()},
                        {name: list(found) for name, found in table.cells.items()},
                        {name: words.names for name, words in table.words.items()},
                    )
                )
            notes = sorted(source.notes)
    except DataError as error:
        message, notes = str(error), []
    return tables, message, notes


@pytest.mark.parametrize(
    "kinds",
    [
        {"t": "number", "id": "word", "x": "gaps"},
        {"t": "time", "x": "gaps", "id": "text"},
        {"x": "gaps"},
        {"id": "word"},
    ],
    ids=str,
)
@given(
    rows=st.lists(lines_, max_size=30),
    end=st.sampled_from(["\n", "\r\n"]),
    size=st.sampled_from([16, 40, 100, 1000]),
    limit=st.sampled_from([None, 1, 4]),
)
def test_large_files_are_read_as_small_ones(tmp_path_factory, kinds, rows, end, size, limit):
    pytest.importorskip("pyarrow")
    path = tmp_path_factory.getbasetemp() / "large.csv"
    text = end.join(["t,id,x", *(",".join(row) for row in rows), ""])
    path.write_bytes(text.encode())
    small = outcome(path, limit, kinds)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(csv_blocks, "LARGE", 0)
        patch.setattr(csv_blocks, "BLOCK", size)
        assert outcome(path, limit, kinds) == small


def test_large_files_without_the_parser(tmp_path, monkeypatch):
    monkeypatch.setattr(csv_blocks, "LARGE", 0)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    checked(written(tmp_path, PLAIN))


def test_usual_blocks_are_parsed_at_once(tmp_path, monkeypatch):
    pytest.importorskip("pyarrow")
    monkeypatch.setattr(csv_blocks, "LARGE", 0)
    monkeypatch.setattr(csv_blocks, "_by_lines", None)
    for data in (PLAIN, "\ufeff" + PLAIN, gzip.compress(PLAIN.encode()), FORMS["semicolons"][0]):
        checked(written(tmp_path, data))


def test_a_file_that_was_cut_short_is_no_shorter_recording(tmp_path):
    zstandard = pytest.importorskip("zstandard")
    plots = "t,x\n" + "".join(f"{k},{k * k % 97 + k / 7}\n" for k in range(100_000))
    packed = zstandard.compress(plots.encode())
    path = tmp_path / "f.csv.zst"
    # Frames one after the other are one file.
    path.write_bytes(packed + zstandard.compress(b"100000,1\n"))
    assert len(read_tracks(path).tracks[0].time) == 100_001
    for kept in (len(packed) // 2, len(packed) - 1):
        path.write_bytes(packed[:kept])
        with pytest.raises(DataError, match="cannot be decompressed: the file ends before"):
            read_tracks(path)
