import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzytrack import AlphaBetaTracker, DataError, FixedGains
from fuzzytrack.trackers.catalog import make_tracker
from fuzzytrack.trackers.track_store import TrackStore

FIXED = AlphaBetaTracker(FixedGains(0.5, 0.2))
TRACKERS = {
    name: make_tracker(name)
    for name in (
        "fixed:alpha=0.5:beta=0.2",
        "fading-memory:xi=0.6:order=2",
        "kalman-cv:sigma_v=1",
        "imm:quiet_sigma=0.1:maneuver_sigma=2",
        "imm:quiet_sigma=0.1:maneuver_sigma=2:joint=false",
    )
}


def equal(one, other):
    """Whether two states are the same to the last bit."""
    return (
        one.shape == other.shape
        and np.array_equal(one.time, other.time)
        and np.array_equal(one.lanes, other.lanes, equal_nan=True)
    )


def alone(tracker, history):
    """State of one track, run by itself through all its plots."""
    times, plots, sigmas = (np.array(column) for column in zip(*history, strict=True))
    return tracker.run(times, plots, sigmas).state


def started(store, z, t=0.0):
    return store.add(store.tracker.start(z, t, 1.0))


class Mirror:
    """A store beside the whole history of each of its tracks."""

    def __init__(self, name, n_axes, seed):
        self.store = TrackStore(TRACKERS[name], n_axes)
        self.random, self.n_axes = np.random.default_rng(seed), n_axes
        self.histories = {}

    def drawn(self, count):
        plots = 10 * self.random.normal(size=(count, self.n_axes))
        plots[self.random.random(plots.shape) < 0.15] = math.nan
        return plots, self.random.uniform(0.5, 2.0, plots.shape)

    def some(self, share):
        """Some of the tracks, in any order."""
        slots = self.random.permutation(self.store.slots)
        return slots[: round(share * len(slots))]

    def remember(self, slots, times, plots, sigmas):
        for slot, *plot in zip(slots.tolist(), times, plots, sigmas, strict=True):
            self.histories.setdefault(slot, []).append(plot)

    def add(self, count):
        plots, sigmas = self.drawn(count)
        times = self.random.uniform(0.0, 5.0, count)
        slots = self.store.add(self.store.tracker.start(plots, times, sigmas))
        assert not set(slots.tolist()) & set(self.histories)
        self.remember(slots, times, plots, sigmas)

    def drop(self, share):
        slots = self.some(share)
        self.store.drop(slots)
        for slot in slots.tolist():
            del self.histories[slot]

    def step(self, share):
        slots = self.some(share)
        plots, sigmas = self.drawn(len(slots))
        times = self.store.time(slots) + self.random.uniform(0.1, 3.0, len(slots))
        after = self.store.step(slots, plots, times, sigmas)
        self.remember(slots, times, plots, sigmas)
        assert equal(after, self.store.gather(slots))

    def check(self):
        store = self.store
        assert store.slots.tolist() == sorted(self.histories)
        assert len(store) == len(self.histories)
        assert len(store) <= store.room
        for slot, history in self.histories.items():
            expected = alone(store.tracker, history)
            found = store.gather([slot])
            assert found.time[0] == expected.time
            np.testing.assert_array_equal(found.lanes, expected.lanes)


@given(
    name=st.sampled_from(sorted(TRACKERS)),
    n_axes=st.integers(1, 3),
    seed=st.integers(0, 2**32 - 1),
    actions=st.lists(
        st.one_of(
            st.tuples(st.just("add"), st.integers(0, 6)),
            st.tuples(st.just("drop"), st.sampled_from([0.0, 0.3, 1.0])),
            st.tuples(st.just("step"), st.sampled_from([0.0, 0.5, 1.0])),
        ),
        max_size=12,
    ),
)
@settings(max_examples=60)
def test_tracks_in_a_store_equal_each_track_alone(name, n_axes, seed, actions):
    mirror = Mirror(name, n_axes, seed)
    for action, much in actions:
        getattr(mirror, action)(much)
    mirror.check()


def test_slots_are_given_out_again():
    store = TrackStore(FIXED, 1)
    assert started(store, [[1.0], [2.0], [3.0], [4.0]]).tolist() == [0, 1, 2, 3]
    store.drop([1, 3])
    assert (len(store), store.slots.tolist()) == (2, [0, 2])
    assert started(store, [[5.0], [6.0], [7.0]]).tolist() == [3, 1, 4]
    assert store.gather(store.slots).position.tolist() == [[1], [6], [3], [5], [7]]


def test_room_grows_only_where_it_must():
    store = TrackStore(FIXED, 2)
    for k in range(50):
        started(store, np.full((4, 2), k), k)
        store.drop(store.slots[:3])
    assert len(store) == 50
    assert 53 <= store.room < 80
    for _ in range(5):
        store.drop(started(store, np.zeros((store.room - len(store), 2))))
    assert store.room < 80


def test_one_track_is_taken_in_as_it_is():
    store = TrackStore(FIXED, 2)
    state = FIXED.run([0.0, 1.0, 3.0], [[0.0, 5.0], [1.0, 4.0], [3.0, 3.5]]).state
    (slot,) = store.add(state)
    found = store.gather([slot])
    assert found.shape == (1, 2)
    np.testing.assert_array_equal(found.lanes, state.lanes)
    later = FIXED.step(state, [4.0, 3.0], 4.5)
    store.scatter([slot], later)
    np.testing.assert_array_equal(store.gather([slot]).lanes, later.lanes)
    assert store.time([slot]).tolist() == [4.5]


def test_a_store_of_nothing():
    store = TrackStore(TRACKERS["kalman-cv:sigma_v=1"], 2)
    assert (len(store), store.room, store.slots.tolist()) == (0, 0, [])
    assert store.gather([]).position.shape == (0, 2)
    assert store.step([], np.empty((0, 2)), 1.0, 1.0).shape == (0, 2)
    assert started(store, np.empty((0, 2))).tolist() == []
    store.drop([])


def test_a_gathered_state_is_a_copy():
    store = TrackStore(FIXED, 1)
    slots = started(store, [[1.0], [2.0]])
    state = store.gather(slots)
    store.step(slots, [[5.0], [6.0]], 1.0)
    assert state.position.tolist() == [[1], [2]]
    assert state.time.tolist() == [0, 0]


def test_a_store_pickles_and_grows_on():
    store = TrackStore(FIXED, 2)
    started(store, np.arange(8.0).reshape(4, 2))
    store.drop([2])
    copy = pickle.loads(pickle.dumps(store, protocol=5))
    for each in (store, copy):
        started(each, np.full((20, 2), 7.0), 3.0)
    assert copy.slots.tolist() == store.slots.tolist()
    assert equal(copy.gather(copy.slots), store.gather(store.slots))


def test_a_step_that_fails_changes_nothing():
    store = TrackStore(FIXED, 1)
    slots = started(store, [[1.0], [2.0]], [0.0, 5.0])
    with pytest.raises(DataError, match="times must increase"):
        store.step(slots, [[3.0], [4.0]], 5.0)
    with pytest.raises(DataError, match="infinite plot"):
        store.step(slots, [[3.0], [math.inf]], 6.0)
    assert store.time(slots).tolist() == [0, 5]
    assert store.gather(slots).position.tolist() == [[1], [2]]


@pytest.mark.parametrize(
    ("slots", "message"),
    [
        ([0, 1], "there is no track in slot 1"),
        ([3, 0], "there is no track in slot 3"),
        ([-1], "there is no track in slot -1"),
        ([0, 2, 0], "slot 0 is named twice"),
        ([0.5], r"needs whole numbers, shape \(n,\); got float64, shape \(1,\)"),
        (0, r"needs whole numbers, shape \(n,\); got int64, shape \(\)"),
    ],
)
def test_slots_without_a_track(slots, message):
    store = TrackStore(FIXED, 1)
    started(store, [[1.0], [2.0], [3.0]])
    store.drop([1])
    for use in (store.drop, store.gather, store.time, lambda s: store.step(s, [[1.0]], 1.0)):
        with pytest.raises(ValueError, match=message):
            use(slots)
    assert store.slots.tolist() == [0, 2]


def test_states_that_do_not_fit():
    store = TrackStore(FIXED, 2)
    for z, shape in (
        (1.0, r"\(\)"),
        ([1.0], r"\(1,\)"),
        ([[1.0]], r"\(1, 1\)"),
        ([[[1.0, 2.0]]], r"\(1, 1, 2\)"),
    ):
        with pytest.raises(
            ValueError, match=rf"state: shape {shape} does not fit; a state of 1 track and 2 axes"
        ):
            store.add(FIXED.start(z, 0.0))
    with pytest.raises(ValueError, match=r"state: it comes from AlphaBetaTracker\(KalmanCV"):
        store.add(TRACKERS["kalman-cv:sigma_v=1"].start([[1.0, 2.0]], 0.0, 1.0))
    slots = started(store, [[1.0, 2.0], [3.0, 4.0]])
    with pytest.raises(ValueError, match="a state of 2 tracks and 2 axes has"):
        store.scatter(slots, FIXED.start([[1.0, 2.0]], 0.0))
    with pytest.raises(TypeError, match="state must be a TrackState, got TrackResult"):
        store.add(FIXED.run([0.0], [[[1.0, 2.0]]]))


def test_what_a_store_is_made_of():
    scheduler = FixedGains(0.5, 0.2)
    for tracker in (None, 3, scheduler, AlphaBetaTracker):
        with pytest.raises(TypeError, match="tracker must be a Tracker, or a text"):
            TrackStore(tracker, 1)
    for n_axes in (0, -1):
        with pytest.raises(ValueError, match=f"n_axes must be at least 1, got {n_axes}"):
            TrackStore(AlphaBetaTracker(scheduler), n_axes)
    with pytest.raises(TypeError, match="integer"):
        TrackStore(AlphaBetaTracker(scheduler), 1.5)
