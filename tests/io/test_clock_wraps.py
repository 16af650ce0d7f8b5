"""Clocks that start again, and rows in order of time."""

import numpy as np
import pytest
from dirty_rows import cleaned, joined, piece, plots, times
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack.errors import DataError
from fuzzytrack.io.cleaning import Cleaner
from fuzzytrack.io.cleaning_rules import Cleaning, CleaningCounts


def wrapped(period, step, count=12, before=6):
    """Raw times of a clock that starts again after `before` rows."""
    return np.mod(np.arange(count) * step + period - before * step, period)


@pytest.mark.parametrize(
    ("period", "step"),
    [(86_400, 4.0), (604_800, 10.0), (2**32 / 1e3, 0.1), (2**32 / 1e6, 0.25)],
)
def test_clocks_that_start_again_are_recognized(period, step):
    out, counts = cleaned(piece(wrapped(period, step)))
    assert np.diff(times(out)) == pytest.approx([step] * 11, abs=1e-9)
    assert counts == CleaningCounts(wraps=1, period=period)
    assert counts.sentences() == (f"the clock starts again after {period:.15g} s, 1 time",)


@pytest.mark.parametrize(("rules", "known"), [({"wrap": 60}, None), ({}, 60)])
def test_a_period_that_is_known_needs_no_intervals(rules, known):
    out, counts = cleaned(piece([59.5, 0.5, 40, 1]), known, max_gap=None, **rules)
    assert times(out) == [59.5, 60.5, 100, 121]
    assert counts == CleaningCounts(wraps=2, period=60)


def test_tracks_take_the_turn_of_the_row_before():
    rows = piece([50, 58, 3, 5, 10, 20], ids="aabcab")
    out, counts = cleaned(rows, wrap=60)
    assert [row[::2] for row in out] == [
        ("a", 50, 0), ("a", 58, 0), ("a", 70, 0), ("b", 63, 0), ("b", 80, 0), ("c", 65, 0),
    ]  # fmt: skip
    assert counts.wraps == 1
    # An id that is used again a turn later, at an earlier time.
    out, _ = cleaned(piece([20, 30, 59, 1, 15], ids="abbba"), wrap=60)
    assert [row[2] for row in out if row[0] == "a"] == [20, 75]


@pytest.mark.parametrize(
    ("time", "rules", "message"),
    [
        ([0, 1, 2, 1.5], {}, r"row 5: time 1\.5 is earlier than 2 in row 4; expected increasing "
         r"times; `sort` puts them in order, and `id` names the column that distinguishes tracks$"),
        (wrapped(86_400, 4), {"wrap": None}, r"row 8: time 0 is earlier than 86396 in row 7.*; "
         r"if its clock starts again \(it falls by 86396 s\), `wrap` is its period$"),
        # A recording that was started again is no clock with a period.
        ([*range(500), *range(9)], {}, "row 502: time 0 is earlier than 499 in row 501.*`wrap`"),
        ([86_399, 0], {}, "row 3: time 0 is earlier than 86399 in row 2.*`wrap`"),
        # Out of order about midnight.
        ([86398, 86399, 0, 1, 86399.5, 2], {"wrap": 86_400}, "row 6.*86399.5 is earlier than"),
        ([10, 20, 15], {"wrap": 60}, "row 4: time 15 is earlier than 20 in row 3"),
        ([100, 5], {"wrap": 60}, "is earlier than"),
    ],
)  # fmt: skip
def test_other_times_that_fall_are_an_error(time, rules, message):
    with pytest.raises(DataError, match=message):
        cleaned(piece(time), **rules)


@settings(max_examples=60)
@given(
    st.sampled_from([60.0, 86_400.0]),
    st.lists(st.integers(1, 14), min_size=2, max_size=40),
    st.integers(0, 59),
)
def test_time_of_any_number_of_turns_is_restored(period, steps, start):
    true = start + np.cumsum(steps).astype(float)
    raw = np.mod(true, period)
    out, counts = cleaned(piece(raw), wrap=period, max_gap=None)
    assert np.diff(times(out)).tolist() == np.diff(true).tolist()
    assert counts.wraps == true[-1] // period - true[0] // period


@settings(max_examples=60)
@given(st.permutations(range(12)), st.sampled_from([{}, {"wrap": 86_400}]))
def test_rows_out_of_order_about_midnight_are_sorted(order, rules):
    # Local disorder: each row moves by one or two places.
    places = sorted(range(12), key=lambda k: k + 2.5 * (order[k] % 2))
    rows = piece(wrapped(86_400, 4)).take(np.array(places))
    cleaner = Cleaner(Cleaning(**rules))
    out = cleaner.advance(cleaner.in_order(rows))
    assert plots(joined([out])) == [10.0 * k for k in range(12)]
    assert np.diff(out.time).tolist() == [4] * 11
    assert cleaner.counts == CleaningCounts(wraps=1, period=86_400)


def test_tracks_are_sorted_each_by_itself():
    rows = piece([3, 1, 2, 0, 1], [30, 1, 20, 0, 10], ids="abaaa")
    cleaner = Cleaner(Cleaning())
    out = cleaner.advance(cleaner.in_order(rows))
    assert [out.ids[k] for k in range(5)] == list("aaaab")
    assert out.plots.ravel().tolist() == [0, 10, 20, 30, 1]
    assert cleaner.counts == CleaningCounts()
    assert len(Cleaner(Cleaning(wrap=60)).in_order(piece([]))) == 0
