"""Runs that write their results into arrays of the caller's."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fuzzytrack as ft
from fuzzytrack.lanes import runner as module
from fuzzytrack.lanes.layout import BLOCK
from fuzzytrack.trackers import two_model_imm
from fuzzytrack.trackers.result import KEPT
from fuzzytrack.trackers.state import Gains

FIXED = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2, 0.05))
OWN_GAINS = ft.AlphaBetaTracker(ft.FuzzyScheduler("maneuver", level=5.0, axes="own"))
COUPLED = ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("chan-style")))
TRACKERS = {
    "one lane an axis": FIXED,
    "one lane a track": COUPLED,
    "gains of each axis": OWN_GAINS,
    "imm": two_model_imm(level=5.0),
}


def recording(tracks=3, steps=9, seed=5):
    """Irregular times, and plots of two axes, some of which are missed."""
    random = np.random.default_rng(seed)
    plots = np.cumsum(random.normal(0, 30, (steps, tracks, 2)), axis=0)
    plots[random.random(plots.shape[:2]) < 0.2] = np.nan
    return np.cumsum(random.uniform(0.5, 2.0, steps)), plots


def full(shape, dtype=np.float64):
    """An array with something in it, which a run must overwrite."""
    return np.full(shape, 77.0, dtype)


def arrays_for(names, shape, dtype=np.float64):
    return {
        name: Gains(*(full(shape, dtype) for _ in range(3))) if name == "gains" else
        full(shape, dtype)
        for name in names
    }  # fmt: skip


def singles(result):
    """All arrays of a result, by name."""
    found = {name: getattr(result, name) for name in result.kept if name != "gains"}
    if "gains" in result.kept:
        found |= {name: getattr(result.gains, name) for name in ("alpha", "beta", "gamma")}
    return found


def expect_same(one, other, state=True):
    ours, theirs = singles(one), singles(other)
    assert ours.keys() == theirs.keys()
    for name, array in ours.items():
        np.testing.assert_array_equal(array, theirs[name], err_msg=name)
    if state:
        np.testing.assert_array_equal(one.state.lanes, other.state.lanes)


@pytest.mark.parametrize("tracker", TRACKERS.values(), ids=TRACKERS)
@pytest.mark.parametrize("compiled", [False, True], ids=["plain", "compiled"])
def test_results_are_those_of_a_run_of_its_own(tracker, compiled, monkeypatch):
    if compiled:
        monkeypatch.setattr(module, "COMPILE_ABOVE", 0)
    times, plots = recording(tracks=BLOCK // 2 + 3 if compiled else 3)
    out = arrays_for(KEPT, plots.shape)
    result = tracker.run(times, plots, 10.0, out=out)
    for name in KEPT:
        assert getattr(result, name) is out[name]
    expect_same(result, tracker.run(times, plots, 10.0))


@given(st.sets(st.sampled_from(KEPT)), st.sets(st.sampled_from(KEPT)), st.sampled_from([1, 2]))
def test_any_part_of_the_results_may_have_arrays(in_out, others, cut):
    times, plots = recording()
    out = arrays_for(sorted(in_out), plots[cut:].shape)
    first = COUPLED.run(times[:cut], plots[:cut], 10.0)
    more = {"state": first.state, "keep": sorted(in_out | others)}
    result = COUPLED.run(times[cut:], plots[cut:], 10.0, out=out, **more)
    assert set(result.kept) == in_out | others
    assert all(getattr(result, name) is out[name] for name in in_out)
    expect_same(result, COUPLED.run(times[cut:], plots[cut:], 10.0, **more))


def test_what_is_in_out_is_kept():
    times, plots = recording()
    out = arrays_for(["velocity", "predicted"], plots.shape)
    assert FIXED.run(times, plots, out=out).kept == ("predicted", "velocity")
    assert FIXED.run(times, plots, out={}).kept == ()
    both = FIXED.run(times, plots, out=out, keep=("gains", "velocity", "predicted"))
    assert both.kept == ("predicted", "velocity", "gains")
    assert both.velocity is out["velocity"]


@pytest.mark.parametrize("shape", [(7,), (7, 1), (7, 2), (7, 2, 3, 2), (0, 2), (1, 2), (4, 0, 2)])
def test_results_of_any_shape(shape):
    plots = np.random.default_rng(1).normal(0, 10, shape)
    out = arrays_for(KEPT, shape)
    expected = COUPLED.run(np.arange(shape[0]), plots, 10.0)
    result = COUPLED.run(np.arange(shape[0]), plots, 10.0, out=out)
    for name, array in singles(result).items():
        np.testing.assert_array_equal(array, singles(expected)[name])


def test_results_in_single_precision():
    times, plots = recording()
    out = arrays_for(KEPT, plots.shape, np.float32)
    result = FIXED.run(times, plots, dtype=np.float32, out=out)
    assert result.gains.beta is out["gains"].beta
    expect_same(result, FIXED.run(times, plots, dtype=np.float32))


def test_pieces_fill_one_array():
    times, plots = recording(steps=10)
    filtered, state = full(plots.shape), None
    for part in (slice(0, 1), slice(1, 6), slice(6, 10)):
        out = {"filtered": filtered[part]}
        state = FIXED.run(times[part], plots[part], state=state, out=out).state
    np.testing.assert_array_equal(filtered, FIXED.run(times, plots).filtered)


def test_the_arrays_of_a_result_are_used_again():
    times, plots = recording()
    first = FIXED.run(times, plots[::-1], keep=("filtered", "gains"))
    again = FIXED.run(times, plots, out=first)
    assert again.filtered is first.filtered
    assert again.gains is first.gains
    expect_same(again, FIXED.run(times, plots, keep=("filtered", "gains")))


def test_gains_of_each_axis_are_used_again():
    times, plots = recording()
    first = OWN_GAINS.run(times, plots[::-1], 10.0)
    assert OWN_GAINS.run(times, plots, 10.0, out=first).gains is first.gains
    expect_same(first, OWN_GAINS.run(times, plots, 10.0, keep=KEPT), state=False)


def test_gains_that_axes_share_are_not_used_again():
    times, plots = recording()
    first = COUPLED.run(times, plots[::-1])
    before = first.gains.alpha.copy()
    again = COUPLED.run(times, plots, out=first)
    assert again.filtered is first.filtered
    np.testing.assert_array_equal(first.gains.alpha, before)
    expect_same(again, COUPLED.run(times, plots))
    # Once they are written into arrays, they are arrays.
    third = COUPLED.run(
        times, plots, out=COUPLED.run(times, plots, out=arrays_for(KEPT, plots.shape))
    )
    expect_same(third, again)


def test_an_array_may_be_mapped_from_a_file(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "COMPILE_ABOVE", 0)
    times, plots = recording()
    mapped = np.memmap(tmp_path / "filtered", mode="w+", shape=plots.shape, dtype=np.float64)
    assert FIXED.run(times, plots, out={"filtered": mapped}).filtered is mapped
    np.testing.assert_array_equal(mapped, FIXED.run(times, plots).filtered)


SHAPE = (9, 3, 2)


def misaligned():
    size = 8 * np.prod(SHAPE)
    return np.frombuffer(bytearray(size + 1), np.uint8)[1:].view(np.float64).reshape(SHAPE)


def fixed_array():
    array = np.zeros(SHAPE)
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    ("value", "error", "message"),
    [
        (full((9, 3)), ValueError, "out: filtered has shape (9, 3); results have that of the "
         "plots, (9, 3, 2)"),
        (full(SHAPE, np.float32), ValueError, "out: filtered is float32; this run gives float64"),
        (full(SHAPE, ">f8"), ValueError, "out: filtered is >f8; this run gives float64"),
        (np.asfortranarray(full(SHAPE)), ValueError, "out: filtered must be C-contiguous"),
        (fixed_array(), ValueError, "out: filtered must be C-contiguous, aligned and writeable"),
        (misaligned(), ValueError, "out: filtered must be C-contiguous, aligned and writeable"),
        (full(SHAPE).tolist(), TypeError, "out: filtered must be a NumPy array, got list"),
        (np.ma.zeros(SHAPE), TypeError, "out: filtered must be a NumPy array, got MaskedArray"),
    ],
)  # fmt: skip
def test_an_array_that_does_not_fit_is_refused(value, error, message):
    times, plots = recording()
    out = {"velocity": full(SHAPE), "filtered": value}
    with pytest.raises(error, match=re.escape(message)):
        FIXED.run(times, plots, out=out)
    assert (out["velocity"] == 77.0).all()


@pytest.mark.parametrize(
    ("out", "error", "message"),
    [
        ([full(SHAPE)], TypeError, "out must be a mapping from names of results to arrays "
         "(predicted, filtered, velocity, acceleration, innovation, gains), or a TrackResult; got "
         "list"),
        ({"speed": full(SHAPE)}, ValueError, "out: unknown 'speed'; out of predicted, filtered, "),
        ({"gains": full(SHAPE)}, TypeError, "out: gains must be a Gains of three arrays, got "
         "ndarray"),
        ({"gains": Gains(full(SHAPE), full(SHAPE), 0.0)}, TypeError, "out: gains.gamma must be a "
         "NumPy array, got float"),
        ({"gains": Gains(full(SHAPE), full(SHAPE), full((9, 2)))}, ValueError,
         "out: gains.gamma has shape (9, 2)"),
    ],
)  # fmt: skip
def test_what_holds_no_arrays_for_results_is_refused(out, error, message):
    with pytest.raises(error, match=re.escape(message)):
        FIXED.run(*recording(), out=out)


def test_an_array_that_is_not_kept_is_refused():
    with pytest.raises(ValueError, match=re.escape(
        "out: has 'velocity', which is not in keep (filtered); add it there, or leave it out of "
        "both"
    )):  # fmt: skip
        FIXED.run(*recording(), keep="filtered", out={"velocity": full(SHAPE)})


def test_memory_that_is_shared_is_refused():
    times, plots = recording()
    twice = full((10, 3, 2))
    with pytest.raises(ValueError, match="out: filtered and velocity share memory; give two"):
        FIXED.run(times, plots, out={"filtered": twice[1:], "velocity": twice[:-1]})
    one = full(SHAPE)
    with pytest.raises(ValueError, match=r"out: gains\.alpha and gains\.gamma share memory"):
        FIXED.run(times, plots, out={"gains": Gains(one, full(SHAPE), one)})
    with pytest.raises(ValueError, match="out: predicted shares memory with z; give another"):
        FIXED.run(times, plots, out={"predicted": plots})
    sigmas = full(SHAPE)
    with pytest.raises(ValueError, match="out: predicted shares memory with sigma"):
        FIXED.run(times, plots, sigmas[:, :1], out={"predicted": sigmas})
    with pytest.raises(ValueError, match="out: filtered shares memory with t"):
        FIXED.run(times, plots[:, 0, 0], out={"filtered": times})
    assert (twice == 77.0).all()
    assert (one == 77.0).all()


def test_nothing_is_written_before_other_arguments_are_checked():
    times, plots = recording()
    out = arrays_for(KEPT, plots.shape)
    with pytest.raises(ft.DataError, match="times must increase"):
        FIXED.run(times[::-1], plots, out=out)
    with pytest.raises(ValueError, match="threads must be at least 1"):
        FIXED.run(times, plots, threads=0, out=out)
    assert (out["filtered"] == 77.0).all()
