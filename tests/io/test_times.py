"""Times of recordings: numbers in any unit, dates and times of day, as seconds."""

import pickle
from datetime import UTC, datetime, time, timedelta, timezone
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack.errors import DataError
from fuzzytrack.io.time_cells import same_time, unit_in_name
from fuzzytrack.io.times import Clock

SCALES = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}


def read(cells, **how):
    """Clock and seconds of a column that is read as a whole."""
    clock = Clock.of(cells, **how)
    return clock, clock.seconds(cells, range(2, 2 + len(cells)), "a.csv", "time")


def seconds(cells, **how):
    return read(cells, **how)[1].tolist()


def fails(cells, message, clock=None):
    clock = clock or Clock.of(cells)
    with pytest.raises(DataError, match=message):
        clock.seconds(cells, range(2, 2 + len(cells)), "a.csv", "time")


# -------------------------------------------------------------------- numbers


@given(st.lists(st.floats(-(2.0**22), 2.0**22, exclude_min=True, exclude_max=True), min_size=1))
def test_small_numbers_of_seconds_are_used_as_they_are(values):
    clock, found = read(list(map(repr, values)))
    assert (clock.form, clock.unit, clock.origin, clock.note) == ("number", "s", 0, "")
    assert np.array_equal(found, values)
    assert np.array_equal(clock.seconds(np.array(values), [], "", ""), values)


WHOLE = st.integers(-(10**6), 10**6)


@given(
    st.sampled_from(list(SCALES)),
    st.integers(4_200_000, 4_000_000_000),
    st.lists(st.integers(-(2**52), 2**52), min_size=1, max_size=9),
    st.integers(0, 9),
)
def test_differences_are_exact_to_a_nanosecond_whatever_the_epoch(unit, epoch, offsets, places):
    scale, step = SCALES[unit], 10 ** (9 - places)
    counts = [epoch * 10**9 + offset // step * step for offset in [0, *offsets]]
    cells = [f"{Decimal(count) / scale:f}" for count in counts]
    found = np.array(seconds(cells, unit=unit))
    # Python rounds a quotient of integers once.
    assert found.tolist() == [(count - counts[0]) / 10**9 for count in counts]


@given(st.lists(st.integers(10**18, 2 * 10**18), min_size=1), st.booleans())
def test_whole_nanoseconds_are_exact_as_text_and_as_integers(counts, mixed):
    exact = [float(count - counts[0]) / 1e9 for count in counts]
    cells = [f"{count}.0" if mixed and k % 2 else str(count) for k, count in enumerate(counts)]
    assert seconds(cells) == exact
    assert seconds(np.array(counts, dtype=np.int64)) == exact
    assert seconds(np.array(counts, dtype=np.uint64)) == exact
    assert seconds(counts) == exact


@given(st.lists(st.integers(10**15, 4 * 10**15), min_size=1))
def test_microseconds_are_exact_in_double_precision(counts):
    values = [count / 10**6 for count in counts]
    exact = [float((count - counts[0]) * 1000) / 1e9 for count in counts]
    assert seconds(np.array(values)) == exact
    assert seconds([repr(value) for value in values]) == exact


def test_doubles_between_microseconds_keep_their_differences():
    values = 1.7e9 + np.arange(50) * 2.0**-22
    exact = [round(Fraction(value) * 10**9) for value in values.tolist()]
    found = np.array(seconds(values))
    # A microsecond's double is taken for that time, which is within half a step of doubles.
    assert np.abs(found - (np.array(exact) - exact[0]) / 1e9).max() <= 2.0**-23 + 1e-9
    assert (np.diff(found) > 0).all()


@pytest.mark.parametrize(
    ("cells", "unit", "note"),
    [
        (["1700000123.5"], "s", ""),
        (["99999999999"], "s", ""),
        (["100000000000"], "ms", "milliseconds"),
        (["1700000123456"], "ms", "numbers such as 1700000123456 are taken as milliseconds"),
        (["-1700000123456"], "ms", "milliseconds"),
        (["1700000123456789"], "us", "microseconds"),
        (["1700000123456789101"], "ns", "nanoseconds"),
        (["0", "1700000123456789101"], "ns", "nanoseconds"),
        (np.array([1.7e12]), "ms", "milliseconds"),
    ],
)
def test_the_unit_is_guessed_from_the_size_and_said(cells, unit, note):
    clock = Clock.of(cells, name="time")
    assert clock.unit == unit
    assert note in clock.note
    assert ("column time" in clock.note) == bool(note)
    assert Clock.of(cells, unit="s").note == Clock.of(cells, name="t_us").note == ""


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("time_ms", "ms"), ("t_us", "us"), ("timestamp_ns", "ns"), ("time [ms]", "ms"),
        ("Time (s)", "s"), ("timeMs", "ms"), ("time.µs", "us"), ("millis", "ms"), ("t_s", "s"),
        ("timestamp [s of day]", "s"), ("TIME_MS", "ms"), ("t (usec)", "us"),
        ("s", None), ("t", None), ("time", None), ("times", None), ("class", None), ("", None),
    ],
)  # fmt: skip
def test_the_unit_in_the_name_of_a_column(name, unit):
    assert unit_in_name(name) == unit


def test_a_unit_that_is_given_comes_before_the_one_of_the_name():
    cells = ["500", "1000"]
    assert seconds(cells) == [500, 1000]
    assert seconds(cells, name="time_ms") == [0.5, 1]
    assert seconds(cells, name="date", unit_of_name="ms") == [0.5, 1]
    assert seconds(cells, name="time_ms", unit="us") == [0.0005, 0.001]
    assert seconds(np.array([500, 1000]), unit="ms") == [0.5, 1]
    with pytest.raises(ValueError, match=r"^time_unit: 'h'; expected one of s, ms, us, ns$"):
        Clock.of(cells, unit="h")
    with pytest.raises(ValueError, match=r"^time_unit: column t holds dates, such as 2020"):
        Clock.of(["2020-01-01"], unit="s", name="t")


@pytest.mark.parametrize("first", ["2020-06-30T00:00:00", "2020-06-30T00:00:00Z", "1700000123",
                                   "1700000123.5", "00:00:00"])  # fmt: skip
def test_a_cell_of_several_lines_is_no_time(first):
    fails([first, f"{first}\n{first}"], "row 3, column time")
    fails([first, f"{first} {first}"], "row 3, column time")


def test_huge_numbers_are_counted_too():
    assert seconds(["1e20", "100000000000000000001"], unit="s") == [0, 1]
    assert seconds(np.array([1e20, 2e20]), unit="s")[1] == pytest.approx(1e20)
    assert seconds(["1e289", "-1e289"], unit="s") == [0, -2e289]
    fails(["9e9", "9e9", "1e291"], r"row 4, column time: '1e291'; expected a number below 1e290")


@pytest.mark.parametrize("first", ["0", "1700000123", "1700000123456"])
@pytest.mark.parametrize(
    ("cell", "message"),
    [
        ("", r"^a\.csv: row 3, column time: an empty cell; expected a finite number$"),
        ("nan", "'nan'; expected a finite number"),
        ("inf", "'inf'; expected a finite number"),
        ("1_0", "'1_0'; expected a finite number, a date and time as 2020-06-30T00:00:01.5Z, or"),
        ("١", "expected a finite number"),
        ("1e999999999", "expected a finite number"),
        ("00:00:01", "'00:00:01'; expected a finite number, as before"),
        ("9" * 50 + "x", "'9{40}…'; expected a finite number"),
    ],
)
def test_what_is_no_number_is_named_with_its_place(first, cell, message):
    fails([first, cell], message)


def test_gaps_in_arrays_are_named_with_their_place():
    for first in (0.0, 1.7e9):
        fails(np.array([first, np.nan]), "row 3, column time: 'nan'; expected a finite number$")
    fails(np.array(["2020-01-01", "NaT"], dtype="M8[s]"), "row 3.*'NaT'; expected a date and time")
    fails(np.array(["2020-01-01"], dtype="M8[s]"), "expected a finite number", Clock())
    fails(np.array([1, 2]), "expected a date and time", Clock.of(["2020-01-01"]))
    fails(np.array([1, 2]), "expected a time of day", Clock.of(["00:00:01"]))
    fails(pd.Series([datetime(2020, 1, 1), None]), "row 3.*NaT")
    fails(np.array(["2020-01-01", None], dtype=object), "row 3, column time: an empty cell")


# -------------------------------------------------------------------- dates

MOMENTS = st.datetimes(datetime(1, 1, 2), datetime(9999, 12, 30))
ZONES = st.integers(-23 * 60, 23 * 60).map(lambda m: timezone(timedelta(minutes=m)))
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def nanoseconds(moment):
    since = moment.replace(tzinfo=moment.tzinfo or UTC) - EPOCH
    return (since.days * 86_400 + since.seconds) * 10**9 + since.microseconds * 1000


@given(st.lists(st.tuples(MOMENTS, st.one_of(st.none(), ZONES)), min_size=1), st.booleans())
def test_dates_count_from_the_first_whatever_their_zones(moments, same_zone):
    zone = moments[0][1]
    stamps = [m.replace(tzinfo=zone if same_zone else own) for m, own in moments]
    exact = [float(nanoseconds(s) - nanoseconds(stamps[0])) / 1e9 for s in stamps]
    assert seconds([s.isoformat() for s in stamps]) == exact
    assert seconds([str(s).replace(".", ",") for s in stamps]) == exact
    assert seconds(stamps) == exact


@given(st.lists(st.datetimes(datetime(1700, 1, 1), datetime(2200, 1, 1)), min_size=1))
def test_dates_of_numpy_and_pandas(moments):
    exact = [float(nanoseconds(m) - nanoseconds(moments[0])) / 1e9 for m in moments]
    assert seconds(np.array(moments, dtype="M8[us]")) == exact
    assert seconds(np.array(moments, dtype="M8[ns]")) == exact
    assert seconds(pd.Series(moments)) == exact
    assert seconds(pd.Series(moments).dt.tz_localize("UTC").dt.tz_convert("Asia/Tokyo")) == exact
    assert seconds([pd.Timestamp(m) for m in moments]) == exact


@given(st.lists(st.integers(0, 10**18), min_size=1), st.sampled_from(["", "Z", "+02:00"]))
def test_dates_are_exact_to_a_nanosecond(counts, zone):
    cells = [f"{np.datetime64(count, 'ns')}{zone}" for count in counts]
    assert seconds(cells) == [float(count - counts[0]) / 1e9 for count in counts]


@pytest.mark.parametrize(
    "cell",
    [
        "2020-06-30T00:00:01", "2020-06-30 00:00:01", "2020-06-30t00:00:01z",
        "2020-06-30T00:00:01.000", "2020-06-30T00:00:01,0", "2020/06/30 00:00:01 UTC",
        "20200630T000001Z", "20200630T000001", "20200630 00:00:01", "2020-06-30T02:00:01+02:00",
        "2020-06-30T02:00:01+0200", "2020-06-30 02:00:01 +02", "2020-06-29T18:30:01-0530",
        " 2020-06-30T00:00:01 ",
    ],
)  # fmt: skip
def test_one_moment_in_many_forms(cell):
    clock, found = read(["2020-06-30T00:00:00", cell])
    assert found.tolist() == [0, 1]
    assert clock.origin == 1_593_475_200 * 10**9
    assert clock.dated
    assert same_time(cell.strip(), "2020-06-30T00:00:01Z")


def test_a_date_without_a_time_is_midnight():
    assert seconds(["2020-06-30", "2020-06-30T00:01", "2020-07-01"]) == [0, 60, 86400]


@pytest.mark.parametrize(
    ("cell", "message"),
    [
        ("2020-06-30T23:59:60", "'2020-06-30T23:59:60'; expected seconds below 60; a leap second"),
        ("2020-02-30T00:00:00", "expected a date and time as 2020-06-30T00:00:01.5Z; day"),
        ("2020-13-01", "month must be in 1..12"),
        ("2020-01-01T24:00:00", "from 00:00:00 to 23:59:59"),
        ("2020-01-01T00:00:00+99:00", "with a zone from"),
        ("now", "expected a date and time"),
        ("NaT", "expected a date and time"),
        ("", "an empty cell; expected a date and time"),
        ("5", "expected a date and time"),
        ("12:00:00", "expected a date and time"),
        ("2020-01", "expected a date and time"),
        ("30.06.2020 00:00:01", "expected a date and time"),
    ],
)
@pytest.mark.parametrize("first", ["2020-06-30", "2020-06-30T00:00:00"])
def test_what_is_no_date_is_named_with_its_place(first, cell, message):
    fails([first, cell], f"row 3, column time: .*{message}")


# -------------------------------------------------------------------- times of day


@given(st.lists(st.times(), min_size=1))
def test_times_of_day_count_from_midnight(moments):
    exact = [
        float(((m.hour * 60 + m.minute) * 60 + m.second) * 10**9 + m.microsecond * 1000) / 1e9
        for m in moments
    ]
    for cells in ([m.isoformat() for m in moments], moments):
        clock, found = read(cells)
        assert (clock.form, clock.period, clock.dated) == ("time of day", 86_400, False)
        assert found.tolist() == exact


def test_times_of_day_in_their_forms():
    assert seconds(["00:00:01.5", "0:00:02,5", "23:59:59.999999999"]) == [1.5, 2.5, 86399.999999999]
    fails(["00:00:01", "24:00:00"], "row 3.*expected a time of day as 23:59:59.5, from 00:00:00")
    fails(["00:00:01", "23:59:60"], "leap second")
    fails(["00:00:01", "12:30"], "expected a time of day")
    fails(["00:00:01", "5"], "expected a time of day")


# -------------------------------------------------------------------- show, and the rest


@settings(max_examples=50)
@given(st.lists(st.integers(0, 2**51), min_size=2))
def test_a_time_is_shown_as_it_was(offsets):
    dates = [f"{np.datetime64(1_593_475_200 * 10**9 + k, 'ns')}Z" for k in offsets]
    clock, found = read(dates)
    assert all(same_time(clock.show(s), d) for s, d in zip(found, dates, strict=True))
    counts = [str(1_700_000_123 * 10**9 + k) for k in offsets]
    clock, found = read(counts)
    exact = [np.datetime64(int(c), "ns") for c in counts]
    assert [np.datetime64(clock.show(s)[:-1], "ns") for s in found] == exact


@pytest.mark.parametrize(
    ("cells", "how", "shown"),
    [
        (["0", "1.5"], {}, ["0", "1.5"]),
        (["0", "1500"], {"unit": "ms"}, ["0", "1500"]),
        (["4294966696", "4294966796.5"], {"unit": "ms"}, ["4294966696", "4294966796.5"]),
        (["9000000", "9000000.25"], {}, ["9000000", "9000000.25"]),
        (["23:59:59", "00:00:00.5"], {}, ["23:59:59", "00:00:00.5"]),
        (["1700000123.5", "1700000124"], {}, ["2023-11-14T22:15:23.5Z", "2023-11-14T22:15:24Z"]),
        (["2020-06-30T02:00:00+02:00"], {}, ["2020-06-30T00:00:00Z"]),
    ],
)
def test_times_as_text(cells, how, shown):
    clock, found = read(cells, **how)
    assert list(map(clock.show, found)) == shown
    if clock.form == "number" or "+" not in cells[0]:
        assert [clock.as_cell(s).rstrip("Z") for s in found] == cells


def test_only_times_since_1970_are_dated():
    assert Clock.of(["1700000123"]).dated
    assert Clock.of(["1700000123456"]).dated
    assert not Clock.of(["4294966696"], unit="ms").dated
    assert not Clock.of(["5"]).dated


def test_other_objects():
    assert seconds([timedelta(seconds=1), timedelta(seconds=3)]) == [1, 3]
    assert seconds(np.array([1500], dtype="m8[ms]")) == [1.5]
    fails(np.array([1500], dtype="m8[ms]"), "expected a finite number", Clock())
    assert seconds([Decimal("1700000123.02"), Decimal("1700000123.04")]) == [0, 0.02]
    assert seconds(np.array(["1.5", "2"])) == [1.5, 2]
    assert seconds(np.array([b"1.5", b"2"])) == [1.5, 2]
    assert seconds(("1.5", "2")) == [1.5, 2]
    assert seconds([time(0, 0, 1)]) == [1]


def test_a_clock_of_nothing_reads_numbers():
    assert Clock.of([]) == Clock.of(["x"]) == Clock.of(np.array([])) == Clock()
    assert Clock().seconds([], [], "", "").shape == (0,)


def test_a_clock_is_a_value():
    clock = Clock.of(["2020-06-30T00:00:01"])
    assert pickle.loads(pickle.dumps(clock)) == clock
    assert len({clock, Clock.of(["2020-06-30T00:00:01"])}) == 1


def test_the_same_time_in_other_digits():
    assert same_time("1.0", "1.00")
    assert same_time("0e99999999999999999999", "0")
    assert not same_time("1.0", "1.0000000000000000001")
    assert same_time("00:00:01", "00:00:01.0")
    assert not same_time("00:00:01", "1")
    assert same_time("x", "x")


MARKS = st.text("0123456789" * 3 + "-+:.,TZzeE_/ \nUTC\t١", max_size=30)


@settings(max_examples=500)
@given(
    st.sampled_from(
        ["0", "1700000123.5", "1700000123456789101", "2020-06-30T00:00:00Z", "1:00:00"]
    ),
    st.lists(st.one_of(MARKS, st.text(max_size=5)), min_size=1, max_size=3),
    st.booleans(),
)
def test_any_text_is_a_time_or_an_error_with_its_place(first, cells, at_first):
    cells = [*cells, first] if at_first else [first, *cells]
    clock = Clock.of(cells)
    try:
        found, message = clock.seconds(cells, range(2, 2 + len(cells)), "a.csv", "time"), ""
    except DataError as error:
        found, message = np.zeros(0), str(error)
    if message:
        assert message.startswith("a.csv: row ")
        return
    assert np.isfinite(found).all()
    # One by one, or all at once: the same.
    each = [clock.seconds([cell], [2], "a.csv", "time")[0] for cell in cells]
    assert each == found.tolist()


@pytest.mark.parametrize("cell", ["1e-99999999999999999999", "0e99999999999999999999", "-0", "+5."])
@pytest.mark.parametrize("first", ["0", "1700000123"])
def test_unusual_spellings_of_numbers(cell, first):
    assert seconds([first, cell], unit="s")[1] == float(cell) - float(first)


def test_dates_in_two_units_are_refused():
    seconds_first = [1_700_000_000 + k for k in range(5)]
    milliseconds = [1000 * (1_700_000_005 + k) for k in range(9)]
    with pytest.raises(ValueError, match=r"column t: 1700000000 and .* different units"):
        Clock.of([*seconds_first, *milliseconds], name="t")
    assert Clock.of([*seconds_first, *milliseconds], name="t", unit="ms").unit == "ms"
    # A counter that begins small is none.
    assert Clock.of([0, *milliseconds], name="t").unit == "ms"
