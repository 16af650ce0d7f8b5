"""Kinds of faults in files of plots that users of such software have reported, a property each.

What a single reader or rule does has its properties beside it, in ``tests/io``; here a whole file
is tracked.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import fuzzytrack as ft

SEEDS = st.integers(0, 10_000)


def track_text(folder, text, name="plots.csv", **options):
    """Track a file of this text."""
    path = folder / name
    path.write_text(text)
    return ft.track(path, **options)


def straight(seed, n, speed=5.0, sigma=3.0):
    """Times, true positions and plots of a straight course."""
    t = np.arange(float(n))
    truth = speed * t
    return t, truth, truth + np.random.default_rng(seed).normal(0, sigma, n)


# ------------------------------------------------------------------ plots almost at one time


@settings(max_examples=25)
@given(SEEDS, st.floats(0.001, 0.03), st.sampled_from(["start", "middle", "pairs"]))
def test_plots_in_close_pairs_throw_the_default_tracker_off_nowhere(seed, apart, where):
    """Two plots with 3 m of noise, 10 ms apart, look like 400 m/s; errors stay those of a plot."""
    t, truth, _ = straight(seed, 40)
    doubled = {"start": [0], "middle": [9], "pairs": range(40)}[where]
    t = np.sort(np.concatenate([t, t[list(doubled)] + apart]))
    truth = 5 * t
    z = truth + np.random.default_rng(seed).normal(0, 3, len(t))
    (result,) = ft.track((t, z), sigma=3.0).results
    error = (result.filtered[:, 0] - truth)[2:]
    assert np.sqrt(np.mean(error**2)) < 3.0
    assert np.abs(error).max() < 4.5 * 3.0


# ------------------------------------------------------------------ rows that are left out


@settings(max_examples=30)
@given(SEEDS, st.lists(st.integers(3, 29), max_size=12, unique=True))
def test_empty_rows_and_rows_left_out_give_the_same(seed, missed):
    t, _, z = straight(seed, 30)
    z[missed] = math.nan
    kept = np.isfinite(z)
    (whole,) = ft.track((t, z), sigma=3.0).results
    (short,) = ft.track((t[kept], z[kept]), sigma=3.0).results
    np.testing.assert_allclose(whole.filtered[kept], short.filtered, rtol=1e-12)


# ------------------------------------------------------------------ values that are none


@settings(max_examples=30)
@given(
    SEEDS,
    st.sets(st.integers(0, 29), min_size=1, max_size=8),
    st.sampled_from([181.0, -1e5, 511.0]),
    st.booleans(),
)
def test_codes_outside_of_the_valid_range_are_as_empty_cells(seed, where, code, lower):
    t, _, z = straight(seed, 30, speed=1.0)
    coded, empty = z.copy(), z.copy()
    coded[list(where)], empty[list(where)] = code, math.nan
    limits = (("x", -100.0, 150.0),) if lower or code < 0 else (("x", -math.inf, 150.0),)
    columns = {"time": t, "x": coded}
    tracked = ft.track(columns, "stiffness-damping", valid=limits, sigma=3.0)
    (plain,) = ft.track({"time": t, "x": empty}, "stiffness-damping", sigma=3.0).results
    np.testing.assert_array_equal(tracked.results[0].filtered, plain.filtered)
    (sentence,) = (s for s in tracked.findings.sentences() if "outside of" in s)
    assert sentence.startswith(f"{len(where)} plot")


@settings(max_examples=30)
@given(SEEDS, st.sets(st.integers(5, 39), max_size=6), st.floats(1e3, 1e6))
def test_a_few_spikes_are_counted_and_change_the_tracks_as_missed_plots_do(seed, where, size):
    assume(all(place + 1 not in where or place + 2 not in where for place in where))
    t, truth, z = straight(seed, 40)
    spiked = z.copy()
    spiked[list(where)] += size
    tracked = ft.track((t, spiked), sigma=3.0)
    assert tracked.findings.rejected == len(where)
    assert np.abs(tracked.results[0].filtered[3:, 0] - truth[3:]).max() < 5 * 3.0


# ------------------------------------------------------------------ boxes without identities


@settings(max_examples=20)
@given(st.lists(st.integers(1, 5), min_size=2, max_size=12), st.booleans())
def test_boxes_without_identities_are_one_track_or_an_error_that_says_so(
    tmp_path_factory, frames, header
):
    """One box a frame is a track; two in a frame need to be associated with tracks first."""
    frames = sorted(frames)
    text = "".join(f"{frame},-1,{10 * k},5,4,6,1,-1,-1,-1\n" for k, frame in enumerate(frames))
    name, options = "det.txt", {}
    if header:
        text = "frame,id,left,top,w,h,conf,x,y,z\n" + text
        name, options = "boxes.csv", {"time": "frame", "id": "id", "axes": ("left", "top")}
    folder = tmp_path_factory.mktemp("mot")
    if len(set(frames)) == len(frames):
        assert len(track_text(folder, text, name, **options)) == 1
        return
    with pytest.raises(ft.DataError, match=r"\(id '-1'\) repeats that of .* id -1 says that there"):
        track_text(folder, text, name, **options)


@settings(max_examples=30)
@given(st.floats(-1e6, 1e6), st.integers(1, 12), st.booleans())
def test_a_column_of_position_that_never_changes_is_remarked(value, n, moves):
    x = np.full(n, value) + (np.arange(n) if moves else 0)
    columns = {"time": np.arange(float(n)), "x": np.arange(float(n)) ** 2, "y": x}
    notes = ft.track(columns, sigma=1.0).findings.notes
    told = [note for note in notes if note.startswith("column y is ")]
    assert bool(told) == (n >= 4 and not moves)


# ------------------------------------------------------------------ columns that are guessed

TIME_NAMES = st.lists(
    st.sampled_from(["t", "time", "timestamp", "Time (s)", "TIME_MS", "t_s"]),
    min_size=1,
    max_size=3,
    unique_by=str.lower,
)
OTHERS = st.lists(st.sampled_from(["note", "temperature", "speed"]), max_size=2, unique=True)


@given(TIME_NAMES, OTHERS, st.randoms(use_true_random=False))
def test_two_columns_that_could_be_the_time_are_an_error_whatever_their_order(names, others, order):
    columns = [*names, *others, "x"]
    order.shuffle(columns)
    data = {name: np.arange(5.0) * (k + 1) for k, name in enumerate(columns)}
    if len(names) > 1:
        with pytest.raises(ft.DataError, match=r"could all be the time; name one .* `time`"):
            ft.track(data, sigma=1.0)
    tracked = ft.track(data, sigma=1.0, time=names[0])
    assert tracked.recording.decoder.columns.time == names[0]


@given(st.lists(st.sampled_from(["x", "X [m]", "x_m", "y", "y_m"]), min_size=1, unique=True))
def test_two_columns_that_could_be_one_coordinate_are_an_error(names):
    data = {"time": np.arange(5.0)} | {name: np.arange(5.0) for name in names}
    plain = [name[0].lower() for name in names]
    if len(set(plain)) < len(plain):
        with pytest.raises(ft.DataError, match=r"could all be [xy]; name those .* `axes`"):
            ft.track(data, sigma=1.0)
    else:
        used = ft.track(data, sigma=1.0).recording.decoder.columns.axes
        assert set(used) == set(names)
