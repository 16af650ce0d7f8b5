import pytest
from data_files import written
from source_rows import read

from fuzzytrack import DataError
from fuzzytrack.io.csv import CsvSource
from fuzzytrack.io.formats import open_table
from fuzzytrack.io.mot import Mot
from fuzzytrack.io.readers import reader_of
from fuzzytrack.io.recording import read_tracks

DETECTIONS = "1,-1,800,240,60,130,0.99,-1,-1,-1\n\n2,-1,816.25,241.5,60,130,0.5,-1,-1,-1\n"
TRUTH = "1,7,10,20,4,6,1,1,0.5\n1,8,90,10,5,5,1,1,1\n2,7,12,20,4,6,1,1,1\n"


def test_the_position_is_the_center_of_the_box(tmp_path):
    columns, description, notes = read(written(tmp_path, DETECTIONS, "det.txt"))
    assert columns["x"] == [830.0, 846.25]
    assert columns["y"] == [305.0, 306.5]
    assert columns["time"] == columns["frame"] == [1.0, 2.0]
    assert columns["confidence"] == [0.99, 0.5]
    assert (description.time, description.id, description.axes) == ("time", "id", ("x", "y"))
    assert "id is -1: no identities; all boxes are taken as one track" in notes


def test_identities_are_whole_numbers(tmp_path):
    columns, description, notes = read(written(tmp_path, TRUTH, "gt.txt"))
    assert columns["id"] == ["7", "8", "7"]
    assert description.id == "id"
    assert not [note for note in notes if "-1" in note]


def test_boxes_without_identities_at_one_time_are_an_error_that_shows_it(tmp_path):
    text = DETECTIONS.replace("\n\n2,", "\n1,")
    with pytest.raises(DataError, match=r"det\.txt: row 2, .*\(id '-1'\) repeats that of row 1"):
        read_tracks(written(tmp_path, text, "det.txt"))


def test_a_rate_makes_seconds(tmp_path):
    columns, _, notes = read(written(tmp_path, TRUTH, "any.csv"), "mot:rate=25")
    assert columns["time"] == [0.04, 0.04, 0.08]
    assert not [note for note in notes if "frames" in note]


@pytest.mark.parametrize(
    ("name", "text", "is_mot"),
    [
        ("det.txt", DETECTIONS, True),
        ("GT.TXT", TRUTH, True),
        ("weight.txt", TRUTH, False),
        ("det.txt", "frame,id,left,top,w,h,conf\n" + TRUTH, False),
        ("det.txt", "1,2,3\n", False),
        ("det.txt", "1,2,3,4,5,6,7,8,9,10,11\n", False),
        ("det.txt", "", False),
    ],
)
def test_which_files_are_recognized(tmp_path, name, text, is_mot):
    assert isinstance(reader_of(str(written(tmp_path, text, name))), Mot) == is_mot


def test_a_file_that_is_not_there_is_not_recognized():
    assert reader_of("nowhere/det.txt") is None


def test_the_format_goes_before_the_name(tmp_path):
    file = str(written(tmp_path, "t,x\n0,1\n", "det.txt"))
    with open_table(file, format="csv") as source:
        assert isinstance(source, CsvSource)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "row 1: expected 7 to 10 numbers"),
        ("a,b\n", "row 1: expected 7 to 10 numbers"),
        (TRUTH + "3,7,12,20,4,6,1,1\n", "row 4: expected 9 numbers separated by commas, as in"),
        (TRUTH + "3,7,12,20,4,6,1,1,nan\n", "row 4: expected 9 numbers"),
        (TRUTH + "3,7,12,2_0,4,6,1,1,1\n", "row 4: expected 9 numbers"),
    ],
)
def test_what_is_no_row_of_the_format_is_an_error_with_its_row(tmp_path, text, message):
    with pytest.raises(DataError, match=rf"f\.csv: {message}"):
        read(written(tmp_path, text), "mot")


@pytest.mark.parametrize("rate", ["0", "-1", "nan", "inf"])
def test_a_rate_that_is_none(rate):
    message = r"format 'mot:rate=.*': rate:? must be (positive|a number)"
    with pytest.raises(ValueError, match=message):
        open_table("det.txt", format=f"mot:rate={rate}")


def test_pieces_are_parts_of_the_whole(tmp_path):
    file = written(tmp_path, TRUTH * 5, "gt.txt")
    assert read(file, rows=4)[0] == read(file)[0]
