"""Tracking in single precision: near to double, the same however it is cut, refused where wrong."""

import re
from dataclasses import dataclass

import numpy as np
import pytest

import fuzzytrack as ft
from fuzzytrack.kernels.compile import entry_point
from fuzzytrack.lanes import runner as module
from fuzzytrack.lanes.layout import BLOCK
from fuzzytrack.schedulers import GainScheduler, InnovationScheduler, KalmanCA, KalmanCV
from fuzzytrack.trackers import InteractingPair, ParallelBank, WindowSearch
from fuzzytrack.trackers.covariance import track_covariance
from fuzzytrack.trackers.result import KEPT
from fuzzytrack.trackers.runners import runner

pytestmark = [
    pytest.mark.untraced,
    # Some gains do not suit the times of these plots.
    pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning"),
]

SINGLE = np.dtype(np.float32)
SIGMA = 10.0
FIXED = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2, 0.05))
COUPLED = ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("chan-style")))
KALMAN = ft.AlphaBetaTracker(KalmanCV(0.5))
TRACKERS = {
    "fixed": FIXED,
    "fuzzy": ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("stiffness-damping"))),
    "fuzzy, by table": ft.AlphaBetaTracker(
        ft.FuzzyScheduler(ft.load_rulebase("stiffness-damping"), "table")
    ),
    "fuzzy, by relation": ft.AlphaBetaTracker(
        ft.FuzzyScheduler(ft.load_rulebase("stiffness-damping-cog"), "relation")
    ),
    "coupled": COUPLED,
    "kalman-cv": KALMAN,
    "kalman-ca": ft.AlphaBetaTracker(KalmanCA(0.5, 1.0, 10.0)),
    "innovation": ft.AlphaBetaTracker(InnovationScheduler(window=3)),
    "window search": WindowSearch(window=4),
}


def recording(tracks=BLOCK + 1, steps=30, seed=3):
    """Irregular times, and noisy turns of more tracks than go into a block; some are missed."""
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.5, 2.0, steps))
    angle = np.outer(times, random.uniform(-0.1, 0.1, tracks))
    plots = 1e3 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    plots += random.normal(0.0, SIGMA, plots.shape)
    plots[random.random((steps, tracks)) < 0.1] = np.nan
    # One starts late, one never does, and one misses an axis.
    plots[:6, 3], plots[:, 4], plots[9, 5, 0] = np.nan, np.nan, np.nan
    return times, plots


def arrays(result):
    gains = result.gains
    names = [name for name in KEPT if name != "gains"]
    found = {name: getattr(result, name) for name in names}
    return {**found, "alpha": gains.alpha, "beta": gains.beta, "gamma": gains.gamma}


def expect_same(one, other):
    for name, array in one.items():
        np.testing.assert_array_equal(array, other[name], err_msg=name)


def single(tracker, times, plots, **settings):
    return tracker.run(times, plots, SIGMA, dtype=np.float32, **settings)


@pytest.mark.parametrize("name", TRACKERS)
def test_it_is_near_to_double_precision(name):
    times, plots = recording()
    exact = arrays(TRACKERS[name].run(times, plots, SIGMA))
    result = single(TRACKERS[name], times, plots)
    found = arrays(result)
    assert {array.dtype for array in (result.measured, *found.values())} == {SINGLE}
    assert (result.time.dtype, result.state.lanes.dtype) == (np.float64, np.float64)
    for key, array in found.items():
        np.testing.assert_array_equal(np.isnan(array), np.isnan(exact[key]), err_msg=key)
    # Of two choices as good as each other the search may take the other one, now and then.
    off, gains_off = (np.abs(found[key] - exact[key]) for key in ("filtered", "alpha"))
    assert 0.0 < np.nanmedian(off) < 1e-4 * SIGMA
    assert np.nanquantile(off, 0.999) < 1e-2 * SIGMA
    assert np.nanquantile(gains_off, 0.999) < 1e-3


@pytest.mark.parametrize("name", ["fixed", "coupled", "kalman-cv", "window search"])
def test_however_it_is_cut_it_is_the_same(name):
    tracker, (times, plots) = TRACKERS[name], recording(tracks=2 * BLOCK + 1)
    whole = single(tracker, times, plots)
    expect_same(arrays(single(tracker, times, plots, threads=3)), arrays(whole))
    own = np.repeat(times[:, None], plots.shape[1], axis=1)
    expect_same(arrays(single(tracker, own, plots)), arrays(whole))
    for track in (0, 3, 4, BLOCK - 1, BLOCK, 2 * BLOCK):
        alone = arrays(single(tracker, times, plots[:, track]))
        expect_same(alone, {key: array[:, track] for key, array in arrays(whole).items()})
    state, parts = None, []
    for begin, end in ((0, 1), (1, 2), (2, 13), (13, 30)):
        part = single(tracker, times[begin:end], plots[begin:end], state=state)
        state, parts = part.state, [*parts, arrays(part)]
    expect_same({key: np.concatenate([p[key] for p in parts]) for key in parts[0]}, arrays(whole))
    np.testing.assert_array_equal(state.lanes, whole.state.lanes)


@pytest.mark.parametrize("keep", [("predicted",), ("filtered",), ("innovation", "gains"), ()])
def test_what_is_kept_is_the_same(keep):
    times, plots = recording()
    whole, part = single(KALMAN, times, plots), single(KALMAN, times, plots, keep=keep)
    assert part.kept == keep
    for name in set(keep) - {"gains"}:
        np.testing.assert_array_equal(getattr(part, name), getattr(whole, name))
    if "gains" in keep:
        np.testing.assert_array_equal(part.gains.beta, whole.gains.beta)
    np.testing.assert_array_equal(part.state.lanes, whole.state.lanes)


def test_shapes_without_tracks_or_steps():
    times, plots = recording(steps=10)
    for z in (plots[:, 0, 0], plots[:, 0], plots[:, :0], plots[:0]):
        result = single(FIXED, times[: len(z)], z)
        assert (result.filtered.shape, result.filtered.dtype) == (z.shape, SINGLE)
    assert result.state is None


def test_tracks_go_on_in_the_other_precision():
    times, plots = recording()
    whole = FIXED.run(times, plots).filtered
    first, second = (np.float32, np.float64), (np.float64, np.float32)
    for before, after in (first, second):
        state = FIXED.run(times[:15], plots[:15], dtype=before).state
        rest = FIXED.run(times[15:], plots[15:], state=state, dtype=after).filtered
        assert rest.dtype == after
        np.testing.assert_allclose(rest, whole[15:], rtol=0.0, atol=2e-3)
    state = FIXED.run(times[:15], plots[:15], dtype=np.float32).state
    step = FIXED.step(state, plots[15], times[15])
    np.testing.assert_allclose(step.position, whole[15], rtol=0.0, atol=2e-3)


@pytest.mark.parametrize("value", [np.inf, -np.inf, 1e39])
@pytest.mark.parametrize("tracker", [FIXED, COUPLED])
def test_plots_that_are_too_large_are_found(tracker, value):
    times, plots = recording()
    # The other axis of the track was missed at that time.
    plots[9, BLOCK] = np.nan, value
    with pytest.raises(ft.DataError, match=rf"too large for float32\) at index \(9, {BLOCK}, 1\)"):
        single(tracker, times, plots, threads=2)


def test_a_sigma_of_any_size_may_stand_where_nothing_was_seen():
    times, plots = recording()
    sigma = np.where(np.isnan(plots), 1e300, SIGMA)
    found = KALMAN.run(times, plots, sigma, dtype=np.float32)
    expect_same(arrays(found), arrays(single(KALMAN, times, plots)))


@pytest.mark.parametrize("dtype", ["float16", "int32", ">f4", "complex64"])
def test_other_numbers_are_refused(dtype):
    message = rf"dtype must be float64 or float32, got {np.dtype(dtype)}"
    with pytest.raises(ValueError, match=message):
        FIXED.run(range(3), range(3), dtype=dtype)


@pytest.mark.parametrize(
    ("tracker", "number"),
    [
        (ParallelBank(), r"1e\+300"),
        (InteractingPair(0.2, 3.0), r"1e\+100"),
        (ft.AlphaBetaTracker(KalmanCV(1e-24)), "1e-48"),
    ],
)
def test_trackers_with_other_numbers_are_refused(tracker, number):
    times, plots = recording(tracks=6, steps=10)
    message = rf"dtype: this tracker works with {number}, which float32 lacks; use float64"
    with pytest.raises(ValueError, match=message):
        single(tracker, times, plots)


def test_a_covariance_needs_double_precision():
    times, plots = recording(tracks=6, steps=10)
    with pytest.raises(ValueError, match="result: its dtype must be float64, got float32"):
        track_covariance(single(KALMAN, times, plots), SIGMA, 0.5)


@dataclass(frozen=True)
class Stairs(GainScheduler):
    """Gains from a table that is long enough to become an array, with whole numbers beside it."""

    first: float = 0.3

    def initial_memory(self, n_axes):
        return (0.0,)

    def kernel(self, n_axes):
        table = (self.first, *(0.3 + 0.01 * k for k in range(1, 32)))

        def stairs(innovation, change, dt, sigma, memory):
            alpha = table[int(min(31.0, abs(innovation)))]
            return alpha, alpha / 2 - 1 / 10, 0.0, 1.0, (memory[0] + 1,)

        return stairs


def test_kernels_of_others_run_in_it():
    times, plots = recording()
    tracker = ft.AlphaBetaTracker(Stairs())
    exact, found = tracker.run(times, plots), tracker.run(times, plots, dtype=np.float32)
    assert found.filtered.dtype == SINGLE
    # A rounded innovation may be on another stair, now and then.
    off = np.abs(found.gains.alpha - exact.gains.alpha)
    assert np.nanquantile(off, 0.999) < 1e-6
    with pytest.raises(ValueError, match=r"works with 1e\+300, which float32 lacks; use float64"):
        ft.AlphaBetaTracker(Stairs(1e300)).run(times, plots, dtype=np.float32)


def test_small_numbers_of_a_table_may_count_as_nothing():
    table = (1e-300, *range(1, 20))

    def function(b, count):
        b[0] = table[count]

    code = entry_point(function, "vpi", np.float32)
    numbers = np.ones(1, np.float32)
    for count, expected in ((0, 0.0), (7, 7.0)):
        code.ctypes(np.ctypeslib.as_ctypes(numbers), count)
        assert numbers[0] == expected


def test_a_stream_does_not_wait_for_the_compiler():
    tracker = ft.AlphaBetaTracker(ft.FixedGains(0.5123, 0.2))
    core = runner(tracker, 1)
    times, plots = recording(tracks=6)
    tracker.run(times, plots, dtype=np.float32)
    # Compiled in single precision only, which a step is not.
    assert (bool(core._code), core.native) == (True, False)
    tracker.step(tracker.start(plots[0], times[0]), plots[1], times[1])
    assert {dtype for _, dtype in core._code} == {np.float32}


def test_a_stream_after_a_large_job_compiles_no_more(monkeypatch):
    monkeypatch.setattr(module, "COMPILE_ABOVE", 0)
    tracker = ft.AlphaBetaTracker(ft.FixedGains(0.5124, 0.2))
    times, plots = recording(tracks=6)
    tracker.run(times, plots)
    code = dict(runner(tracker, 1)._code)
    tracker.step(tracker.start(plots[0], times[0]), plots[1], times[1])
    assert runner(tracker, 1)._code == code


@pytest.mark.parametrize("sigma", [1e39, 1e-46])
def test_a_sigma_out_of_range_is_refused_where_it_counts(sigma):
    tracker = ft.AlphaBetaTracker(KalmanCV(0.5))
    sigmas, plots = np.array([10.0, 10.0, sigma, 10.0]), np.array([0.0, 1.0, np.nan, 3.0])
    tracker.run(range(4), plots, sigmas, dtype=np.float32)
    plots[2] = 2.0
    message = re.escape("from 1e-18 to 1e+18 since it is squared") + f".*{re.escape(f'{sigma:g}')}"
    with pytest.raises(ValueError, match=message):
        tracker.run(range(4), plots, sigmas, dtype=np.float32)


def test_a_time_step_out_of_range_is_refused():
    with pytest.raises(ValueError, match="a time step of 1e-50 is out of the range of float32"):
        FIXED.run([0.0, 1e-50, 1.0], [0.0, 1.0, 2.0], dtype=np.float32)
