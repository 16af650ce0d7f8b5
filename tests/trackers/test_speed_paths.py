"""The fast ways through the code give the numbers of the slow ones, and are the fast ones."""

import itertools
import pickle
import platform
import re
import threading

import llvmlite.binding
import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.fuzzy.ramps import find_ramps
from fuzzytrack.kernels.compile import entry_point
from fuzzytrack.lanes import runner as module
from fuzzytrack.lanes.block_loop import compiled_one_step, compiled_run
from fuzzytrack.lanes.layout import BLOCK, aligned
from fuzzytrack.schedulers import KalmanCV
from fuzzytrack.trackers.result import KEPT
from fuzzytrack.trackers.runners import runner

pytestmark = pytest.mark.untraced

FIXED = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2, 0.05))
FUZZY = ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("stiffness-damping")))
COUPLED = ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("chan-style")))
KALMAN = ft.AlphaBetaTracker(KalmanCV(0.5))
TRACKERS = {"fixed": FIXED, "fuzzy": FUZZY, "coupled": COUPLED}


def recording(tracks=BLOCK + 7, steps=12, seed=3):
    """Irregular times, and plots of more tracks than go into a block; some are missed."""
    random = np.random.default_rng(seed)
    plots = np.cumsum(random.normal(0, 30, (steps, tracks, 2)), axis=0)
    plots[random.random(plots.shape) < 0.1] = np.nan
    # One starts late, and one never does.
    plots[:6, 3], plots[:, 4] = np.nan, np.nan
    return np.cumsum(random.uniform(0.5, 2.0, steps)), plots


@pytest.fixture
def compile_always(monkeypatch):
    monkeypatch.setattr(module, "COMPILE_ABOVE", 0)


def arrays(result):
    gains = result.gains
    names = [name for name in KEPT if name != "gains"]
    return [getattr(result, n) for n in names] + [gains.alpha, gains.beta, gains.gamma]


def expect_same(one, other):
    for ours, theirs in zip(one, other, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def run_plain(tracker, times, plots):
    """All outputs of the plain run, a part of the tracks at a time so that nothing compiles."""
    core = runner(tracker, 2 if tracker.coupled else 1)
    shape = (len(plots), -1, core.rows.n_axes)
    lanes = plots.reshape(shape)
    nowhere = np.full((1, 1, 1), np.nan)
    return core(core.fresh(lanes.shape[1]), lanes, times[:, None], nowhere, native=False)


@pytest.mark.parametrize("name", TRACKERS)
@pytest.mark.usefixtures("compile_always")
def test_batches_equal_plain_python(name):
    times, plots = recording()
    after, plain = run_plain(TRACKERS[name], times, plots)
    result = TRACKERS[name].run(times, plots)
    for key in ("predicted", "filtered", "velocity", "acceleration", "innovation"):
        np.testing.assert_array_equal(getattr(result, key), plain[key].reshape(plots.shape))
    np.testing.assert_array_equal(result.state.lanes, after)
    own = np.repeat(times[:, None], plots.shape[1], axis=1)
    expect_same(arrays(TRACKERS[name].run(own, plots)), arrays(result))


def subsets(names):
    return [c for size in range(len(names) + 1) for c in itertools.combinations(names, size)]


@pytest.mark.parametrize("tracker", [FIXED, COUPLED])
@pytest.mark.usefixtures("compile_always")
def test_what_is_kept_is_the_same(tracker):
    times, plots = recording(tracks=9)
    whole = tracker.run(times, plots)
    for keep in subsets(KEPT):
        part = tracker.run(times, plots, keep=keep)
        assert part.kept == keep
        for name in set(keep) - {"gains"}:
            np.testing.assert_array_equal(getattr(part, name), getattr(whole, name))
        if "gains" in keep:
            np.testing.assert_array_equal(part.gains.beta, whole.gains.beta)
        np.testing.assert_array_equal(part.state.lanes, whole.state.lanes)


@pytest.mark.parametrize("name", TRACKERS)
@pytest.mark.parametrize("tracks", [1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK + 1])
@pytest.mark.usefixtures("compile_always")
def test_the_last_block_may_be_of_any_size(name, tracks):
    tracker, (times, plots) = TRACKERS[name], recording(2 * BLOCK + 1, 5)
    plots = plots[:, -tracks:] if tracker.coupled else plots[:, -tracks:, :1]
    after, plain = run_plain(tracker, times, plots)
    for steps in (slice(0, 1), slice(0, 5)):
        result = tracker.run(times[steps], plots[steps])
        np.testing.assert_array_equal(result.innovation.ravel(), plain["innovation"][steps].ravel())
    np.testing.assert_array_equal(result.state.lanes, after)
    predicted = tracker.run(times, plots, keep="predicted").predicted
    np.testing.assert_array_equal(predicted.ravel(), plain["predicted"].ravel())


@pytest.mark.usefixtures("compile_always")
def test_the_passage_is_compiled_once_for_all_forms_of_input():
    times, plots = recording()
    own, sealed = np.repeat(times[:, None], plots.shape[1], axis=1), plots.copy()
    sealed.flags.writeable = False
    # Also of a stream, as `compile` leaves it.
    FIXED.compile()
    known = list(compiled_run().signatures)
    expected = FIXED.run(times, plots)
    for t, z, sigma in (
        (times, sealed, None), (own, plots, np.full(plots.shape, 2.0)), (own, plots, [2.0, 3.0]),
    ):  # fmt: skip
        expect_same(arrays(FIXED.run(t, z, sigma)), arrays(expected))
    FIXED.run(times, plots[:, 0, 0])
    assert compiled_run().signatures == known


def test_what_was_not_kept_says_so():
    result = FIXED.run(range(4), np.zeros((4, 2)), keep=["filtered", "innovation"])
    assert result.kept == ("filtered", "innovation")
    with pytest.raises(AttributeError, match=r"predicted was not kept; run with keep=\(\.\.\., 'p"):
        _ = result.predicted
    with pytest.raises(AttributeError, match="no attribute 'color'"):
        _ = result.color
    assert pickle.loads(pickle.dumps(result)).kept == result.kept
    assert repr(result) == "TrackResult(shape=(4, 2), kept=('filtered', 'innovation'))"
    assert FIXED.run(range(4), np.zeros(4)).kept == KEPT
    assert FIXED.run(range(4), np.zeros(4), keep="gains").kept == ("gains",)


def test_bad_choices_are_refused():
    with pytest.raises(ValueError, match="keep: unknown 'speed'; out of predicted, filtered"):
        FIXED.run(range(4), np.zeros(4), keep=("predicted", "speed"))
    with pytest.raises(ValueError, match="threads must be at least 1, got 0"):
        FIXED.run(range(4), np.zeros(4), threads=0)


@pytest.mark.parametrize("tracker", [FIXED, COUPLED])
@pytest.mark.usefixtures("compile_always")
def test_threads_change_nothing(tracker):
    times, plots = recording(tracks=5 * BLOCK + 3)
    names = set()

    def noted(part):
        def call(ends):
            names.add(threading.current_thread().name)
            return part(ends)

        return call

    original = module._in_parts
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_in_parts", lambda part, *rest: original(noted(part), *rest))
        many = tracker.run(times, plots, threads=3)
    assert names - {threading.main_thread().name} == names
    expect_same(arrays(many), arrays(tracker.run(times, plots, threads=1)))


@pytest.mark.usefixtures("compile_always")
def test_infinite_plots_are_found_in_compiled_batches():
    times, plots = recording()
    for place in ((7, BLOCK + 2, 1), (0, 0, 0), (11, 17, 0)):
        bad = plots.copy()
        bad[place] = -np.inf
        index = ", ".join(map(str, place))
        for tracker in TRACKERS.values():
            with pytest.raises(ft.DataError, match=rf"infinite plot at index \({index}\)"):
                tracker.run(times, bad, threads=2)


@pytest.mark.parametrize("name", TRACKERS)
def test_compiled_streams_equal_plain_ones(name):
    tracker = TRACKERS[name]
    times, plots = recording()
    for z in (plots[:, 0], plots):
        _, plain = run_plain(tracker, times, z)
        tracker.compile(2)
        state = tracker.start(z[0], times[0])
        for k in range(1, len(times)):
            # As they may come: a list for an array now and then, a sigma that nobody asked for.
            row = z[k].tolist() if k % 3 == 0 else z[k]
            state = tracker.step(state, row, float(times[k]), 5.0 if k % 4 == 0 else None)
            np.testing.assert_array_equal(
                state.predicted, plain["predicted"][k].reshape(z[k].shape)
            )
            np.testing.assert_array_equal(state.velocity, plain["velocity"][k].reshape(z[k].shape))
            np.testing.assert_array_equal(
                state.innovation, plain["innovation"][k].reshape(z[k].shape)
            )
        assert (state.time.shape, state.time) == ((), times[-1])


def test_compiled_streams_check_what_they_are_given():
    FIXED.compile(2)
    state = FIXED.step(FIXED.start([0.0, 0.0], 0.0), [1.0, 1.0], 1.0)
    cases = {
        "infinite plot at index": ([np.inf, 0.0], 2.0, None),
        "must increase": ([0.0, 0.0], 1.0, None),
        "not finite": ([0.0, 0.0], np.nan, None),
        "do not go on from": ([0.0, 0.0, 0.0], 2.0, None),
        "must be positive and finite": ([0.0, 0.0], 2.0, -1.0),
    }
    for message, (z, t, sigma) in cases.items():
        with pytest.raises(ValueError, match=message):
            FIXED.step(state, z, t, sigma)
    with pytest.raises(ValueError, match=r"state: it comes from AlphaBetaTracker\(FixedGains"):
        FUZZY.step(state, [0.0, 0.0], 2.0)
    expected = FIXED.step(state, [3.0, 4.0], 2.0)
    spread_out = np.array([[3.0, 4.0], [0.0, 0.0]]).T[:, 0]
    for z, t in (([3, 4], 2), (np.array([3, 4]), np.float64(2.0)), (spread_out, np.array(2.0))):
        np.testing.assert_array_equal(FIXED.step(state, z, t).lanes, expected.lanes)


def streams_of_each(times, plots, seed):
    """Ways in which times and sigmas of a scan may come, step by step."""
    random = np.random.default_rng(seed)
    n_steps, tracks, _ = plots.shape
    own = times[:, None] + random.uniform(0.0, 0.4, tracks)
    each = random.uniform(1.0, 30.0, plots.shape)
    common = [float(t) for t in times]
    return {
        "times of each track": (own, [None] * n_steps),
        "times and sigmas of each": (own, each),
        "sigmas of each": (common, each),
        "sigmas of each axis": (common, each[:, 0]),
        "sigmas of each track": (own, each[:, :, :1]),
        "common times in the end": ([*own[:6], *common[6:]], [20.0] * n_steps),
        "own times in the end": ([*common[:6], *own[6:]], [20.0] * n_steps),
    }


@pytest.mark.parametrize("way", streams_of_each(*recording(5), 0))
@pytest.mark.parametrize("name", [*TRACKERS, "kalman"])
def test_compiled_streams_of_tracks_with_times_of_their_own(name, way):
    tracker = {**TRACKERS, "kalman": KALMAN}[name]
    tracker.compile(2)
    core = runner(tracker, 2 if tracker.coupled else 1)
    for tracks in (1, 3, BLOCK + 7):
        times, plots = recording(max(tracks, 5))
        plots = plots[:, :tracks]
        times, sigmas = streams_of_each(times, plots, 1)[way]
        if tracker.needs_sigma and sigmas[0] is None:
            sigmas = [5.0] * len(times)
        state = tracker.start(plots[0], times[0], sigmas[0])
        short = tracker._new_compiled_step(state)
        for z, t, sigma in zip(plots[1:], times[1:], sigmas[1:], strict=True):
            expected = plain_step(core, state, z, t, sigma)
            found = short(state, z, t, sigma)
            state = tracker.step(state, z, t, sigma)
            for after in (found, state):
                np.testing.assert_array_equal(after.lanes, expected)
                np.testing.assert_array_equal(after.time, np.broadcast_to(t, np.shape(after.time)))
    assert len(tracker._compiled_steps) == 1


def plain_step(core, state, z, t, sigma):
    """Lanes after a step in plain Python."""
    count, n_axes = state.lanes.shape[1], core.rows.n_axes
    tracks = z.shape[:-1]
    times = np.broadcast_to(t, tracks).ravel()
    sigmas = np.broadcast_to(np.nan if sigma is None else sigma, z.shape)
    return core.step(
        state.lanes,
        z.reshape(count, n_axes),
        np.repeat(times, count // tracks[0]).tolist(),
        sigmas.reshape(count, n_axes).tolist(),
    )


def test_compiled_scans_check_what_they_are_given():
    KALMAN.compile(2)
    z, now = np.ones((3, 2)), np.array([1.0, 2.0, 3.0])
    state = KALMAN.step(KALMAN.start(z, now - 1.0, 1.0), z, now, 1.0)
    cases = {
        r"infinite plot at index \(0, 1, 0\)": ([[0, 0], [np.inf, 0], [0, 0]], now + 1.0, 1.0),
        r"index \(0, 2\) \(3.0 s\) is not later": (z, now + np.array([1.0, 1.0, 0.0]), 1.0),
        r"index \(0, 1\) \(2.0 s\) is not later": (z, 2.0, 1.0),
        "time at index 0 is not finite": (z, now + np.array([1.0, np.nan, 1.0]), 1.0),
        r"t: shape \(1, 2\) does not fit": (z, now[:2] + 1.0, 1.0),
        r"at index \(0, 1, 1\) it is -1": (z, now + 1.0, np.array([[1, 1], [1, -1.0], [1, 1]])),
        "it is 0": (z, now + 1.0, 0.0),
        "KalmanCV needs the standard deviation": (z, now + 1.0, None),
        r"sigma: shape \(1, 3\) does not broadcast": (z, now + 1.0, np.ones(3)),
    }
    for message, (plots, t, sigma) in cases.items():
        with pytest.raises(ValueError, match=message):
            KALMAN.step(state, np.array(plots, float), t, sigma)
    # A plot that is missed needs no sigma; and other forms of the same numbers.
    z[1, 0] = np.nan
    sigma = np.full((3, 2), 2.0)
    expected = KALMAN.step(state, z, now + 1.0, sigma)
    sigma[1, 0] = np.nan
    others = [(sigma, now + 1.0), (2, now + 1.0), (2.0, [2.0, 3, 4]), ([2.0, 2.0], now + 1.0)]
    for noise, t in others:
        found = KALMAN.step(state, z, t, noise)
        np.testing.assert_array_equal(found.lanes, expected.lanes)
        np.testing.assert_array_equal(found.time, expected.time)


def test_a_state_does_not_share_times_with_the_caller_of_a_compiled_step():
    FIXED.compile(1)
    now = np.array([1.0, 2.0])
    state = FIXED.step(FIXED.start(np.zeros((2, 1)), 0.0), np.ones((2, 1)), now)
    now += 5.0
    assert state.time.tolist() == [1.0, 2.0]


def test_scans_of_any_size_are_stepped_by_what_was_compiled():
    FIXED.compile(2)
    kept = [len(compiled_one_step(own).signatures) for own in (False, True)]
    for tracks in range(1, 40):
        state = FIXED.start(np.zeros((tracks, 2)), 0.0)
        state = FIXED.step(state, np.ones((tracks, 2)), np.full(tracks, 1.0), np.ones((tracks, 2)))
        FIXED.step(state, np.ones((tracks, 2)), 2.0)
    assert [len(compiled_one_step(own).signatures) for own in (False, True)] == kept == [1, 1]
    assert len(FIXED._compiled_steps) == 1


def test_a_state_has_as_many_numbers_as_its_plots_need():
    state = FIXED.start([0.0, 0.0], 0.0)
    with pytest.raises(ValueError, match=r"lanes: shape \(\d+, 1\); plots of \(2,\) need"):
        ft.TrackState(state.time, state.shape, state.lanes[:, :1], state.rows)
    spread_out = np.asfortranarray(state.lanes)
    again = ft.TrackState(state.time, state.shape, spread_out, state.rows)
    assert again.lanes.flags.c_contiguous


def test_a_compiled_tracker_pickles_and_stays_equal():
    FIXED.compile(2)
    state = FIXED.step(FIXED.start([0.0, 0.0], 0.0), [1.0, 1.0], 1.0)
    copy = pickle.loads(pickle.dumps(FIXED))
    assert (copy, hash(copy)) == (FIXED, hash(FIXED))
    again = pickle.loads(pickle.dumps(state))
    here, there = FIXED.step(state, [2.0, 2.0], 2.0), copy.step(again, [2.0, 2.0], 2.0)
    np.testing.assert_array_equal(here.lanes, there.lanes)


def test_a_state_with_fewer_rows_is_refused():
    """As one that another release has pickled: loading it does not run the constructor's checks."""
    FIXED.compile(2)
    state = FIXED.step(FIXED.start([0.0, 0.0], 0.0), [1.0, 1.0], 1.0)
    old = ft.TrackState.unchecked(
        state.time, (2,), state.lanes[:-1].copy(), state.rows, state.made_by
    )
    with pytest.raises(ValueError, match="laid out for another tracker"):
        FIXED.step(old, [2.0, 2.0], 2.0)
    with pytest.raises(ValueError, match="laid out for another tracker"):
        FIXED.run([2.0], [[2.0, 2.0]], state=old)


def test_scratch_begins_with_a_line_of_the_cache():
    for count in (1, 100, 12345):
        numbers = aligned(count)
        assert (len(numbers), numbers.ctypes.data % 64) == (count, 0)


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="reads x86 assembly")
@pytest.mark.parametrize("name", ["fixed", "fuzzy"])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_several_lanes_are_worked_on_at_once(name, dtype, monkeypatch):
    monkeypatch.setenv("FUZZYTRACK_CACHE_DIR", "off")
    code = entry_point(TRACKERS[name].program(1).steady(BLOCK, False, True), "vpixpp", dtype)
    assembly = code._library.get_asm_str()
    kind = "pd" if dtype is np.float64 else "ps"
    assert f"mul{kind}" in assembly
    # The time step is common, so only what the rules divide by is left.
    assert (f"div{kind}" in assembly) == (name == "fuzzy")
    if llvmlite.binding.get_host_cpu_features().get("avx512f"):
        assert "zmm" in assembly
    # Lanes begin where the block begins: none is taken apart.
    assert re.search(r"\s[48]\(%r\w+,%r\w+,[48]\), %[yz]mm", assembly) is None
    # Two vectors go through a turn; each is divided three times.
    if name == "fuzzy":
        parts = assembly.split("\n.LBB")
        assert max(len(re.findall(rf"v?div{kind}", part)) for part in parts) == 6


def test_rules_that_share_out_every_point_are_ramps():
    assert find_ramps(ft.load_rulebase("stiffness-damping")) is not None
    assert find_ramps(ft.load_rulebase("chan-style")) is not None
    # Output sets of different areas: rules differ in weight.
    assert find_ramps(ft.load_rulebase("stiffness-damping-cog")) is None
    assert find_ramps(ft.load_rulebase("tipper")) is None
