"""Faults of recordings: what is dropped, merged, divided or refused, whatever the pieces."""

import math
import pickle
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from dirty_rows import NAN, cleaned, joined, lines, piece, plots, same, segments
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack.errors import DataError
from fuzzytrack.io import cleaning
from fuzzytrack.io.cleaning import Cleaner
from fuzzytrack.io.cleaning_rules import Cleaning, CleaningCounts
from fuzzytrack.simulation.sampling import PATTERNS

# -------------------------------------------------------------------- nothing to do


def test_clean_rows_stay_as_they_are():
    given = piece([0, 1, 2.5], [[1, 2], [3, NAN], [5, 6]], ["b", "a", "b"])
    cleaner = Cleaner(Cleaning())
    out = cleaner.advance(given)
    assert out.time.tolist() == given.time.tolist()
    assert np.array_equal(out.plots, given.plots, equal_nan=True)
    assert out.rows.tolist() == [2, 3, 4]
    assert out.segments.tolist() == [0, 0, 0]
    assert cleaner.counts == CleaningCounts()
    assert cleaner.counts.sentences() == ()
    assert cleaner.finish() is None


@pytest.mark.parametrize("duplicates", ["error", "mean"])
def test_no_rows_are_no_rows(duplicates):
    cleaner = Cleaner(Cleaning(duplicates=duplicates))
    for _ in range(2):
        out = cleaner.advance(piece([]))
        assert len(out) == len(out.segments) == 0
    assert cleaner.finish() is None


def test_what_comes_in_is_not_changed():
    given = piece([0, 1], [[5, 1e20], [5, 6]])
    before = (given.time.copy(), given.plots.copy())
    Cleaner(Cleaning(stale=9, wrap=5), 5).advance(given)
    assert np.array_equal(given.time, before[0])
    assert np.array_equal(given.plots, before[1])


# -------------------------------------------------------------------- missed plots


def test_values_beyond_any_use_are_missed():
    out, counts = cleaned(piece([0, 1, 2], [[9.97e36, 1], [2, -1e16], [3, 1e15]]))
    assert same([row[3] for row in out], [(NAN, 1.0), (2.0, NAN), (3.0, 1e15)])
    assert counts == CleaningCounts(fills=2)
    assert cleaned(piece([0], [1e16]), fill_limit=math.inf)[1].fills == 0


def test_infinite_values_stay_an_error():
    with pytest.raises(DataError, match=r"a\.csv: row 3: plot \[inf\]; expected finite numbers"):
        cleaned(piece([0, 1], [0, math.inf]))
    with pytest.raises(DataError, match="row 2: time nan; expected a finite number"):
        cleaned(piece([NAN]))


def test_positions_that_are_repeated_are_missed_for_a_while():
    rows = piece(range(7), [0, 0, 0, 0, 5, NAN, 5])
    assert cleaned(rows)[1].stale == 0
    out, counts = cleaned(rows, stale=math.inf)
    assert same(plots(out), [0.0, NAN, NAN, NAN, 5.0, NAN, NAN])
    assert counts == CleaningCounts(stale=4)
    # The position is a new plot when it has been repeated for two seconds.
    assert same(plots(cleaned(rows, stale=2)[0]), [0.0, NAN, NAN, 0.0, 5.0, NAN, NAN])
    # Both axes have to be the same.
    both = piece(range(3), [[1, 2], [1, 3], [1, NAN]])
    assert cleaned(both, stale=math.inf)[1].stale == 0


def test_a_start_waits_for_a_baseline():
    rows = piece([0, 0.01, 0.02, 1, 1.01, 2])
    out, counts = cleaned(rows, least_step=0.2)
    assert same(plots(out), [0.0, NAN, NAN, 30.0, 40.0, 50.0])
    assert counts == CleaningCounts(delayed=2)
    # After a gap the track starts again.
    out, counts = cleaned(piece([0, 1, 50, 50.1, 51]), least_step=0.2, max_gap=10)
    assert same(plots(out), [0.0, 10.0, 20.0, NAN, 40.0])
    assert segments(out) == [0, 0, 1, 1, 1]
    assert counts == CleaningCounts(delayed=1, segments=1)


@given(st.lists(st.floats(1e-3, 10), min_size=1, max_size=20), st.floats(0.01, 5))
def test_the_first_two_plots_are_never_closer_than_the_least_step(steps, least):
    time = np.concatenate([[0], np.cumsum(steps)])
    out, counts = cleaned(piece(time), least_step=least, max_gap=None)
    there = [row[2] for row in out if row[3][0] == row[3][0]]
    assert len(there) < 2 or there[1] - there[0] >= least
    assert len(out) == len(there) + counts.delayed == len(time)


# -------------------------------------------------------------------- gaps


def voyages(step=10.0, plots_each=20, apart=21_600.0):
    return np.concatenate([np.arange(plots_each) * step, apart + np.arange(plots_each) * step])


def test_six_hours_after_intervals_of_ten_seconds_begin_a_new_segment():
    out, counts = cleaned(piece(voyages()))
    assert segments(out) == [0] * 20 + [1] * 20
    assert counts == CleaningCounts(segments=1)
    assert counts.sentences() == ("1 new segment after a long time without a plot",)
    assert set(segments(cleaned(piece(voyages()), max_gap=None)[0])) == {0}


def test_a_gap_that_is_given():
    out, counts = cleaned(piece([0, 5, 10.1, 15.1, 100, 101]), max_gap=5)
    assert segments(out) == [0, 0, 1, 1, 2, 2]
    assert counts.segments == 2
    # Each track by itself.
    out, counts = cleaned(piece([0, 0, 9, 4, 13], ids="ababb"), max_gap=5)
    assert [row[::4] for row in out] == [("a", 0), ("a", 1), ("b", 0), ("b", 0), ("b", 1)]


def test_rows_without_a_plot_do_not_bridge_a_gap():
    time = np.arange(0, 31.0)
    values = np.where((time > 5) & (time < 25), NAN, time)
    out, counts = cleaned(piece(time, values), max_gap=10)
    # After ten seconds the track has ended; these rows belong to the next one.
    assert segments(out) == [0] * 16 + [1] * 15
    assert counts == CleaningCounts(segments=1)
    bare, _ = cleaned(piece(time[values == values], values[values == values]), max_gap=10)
    assert [row[2:] for row in out if row[3][0] == row[3][0]] == [row[2:] for row in bare]


def test_a_track_that_ends_in_rows_without_a_plot_has_no_new_segment():
    out, counts = cleaned(piece(range(9), [0, 1, 2, *[NAN] * 6]), max_gap=3)
    assert segments(out) == [0] * 6 + [1] * 3
    assert counts.segments == 0


def test_rows_after_coasting_are_dropped():
    values = [NAN, 0, 1, NAN, NAN, NAN, NAN, 7]
    out, counts = cleaned(piece(range(8), values), max_coast=2)
    assert lines(out) == [2, 3, 4, 5, 6, 9]
    assert counts == CleaningCounts(coasted=2)
    assert counts.sentences() == ("2 rows long after the last plot dropped",)
    assert lines(cleaned(piece(range(8), values), max_coast=0)[0]) == [2, 3, 4, 9]
    assert lines(cleaned(piece(range(8), values), max_coast=2, max_gap=1)[0]) == [2, 3, 4, 5, 6, 9]


IRREGULAR = {
    "regular": ("regular", ()),
    "jitter": ("jitter", (0.4,)),
    "1:10": ("alternate", (1, 10)),
    "10:1": ("alternate", (10, 1)),
    "near-duplicate pairs": ("alternate", (0.02, 0.98)),
    "bursts": ("burst", (5, 20)),
    "log-uniform": ("log-uniform", (0.1, 10)),
}


@pytest.mark.parametrize("name", IRREGULAR)
@pytest.mark.parametrize("detection", [1.0, 0.4])
def test_irregular_times_are_not_divided(name, detection):
    pattern, numbers = IRREGULAR[name]
    rng = np.random.default_rng(7)
    for _ in range(40):
        time = np.cumsum(PATTERNS[pattern].draw(rng, 200, *numbers))
        time = time[rng.random(200) < detection]
        assert cleaned(piece(time))[1].segments == 0


def test_a_near_duplicate_at_the_start_divides_nothing():
    for least_step in (None, 0.2):
        rows = piece([0, 0.01, *range(1, 30)])
        assert cleaned(rows, least_step=least_step)[1].segments == 0


# -------------------------------------------------------------------- any pieces, any way


@st.composite
def recordings(draw):
    """Rows of some tracks with all kinds of faults; times in each track do not fall."""
    count = draw(st.integers(0, 40))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    codes = rng.integers(0, 3, count)
    steps = rng.choice(
        [0.0, 0.01, 1.0, 1.5, 30.0, 5000.0], count, p=[0.1, 0.1, 0.4, 0.3, 0.05, 0.05]
    )
    time = np.zeros(count)
    for code in range(3):
        time[codes == code] = np.cumsum(steps[codes == code])
    values = rng.choice([0.0, 1.0, 2.0, NAN, 1e20], (count, 2), p=[0.3, 0.3, 0.2, 0.15, 0.05])
    return piece(time, values, np.array(list("abc"))[codes])


RULES = st.fixed_dictionaries(
    {},
    optional={
        "duplicates": st.sampled_from(["first", "last", "mean"]),
        "stale": st.sampled_from([1.0, math.inf]),
        "least_step": st.just(0.2),
        "max_gap": st.sampled_from([None, 20.0]),
        "max_coast": st.sampled_from([0.0, 3.0]),
    },
)


def run(rows, rules, cuts):
    """Rows and counts, or the message of an error, when rows come in pieces."""
    cleaner = Cleaner(Cleaning(**rules), column="t")
    edges = [0, *sorted(cut % (len(rows) + 1) for cut in cuts), len(rows)]
    try:
        parts = [cleaner.advance(rows.take(np.arange(a, b))) for a, b in pairwise(edges)]
    except DataError as error:
        return str(error)
    last = cleaner.finish()
    return joined([*parts, *([] if last is None else [last])]), cleaner.counts


@settings(max_examples=300, deadline=None)
@given(recordings(), RULES, st.lists(st.integers(0, 99), max_size=6))
def test_any_cut_into_pieces_gives_the_same(rows, rules, cuts):
    assert same(run(rows, rules, cuts), run(rows, rules, []))


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0.1, 5), min_size=1, max_size=60), st.lists(st.integers(0, 99)))
def test_any_cut_of_a_clock_that_starts_again_gives_the_same(steps, cuts):
    raw = np.mod(86_390 + np.cumsum([3.0, 3.0, *steps]), 86_400)
    rows = piece(raw, ids=["a", "b"] * (len(raw) // 2) + ["a"] * (len(raw) % 2))
    assert same(run(rows, {}, cuts), run(rows, {}, []))


@settings(max_examples=100, deadline=None)
@given(recordings(), RULES)
def test_what_is_not_counted_is_not_changed(rows, rules):
    found = run(rows, rules, [])
    if isinstance(found, str):
        assert "repeats" in found
        assert "duplicates" not in rules
        return
    out, counts = found
    assert len(out) == len(rows) - counts.copies - counts.merged - counts.coasted
    before = {int(line): position for line, position in zip(rows.rows, rows.plots, strict=True)}
    if rules.get("duplicates") != "mean":
        changed = [row for row in out if not same(np.array(row[3]), before[row[1]])]
        assert len(changed) <= counts.fills + counts.stale + counts.delayed
    for id in "abc":
        mine = np.array([row[2] for row in out if row[0] == id])
        assert (np.diff(mine) > 0).all()


@pytest.mark.parametrize("rules", [
    {}, {"wrap": 7.0}, {"stale": 1.0, "least_step": 0.2, "max_coast": 2.0, "max_gap": 20.0},
])  # fmt: skip
def test_compiled_and_plain_agree(rules, monkeypatch):
    rng = np.random.default_rng(5)
    codes = rng.integers(0, 4, 3000)
    time = np.arange(3000) * 0.1 + np.where(np.arange(3000) > 2000, 5000, 0)
    if "wrap" in rules:
        time = np.mod(time, 7.0)
    values = rng.choice([0.0, 1.0, NAN, 3.0], (3000, 2), p=[0.4, 0.3, 0.2, 0.1])
    copies = np.repeat(np.arange(3000), rng.choice([1, 2], 3000, p=[0.9, 0.1]))
    rows = piece(time[copies], values[copies], np.array(list("abcd"))[codes[copies]])
    found = []
    for above in (10**9, 0):
        monkeypatch.setattr(cleaning, "_COMPILE_ABOVE", above)
        # Positions side by side by axis, as data frames have them.
        found.append(run(replace(rows, plots=np.asfortranarray(rows.plots)), rules, [2500]))
    assert same(*found)
    assert found[0][1].copies > 100


def test_the_axes_do_not_change():
    cleaner = Cleaner(Cleaning())
    cleaner.advance(piece([0], [[1, 2]]))
    with pytest.raises(ValueError, match=r"^plots: 1 axes; the pieces before have 2$"):
        cleaner.advance(piece([1], [1]))


# -------------------------------------------------------------------- values


@pytest.mark.parametrize(
    ("rules", "message"),
    [
        ({"duplicates": "drop"}, "^duplicates: 'drop'; expected one of error, first, last, mean$"),
        ({"stale": 0}, "^stale: 0; expected a number of seconds above 0$"),
        ({"least_step": NAN}, "^least_step: nan"),
        ({"max_gap": "yes"}, "^max_gap: 'yes'; expected a number of seconds above 0, or auto$"),
        ({"max_coast": -1}, "^max_coast: -1; expected a number of seconds, at least 0$"),
        ({"wrap": math.inf}, "^wrap: inf"),
        ({"fill_limit": True}, "^fill_limit: True"),
    ],
)
def test_rules_that_are_none(rules, message):
    with pytest.raises(ValueError, match=message):
        Cleaning(**rules)


def test_rules_are_values():
    rules = Cleaning(max_gap=5.0, duplicates="mean")
    assert pickle.loads(pickle.dumps(rules)) == rules
    assert eval(repr(rules)) == rules
    assert len({rules, Cleaning()}) == 2


def test_counts_add_up():
    total = CleaningCounts(copies=1, wraps=1, period=60) + CleaningCounts(copies=2, stale=3)
    assert total == CleaningCounts(copies=3, stale=3, wraps=1, period=60)
    assert total.sentences()[0] == "3 exact copies of rows dropped"
    one = CleaningCounts(copies=1, merged=1, fills=1, stale=1, delayed=1, segments=1, coasted=1)
    assert all(sentence.startswith("1 ") for sentence in one.sentences())
    assert len(one.sentences()) == 7


# -------------------------------------------------------------------- against a plain account


def told(time, there, values, *, max_gap, max_coast, least_step, stale):
    """Segment (None if dropped) and position of each row of one track, told step by step."""
    answer, segment, starts, last, shown = [], 0, [], None, None
    for t, plot, value in zip(time, there, values, strict=True):
        if plot and shown is not None and value == shown[1] and t - shown[0] <= stale:
            plot, value = False, None
        if starts and t - last > max_gap:
            segment, starts = segment + 1, []
        if plot and len(starts) == 1 and t - last < least_step:
            plot, value = False, None
            answer.append((segment, None))
            continue
        if plot:
            starts.append(t)
            last, shown = t, (t, value)
        elif last is not None and t - last > max_coast:
            answer.append(None)
            continue
        answer.append((segment, value if plot else None))
    return answer


@settings(max_examples=200)
@given(
    st.lists(
        st.tuples(st.integers(1, 9), st.booleans(), st.integers(0, 2)), min_size=1, max_size=40
    ),
    st.sampled_from([3, 8, 20, None]),
    st.sampled_from([0, 5, None]),
    st.sampled_from([4, None]),
    st.sampled_from([6, math.inf, None]),
)
def test_rows_are_judged_as_told_step_by_step(steps, max_gap, max_coast, least_step, stale):
    time = np.cumsum([float(step) for step, _, _ in steps])
    there = [plot for _, plot, _ in steps]
    values = [float(value) for _, _, value in steps]
    rows = piece(time, [v if plot else NAN for plot, v in zip(there, values, strict=True)])
    rules = {
        "max_gap": max_gap, "max_coast": max_coast, "least_step": least_step, "stale": stale
    }  # fmt: skip
    out, _ = cleaned(rows, **rules)
    numbers = {"max_gap": math.inf, "max_coast": math.inf, "least_step": 0, "stale": -1}
    numbers.update({name: value for name, value in rules.items() if value is not None})
    expected = [
        (line, segment, NAN if value is None else value)
        for line, answer in enumerate(told(time, there, values, **numbers), 2)
        if answer is not None
        for segment, value in [answer]
    ]
    assert same([(row[1], row[4], row[3][0]) for row in out], expected)


@given(st.lists(st.floats(0.1, 10), min_size=9, max_size=40), st.floats(1, 1000))
def test_a_segment_begins_after_a_hundred_mean_intervals(steps, factor):
    gap = factor * float(np.mean(steps))
    time = np.concatenate([[0], np.cumsum(steps)])
    _, counts = cleaned(piece([*time, time[-1] + gap]))
    if abs(factor - 100) > 1e-6:
        assert counts.segments == (factor > 100)
