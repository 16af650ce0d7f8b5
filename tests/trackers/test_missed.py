"""Rows without a plot and rows left out are the same, to the last bit, however tracks are run."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import fuzzytrack as ft
from fuzzytrack.lanes.layout import BLOCK, GAINS, OUTPUTS
from fuzzytrack.schedulers import KalmanCA, KalmanCV, QualityGains
from fuzzytrack.trackers import InteractingPair, ParallelBank
from fuzzytrack.trackers.runners import runner

pytestmark = pytest.mark.untraced

SIGMA = 7.0
TRACKS, AXES = 3, 2
# Numbers of other tests where they do not matter, so that code is compiled once for all of them.
TRACKERS = {
    "fixed": ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2, 0.05)),
    "kalman-cv": ft.AlphaBetaTracker(KalmanCV(0.5, velocity_sigma=20.0), "one-point"),
    "kalman-ca": ft.AlphaBetaTracker(KalmanCA(0.5, 1.0, 10.0)),
    "omega-schedule": ft.AlphaBetaTracker("omega-schedule"),
    "bank": ParallelBank(members=4, selection="best"),
    "imm": InteractingPair(0.2, 3.0),
}
#: The bank and the interacting models work with numbers that single precision lacks.
IN_SINGLE = ("fixed", "kalman-cv", "kalman-ca", "omega-schedule")


@st.composite
def recordings(draw):
    """Irregular times, plots of which any may be missing, and where the recording is cut."""
    steps = draw(st.integers(1, 14))
    dts = draw(st.lists(st.floats(0.05, 20.0), min_size=steps, max_size=steps))
    times = draw(st.sampled_from([0.0, -3e5, 1e9])) + np.cumsum(dts)
    shape = (steps, TRACKS, AXES)
    plots = np.random.default_rng(steps).normal(0.0, 30.0, shape).cumsum(axis=0)
    # Rows in which every track has its plot are run in another way.
    gaps = draw(arrays(bool, (steps, 1, 1)))
    plots[draw(arrays(bool, shape)) & gaps] = np.nan
    cuts = sorted(draw(st.sets(st.integers(1, max(1, steps - 1)))) & set(range(1, steps)))
    return times, plots, list(itertools.pairwise([0, *cuts, steps]))


def outputs_of(rows, lanes):
    """What lanes after a step show, as the outputs of a run of one row."""
    shown = {name: lanes[rows.shown(name) :] for name in OUTPUTS}
    return {
        name: part[:1] if name in GAINS else part[: rows.n_axes].T[None]
        for name, part in shown.items()
    }


def joined(parts):
    return {name: np.concatenate([part[name] for part in parts]) for name in OUTPUTS}


def in_parts(core, lanes, times, ends, native):
    """Outputs and the last lanes of a run that goes on from part to part."""
    after, parts = None, []
    for begin, end in ends:
        sigma = np.full((1, 1, 1), SIGMA)
        after, outputs = core(after, lanes[begin:end], times[begin:end], sigma, native)
        parts.append(outputs)
    return joined(parts), after


def streamed(core, lanes, times):
    """The same from single steps in plain Python."""
    count, n_axes = lanes.shape[1:]
    after, parts = core.fresh(count), []
    for z, t in zip(lanes, np.broadcast_to(times, lanes.shape[:2]).tolist(), strict=True):
        after = core.step(after, z, t, [[SIGMA] * n_axes] * count)
        parts.append(outputs_of(core.rows, after))
    return joined(parts), after


def streamed_compiled(tracker, core, plots, times):
    """The same from compiled single steps; times are common or each track's own."""
    tracker.compile(AXES)
    common = times.shape[1] == 1
    given_times = times[:, 0].tolist() if common else list(times[:, :: times.shape[1] // TRACKS])
    state = tracker.start(plots[0], given_times[0], SIGMA)
    parts = [outputs_of(core.rows, state.lanes)]
    for z, t in zip(plots[1:], given_times[1:], strict=True):
        state = tracker.step(state, z, t, SIGMA)
        parts.append(outputs_of(core.rows, state.lanes))
    return joined(parts), state.lanes


def alone(core, lanes, times, native):
    """Of every lane its rows that have a plot, and the run of these rows alone."""
    for lane in range(lanes.shape[1]):
        rows = ~np.isnan(lanes[:, lane]).any(axis=1)
        part, sigma = lanes[rows, lane : lane + 1], np.full((1, 1, 1), SIGMA)
        own = np.broadcast_to(times, lanes.shape[:2])[rows, lane : lane + 1]
        after, outputs = core(None, part, own, sigma, native)
        yield lane, rows, outputs, after


def assert_left_out(core, found, expected):
    outputs, after = found
    kept = [*range(core.rows.state), core.rows.last_time]
    for lane, rows, own, own_after in expected:
        for name in OUTPUTS:
            ours, theirs = outputs[name][:, lane], own[name][:, 0]
            np.testing.assert_array_equal(ours[rows], theirs, err_msg=name)
        np.testing.assert_array_equal(after[kept, lane], own_after[kept, 0])
        coasting = outputs["filtered"][~rows, lane]
        predicted = outputs["predicted"][~rows, lane]
        known = ~np.isnan(predicted)
        np.testing.assert_array_equal(coasting[known], predicted[known])
        assert np.isnan(outputs["innovation"][~rows, lane]).all()


def common_and_own(times, lanes):
    """Times of all lanes, and times that differ from track to track."""
    scale = np.repeat(1.0 + 0.1 * np.arange(TRACKS), lanes.shape[1] // TRACKS)
    return times[:, None], (times - times[0])[:, None] * scale + times[0]


@pytest.mark.parametrize("name", TRACKERS)
@settings(max_examples=20)
@given(recording=recordings())
def test_rows_without_a_plot_are_as_rows_left_out(name, recording):
    times, plots, ends = recording
    tracker = TRACKERS[name]
    core = runner(tracker, AXES if tracker.coupled else 1)
    lanes = plots.reshape(len(plots), -1, AXES if tracker.coupled else 1)
    for given_times in common_and_own(times, lanes):
        expected = list(alone(core, lanes, given_times, native=False))
        for parts, native in itertools.product(([(0, len(times))], ends), (False, True)):
            assert_left_out(core, in_parts(core, lanes, given_times, parts, native), expected)
        assert_left_out(core, streamed(core, lanes, given_times), expected)
        assert_left_out(core, streamed_compiled(tracker, core, plots, given_times), expected)


@pytest.mark.parametrize("name", IN_SINGLE)
@settings(max_examples=20)
@given(recording=recordings())
def test_in_single_precision_too(name, recording):
    times, plots, ends = recording
    core = runner(TRACKERS[name], 1)
    lanes = plots.reshape(len(plots), -1, 1).astype(np.float32)
    for given_times in common_and_own(times, lanes):
        expected = list(alone(core, lanes, given_times, native=True))
        for parts in ([(0, len(times))], ends):
            assert_left_out(core, in_parts(core, lanes, given_times, parts, True), expected)


@pytest.mark.parametrize("name", ["fixed", "imm"])
def test_more_tracks_than_a_block_takes(name):
    random = np.random.default_rng(5)
    tracker, steps = TRACKERS[name], 25
    n_axes = AXES if tracker.coupled else 1
    core = runner(tracker, n_axes)
    lanes = random.normal(0.0, 30.0, (steps, 2 * BLOCK + 3, n_axes)).cumsum(axis=0)
    # One block has gaps of its own, the last one is never whole, and rows between are.
    lanes[4:6, BLOCK - 1], lanes[9, BLOCK : BLOCK + 40], lanes[:, -1] = np.nan, np.nan, np.nan
    lanes[random.random(lanes.shape[:2]) < np.where(np.arange(steps) > 12, 0.2, 0.0)[:, None]] = (
        np.nan
    )
    times = np.cumsum(random.uniform(0.3, 4.0, steps))
    sigma = np.full((1, 1, 1), SIGMA)
    after, outputs = core(None, lanes, times[:, None], sigma, True, threads=2)
    some = [0, BLOCK - 1, BLOCK, BLOCK + 39, BLOCK + 40, 2 * BLOCK + 1, 2 * BLOCK + 2]
    part = {name: values[:, some] for name, values in outputs.items()}
    expected = list(alone(core, lanes[:, some], times[:, None], native=False))
    assert_left_out(core, (part, after[:, some]), expected)
    assert np.isnan(part["filtered"][:, -1]).all()


@pytest.mark.parametrize("name", TRACKERS)
def test_a_prediction_leaves_no_trace(name):
    """The state at the last plot is jumped from, whatever rows and predictions came between."""
    tracker, random = TRACKERS[name], np.random.default_rng(8)
    times = np.cumsum(random.uniform(0.3, 4.0, 12))
    plots = random.normal(0.0, 30.0, (12, TRACKS, AXES)).cumsum(axis=0)
    state = tracker.run(times, plots, SIGMA).state
    coasted = tracker.step(state, np.full((TRACKS, AXES), np.nan), times[-1] + 2.5, SIGMA)
    before = state.lanes.copy(), coasted.lanes.copy()
    for later in (2.6, 30.0):
        one, other = (tracker.predict(s, times[-1] + later, SIGMA) for s in (state, coasted))
        for quantity in ("position", "velocity", "acceleration", "position_variance"):
            np.testing.assert_array_equal(getattr(one, quantity), getattr(other, quantity))
    np.testing.assert_array_equal(state.lanes, before[0])
    np.testing.assert_array_equal(coasted.lanes, before[1])
    assert (coasted.time, state.time) == (times[-1] + 2.5, times[-1])
    assert (coasted.position != state.position).all()


def test_who_counts_misses_is_the_exception():
    """Rows without a plot lower a track's quality, and only the gains tell of it."""
    tracker = ft.AlphaBetaTracker(QualityGains())
    times, plots = np.arange(12.0), np.random.default_rng(3).normal(0.0, 30.0, 12)
    plots[6:9] = np.nan
    rows = ~np.isnan(plots)
    with_rows, without = tracker.run(times, plots), tracker.run(times[rows], plots[rows])
    np.testing.assert_array_equal(with_rows.predicted[rows][:7], without.predicted[:7])
    assert (with_rows.gains.alpha[9:] > without.gains.alpha[6:]).all()


def test_by_steps_a_missed_plot_counts():
    """Then the velocity gain β/T has the T of the step, and not the whole gap."""
    times, plots = [0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 10.0, np.nan, np.nan, 43.0]
    for missed, velocity in (("elapsed", 10 + 0.2 / 3 * 3), ("step", 10 + 0.2 / 1 * 3)):
        result = ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2), missed=missed).run(times, plots)
        np.testing.assert_array_equal(result.predicted, [np.nan, np.nan, 20.0, 30.0, 40.0])
        assert result.velocity[-1] == pytest.approx(velocity, rel=1e-14)
    with pytest.raises(ValueError, match="missed: unknown 'late'; one of elapsed, step"):
        ft.AlphaBetaTracker(ft.FixedGains(0.5, 0.2), missed="late")
