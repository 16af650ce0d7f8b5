"""Numbers as text: one rule, wherever they are written."""

import math
import re
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import fuzzytrack as ft
from fuzzytrack.cli.options import lags
from fuzzytrack.cli.plot_options import plot_reading
from fuzzytrack.io.recording import read_tracks
from fuzzytrack.numerals import as_number, is_number
from fuzzytrack.trackers.catalog import make_tracker

TIPPER = (Path(__file__).parents[1] / "rulebases" / "tipper.yaml").read_text("utf-8")
GOOD = {"2": 2, "+2": 2, "02.50": 2.5, ".5": 0.5, "3.": 3, "25e-1": 2.5, "1E+1": 10}
# Python's float takes all of them but the last three.
BAD = ["1_0", "٣", "1٣", "nan", "inf", "-Infinity", "1e999", "1,5", "0x10", "2 3"]


@pytest.mark.parametrize(("text", "value"), GOOD.items())
def test_numbers(text, value):
    assert (is_number(text), as_number(text)) == (True, value)
    assert (is_number(f" {text} "), as_number(f" {text} ")) == (True, value)


@pytest.mark.parametrize("text", [*BAD, "", " ", "- 1", ".", "e5", "1e", "--1", "1..2"])
def test_no_numbers(text):
    assert as_number(text) is None
    assert is_number(text) == (text == "1e999")


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_what_python_writes_is_read(value):
    assert as_number(repr(value)) == value


@given(st.text(alphabet="0123456789.eE+-_ inf", max_size=8))
def test_what_is_read_is_what_python_reads(text):
    found = as_number(text)
    if found is not None:
        assert found == float(text)
    elif "_" not in text:
        with suppress(ValueError):
            assert not math.isfinite(float(text))


def in_a_table(text, folder):
    (folder / "a.csv").write_text(f"t;x\n0;1\n1;{text}\n", encoding="utf-8")
    return read_tracks(folder / "a.csv", delimiter=";", decimal=".").tracks[0].plots[1, 0]


def in_a_rule_base(text, folder):
    rules = TIPPER.replace("poor:      {gaussmf: [0, 1.5]}", f"poor: {{gaussmf: [0, '{text}']}}")
    (folder / "a.yaml").write_text(rules, encoding="utf-8")
    service = ft.load_rulebase(folder / "a.yaml").inputs[0]
    return next(one for one in service.sets if one.name == "poor").parameters[1]


def in_a_specification(text, folder):
    return make_tracker(f"kalman-cv:sigma_v={text}").scheduler.sigma_v


def in_an_option(text, folder):
    return plot_reading(max_coast=text).cleaning.max_coast


def in_a_lag(text, folder):
    return lags(text)


PLACES = [
    in_a_table, in_a_rule_base, in_a_specification, in_an_option, in_a_lag
]  # fmt: skip


@pytest.mark.parametrize("place", PLACES)
def test_a_number_is_one_everywhere(place, tmp_path):
    for text, value in GOOD.items():
        assert place(text, tmp_path) == value
    assert place(" 25e-1 ", tmp_path) == 2.5


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("text", BAD)
def test_what_is_none_is_none_anywhere(place, text, tmp_path):
    if (place, text) in ((in_a_table, "nan"), (in_a_specification, "inf")):
        pytest.skip("a word there: no plot, no limit")
    with pytest.raises(
        ValueError, match=f"(number|seconds).*{re.escape(text)}|{re.escape(text)}.*number"
    ):
        place(text, tmp_path)
