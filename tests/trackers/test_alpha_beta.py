import pickle
from contextlib import nullcontext
from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from scipy.signal import lfilter

import fuzzytrack as ft
from fuzzytrack.schedulers import GainScheduler

FIXED = ft.FixedGains(0.5377, 0.2018)


def test_golden_run_of_the_exact_engine():
    plots = [0, 10, 19, 31, 44, 50, 62, 71, 95, 100, 103, 118]
    expected = [
        20, 29.009578260, 40.661585754, 54.016157485, 61.738041977,
        72.276899371, 81.378782053, 102.932857757, 113.281026573, 116.874107683,
    ]  # fmt: skip
    tracker = ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("stiffness-damping")))
    result = tracker.run(np.arange(12), plots)
    np.testing.assert_allclose(result.predicted[2:], expected, rtol=0, atol=1e-8)
    assert np.isnan(result.predicted[:2]).all()


def test_golden_run_of_the_relational_engine():
    plots = [0, 10, 19, 31, 44, 50, 62, 71, 95, 100, 103, 118]
    expected = [
        20, 29.043447923, 40.603402826, 53.939333283, 61.776874840,
        72.265308097, 81.416174286, 102.797833816, 113.335412724, 117.106844506,
    ]  # fmt: skip
    rules = ft.load_rulebase("stiffness-damping-cog")
    tracker = ft.AlphaBetaTracker(ft.FuzzyScheduler(rules, method="relation"))
    result = tracker.run(np.arange(12), plots)
    np.testing.assert_allclose(result.predicted[2:], expected, rtol=0, atol=1e-8)


def literal_tracker(times, plots, alpha, beta, gamma=0.0):
    """Eqs. 2.1-2.6 and 2.35-2.39 as they stand, for one axis without misses; predictions."""
    dt = times[1] - times[0]
    x, v, a = plots[1], (plots[1] - plots[0]) / dt, 0.0
    predicted = [np.nan, np.nan]
    for k in range(2, len(plots)):
        dt = times[k] - times[k - 1]
        forecast = x + dt * v + dt**2 / 2 * a
        error = plots[k] - forecast
        x, v, a = (
            forecast + alpha * error,
            v + dt * a + beta / dt * error,
            a + gamma / (2 * dt**2) * error,
        )
        predicted.append(forecast)
    return np.array(predicted)


@pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")
@given(
    st.lists(st.tuples(st.floats(0.1, 5), st.floats(-1e3, 1e3)), min_size=3, max_size=30),
    st.sampled_from([(0.5, 0.2, 0.0), (0.9, 1.1, 0.4), (1.2, 0.7, 0.0)]),
)
def test_it_is_the_recursion_of_the_report(track, gains):
    steps, plots = np.array(track).T
    times = np.cumsum(steps)
    result = ft.AlphaBetaTracker(ft.FixedGains(*gains)).run(times, plots)
    expected = literal_tracker(times, plots, *gains)
    np.testing.assert_allclose(result.predicted, expected, rtol=1e-9, atol=1e-6)


def test_the_prediction_has_the_transfer_function_of_the_report():
    """Eq. 2.7: G(z) = ((α+β)z - α)/(z² + (α+β-2)z + 1-α), from plot to next prediction."""
    alpha, beta = 0.5, 0.7
    plots = np.zeros(40)
    plots[3] = 1.0  # an impulse after the start
    result = ft.AlphaBetaTracker(ft.FixedGains(alpha, beta)).run(np.arange(40), plots)
    impulse = np.zeros(37)
    impulse[0] = 1.0
    response = lfilter([0, alpha + beta, -alpha], [1, alpha + beta - 2, 1 - alpha], impulse)
    np.testing.assert_allclose(result.predicted[3:], response, atol=1e-12)


def test_a_straight_track_is_followed_without_error():
    times = np.cumsum([0.0, 1.0, 0.5, 2.0, 1.5, 1.0])
    plots = np.stack([3.0 + 2.0 * times, -1.0 - 0.5 * times], axis=-1)
    result = ft.AlphaBetaTracker(FIXED).run(times, plots)
    np.testing.assert_allclose(result.predicted[2:], plots[2:], atol=1e-12)
    np.testing.assert_allclose(result.velocity[1:], [[2.0, -0.5]] * 5, atol=1e-12)


def test_one_point_start_with_unit_gains_is_the_two_point_start():
    @dataclass(frozen=True)
    class UnitAtFirst(GainScheduler):
        def initial_memory(self, n_axes):
            return (0.0,)

        def kernel(self, n_axes):
            def unit_at_first(innovation, change, dt, sigma, memory):
                first = memory[0] == 0.0
                return (1.0 if first else 0.5), (1.0 if first else 0.2), 0.0, 1.0, (1.0,)

            return unit_at_first

    plots = [0.0, 10.0, 19.0, 31.0, 44.0]
    one = ft.AlphaBetaTracker(UnitAtFirst(), start="one-point").run(np.arange(5), plots)
    two = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2)).run(np.arange(5), plots)
    np.testing.assert_array_equal(one.predicted[2:], two.predicted[2:])
    assert one.predicted[1] == 0.0
    assert np.isnan(one.predicted[0])


@pytest.mark.parametrize(("missed", "dt"), [("elapsed", 3), ("step", 1)])
def test_missed_plots_are_coasted_and_beta_is_over_its_time_step(missed, dt):
    plots = np.array([0.0, 10.0, 20.0, np.nan, np.nan, 56.0, 60.0])
    result = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2), missed=missed).run(np.arange(7), plots)
    np.testing.assert_allclose(result.predicted[2:6], [20, 30, 40, 50])
    np.testing.assert_array_equal(result.coasted, [0, 0, 0, 1, 1, 0, 0])
    np.testing.assert_allclose(result.filtered[3:6], [30, 40, 53])
    assert result.velocity[5] == pytest.approx(10 + 0.2 * 6 / dt)
    assert np.isnan(result.gains.alpha[3])
    assert np.isnan(result.innovation[3])


@pytest.mark.parametrize(
    ("gains", "gap", "stable"),
    [
        ((0.5, 0.2), 14, True),
        ((0.5, 0.2), 16, False),
        ((0.9, 1.0), 2, True),
        ((0.9, 1.0), 3, False),
    ],
)
def test_how_long_gaps_may_be(gains, gap, stable):
    """One plot is seen in every g steps: with β over one step stable while 2α + gβ < 4."""
    alpha, beta = gains
    assert (2 * alpha + gap * beta < 4) == stable
    plots = np.full(300 * gap, np.nan)
    plots[::gap] = np.random.default_rng(1).normal(size=300)
    plots[1] = 0.0
    times = np.arange(float(len(plots)))
    by_step = ft.AlphaBetaTracker(ft.FixedGains(alpha, beta), missed="step").run(times, plots)
    assert (np.abs(by_step.filtered[-gap:]).max() < 1e3) == stable
    elapsed = ft.AlphaBetaTracker(ft.FixedGains(alpha, beta)).run(times, plots)
    assert np.abs(elapsed.filtered[-gap:]).max() < 1e3


@pytest.mark.parametrize(
    ("gains", "ratio", "stable"),
    [
        ((0.5, 0.2), 20.0, True),
        ((0.5, 0.2), 23.0, False),
        ((0.543, 0.548), 6.0, True),
        ((0.543, 0.548), 7.0, False),
    ],
)
def test_how_different_time_steps_may_be(gains, ratio, stable):
    times = np.cumsum(np.tile([1.0, ratio], 600))
    plots = np.random.default_rng(1).normal(size=len(times))
    with nullcontext() if stable else pytest.warns(ft.TrackWarning):
        found = ft.AlphaBetaTracker(ft.FixedGains(*gains)).run(times, plots)
    assert (np.abs(found.filtered[-2:]).max() < 1e4) == stable


def test_the_start_waits_for_plots():
    plots = [np.nan, 4.0, np.nan, np.nan, 10.0, 12.0]
    result = ft.AlphaBetaTracker(FIXED).run([0, 1, 2, 4, 5, 6], plots)
    np.testing.assert_array_equal(result.filtered[:5], [np.nan, 4, 4, 4, 10])
    assert np.isnan(result.predicted[:5]).all()
    # 6 m in the 4 s since the first plot
    assert result.predicted[5] == pytest.approx(11.5)


@pytest.mark.parametrize(("missed", "dt"), [("elapsed", 3.0), ("step", 1.0)])
def test_the_change_of_observation_spans_the_gap(missed, dt):
    @dataclass(frozen=True)
    class Spy(GainScheduler):
        seen: list = field(default_factory=list, compare=False)

        def kernel(self, n_axes):
            seen = self.seen

            def spy(innovation, change, dt, sigma, memory):
                seen.append((innovation, change, dt, sigma))
                return 0.5, 0.2, 0.0, 1.0, memory

            return spy

    spy = Spy()
    ft.AlphaBetaTracker(spy, missed=missed).run([0, 1, 3, 4], [0.0, 1.0, np.nan, 6.0], [1, 2, 3, 4])
    assert spy.seen[-1] == (2.0, 5.0, dt, 4.0)
    # Missed plots and the start are asked with harmless numbers, never with NaN.
    assert spy.seen[:3] == [(0.0, 0.0, 1.0, 1.0), (0.0, 0.0, 1.0, 1.0), (0.0, 0.0, 2.0, 1.0)]


@dataclass(frozen=True)
class Leaky(GainScheduler):
    """Retention times in turn, each for the acceleration after one plot."""

    times: tuple
    uses_retention: bool = True
    sees_starts: bool = True

    def initial_memory(self, n_axes):
        return (0.0,)

    def kernel(self, n_axes):
        times, count = self.times, float(len(self.times))

        def leaky(innovation, change, dt, sigma, memory):
            turn, following = memory[0], memory[0] + 1.0
            retention = times[0]
            for k, time in enumerate(times):
                retention = time if turn == k else retention
            return 0.5, 0.4, 0.2, retention, (following if following < count else 0.0,)

        return leaky


@pytest.mark.parametrize("missed", ["elapsed", "step"])
def test_the_acceleration_decays_until_the_next_prediction(missed):
    retention = (2.0, np.inf, 0.5)
    times = np.array([0.0, 1.0, 1.5, 4.0, 4.5, 6.0, 9.0])
    plots = np.array([0.0, 1.0, 4.0, np.nan, 20.0, 31.0, 70.0])
    tracker = ft.AlphaBetaTracker(Leaky(retention), missed=missed)
    result = tracker.run(times, plots)

    def faded(x):
        return 1 / (1 + x + x**2 / 2)

    # At the second plot velocity is 1 m/s; both plots of the start have been counted.
    x, v, a, last, turn, tau = 1.0, 1.0, 0.0, times[1], 2, retention[1]
    for k in range(2, len(times)):
        dt = times[k] - last
        decayed = a * faded(dt / tau)
        predicted, moving = x + v * dt + decayed * dt * dt / 2, v + decayed * dt
        assert result.predicted[k] == pytest.approx(predicted, rel=1e-12)
        seen = not np.isnan(plots[k])
        e = plots[k] - predicted if seen else 0.0
        now = (
            predicted + 0.5 * e,
            moving + 0.4 / dt * e,
            decayed + 0.2 / (2 * dt * dt) * e,
        )
        shown = result.filtered[k], result.velocity[k], result.acceleration[k]
        assert shown == pytest.approx(now, rel=1e-12)
        if seen or missed == "step":
            (x, v, a), last = now, times[k]
            # The memory is kept, and the retention time that of the last plot.
            tau, turn = retention[turn % 3] if seen else tau, turn + 1

    assert tracker.retention_time(result.state) == tau
    state = tracker.start(plots[0], times[0])
    for z, t in zip(plots[1:], times[1:], strict=True):
        state = tracker.step(state, z, t)
    np.testing.assert_array_equal(state.lanes, result.state.lanes)
    batch = np.repeat(plots[:, None, None], 40_000, axis=1)
    np.testing.assert_array_equal(tracker.run(times, batch).predicted[:, 7, 0], result.predicted)


def test_retention_times_are_shaped_as_plots():
    plots = np.cumsum(np.ones((5, 3, 2)), axis=0)
    plots[3, 1, 1] = np.nan
    for covariance in (None, 1.0):
        tracker = ft.AlphaBetaTracker(Leaky((2.0, np.inf, 0.5)), covariance=covariance)
        # An axis with a plot less is one turn behind.
        found = tracker.retention_time(tracker.run(np.arange(5.0), plots, 1.0).state)
        np.testing.assert_array_equal(found, [[np.inf, np.inf], [np.inf, 2.0], [np.inf, np.inf]])
    together = ft.AlphaBetaTracker(ft.FuzzyScheduler("maneuver", level=5.0))
    assert together.coupled
    state = together.run(np.arange(5.0), plots, 1.0).state
    found = together.retention_time(state)
    assert found.shape == (3, 2)
    np.testing.assert_array_equal(found[:, 0], found[:, 1])
    assert (found > 0.0).all()
    fixed = ft.AlphaBetaTracker(FIXED)
    assert fixed.retention_time(fixed.start(1.0, 0.0)) == np.inf


@pytest.mark.parametrize("state", [None, "state", 3.0])
def test_a_step_needs_a_state(state):
    with pytest.raises(TypeError, match="state must be a TrackState, got"):
        ft.AlphaBetaTracker(FIXED).step(state, 1.0, 1.0)
    with pytest.raises(TypeError, match="state must be a TrackState, got"):
        ft.AlphaBetaTracker(FIXED).predict(state, 1.0)


def test_without_retention_the_fourth_number_is_not_used():
    given = Leaky((2.0, np.inf, 0.5), uses_retention=False)
    result = ft.AlphaBetaTracker(given).run(range(5), [0.0, 1.0, 4.0, 9.0, 20.0])
    kept = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.4, 0.2)).run(
        range(5), [0.0, 1.0, 4.0, 9.0, 20.0]
    )
    np.testing.assert_array_equal(result.predicted, kept.predicted)


def test_a_coupled_scheduler_misses_a_plot_with_a_coordinate_missing():
    scheduler = ft.FuzzyScheduler(ft.load_rulebase("chan-style"))
    plots = np.array([[0, 0], [1, 1], [2, 2.5], [3, np.nan], [4, 4.0]])
    result = ft.AlphaBetaTracker(scheduler).run(range(5), plots)
    assert result.coasted[3].all()
    assert result.gains.alpha.shape == plots.shape
    np.testing.assert_array_equal(result.gains.alpha[4, 0], result.gains.alpha[4, 1])
    alone = ft.AlphaBetaTracker(FIXED).run(range(5), plots)
    np.testing.assert_array_equal(alone.coasted[3], [False, True])


shapes = st.tuples(st.integers(1, 12), st.integers(1, 3), st.integers(1, 3))


@settings(max_examples=30)
@given(data=st.data())
def test_streaming_resuming_and_chunks_agree_to_the_last_bit(data):
    shape = data.draw(shapes)
    elements = st.one_of(st.floats(-1e4, 1e4), st.just(np.nan))
    plots = data.draw(npst.arrays(np.float64, shape, elements=elements))
    steps = data.draw(npst.arrays(np.float64, shape[0], elements=st.floats(0.1, 10)))
    times = np.cumsum(steps)
    name = data.draw(st.sampled_from(["stiffness-damping", "chan-style"]))
    tracker = ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase(name)))
    whole = tracker.run(times, plots)

    state = tracker.start(plots[0], times[0])
    for z, t in zip(plots[1:], times[1:], strict=True):
        state = tracker.step(state, z, t)
    np.testing.assert_array_equal(state.position, whole.filtered[-1])
    np.testing.assert_array_equal(state.lanes, whole.state.lanes)

    cut = data.draw(st.integers(0, shape[0]))
    head = tracker.run(times[:cut], plots[:cut])
    tail = tracker.run(times[cut:], plots[cut:], state=head.state)
    for name in ("predicted", "filtered", "velocity", "innovation"):
        joined = np.concatenate([getattr(head, name), getattr(tail, name)])
        np.testing.assert_array_equal(joined, getattr(whole, name))


def test_a_large_batch_runs_compiled_with_the_same_numbers():
    random = np.random.default_rng(5)
    plots = np.cumsum(random.normal(size=(30, 3500, 2)), axis=0) * 10
    plots[random.random(plots.shape) < 0.1] = np.nan
    times = np.cumsum(random.uniform(0.5, 2, (30, 3500)), axis=0)
    tracker = ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("stiffness-damping")))
    batch = tracker.run(times, plots)  # 210,000 updates: above the limit
    for track in (0, 247, 248, 3499):
        alone = tracker.run(times[:, track], plots[:, track])
        np.testing.assert_array_equal(alone.predicted, batch.predicted[:, track])
        np.testing.assert_array_equal(alone.gains.beta, batch.gains.beta[:, track])


def test_state_is_a_value():
    tracker = ft.AlphaBetaTracker(FIXED)
    state = tracker.start([0.0, 0.0], 0.0)
    later = tracker.step(state, [1.0, 2.0], 1.0)
    copy = pickle.loads(pickle.dumps(later))
    one, other = tracker.step(later, [2.0, 4.5], 2.0), tracker.step(copy, [2.0, 4.5], 2.0)
    np.testing.assert_array_equal(one.position, other.position)
    np.testing.assert_array_equal(state.position, [0.0, 0.0])
    assert later.shape == (2,)
    assert later.time == 1.0
    lone = tracker.start(0.0, 0.0)
    lone.position[...] = 5.0
    assert lone.position == 0.0
    with pytest.raises(TypeError, match="state must be a TrackState, got int"):
        tracker.run([0.0], [1.0], state=3)


def test_empty_and_single():
    tracker = ft.AlphaBetaTracker(FIXED)
    assert tracker.run([], np.empty((0, 2))).state is None
    assert tracker.run([1.0], [[3.0, 4.0]]).filtered.tolist() == [[3.0, 4.0]]
    assert tracker.run([1.0, 2.0], np.empty((2, 0, 2))).filtered.shape == (2, 0, 2)
    state = tracker.run([1.0], [3.0]).state
    assert tracker.run([], [], state=state).state is state


@pytest.mark.parametrize(
    ("times", "plots", "sigma", "error", "message"),
    [
        ([0, 1], [0, np.inf], None, ft.DataError, r"infinite plot at index \(1,\)"),
        ([0, 0], [0, 1], None, ft.DataError, r"at index 1 \(0\.0 s\) is not later"),
        ([0, np.nan], [0, 1], None, ft.DataError, "time at index 1 is not finite"),
        (
            [0, 1, 2],
            [0, 1],
            None,
            ValueError,
            r"t: shape \(3,\) does not fit .* \(2,\)",
        ),
        ([0, 1], [0, 1], -1.0, ValueError, r"sigma must be positive .* index \(0,\) it is -1"),
        ([0, 1], [0, 1], [1, 2, 3], ValueError, r"sigma: shape \(3,\) does not broadcast"),
        (0.0, 1.0, None, ValueError, "needs a time axis"),
        ([0, 1], np.empty((2, 0)), None, ValueError, "at least one axis of space"),
        (
            [[0, 100.0], [1, 200], [2, 150]],
            np.zeros((3, 2, 1)),
            None,
            ft.DataError,
            r"the one at index \(2, 1\) \(150\.0 s\) is not later",
        ),
        (
            np.array(["2026-01-01", "2026-01-02"], "datetime64"),
            [0, 1],
            None,
            ValueError,
            r"t: needs seconds as real numbers, got datetime64\[D\]",
        ),
        ([0, 1], [0, 1j], None, ValueError, "z: needs real numbers, got complex128"),
    ],
)
def test_bad_input_is_named(times, plots, sigma, error, message):
    with pytest.raises(error, match=message):
        ft.AlphaBetaTracker(FIXED).run(times, plots, sigma)


def test_a_state_goes_on_later_and_with_plots_of_its_shape():
    tracker = ft.AlphaBetaTracker(FIXED)
    state = tracker.start([0.0, 0.0], 5.0)
    with pytest.raises(ft.DataError, match=r"not later than that of the state \(5.0 s\)"):
        tracker.step(state, [0.0, 0.0], 5.0)
    with pytest.raises(ValueError, match="do not go on from a state of shape"):
        tracker.step(state, [0.0, 0.0, 0.0], 6.0)
    other = ft.AlphaBetaTracker(ft.FuzzyScheduler(ft.load_rulebase("stiffness-damping")))
    with pytest.raises(ValueError, match=r"state: it comes from AlphaBetaTracker\(FixedGains"):
        other.step(state, [0.0, 0.0], 6.0)


@pytest.mark.parametrize("compiled", [False, True])
def test_tracks_of_their_own_times_go_on_with_common_ones(compiled):
    tracker = ft.AlphaBetaTracker(FIXED)
    if compiled:
        tracker.compile()
    times = np.arange(3.0)[:, None] + [0.0, 0.1]
    plots = np.random.default_rng(1).normal(size=(5, 2, 2))
    state = tracker.run(times, plots[:3]).state
    later = np.array([5.0, 6.5])
    expected = tracker.run(np.stack([later, later], axis=1), plots[3:], state=state)
    together = tracker.run(later, plots[3:], state=state)
    stepped = tracker.step(tracker.step(state, plots[3], 5.0), plots[4], 6.5)
    for found in (together.state, stepped):
        np.testing.assert_array_equal(found.lanes, expected.state.lanes)
        np.testing.assert_array_equal(found.time, [6.5, 6.5])


@pytest.mark.parametrize("compiled", [False, True])
def test_a_mask_is_a_missed_plot(compiled):
    tracker = ft.AlphaBetaTracker(FIXED)
    if compiled:
        tracker.compile()
    plots = np.ma.array([[0.0], [1.0], [999.0], [3.0]], mask=[[0], [0], [1], [0]])
    expected = tracker.run(range(4), [[0.0], [1.0], [np.nan], [3.0]])
    np.testing.assert_array_equal(tracker.run(range(4), plots).filtered, expected.filtered)
    state = tracker.start(plots[0], 0.0)
    for k in range(1, 4):
        state = tracker.step(state, plots[k], float(k))
    np.testing.assert_array_equal(state.lanes, expected.state.lanes)
    assert np.isnan(tracker.start(np.ma.masked, 0.0).position)


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize(
    "plot", [np.datetime64("2020-01-01"), np.timedelta64(5, "s"), np.complex128(1.0), 1j]
)
def test_plots_that_are_no_numbers(compiled, plot):
    # Equal trackers share compiled code.
    tracker = ft.AlphaBetaTracker(ft.FixedGains(0.55 if compiled else 0.54, 0.25))
    if compiled:
        tracker.compile()
    for z, start in (plot, 0.0), ([plot, plot], [0.0, 0.0]):
        with pytest.raises(ValueError, match="z: needs real numbers, got "):
            tracker.step(tracker.start(start, 0.0), z, 1.0)


@pytest.mark.parametrize("compiled", [False, True])
def test_whole_numbers_are_plots(compiled):
    # Equal trackers share compiled code.
    tracker = ft.AlphaBetaTracker(ft.FixedGains(0.55 if compiled else 0.54, 0.25))
    if compiled:
        tracker.compile()
    state = tracker.run([0, 1], [[0, 4], [2, 3]]).state
    whole, same = tracker.step(state, [5, 7], 3), tracker.step(state, [5.0, 7.0], 3.0)
    np.testing.assert_array_equal(whole.lanes, same.lanes)


@pytest.mark.untraced
def test_many_shapes_of_scans_do_not_pile_up():
    tracker = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.25))
    tracker.compile()
    for tracks in range(1, 150):
        state = tracker.start(np.zeros((tracks, 1)), 0.0)
        tracker.step(state, np.zeros((tracks, 1)), 1.0)
    assert len(tracker._compiled_steps) == 1


def test_a_state_does_not_share_its_time_with_the_caller():
    now = np.array([1.0, 2.0])
    state = ft.AlphaBetaTracker(FIXED).start(np.zeros((2, 1)), now)
    now += 5.0
    assert state.time.tolist() == [1.0, 2.0]


def test_sigma_may_be_missing_where_the_plot_is():
    tracker = ft.AlphaBetaTracker(FIXED)
    result = tracker.run(range(3), [0.0, np.nan, 1.0], [1.0, np.nan, 1.0])
    assert np.isfinite(result.filtered).all()


def test_arguments_of_the_tracker():
    with pytest.raises(ValueError, match="n_axes must be at least 1, got 0"):
        ft.AlphaBetaTracker(FIXED).compile(0)
    with pytest.raises(TypeError, match=r"scheduler must be a GainScheduler, or a .*got float"):
        ft.AlphaBetaTracker(0.5)
    with pytest.raises(ValueError, match="start: unknown 'three-point'; one of two-point"):
        ft.AlphaBetaTracker(FIXED, start="three-point")
