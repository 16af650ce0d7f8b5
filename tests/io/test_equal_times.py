"""Copies of rows, and plots of a track at equal times."""

import math
from dataclasses import replace

import numpy as np
import pytest
from dirty_rows import NAN, cleaned, lines, piece, plots
from hypothesis import given
from hypothesis import strategies as st

from fuzzytrack.errors import DataError
from fuzzytrack.io.cleaning import Cleaner
from fuzzytrack.io.cleaning_rules import Cleaning, CleaningCounts
from fuzzytrack.io.recording import read_tracks

# -------------------------------------------------------------------- copies and equal times


def test_exact_copies_of_a_row_are_dropped():
    rows = piece([0, 1, 1, 2, 0, 2], [0, 10, 10, 20, 5, 20], ["a", "a", "a", "a", "b", "a"])
    out, counts = cleaned(rows)
    assert lines(out) == [2, 3, 5, 6]
    assert counts == CleaningCounts(copies=2)
    assert counts.sentences() == ("2 exact copies of rows dropped",)
    missed, counts = cleaned(piece([0, 0, 0], [[NAN, 1], [NAN, 1], [NAN, 1]]))
    assert lines(missed) == [2]
    assert counts.copies == 2


def test_equal_times_are_an_error_that_names_both_rows_and_the_remedies():
    with pytest.raises(
        DataError,
        match=r"^a\.csv: row 3, column t: time 0 repeats that of row 2; expected times that "
        r"differ, or `duplicates` .*; if these are several tracks, name the .* \(`id`\)$",
    ):
        Cleaner(Cleaning(), column="t").advance(piece([0, 0]))
    with pytest.raises(DataError, match=r"row 4: time 0 \(id 'a'\) repeats that of row 2; ") as got:
        cleaned(piece([0, 0, 0], ids="aba"))
    assert "several tracks" not in str(got.value)
    cleaner = Cleaner(Cleaning(), show=lambda seconds: f"<{seconds:g}>")
    cleaner.advance(piece([7]))
    with pytest.raises(DataError, match=r"b\.csv: row 2: time <7> repeats that of row 2 of a\.csv"):
        cleaner.advance(piece([7], [5], file="b.csv"))


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        (["1e-30", "2e-30"], "in the cell 2e-30 and 1e-30 in row 2 are too close to tell apart"),
        (["1.0", "1.00"], "repeats"),
        (["12:00:00", "12:00:00.0"], "repeats"),
        (np.array([1, 1]), "repeats"),
    ],
)
def test_different_cells_of_equal_times_are_told(cells, message):
    with pytest.raises(DataError, match=message):
        cleaned(piece([5, 5], cells=cells))


EQUAL = piece([0, 1, 1, 1, 1, 2, 2, 2], [0, NAN, 10, 11, 10, 20, 22, NAN])


@pytest.mark.parametrize(
    ("duplicates", "kept", "values"),
    [
        ("first", [2, 4, 7], [0, 10, 20]),
        ("last", [2, 5, 8], [0, 11, 22]),
        ("mean", [2, 3, 7], [0, 10.5, 21]),
    ],
)
def test_plots_of_equal_times_become_one(duplicates, kept, values):
    out, counts = cleaned(EQUAL, duplicates=duplicates)
    assert lines(out) == kept
    assert plots(out) == values
    assert counts == CleaningCounts(copies=1, merged=4)
    assert counts.sentences()[1] == "4 rows merged with others of equal time"


@pytest.mark.parametrize(("unit", "turn"), [("deg", 360.0), ("rad", 2 * math.pi)])
def test_the_mean_of_bare_angles_is_taken_the_shorter_way(unit, turn, tmp_path):
    share = np.array([359, 1, 350, 20, 10, 90]) / 360 * turn
    rows = zip([0, 0, 1, 1, 1, 2], share.tolist(), strict=True)
    (tmp_path / "a.csv").write_text(
        f"t,bearing_{unit}\n" + "".join(f"{time},{angle!r}\n" for time, angle in rows)
    )
    read = read_tracks(tmp_path / "a.csv", angle=f"bearing_{unit}", duplicates="mean")
    found = np.exp(2j * math.pi * read.tracks[0].plots[:, 0] / turn)
    expected = np.exp(2j * math.pi * np.array([0, 20 / 3, 90]) / 360)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_the_mean_is_one_of_each_axis_and_of_sigma():
    rows = piece([0, 0, 0], [[1, NAN], [2, 5], [NAN, NAN]])
    rows = replace(rows, sigma=np.array([[1.0, NAN], [2.0, 4.0], [NAN, NAN]]))
    cleaner = Cleaner(Cleaning(duplicates="mean"))
    assert len(cleaner.advance(rows)) == 0
    out = cleaner.finish()
    assert out.plots.tolist() == [[1.5, 5]]
    assert out.sigma.tolist() == [[1.5, 4]]


# -------------------------------------------------------------------- against a plain account


@given(
    st.lists(st.lists(st.floats(-9, 9), min_size=1, max_size=4), min_size=1, max_size=9),
    st.sampled_from(["first", "last", "mean"]),
)
def test_equal_times_become_one_plot_by_the_rule(groups, duplicates):
    groups = [list(dict.fromkeys(group)) for group in groups]
    time = [float(k) for k, group in enumerate(groups) for _ in group]
    out, counts = cleaned(piece(time, np.concatenate(groups)), duplicates=duplicates)
    rule = {"first": lambda g: g[0], "last": lambda g: g[-1], "mean": np.mean}[duplicates]
    assert plots(out) == pytest.approx([rule(group) for group in groups])
    assert counts == CleaningCounts(merged=sum(map(len, groups)) - len(groups))
