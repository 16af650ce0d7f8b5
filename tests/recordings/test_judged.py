"""Plots judged by the prediction of their track: in blocks as one by one."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import Phase, example, given, settings
from hypothesis import strategies as st

from fuzzytrack import AlphaBetaTracker, DataError, FixedGains
from fuzzytrack.recordings.judge import Circle, Gate, Judge, JudgeMemory
from fuzzytrack.recordings.judged import run_judged
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.tuning import VARIANTS
from fuzzytrack.tuning.scored_plots import scored_plots

pytestmark = pytest.mark.filterwarnings("ignore::fuzzytrack.TrackWarning")

FIXED = AlphaBetaTracker(FixedGains(0.5, 0.2))
TRACKERS = {
    "fixed": FIXED,
    "fixed, steps": AlphaBetaTracker(FixedGains(0.5, 0.2), missed="step"),
    "stiffness-damping": make_tracker("stiffness-damping"),
    "kalman": make_tracker("kalman-cv:sigma_v=1"),
    "maneuver": make_tracker("maneuver"),
    "chan-style": make_tracker("chan-style"),
    "imm": make_tracker("imm:quiet_sigma=0.1:maneuver_sigma=2"),
    "imm-three": make_tracker("imm-three"),
    "window-search": make_tracker("window-search:window=3"),
}
GATE = Judge(Gate())
# A failure that takes minutes to make smaller is no help.
NO_SHRINKING = [Phase.explicit, Phase.reuse, Phase.generate]
OUTPUTS = ("predicted", "filtered", "velocity", "acceleration", "innovation")


class OneByOne:
    """A track whose plots are judged and used one after the other, as the definition says."""

    def __init__(self, tracker, judge, n_axes):
        self.tracker, self.judge, self.n_axes = tracker, judge, n_axes
        self.state = None
        self.restart()

    def restart(self):
        self.state, self.in_a_row = None, 0
        self.first, self.last, self.count, self.error = ([0.0] * self.n_axes for _ in range(4))

    def step(self, t, z, sigma):
        """State, plot as used, whether it was rejected, whether it began the track again."""
        predicted = np.full(self.n_axes, math.nan)
        if self.state is not None:
            predicted = self.tracker.predict(self.state, t).position
        plot = self.turned(z, predicted)
        rejected = begins = False
        if self.judge.gate is not None and self.is_far(t, plot, predicted, sigma):
            if self.in_a_row >= self.judge.gate.again:
                begins = True
                self.restart()
                plot = z.copy()
                predicted = np.full(self.n_axes, math.nan)
            else:
                rejected = True
                self.in_a_row += 1
                plot = np.full(self.n_axes, math.nan)
        for axis in range(self.n_axes):
            if plot[axis] == plot[axis]:
                size = abs(plot[axis] - predicted[axis])
                self.error[axis] = size if self.count[axis] >= 2 and size == size else 0.0
                if not self.count[axis]:
                    self.first[axis] = t
                self.last[axis] = t
                self.count[axis] += 1
        if not np.isnan(plot).all():
            self.in_a_row = 0
        if self.state is None:
            self.state = self.tracker.start(plot, t, sigma)
        else:
            self.state = self.tracker.step(self.state, plot, t, sigma)
        return self.state, plot, rejected, begins

    def turned(self, z, predicted):
        if self.judge.circle is None:
            return z.copy()
        period = self.judge.circle.period
        turns = [
            round((p - x) / period) if p - x == p - x else 0
            for p, x in zip(predicted, z, strict=True)
        ]
        return np.array([x + period * n for x, n in zip(z.tolist(), turns, strict=True)])

    def is_far(self, t, plot, predicted, sigma):
        far = False
        for axis in range(self.n_axes):
            if self.count[axis] >= 2:
                mean = (self.last[axis] - self.first[axis]) / (self.count[axis] - 1)
                growth = max(1.0, (t - self.last[axis]) / (2.0 * mean))
                limit = self.judge.gate.width * sigma[axis] * (growth * growth) + self.error[axis]
                far |= bool(abs(plot[axis] - predicted[axis]) > limit)
        return far


def check(tracker, t, z, sigma, judge, cuts=()):
    """Compare a run, and one in pieces, of tracks with plots one by one."""
    n, n_tracks, n_axes = z.shape
    sigmas = np.broadcast_to(sigma, z.shape)
    times = np.broadcast_to(t.reshape(n, -1), (n, n_tracks))
    found = run_judged(tracker, t, z, sigma, judge)
    pieces, state, memory = [], None, None
    edges = [0, *sorted(cuts), n]
    for a, b in pairwise(edges):
        piece = run_judged(tracker, t[a:b], z[a:b], sigmas[a:b], judge, state=state, memory=memory)
        state, memory = piece.result.state, piece.memory
        pieces.append(piece)
    for track in range(n_tracks):
        one = OneByOne(tracker, judge, n_axes)
        steps = zip(times[:, track].tolist(), z[:, track], sigmas[:, track], strict=True)
        states, plots, rejected, begins = zip(*(one.step(*step) for step in steps), strict=True)
        for name in ("predicted", "innovation", "velocity", "acceleration"):
            values = [getattr(state, name) for state in states]
            np.testing.assert_array_equal(getattr(found.result, name)[:, track], values, name)
        positions = [state.position for state in states]
        np.testing.assert_array_equal(found.result.filtered[:, track], positions)
        np.testing.assert_array_equal(found.result.measured[:, track], plots)
        np.testing.assert_array_equal(found.rejected[:, track], rejected)
        np.testing.assert_array_equal(found.begins[:, track], begins)
        np.testing.assert_array_equal(found.result.state.position[track], one.state.position)
        assert found.memory.rejected[track] == one.in_a_row
    for name in OUTPUTS:
        whole = np.concatenate([getattr(piece.result, name) for piece in pieces])
        np.testing.assert_array_equal(whole, getattr(found.result, name), name)
    for name in ("alpha", "beta", "gamma"):
        whole = np.concatenate([getattr(piece.result.gains, name) for piece in pieces])
        np.testing.assert_array_equal(whole, getattr(found.result.gains, name), name)
    np.testing.assert_array_equal(np.concatenate([p.rejected for p in pieces]), found.rejected)
    np.testing.assert_array_equal(np.concatenate([p.begins for p in pieces]), found.begins)
    np.testing.assert_array_equal(memory.numbers, found.memory.numbers)
    np.testing.assert_array_equal(state.lanes, found.result.state.lanes)
    return found


def spiky(seed, n, n_tracks, n_axes, share=0.1, missed=0.1):
    """Maneuvering tracks with gaps, spikes of all sizes, and times when the target has gone."""
    rng = np.random.default_rng(seed)
    steps = rng.uniform(0.2, 2.0, (n, n_tracks)) * 10 ** (rng.random((n, n_tracks)) < 0.03)
    t = np.cumsum(steps, axis=0)
    turn = rng.normal(size=(n_tracks, n_axes))
    z = 30 * np.sin(t[..., None] * 0.05 * turn) + 5 * t[..., None] * turn
    z += rng.normal(size=z.shape)
    spikes = rng.random((n, n_tracks)) < share
    z[spikes] += (rng.choice([-1, 1], z.shape) * 10 ** rng.uniform(0.5, 4, z.shape))[spikes]
    gone = rng.integers(0, n, n_tracks)
    for track in range(n_tracks):
        z[gone[track] :, track] += rng.choice([0.0, 300.0])
    z[rng.random(z.shape) < missed] = math.nan
    return t, z


# -------------------------------------------------------------------- as one by one


@pytest.mark.parametrize("n_axes", [1, 2])
@pytest.mark.parametrize("name", TRACKERS)
def test_trackers(name, n_axes):
    t, z = spiky(1, 60, 2, n_axes)
    found = check(TRACKERS[name], t, z, 1.0, GATE, [1, 2, 40, 41, 59])
    assert found.rejected.any()


def test_tracks_begin_again():
    found = [check(FIXED, *spiky(seed, 60, 2, 1, 0.3), 1.0, GATE) for seed in range(6)]
    assert sum(each.begins.sum() for each in found) > 3


@pytest.mark.untraced
@example(seed=1, n=6, n_tracks=2, share=0.7, again=0, cuts=[])
@example(seed=0, n=39, n_tracks=3, share=0.7, again=0, cuts=[])
@given(
    seed=st.integers(0, 10_000),
    n=st.integers(1, 40),
    n_tracks=st.integers(1, 4),
    share=st.sampled_from([0.0, 0.05, 0.3, 0.7]),
    again=st.integers(0, 4),
    cuts=st.lists(st.integers(0, 40), max_size=5),
)
@settings(max_examples=20, deadline=None, phases=NO_SHRINKING)
def test_any_spikes_gaps_and_cuts(seed, n, n_tracks, share, again, cuts):
    t, z = spiky(seed, n, n_tracks, 2, share)
    cuts = [min(cut, n) for cut in cuts]
    sigma = np.random.default_rng(seed).uniform(0.5, 2, z.shape)
    check(FIXED, t, z, sigma, Judge(Gate(8.0, again)), cuts)


@pytest.mark.untraced
@given(
    seed=st.integers(0, 10_000),
    rate=st.floats(-200, 200),
    gate=st.sampled_from([None, Gate(8.0)]),
    cuts=st.lists(st.integers(0, 50), max_size=4),
)
@settings(max_examples=20, deadline=None, phases=NO_SHRINKING)
def test_any_angles(seed, rate, gate, cuts):
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.2, 2.0, 50))
    z = rate * t[:, None, None] + rng.normal(size=(50, 2, 1))
    z[rng.random(z.shape) < 0.05] += 90
    z[rng.random(z.shape) < 0.1] = math.nan
    check(TRACKERS["kalman"], t, np.mod(z, 360), 1.0, Judge(gate, Circle()), cuts)


@pytest.mark.untraced
@pytest.mark.parametrize("length", [40, 33])
def test_blocks_of_any_length(length, monkeypatch):
    from fuzzytrack.recordings import judged

    monkeypatch.setattr(judged, "_FIRST", length)
    t, z = spiky(3, 400, 5, 2)
    found = run_judged(FIXED, t, z, 1.0, GATE)
    monkeypatch.setattr(judged, "_FIRST", 1000)
    other = run_judged(FIXED, t, z, 1.0, GATE)
    np.testing.assert_array_equal(found.result.filtered, other.result.filtered)
    np.testing.assert_array_equal(found.rejected, other.rejected)
    np.testing.assert_array_equal(found.memory.numbers, other.memory.numbers)


@pytest.mark.parametrize("shape", [(70,), (70, 1), (70, 2), (70, 3, 2), (70, 2, 3, 1)])
def test_shapes(shape):
    t = np.arange(70.0)
    z = np.random.default_rng(1).normal(size=shape) + t.reshape(-1, *(1,) * (len(shape) - 1))
    plain = FIXED.run(t, z, 1.0)
    spikes = z.copy()
    spikes[50] = math.nan
    for plots, expected in ((z, plain), (np.where(np.isnan(spikes), 1e9, z), FIXED.run(t, spikes))):
        found = run_judged(FIXED, t, plots, 1.0, GATE)
        assert found.rejected.shape == (shape[:-1] if len(shape) > 1 else shape)
        for name in OUTPUTS:
            np.testing.assert_array_equal(getattr(found.result, name), getattr(expected, name))
        assert found.result.state.shape == plain.state.shape
        np.testing.assert_array_equal(found.result.state.lanes, expected.state.lanes)
        after = FIXED.step(found.result.state, z[0], 71.0)
        np.testing.assert_array_equal(
            after.position, FIXED.step(expected.state, z[0], 71.0).position
        )


class NoLanes:
    """A tracker with the four methods alone."""

    def run(self, t, z, sigma=None):
        return FIXED.run(t, z, sigma)

    def start(self, z, t, sigma=None):
        return FIXED.start(z, t, sigma)

    def step(self, state, z, t, sigma=None):
        return FIXED.step(state, z, t, sigma)

    def predict(self, state, t, sigma=None):
        return FIXED.predict(state, t, sigma)


@pytest.mark.parametrize("n_tracks", [1, 3])
def test_trackers_without_lanes(n_tracks):
    t, z = spiky(4, 80, n_tracks, 2, 0.3)
    other, found = (run_judged(each, t, z, 1.0, GATE) for each in (NoLanes(), FIXED))
    np.testing.assert_array_equal(other.result.filtered, found.result.filtered)
    np.testing.assert_array_equal(other.begins, found.begins)
    np.testing.assert_array_equal(other.memory.numbers, found.memory.numbers)
    assert other.result.state is None
    with pytest.raises(ValueError, match="state: NoLanes is no LaneTracker"):
        run_judged(NoLanes(), t + 1e4, z, 1.0, GATE, state=found.result.state)


def test_no_plots():
    found = run_judged(FIXED, [], np.empty((0, 2)), 1.0, GATE)
    assert found.result.filtered.shape == (0, 2)
    assert found.result.state is None
    one = run_judged(FIXED, [1.0], [[3.0, math.nan]], 1.0, GATE)
    np.testing.assert_array_equal(one.result.filtered, [[3.0, math.nan]])
    again = run_judged(
        FIXED, [], np.empty((0, 2)), 1.0, GATE, state=one.result.state, memory=one.memory
    )
    assert again.result.state is one.result.state
    np.testing.assert_array_equal(again.memory.numbers, one.memory.numbers)
    assert not run_judged(FIXED, [0.0, 1.0], np.empty((2, 0, 2)), 1.0, GATE).rejected.size
    assert "rejected=0" in repr(one)


# -------------------------------------------------------------------- right


NAMES = ("maneuver", "stiffness-damping", "fixed", "kalman", "imm-three", "chan-style")


@pytest.mark.untraced
@pytest.mark.parametrize(
    ("kind", "missed"), [("constant T", 0.0), ("jitter", 0.0), ("jitter", 0.2)]
)
@pytest.mark.parametrize("name", ["report", "mixed", "strong"])
def test_targets_that_maneuver_lose_no_plots(name, kind, missed):
    plots = scored_plots(name, VARIANTS[kind], 30, 8)
    z = plots.z.copy()
    z[np.random.default_rng(2).random(z.shape[:2]) < missed] = math.nan
    for tracker in NAMES:
        found = run_judged(TRACKERS[tracker], plots.time, z, 1.0, GATE)
        # With missed plots it is less than 0.1 % of many tracks; these are few.
        assert found.rejected.mean() < (0.003 if missed else 0.001), tracker
        assert missed or not found.begins.any()


@pytest.mark.untraced
@pytest.mark.parametrize("kind", ["constant T", "jitter"])
@pytest.mark.parametrize("name", ["report", "mixed", "strong"])
def test_spikes_are_rejected(name, kind):
    plots, rng = scored_plots(name, VARIANTS[kind], 30, 9), np.random.default_rng(3)
    spikes = rng.random(plots.z.shape[:2]) < 0.02
    # Those at a start are another matter.
    spikes[:4] = False
    z = plots.z + np.where(spikes, 50 * rng.choice([-1, 1], spikes.shape), 0)[..., None]
    for tracker in NAMES:
        found = run_judged(TRACKERS[tracker], plots.time, z, 1.0, GATE)
        assert (found.rejected & spikes).sum() >= 0.97 * spikes.sum(), tracker
        assert (found.rejected & ~spikes).mean() < 0.002, tracker


@pytest.mark.parametrize("size", [50.0, 500.0, 1e6])
@pytest.mark.parametrize("wrong", [0, 1, 2])
@pytest.mark.parametrize("name", NAMES)
def test_a_wrong_plot_at_the_start(name, wrong, size):
    t, rng = np.arange(40.0), np.random.default_rng(4)
    truth = 5 * t
    z = truth + rng.normal(size=40)
    z[wrong] += size
    found = run_judged(TRACKERS[name], t, z, 1.0, GATE)
    assert np.abs(found.result.filtered - truth)[12:].max() < 10


def test_a_target_that_jumps_is_followed_again():
    t = np.arange(40.0)
    z = 5 * t + np.random.default_rng(5).normal(size=40)
    z[20:] += 1e5
    found = run_judged(FIXED, t, z, 1.0, GATE)
    assert np.flatnonzero(found.rejected).tolist() == [20, 21, 22]
    assert np.flatnonzero(found.begins).tolist() == [23]
    assert found.result.filtered[23] == z[23]
    assert math.isnan(found.result.predicted[23])


def test_spikes_of_a_sonar():
    """Impulses among distances of about 0.52 m."""
    z = [0.52, 0.51, 0.52, 0.53, 0.07, 0.52, 0.51, 0.06, 0.52, 0.07, 0.51, 0.53, 0.52]
    for name in NAMES:
        found = run_judged(TRACKERS[name], 0.1 * np.arange(13), z, 0.01, GATE)
        assert np.flatnonzero(found.rejected).tolist() == [4, 7, 9]
        assert np.abs(found.result.filtered - 0.52).max() < 0.02


def test_fill_values():
    t = np.arange(30.0)
    z = 5 * t
    z[10], z[20] = 9.97e36, -1e300
    for name, tracker in TRACKERS.items():
        found = run_judged(tracker, t, z, 1.0, GATE)
        assert np.flatnonzero(found.rejected).tolist() == [10, 20], name


def test_bearing_through_north():
    z = [355.0, 356.0, 357.1, 358.0, 358.9, 0.1, 1.0, 2.0, 2.9, 4.1]
    circle = Circle()
    for judge, sigma in ((Judge(circle=circle), None), (Judge(Gate(), circle), 0.1)):
        found = run_judged(FIXED, np.arange(10), z, sigma, judge).result
        unwrapped = FIXED.run(np.arange(10), np.unwrap(z, period=360))
        np.testing.assert_array_equal(found.filtered, unwrapped.filtered)
        assert circle.wrapped(found.filtered)[5:] == pytest.approx(
            [0.024, 1.016, 2.009, 2.954, 4.015], abs=0.0006
        )
        assert found.velocity[5:] == pytest.approx(1, abs=0.025)
        assert np.abs(found.innovation[2:]).max() <= 0.17


def test_a_spike_on_the_circle():
    t = np.arange(60.0)
    z = np.mod(300 + 3 * t, 360)
    z[20], z[30] = np.mod(z[20] + 170, 360), np.mod(z[30] - 100, 360)
    found = run_judged(TRACKERS["kalman"], t, z, 1.0, Judge(Gate(), Circle()))
    assert np.flatnonzero(found.rejected).tolist() == [20, 30]
    assert Circle().wrapped(found.result.filtered) == pytest.approx(np.mod(300 + 3 * t, 360))


# -------------------------------------------------------------------- arguments


def test_wrong_arguments():
    t, z = np.arange(3.0), np.zeros((3, 2))
    with pytest.raises(ValueError, match="sigma: a gate needs the standard deviation"):
        run_judged(FIXED, t, z, None, GATE)
    with pytest.raises(DataError, match=r"z: infinite plot at index \(1, 0\)"):
        run_judged(FIXED, t, [[0, 0], [math.inf, 0], [0, 0]], 1.0, GATE)
    with pytest.raises(DataError, match="t: times must increase; the one at index 2"):
        run_judged(FIXED, [0, 1, 1], z, 1.0, GATE)
    with pytest.raises(ValueError, match="keep: unknown 'position'"):
        run_judged(FIXED, t, z, 1.0, GATE, keep=("position",))
    with pytest.raises(ValueError, match=r"memory: numbers of shape \(4, 2, 5\) do not fit"):
        run_judged(FIXED, t, z, 1.0, GATE, memory=JudgeMemory.fresh(4, 2))
    with pytest.raises(ValueError, match="do not go on from a state of shape"):
        run_judged(FIXED, t, z, 1.0, GATE, state=FIXED.start([0.0, 0.0, 0.0], -1.0))
    with pytest.raises(ValueError, match="width must be"):
        Gate(0.0)
    with pytest.raises(ValueError, match="again must not be negative, got -1"):
        Gate(again=-1)
    with pytest.raises(ValueError, match="period must be"):
        Circle(-1.0)


def test_the_deviation_of_the_tracker_serves_the_gate():
    tracker = make_tracker("kalman-cv:sigma_v=1:sigma_w=1")
    z = 5 * np.arange(20.0)
    z[10] = 1e4
    assert run_judged(tracker, np.arange(20), z, None, GATE).rejected[10]


def test_what_is_kept():
    found = run_judged(FIXED, [0, 1], [0.0, 1.0], 1.0, GATE, keep=("filtered",))
    assert found.result.kept == ("filtered",)


def test_constructor_code():
    judge = Judge(Gate(5.0), Circle(2.0))
    assert eval(repr(judge)) == judge
